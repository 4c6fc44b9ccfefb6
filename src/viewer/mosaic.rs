//! Compared pictures as one, as they stand in the window.

use std::sync::Arc;

use super::compared;
use super::figure;
use super::panes::Arrange;
use super::state::State;
use crate::render::Picture;
use crate::task::Cancel;

/// The pictures, and how they stand.
pub struct Mosaic {
    arrange: Arrange,
    /// Where strips begin but for the first, from 0 to 1.
    dividers: Vec<f32>,
    /// Columns and rows of one view.
    view: [u32; 2],
    /// The first, and those beside it; nothing where there is none yet.
    pictures: Vec<Option<Arc<Picture>>>,
}

impl Mosaic {
    /// The pictures on the screen; `None` while the first is not there.
    pub fn of(state: &State) -> Option<Self> {
        let panes = &state.settings.panes;
        state.on_screen()?;
        let pictures = compared::shown(state).into_iter().map(|shown| shown.picture.cloned()).collect();
        let view = state.size_px.map(|side| side.max(1));
        Some(Self { arrange: panes.arrange, dividers: panes.places(), view, pictures })
    }

    /// As PNG: strips of one view, or whole views side by side, clear where there is none.
    ///
    /// # Errors
    /// In words; there is none that ordinary pictures give, but that it was stopped.
    pub fn png(&self, cancel: &Cancel) -> Result<Vec<u8>, String> {
        let [across, down] = match self.arrange {
            Arrange::Divider => [1, 1],
            Arrange::Two => [2, 1],
            Arrange::Four => [2, 2],
        };
        let [width, height] = [self.view[0].saturating_mul(across), self.view[1].saturating_mul(down)];
        let mut rgba = Vec::new();
        for y in 0..height {
            cancel.check().map_err(|_| "Stopped.".to_owned())?;
            (0..width).for_each(|x| rgba.extend(self.pixel([x, y], across)));
        }
        figure::encoded(&rgba, [width, height])
    }

    /// What is seen at a pixel, in a row of so many views.
    fn pixel(&self, [x, y]: [u32; 2], across: u32) -> [u8; 4] {
        let [width, height] = self.view;
        let which = match self.arrange {
            Arrange::Divider => {
                let begins = |at: &&f32| x as f32 + 0.5 >= **at * width as f32;
                self.dividers.iter().filter(begins).count()
            }
            Arrange::Two | Arrange::Four => (y / height * across + x / width) as usize,
        };
        // A strip without a picture shows the first, as in the window.
        let instead = self.pictures.first().filter(|_| self.arrange == Arrange::Divider);
        let picture = self.pictures.get(which).and_then(Option::as_ref).or_else(|| instead.and_then(Option::as_ref));
        picture.map_or([0; 4], |picture| at(picture, [x % width, y % height], self.view))
    }
}

/// The pixel of a picture, of any resolution, that covers one of a view.
fn at(picture: &Picture, [x, y]: [u32; 2], [width, height]: [u32; 2]) -> [u8; 4] {
    let index = |at: u32, of: u32, n: u32| (u64::from(at) * u64::from(n) / u64::from(of)) as usize;
    let pixel = index(y, height, picture.height) * picture.width as usize + index(x, width, picture.width);
    picture.rgba.as_chunks::<4>().0.get(pixel).copied().unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::render::Range;
    use crate::scene::{Camera, Projection};
    use glam::Vec3;

    /// A picture of one colour.
    fn plain(color: u8, [width, height]: [u32; 2]) -> Option<Arc<Picture>> {
        let projection = Projection::Perspective { fov_y: 1.0 };
        let range = Range { min: 0.0, max: 1.0 };
        Some(Arc::new(Picture {
            generation: 1,
            request: 1,
            camera: Camera { eye: Vec3::Z, target: Vec3::ZERO, up: Vec3::Y, projection },
            width,
            height,
            rgba: [color, color, color, 255].repeat((width * height) as usize),
            depth: Arc::default(),
            range,
            progress: crate::render::Progress::default(),
            amounts: None,
            suits: range,
            shots: Vec::new(),
        }))
    }

    fn drawn(mosaic: &Mosaic) -> image::RgbaImage {
        image::load_from_memory(&mosaic.png(&Cancel::new()).expect("made")).expect("a picture").into_rgba8()
    }

    #[test]
    fn strips_are_those_of_one_view() {
        let view = [8, 2];
        // The second is coarse, and the third not there yet.
        let pictures = vec![plain(10, view), plain(20, [2, 1]), None];
        let mosaic = Mosaic { arrange: Arrange::Divider, dividers: vec![0.25, 0.5], view, pictures };
        let image = drawn(&mosaic);
        assert_eq!(image.dimensions(), (8, 2));
        let row: Vec<u8> = (0..8).map(|x| image.get_pixel(x, 1).0[0]).collect();
        assert_eq!(row, [10, 10, 20, 20, 10, 10, 10, 10]);
    }

    #[test]
    fn views_stand_in_rows_and_an_empty_place_is_clear() {
        let view = [3, 2];
        let pictures = vec![plain(10, view), plain(20, view), plain(30, view)];
        let mosaic = Mosaic { arrange: Arrange::Four, dividers: Vec::new(), view, pictures };
        let image = drawn(&mosaic);
        assert_eq!(image.dimensions(), (6, 4));
        let corners = [[2, 1], [3, 0], [0, 2], [5, 3]].map(|[x, y]| image.get_pixel(x, y).0);
        assert_eq!(corners.map(|c| c[0]), [10, 20, 30, 0]);
        assert_eq!(corners.map(|c| c[3]), [255, 255, 255, 0]);
        let two = Mosaic { arrange: Arrange::Two, ..mosaic };
        assert_eq!(drawn(&two).dimensions(), (6, 2));
        let stopped = Cancel::new();
        stopped.cancel();
        assert!(two.png(&stopped).is_err());
    }
}
