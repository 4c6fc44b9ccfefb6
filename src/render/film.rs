//! Where samples gather: a sum for each pixel, and how many samples it holds.

use std::sync::Arc;

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
}

/// The sums of some rows, and their depths while they are still to be written.
pub(super) type Band<'a> = (&'a mut [[f32; 4]], Option<&'a mut [f32]>);

impl Film {
    /// An empty film of at least one pixel.
    pub fn new(width: u32, height: u32) -> Self {
        let (width, height) = (width.max(1), height.max(1));
        let pixels = width as usize * height as usize;
        Self { width, height, sums: vec![[0.0; 4]; pixels], depth: Arc::new(vec![f32::INFINITY; pixels]), samples: 0 }
    }

    /// Columns.
    pub const fn width(&self) -> u32 {
        self.width
    }

    /// Rows.
    pub const fn height(&self) -> u32 {
        self.height
    }

    /// Samples in each pixel.
    pub const fn samples(&self) -> u32 {
        self.samples
    }

    /// Counts a pass as done.
    pub(super) const fn pass_done(&mut self) {
        self.samples += 1;
    }

    /// Bands of rows: sums to add to and, for the first sample, depths to write. Later the depths are
    /// shared with pictures and stay as they are.
    pub(super) fn bands_mut(&mut self, rows: usize) -> Vec<Band<'_>> {
        let chunk = rows * self.width as usize;
        let sums = self.sums.chunks_mut(chunk);
        if self.samples > 0 {
            return sums.map(|sums| (sums, None)).collect();
        }
        let depth = Arc::make_mut(&mut self.depth).chunks_mut(chunk);
        sums.zip(depth.map(Some)).collect()
    }

    /// Their number.
    pub const fn pixels(&self) -> usize {
        self.sums.len()
    }

    /// The sums of each pixel's samples.
    pub(super) fn sums(&self) -> &[[f32; 4]] {
        &self.sums
    }

    /// The mean of each pixel's samples.
    pub fn means(&self) -> impl Iterator<Item = [f32; 4]> + '_ {
        let scale = 1.0 / self.samples.max(1) as f32;
        self.sums.iter().map(move |s| s.map(|x| x * scale))
    }

    /// Linear depths of the first sample, in the scaled space.
    pub const fn depth(&self) -> &Arc<Vec<f32>> {
        &self.depth
    }
}
