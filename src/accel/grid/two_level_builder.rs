//! Builds a two-level grid in O(N): count what falls into each cell of the coarse grid, settle from
//! that how finely each is cut, then sort the triangles into the cuts of all cells at once
//! (Kalojanov, Billeter and Slusallek 2011, §3).

use std::sync::Arc;
use std::sync::atomic::{AtomicU32, Ordering};

use rayon::prelude::*;

use super::affordable;
use super::contents::{Contents, Overlapped, Refusal, counts};
use super::lattice::Lattice;
use super::two_level::{Built, Cuts, Top};
use crate::accel::{BuildCx, BuildError};
use crate::geometry::num;
use crate::scene::Geometry;
use crate::task::{Cancel, Cancelled};
use glam::Vec3;

/// Cells for each triangle, and for each reference in a cell that is cut.
#[derive(Clone, Copy, Debug)]
pub struct Densities {
    /// Of the coarse grid.
    pub top: f64,
    /// Of the cuts.
    pub leaf: f64,
}

const REFUSAL: Refusal = Refusal { structure: "grid2", remedy: "Lower the densities, or raise the memory budget." };

/// Coarse cells cut between two looks at the cancel flag.
const CHUNK: usize = 1 << 14;

/// Builds a two-level grid.
///
/// # Errors
/// Cancelled, over the memory budget, which is asked before anything is taken, or more cells or
/// references than 32 bits can number.
pub fn build(geometry: &Arc<Geometry>, densities: Densities, cx: &BuildCx) -> Result<Built, BuildError> {
    cx.cancel.check()?;
    let (lattice, remark) = affordable::lattice(geometry, densities.top, cx)?;
    let tops = REFUSAL.numbered(lattice.count() as u64, "cells", cx)?;
    let charge = |bytes: usize| cx.budget.charge(bytes as u64).map_err(|over| REFUSAL.too_large(over));
    let (kept, counting) = (charge(tops * size_of::<Top>())?, charge(tops * size_of::<u32>())?);
    cx.progress.start("count coarse", geometry.live_count() as u64);
    let counts = counts(geometry, tops, &lattice, cx)?;
    let (leaf, less) = affordable::cuts(&counts, densities.leaf, geometry.live_count(), cx)?;
    let (cuts, cells) = cut(lattice, counts, leaf, cx)?;
    drop(counting);
    let contents = Contents::sort(geometry, cells, &cuts, &REFUSAL, cx)?;
    Ok(Built { geometry: Arc::clone(geometry), cuts, contents, remarks: remark.into_iter().chain(less).collect(), _charge: kept })
}

/// Cuts each cell of the coarse grid, and says how many cells that makes.
fn cut(lattice: Lattice, counts: Vec<AtomicU32>, density: f64, cx: &BuildCx) -> Result<(Cuts, usize), BuildError> {
    let mut tops = vec![Top { first: 0, resolution: [1; 3] }; counts.len()];
    let settle = |(tops, counts): (&mut [Top], &[AtomicU32])| {
        for (top, count) in tops.iter_mut().zip(counts) {
            top.resolution = lattice.resolution_within(count.load(Ordering::Relaxed), density);
        }
        cx.cancel.check()
    };
    cx.pool.run(|| tops.par_chunks_mut(CHUNK).zip(counts.par_chunks(CHUNK)).try_for_each(settle))?;
    let mut cells = 0u64;
    for chunk in tops.chunks_mut(CHUNK) {
        cx.cancel.check()?;
        for top in chunk {
            top.first = num::index(REFUSAL.numbered(cells, "cells", cx)?);
            cells += u64::from(top.cells());
        }
    }
    // Every cell of either level has a number in walks, the root one more.
    let numbered = REFUSAL.numbered(cells + tops.len() as u64 + 1, "cells", cx)?;
    let cells = numbered - tops.len() - 1;
    Ok((Cuts { lattice, tops }, cells))
}

impl Overlapped for Cuts {
    fn overlapped(
        &self,
        tri: &[Vec3; 3],
        cancel: &Cancel,
        each: &mut impl FnMut(usize) -> Result<(), Cancelled>,
    ) -> Result<(), Cancelled> {
        self.lattice.overlapped(tri, cancel, &mut |i| {
            let top = self.tops[i];
            let first = top.first as usize;
            if top.is_whole() {
                return each(first);
            }
            self.within(self.lattice.at(i), top).overlapped(tri, cancel, &mut |cell| each(first + cell))
        })
    }
}
