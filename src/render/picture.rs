//! A finished pass as the window gets it.

use super::{Amounts, Range};
use std::sync::Arc;

use crate::accel::probe::Counts;
use crate::geometry::num::floor_index;
use crate::scene::Camera;
use crate::task::Charge;
use glam::Vec2;

/// Bytes to show, the depth behind them, and how they came to be.
#[derive(Clone, Debug)]
pub struct Picture {
    /// Grows with every picture; two of one generation are the same.
    pub generation: u64,
    /// The request it answers.
    pub request: u64,
    /// From where it is seen.
    pub camera: Camera,
    /// Columns; fewer than asked for in a coarse pass.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Gamma-encoded red, green, blue and opacity, multiplied by opacity; row 0 at the top.
    pub rgba: Vec<u8>,
    /// Linear depth in the scaled space, infinite where nothing is hit.
    pub depth: Arc<Vec<f32>>,
    /// The range that amounts were mapped with.
    pub range: Range,
    /// The amounts of a heat map.
    pub amounts: Option<Arc<Amounts>>,
    /// The range that would suit them.
    pub suits: Range,
    /// How far the picture is.
    pub progress: Progress,
    /// What was kept on the way, if that was asked for.
    pub shots: Vec<Arc<Shot>>,
}

impl Picture {
    /// The amount at a place: (-1, -1) is the lower left corner, (1, 1) the upper right. `None` outside, where nothing is seen,
    /// and of pictures that are no heat maps.
    pub fn amount_at(&self, at: Vec2) -> Option<f32> {
        let inside = at.abs().max_element() <= 1.0;
        let place = |x: f32, n: u32| {
            let last = n.saturating_sub(1) as usize;
            floor_index(f64::from(x * 0.5 + 0.5) * f64::from(n), last)
        };
        let pixel = place(-at.y, self.height) * self.width as usize + place(at.x, self.width);
        self.amounts.as_ref().filter(|_| inside)?.values.get(pixel).copied().filter(|amount| amount.is_finite())
    }
}

/// What is kept of a picture on its way: the light of so many samples.
#[derive(Debug)]
pub struct Shot {
    /// Samples in each pixel.
    pub samples: u32,
    /// Seconds that they took to trace and shade.
    pub secs: f64,
    /// The estimated noise.
    pub noise: Option<f64>,
    /// Linear red, green and blue, row by row; `None` where the memory budget had no room.
    pub light: Option<Vec<[f32; 3]>>,
    pub(super) _memory: Option<Charge>,
}

/// How far a picture is, and at what pace.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Progress {
    /// Samples in each pixel.
    pub samples: u32,
    /// Screen pixels to a pixel of the picture, on each axis: more than 1 in a coarse pass.
    pub step: u32,
    /// Seconds from the request to this picture.
    pub secs: f64,
    /// The exposure that would suit ([`super::Film::fitting_exposure`]), of path traced pictures.
    pub exposure: Option<f32>,
    /// The share of pixels that got a sample in this pass: the others cannot see the scene, or have converged.
    pub share: f64,
    /// Rays traced a second in this pass, by all threads.
    pub rays_per_sec: f64,
    /// What camera rays do in this view: summed over [`Self::counted`] of them, but for the stack, which is the deepest.
    pub counts: Counts,
    /// Rays that were counted.
    pub counted: u64,
    /// No more samples will come.
    pub done: bool,
}
