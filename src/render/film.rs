//! Where samples gather: a sum for each pixel, and how many samples it holds.

/// Sums of samples. A pixel is red, green, blue and coverage; in scalar modes the first is the
/// amount. Row 0 is the top.
#[derive(Clone, Debug, PartialEq)]
pub struct Film {
    width: u32,
    height: u32,
    sums: Vec<[f32; 4]>,
    /// Linear depth of the first sample, infinite for a miss, in the scaled space.
    depth: Vec<f32>,
    samples: u32,
}

impl Film {
    /// An empty film of at least one pixel.
    pub fn new(width: u32, height: u32) -> Self {
        let (width, height) = (width.max(1), height.max(1));
        let pixels = width as usize * height as usize;
        Self { width, height, sums: vec![[0.0; 4]; pixels], depth: vec![f32::INFINITY; pixels], samples: 0 }
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

    /// Sums and depths, to be added to by rows.
    pub(super) fn rows_mut(&mut self, rows: usize) -> impl Iterator<Item = (&mut [[f32; 4]], &mut [f32])> {
        let chunk = rows * self.width as usize;
        self.sums.chunks_mut(chunk).zip(self.depth.chunks_mut(chunk))
    }

    /// The mean of each pixel's samples.
    pub fn means(&self) -> impl Iterator<Item = [f32; 4]> + '_ {
        let scale = 1.0 / self.samples.max(1) as f32;
        self.sums.iter().map(move |s| s.map(|x| x * scale))
    }

    /// Linear depths of the first sample, in the scaled space.
    pub fn depth(&self) -> &[f32] {
        &self.depth
    }
}
