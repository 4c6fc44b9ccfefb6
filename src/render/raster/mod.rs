//! The other way round: for each triangle the pixels, instead of for each pixel the triangles. A
//! rasteriser with a z-buffer (Catmull 1974), which sees what the primary rays of the same camera see.
//!
//! - Samples are those of the first pass of a picture, the rays of `RayKind::Primary`: pixel centres.
//! - Triangles have two sides. What counts is what lies before the eye, at any depth.
//! - Of equal depths the lowest (instance, primitive) stays, as in the tracer.
//!
//! Triangles are sorted into bands of rows, then each band is drawn by one thread (Molnar, Cox,
//! Ellsworth and Fuchs 1994 call it sort-middle), a batch of triangles at a time, so that the lists
//! stay small whatever the scene.

mod bands;
mod triangle;
mod view;

pub use triangle::Triangle;
pub use view::View;

use crate::geometry::num::narrow;
use crate::scene::{Camera, Geometry, PrimRef};
use crate::task::{Cancel, Cancelled, Pool, Progress};
use rayon::prelude::*;

/// A picture's z-buffer: what is nearest at each sample.
#[derive(Clone, Debug)]
pub struct Raster {
    width: u32,
    height: u32,
    /// Depth and primitive as one number each, so that the less is the nearer, and of two at the same
    /// depth the lower: the bits of a float that is not negative are ordered as it is.
    texels: Vec<u64>,
    /// What turns depths back into t: added first.
    near: f64,
    /// Then divided by.
    scale: f64,
}

/// Nothing is there.
const EMPTY: u64 = u64::MAX;

/// What is seen at a sample.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Seen {
    /// The triangle.
    pub prim: PrimRef,
    /// In units of the primary ray's direction, as a hit's.
    pub t: f32,
}

/// What a drawing did.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counts {
    /// Samples covered by triangles before the eye, hidden ones too: total pixels covered.
    pub covered: u64,
    /// Samples where something is seen.
    pub drawn: u64,
    /// Triangles that were drawn, as far as they cover samples.
    pub set_up: u64,
    /// Triangles that were not: behind the eye, off the screen, between samples, or edge on.
    pub culled: u64,
    /// Of those that were drawn, how many reach behind the eye.
    pub crossing: u64,
}

impl Counts {
    /// How often a sample was covered, in the mean over those where something is seen; NaN where
    /// there are none.
    pub fn overdraw(&self) -> f64 {
        self.covered as f64 / self.drawn as f64
    }

    /// The sum of both.
    fn join(self, other: Self) -> Self {
        Self {
            covered: self.covered + other.covered,
            drawn: self.drawn + other.drawn,
            set_up: self.set_up + other.set_up,
            culled: self.culled + other.culled,
            crossing: self.crossing + other.crossing,
        }
    }
}

impl Raster {
    /// An empty picture.
    pub fn new(width: u32, height: u32) -> Self {
        Self { width, height, texels: vec![EMPTY; width as usize * height as usize], near: 0.0, scale: 1.0 }
    }

    /// Bytes of a picture's z-buffer.
    pub const fn bytes(width: u32, height: u32) -> u64 {
        width as u64 * height as u64 * size_of::<u64>() as u64
    }

    /// Columns and rows.
    pub const fn size(&self) -> [u32; 2] {
        [self.width, self.height]
    }

    /// What is seen at the `i`-th sample, row by row from the top.
    pub fn seen(&self, i: usize) -> Option<Seen> {
        let texel = *self.texels.get(i).filter(|texel| **texel != EMPTY)?;
        let [high, low] = [texel >> 32, texel & 0xFFFF_FFFF].map(|half| u32::try_from(half).unwrap_or(u32::MAX));
        Some(Seen { prim: low, t: narrow((f64::from(f32::from_bits(high)) + self.near) / self.scale) })
    }

    /// Draws all triangles of a geometry over whatever was there.
    ///
    /// # Errors
    /// [`Cancelled`], within 100 ms of the request; the picture is then incomplete.
    pub fn draw(
        &mut self,
        geometry: &Geometry,
        camera: &Camera,
        pool: &Pool,
        cancel: &Cancel,
        progress: &Progress,
    ) -> Result<Counts, Cancelled> {
        let live = geometry.live_count();
        progress.start("rasterise", live as u64);
        cancel.check()?;
        pool.run(|| self.texels.par_chunks_mut(1 << 16).for_each(|texels| texels.fill(EMPTY)));
        let Some(view) = View::new(geometry, camera, self.width, self.height) else {
            return Ok(Counts { culled: live as u64, ..Counts::default() });
        };
        (self.near, self.scale) = (view.near, geometry.space().scale());
        let rows = bands::rows(self.height as usize, pool.threads());
        let batch = bands::batch(view.rows.len().div_ceil(rows));
        let mut counts = Counts::default();
        for first in (0..live).step_by(batch) {
            let triangles = first..live.min(first + batch);
            progress.advance(triangles.len() as u64);
            let scene = bands::Drawing { geometry, view: &view, rows, cancel };
            counts = counts.join(pool.run(|| scene.batch(triangles, &mut self.texels))?);
        }
        let drawn = |texels: &[u64]| texels.iter().filter(|texel| **texel != EMPTY).count() as u64;
        counts.drawn = pool.run(|| self.texels.par_chunks(1 << 16).map(drawn).sum());
        Ok(counts)
    }
}

#[cfg(test)]
mod tests;
