//! Bands of rows: each is drawn by one thread, from the lists of the triangles that may reach it.

use std::ops::Range;

use super::{Counts, Triangle, View};
use crate::geometry::num::narrow;
use crate::scene::{Geometry, PrimRef};
use crate::task::{Cancel, Cancelled};
use rayon::prelude::*;

/// The most entries in the lists of a batch, where every triangle reaches every band: 4 MiB.
const ENTRIES: usize = 1 << 20;
/// Triangles that one thread sorts at a time.
const CHUNK: usize = 1 << 10;
/// Samples and triangles looked at between two looks at the cancel flag: about a millisecond.
const WORK_PER_CHECK: usize = 1 << 16;

/// Rows of a band: few enough that every thread finds work, so many that most triangles lie in one.
pub fn rows(height: usize, threads: usize) -> usize {
    (height / (threads * 4)).clamp(4, 16)
}

/// Triangles sorted before any is drawn.
pub fn batch(bands: usize) -> usize {
    (ENTRIES / bands.max(1)).clamp(CHUNK, 1 << 17)
}

/// What is drawn, and how.
pub struct Drawing<'a> {
    pub geometry: &'a Geometry,
    pub view: &'a View,
    pub rows: usize,
    pub cancel: &'a Cancel,
}

/// A part of the triangles: for each band those that may cover samples of it, ascending.
struct Sorted {
    bands: Vec<Vec<PrimRef>>,
    counts: Counts,
}

impl Drawing<'_> {
    /// Draws a range of the live triangles.
    pub fn batch(&self, triangles: Range<usize>, texels: &mut [u64]) -> Result<Counts, Cancelled> {
        let firsts: Vec<usize> = triangles.clone().step_by(CHUNK).collect();
        let sort = |first: usize| self.sort(first..triangles.end.min(first + CHUNK));
        let sorted = firsts.into_par_iter().map(sort).collect::<Result<Vec<Sorted>, Cancelled>>()?;
        let bands = texels.par_chunks_mut(self.view.columns.len() * self.rows).enumerate();
        let draw = |(band, texels)| {
            let lists = sorted.iter().flat_map(|sorted| &sorted.bands[band]);
            self.draw(band * self.rows, lists.copied(), texels)
        };
        let covered = bands.map(draw).try_reduce(|| 0, |a, b| Ok(a + b))?;
        let counts = sorted.iter().fold(Counts::default(), |sum, sorted| sum.join(sorted.counts));
        Ok(Counts { covered, ..counts })
    }

    fn sort(&self, triangles: Range<usize>) -> Result<Sorted, Cancelled> {
        self.cancel.check()?;
        let mut sorted = Sorted { bands: vec![Vec::new(); self.view.rows.len().div_ceil(self.rows)], counts: Counts::default() };
        for prim in triangles.map(|i| self.geometry.live(i)) {
            let Some(triangle) = Triangle::new(self.view, &self.geometry.corners(prim)) else {
                sorted.counts.culled += 1;
                continue;
            };
            sorted.counts.set_up += 1;
            sorted.counts.crossing += u64::from(triangle.crosses_eye);
            let bands = triangle.rows.start / self.rows..triangle.rows.end.div_ceil(self.rows);
            sorted.bands[bands].iter_mut().for_each(|list| list.push(prim));
        }
        Ok(sorted)
    }

    /// Draws triangles into a band that begins with the row `top`; returns the samples covered.
    fn draw(&self, top: usize, prims: impl Iterator<Item = PrimRef>, texels: &mut [u64]) -> Result<u64, Cancelled> {
        let width = self.view.columns.len();
        let bottom = top + texels.len() / width;
        let (mut covered, mut work) = (0, 0);
        for prim in prims {
            // Made again: that costs less than keeping it, and large ones are worth it in any case.
            let Some(triangle) = Triangle::new(self.view, &self.geometry.corners(prim)) else { continue };
            for row in triangle.rows.start.max(top)..triangle.rows.end.min(bottom) {
                let span = triangle.span(self.view, row);
                work += span.len() + 1;
                let xs = &self.view.columns[span.clone()];
                let line = &mut texels[(row - top) * width..][span];
                for (texel, t) in line.iter_mut().zip(triangle.depths(self.view.rows[row], xs)) {
                    if let Some(new) = self.texel(t, prim) {
                        covered += 1;
                        *texel = new.min(*texel);
                    }
                }
            }
            work += 1;
            if work > WORK_PER_CHECK {
                work = 0;
                self.cancel.check()?;
            }
        }
        Ok(covered)
    }

    /// Depth and primitive as one number; nothing behind the eye, or beyond all numbers.
    #[inline]
    fn texel(&self, t: f64, prim: PrimRef) -> Option<u64> {
        // -0 would be the greatest of all.
        let depth = narrow((t - self.view.near).max(0.0)) + 0.0;
        (t >= 0.0 && depth.is_finite()).then(|| u64::from(depth.to_bits()) << 32 | u64::from(prim))
    }
}
