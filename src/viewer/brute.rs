//! What the window knows of comparing a part of the picture with brute force.

use std::sync::Arc;
use std::time::Instant;

use super::kept::{Built, Key};
use super::workers::{Shared, build_now};
use crate::accel::{BuildCx, BuildError, Visibility};
use crate::geometry::HalfSpace;
use crate::job::Job;
use crate::lab::{BruteCheck, PixelRect, UnlikePixel, check_by_brute_force};
use crate::render;
use crate::scene::Camera;
use crate::task::Progress;
use glam::Vec2;

/// The most seconds that it takes: its user waits.
pub const SECS: f64 = 20.0;

/// The comparison on its way, with brute force, which may have to be built for it; or why there is none: nothing to say where
/// it was stopped.
pub type Comparing = Job<Result<(BruteCheck, Built), String>>;

/// Starts comparing a rectangle of a view; brute force is there, or is built first.
pub fn compare(shared: &Shared, there: Result<Built, Key>, view: render::Job, part: Part) -> std::io::Result<Comparing> {
    let Shared { pool, budget, .. } = shared.clone();
    Job::spawn("brute force", shared.waker(), move |cancel, progress| {
        let built = match there {
            Ok(built) => built,
            Err(key) => {
                // Its phases are not told.
                let cx = BuildCx::new(cancel.clone(), Progress::new(), pool.clone(), budget);
                match build_now(key, view.accel.geometry(), &cx) {
                    Ok(built) => built,
                    Err(BuildError::Cancelled(_)) => return Err(String::new()),
                    Err(why) => return Err(why.to_string()),
                }
            }
        };
        let found = check_by_brute_force(&view, &built.accel, (part.size_px, part.rect, SECS), &pool, cancel, progress);
        found.map(|found| (found, built)).map_err(|_| String::new())
    })
}

/// What is compared: a result says nothing of any other view.
#[derive(Clone, Debug, PartialEq)]
pub struct Of {
    /// The structure.
    pub key: Key,
    /// From where it is seen.
    pub camera: Camera,
    /// What of the world is left.
    pub section: Option<HalfSpace>,
    /// Which triangles are seen.
    pub visible: Option<Arc<Visibility>>,
}

/// The pixels that are compared.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Part {
    /// Which.
    pub rect: PixelRect,
    /// Columns and rows of the view that they are of; the viewport may have another size since.
    pub size_px: [u32; 2],
}

impl Part {
    /// Where a point of it, in pixels, is in a viewport of that aspect, width over height: from 0 to 1 from the upper left
    /// corner. A camera sees as much from top to bottom whatever the viewport's shape.
    pub fn place(&self, at: Vec2, aspect: f32) -> Vec2 {
        let size = self.size();
        let at = at / size - 0.5;
        Vec2::new(at.x * (size.x / size.y) / aspect, at.y) + 0.5
    }

    /// The other way round.
    fn pixel(&self, place: Vec2, aspect: f32) -> Vec2 {
        let size = self.size();
        let at = place - 0.5;
        (Vec2::new(at.x * aspect / (size.x / size.y), at.y) + 0.5) * size
    }

    fn size(&self) -> Vec2 {
        Vec2::from(self.size_px.map(|n| n.max(1) as f32))
    }
}

/// Everything of it.
#[derive(Default)]
pub struct Brute {
    /// The next drag in the view marks a rectangle.
    pub marking: bool,
    /// What is compared, or was.
    pub of: Option<(Of, Part)>,
    /// The comparison and when it began, while it runs.
    pub running: Option<(Comparing, Instant)>,
    /// What it has found.
    pub found: Option<BruteCheck>,
    /// Which of the pixels that differ is followed next.
    pub next: usize,
}

impl Brute {
    /// Forgets what was found, and stops.
    pub fn clear(&mut self) {
        *self = Self { marking: self.marking, ..Self::default() };
    }

    /// The pixels that differ.
    pub fn unlike(&self) -> &[UnlikePixel] {
        self.found.as_ref().map_or(&[], |found| &found.examples)
    }

    /// The nearest of them to a place of the viewport, from 0 to 1 from the upper left corner, of that aspect; none that is
    /// farther than a part of its height.
    pub fn near(&self, place: Vec2, aspect: f32, within: f32) -> Option<usize> {
        let (_, part) = self.of.as_ref()?;
        let at = part.pixel(place, aspect);
        let away = |e: &UnlikePixel| at.distance(middle(e)) / part.size().y;
        let near = self.unlike().iter().enumerate().map(|(i, e)| (away(e), i)).filter(|(away, _)| *away <= within);
        near.min_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, i)| i)
    }
}

/// The middle of a pixel, in pixels.
pub fn middle(unlike: &UnlikePixel) -> Vec2 {
    Vec2::from(unlike.pixel.map(|n| n as f32)) + 0.5
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accel::registry;
    use crate::geometry::Ray;
    use crate::geometry::tri::TestKind;
    use glam::Vec3;

    #[test]
    fn a_click_takes_the_nearest_pixel_that_differs() {
        let ray = Ray::new(Vec3::ZERO, Vec3::Z);
        let pixel = |x, y| UnlikePixel { pixel: [x, y], ray, brute: None, found: None, rounded: false };
        let entry = &registry::ALL[0];
        let key = Key { entry, params: entry.defaults(), test: TestKind::default() };
        let camera = Camera::framing(&crate::geometry::Aabb::EMPTY, Vec3::Z, Vec3::Y, 1.0);
        let of = Of { key, camera, section: None, visible: None };
        let part = Part { rect: PixelRect::whole([200, 100]), size_px: [200, 100] };
        let found = BruteCheck { examples: vec![pixel(99, 49), pixel(104, 49)], ..BruteCheck::default() };
        let brute = Brute { of: Some((of, part)), found: Some(found), ..Brute::default() };
        let near = |x: f32, y: f32, aspect: f32| brute.near(Vec2::new(x, y), aspect, 0.08);
        assert_eq!(near(0.5, 0.5, 2.0), Some(0));
        assert_eq!(near(0.52, 0.5, 2.0), Some(1));
        assert_eq!(near(0.75, 0.25, 2.0), None);
        // In a narrower viewport they are farther from the middle.
        assert_eq!(near(0.545, 0.5, 1.0), Some(1));
        assert_eq!(Brute::default().near(Vec2::splat(0.5), 2.0, 1.0), None);
        let corner = part.place(Vec2::new(200.0, 0.0), 4.0);
        assert_eq!((corner, part.pixel(corner, 4.0)), (Vec2::new(0.75, 0.0), Vec2::new(200.0, 0.0)));
    }
}
