//! Where samples gather: a sum for each pixel, and how many samples it holds.

use std::sync::Arc;

use super::spread::{self, Spread};
use crate::geometry::num::narrow;

/// Sums of samples. A pixel is red, green, blue and coverage; in scalar modes the first is the
/// amount. Row 0 is the top.
#[derive(Clone, Debug, PartialEq)]
pub struct Film {
    width: u32,
    height: u32,
    sums: Vec<[f32; 4]>,
    /// Linear depth of the first sample, infinite for a miss, in the scaled space.
    depth: Arc<Vec<f32>>,
    samples: u32,
    /// How sure each pixel is, if that is asked.
    spreads: Option<Vec<Spread>>,
    /// Whether those that are sure get no more samples.
    rests: bool,
    /// Pixels that got a sample in the last pass.
    sampled: usize,
}

/// What of a film some rows are.
pub(super) struct Band<'a> {
    /// The sums.
    pub sums: &'a mut [[f32; 4]],
    /// The depths, while they are still to be written.
    pub depth: Option<&'a mut [f32]>,
    /// How sure the pixels are, if that is asked.
    pub spreads: Option<&'a mut [Spread]>,
}

impl Film {
    /// An empty film of at least one pixel.
    pub fn new(width: u32, height: u32) -> Self {
        let (width, height) = (width.max(1), height.max(1));
        let pixels = width as usize * height as usize;
        let depth = Arc::new(vec![f32::INFINITY; pixels]);
        Self { width, height, sums: vec![[0.0; 4]; pixels], depth, samples: 0, spreads: None, rests: false, sampled: pixels }
    }

    /// The same, which estimates its noise ([`Self::noise`]).
    pub fn estimating(width: u32, height: u32) -> Self {
        let film = Self::new(width, height);
        Self { spreads: Some(vec![Spread::default(); film.pixels()]), ..film }
    }

    /// The same, of which pixels that have converged get no more samples.
    pub fn converging(width: u32, height: u32) -> Self {
        Self { rests: true, ..Self::estimating(width, height) }
    }

    /// Columns.
    pub const fn width(&self) -> u32 {
        self.width
    }

    /// Rows.
    pub const fn height(&self) -> u32 {
        self.height
    }

    /// Samples in each pixel, but for those that have converged before.
    pub const fn samples(&self) -> u32 {
        self.samples
    }

    /// Counts a pass as done, in which so many pixels got a sample.
    pub(super) const fn pass_done(&mut self, sampled: usize) {
        self.samples += 1;
        self.sampled = sampled;
    }

    /// The share of pixels that got a sample in the last pass: the others cannot see the scene, or have converged.
    pub fn share(&self) -> f64 {
        self.sampled as f64 / self.pixels() as f64
    }

    /// Whether it has so many samples, or no pixel gets more.
    pub const fn is_done(&self, max_samples: u32) -> bool {
        self.samples >= max_samples || self.sampled == 0
    }

    /// For each pixel whether it has converged; `None` if nobody asks, or none can have.
    pub(super) fn converged(&self) -> Option<Vec<bool>> {
        let spreads = self.spreads.as_ref().filter(|_| self.rests && self.samples >= spread::LEAST);
        spreads.map(|spreads| spread::at_rest(spreads, self.width as usize))
    }

    /// Bands of rows: sums to add to and, for the first sample, depths to write. Later the depths are
    /// shared with pictures and stay as they are.
    pub(super) fn bands_mut(&mut self, rows: usize) -> Vec<Band<'_>> {
        let chunk = rows * self.width as usize;
        let mut depth = (self.samples == 0).then(|| Arc::make_mut(&mut self.depth).chunks_mut(chunk));
        let mut spreads = self.spreads.as_mut().map(|spreads| spreads.chunks_mut(chunk));
        let band = |sums| {
            let (depth, spreads) = (depth.as_mut().and_then(Iterator::next), spreads.as_mut().and_then(Iterator::next));
            Band { sums, depth, spreads }
        };
        self.sums.chunks_mut(chunk).map(band).collect()
    }

    /// Their number.
    pub const fn pixels(&self) -> usize {
        self.sums.len()
    }

    /// The mean of a pixel's samples.
    #[inline]
    pub(super) fn mean(&self, pixel: usize) -> [f32; 4] {
        let n = self.spreads.as_ref().map_or(self.samples, |spreads| spreads[pixel].n);
        let scale = 1.0 / n.max(1) as f32;
        self.sums[pixel].map(|x| x * scale)
    }

    /// The mean of each pixel's samples.
    pub fn means(&self) -> impl Iterator<Item = [f32; 4]> + '_ {
        (0..self.pixels()).map(|pixel| self.mean(pixel))
    }

    /// The estimated noise: the standard error of pixels' linear red, green and blue, root mean square over the picture. From
    /// the samples alone (Welford 1962), as if they were independent: those that fill space evenly are less noisy than that.
    /// `None` if it was not asked for, or there are fewer than two samples.
    pub fn noise(&self) -> Option<f64> {
        let spreads = self.spreads.as_ref().filter(|_| self.samples >= 2)?;
        let sum: f64 = spreads.iter().map(Spread::error_squared).sum();
        Some((sum / (3.0 * spreads.len() as f64)).sqrt())
    }

    /// The exposure in stops that makes the geometric mean of what is seen a middle grey; `None` where all is black.
    pub fn fitting_exposure(&self) -> Option<f32> {
        /// What is darker is told apart by nobody, and would count for much in a mean of logarithms.
        const LEAST: f32 = 1e-6;
        let bright = |[r, g, b, hit]: [f32; 4]| (hit > 0.0).then(|| (0.2126 * r + 0.7152 * g + 0.0722 * b) / hit);
        let seen = self.means().filter_map(bright).filter(|x| *x > LEAST && x.is_finite());
        let (n, sum) = seen.fold((0u32, 0.0f64), |(n, sum), x| (n + 1, sum + f64::from(x.log2())));
        (n > 0).then(|| narrow(0.18f64.log2() - sum / f64::from(n)))
    }

    /// All light of all samples: sums of red, green and blue.
    pub fn light(&self) -> f64 {
        self.sums.iter().flat_map(|sum| &sum[..3]).map(|x| f64::from(*x)).sum()
    }

    /// The amount of each pixel, in scalar modes; no number where nothing is seen.
    pub fn amounts(&self) -> Vec<f32> {
        self.means().map(|[amount, _, _, seen]| if seen > 0.0 { amount / seen } else { f32::NAN }).collect()
    }

    /// Linear red, green and blue of each pixel over black.
    pub fn linear(&self) -> Vec<[f32; 3]> {
        self.means().map(|[r, g, b, _]| [r, g, b]).collect()
    }

    /// Linear depths of the first sample, in the scaled space.
    pub const fn depth(&self) -> &Arc<Vec<f32>> {
        &self.depth
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_exposure_that_fits_makes_the_mean_a_middle_grey() {
        let mut film = Film::new(3, 1);
        assert_eq!(film.fitting_exposure(), None, "nothing is seen");
        for band in film.bands_mut(1) {
            band.sums.copy_from_slice(&[[0.72, 0.72, 0.72, 1.0], [0.09, 0.09, 0.09, 0.5], [0.0; 4]]);
        }
        film.pass_done(2);
        // Half of the second pixel is covered by 0.18: the geometric mean is 0.36, one stop too bright.
        let stops = film.fitting_exposure().expect("something is seen");
        assert!((stops + 1.0).abs() < 1e-5, "{stops}");
    }
}
