//! Where pictures stand on the page of a figure. All in pixels of a view, from the upper left corner.

use crate::viewer::panes::Arrange;
use crate::viewer::theme;

/// The gap between panes.
pub const GAP: f32 = theme::GUTTER;

/// How the pictures of a figure stand.
#[derive(Clone, Debug, PartialEq)]
pub enum Layout {
    /// One picture alone.
    Alone,
    /// Strips of one view, which begin there but for the first, from 0 to 1.
    Strips(Vec<f32>),
    /// Whole views, so many in a row and so many rows.
    Panes([u32; 2]),
}

impl Layout {
    /// As the window has them, with those dividers.
    pub fn of(arrange: Arrange, dividers: Vec<f32>) -> Self {
        match arrange {
            Arrange::Divider => Self::Strips(dividers),
            Arrange::Two => Self::Panes([2, 1]),
            Arrange::Four => Self::Panes([2, 2]),
        }
    }

    /// Columns and rows of views.
    pub const fn views(&self) -> [u32; 2] {
        match self {
            Self::Alone | Self::Strips(_) => [1, 1],
            Self::Panes(views) => *views,
        }
    }

    /// The places of pictures, A first, in views of that size with so much beneath each.
    pub fn places(&self, [width, height]: [f32; 2], beneath: f32) -> Vec<Place> {
        match self {
            Self::Alone => vec![Place { at: [0.0; 2], columns: [0.0, width], text: [0.0, width] }],
            Self::Strips(dividers) => {
                let even = width / (dividers.len() + 1) as f32;
                let edge = |i: usize| match i.checked_sub(1) {
                    None => 0.0,
                    Some(before) => dividers.get(before).map_or(width, |at| at * width),
                };
                let strip = |i: usize| Place { at: [0.0; 2], columns: [edge(i), edge(i + 1)], text: [i as f32 * even, even] };
                (0..=dividers.len()).map(strip).collect()
            }
            Self::Panes([across, down]) => {
                let pane = |i: u32| {
                    let [x, y] = [i % across, i / across].map(|i| i as f32);
                    let at = [x * (width + GAP), y * (height + beneath + GAP)];
                    Place { at, columns: [0.0, width], text: [at[0], width] }
                };
                (0..across * down).map(pane).collect()
            }
        }
    }

    /// The size of all of them together.
    pub fn size(&self, [width, height]: [f32; 2], beneath: f32) -> [f32; 2] {
        let [across, down] = self.views().map(|n| n as f32);
        [across * (width + GAP) - GAP, down * (height + beneath + GAP) - GAP]
    }
}

/// The place of a picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Place {
    /// The upper left corner of its view.
    pub at: [f32; 2],
    /// The columns of the view that are seen, from and to.
    pub columns: [f32; 2],
    /// Where the text beneath begins, and how wide it may be.
    pub text: [f32; 2],
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn strips_fill_one_view_and_panes_stand_in_rows() {
        let view = [100.0, 50.0];
        let strips = Layout::of(Arrange::Divider, vec![0.25, 0.25]);
        let columns: Vec<[f32; 2]> = strips.places(view, 20.0).iter().map(|place| place.columns).collect();
        assert_eq!(columns, [[0.0, 25.0], [25.0, 25.0], [25.0, 100.0]]);
        assert_eq!(strips.size(view, 20.0), [100.0, 70.0]);
        let four = Layout::of(Arrange::Four, Vec::new());
        let corners: Vec<[f32; 2]> = four.places(view, 20.0).iter().map(|place| place.at).collect();
        assert_eq!(corners, [[0.0, 0.0], [108.0, 0.0], [0.0, 78.0], [108.0, 78.0]]);
        assert_eq!(four.size(view, 20.0), [208.0, 148.0]);
        assert_eq!(Layout::Alone.size(view, 0.0), view);
    }
}
