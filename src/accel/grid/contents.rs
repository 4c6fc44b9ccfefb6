//! What the cells of a grid hold, and how triangles are sorted into them in O(N): count, sum up,
//! place (counting sort; Kalojanov and Slusallek 2009 for uniform grids).
//!
//! ```text
//! starts   0   3   3   5        cell 0 holds refs 0..3, cell 1 nothing, cell 2 refs 3..5
//! refs     a b c   d e
//! ```

use std::sync::atomic::{AtomicU32, Ordering};

use rayon::prelude::*;

use crate::accel::best::Best;
use crate::accel::cell::MemoryPart;
use crate::accel::probe::Probe;
use crate::accel::{BuildCx, BuildError, Fits, Query};
use crate::geometry::num;
use crate::geometry::tri::TriTest;
use crate::scene::{Geometry, PrimRef};
use crate::task::{Cancel, Cancelled, Charge, OverBudget};
use glam::Vec3;

/// Knows which cells a triangle belongs into.
pub trait Overlapped: Sync {
    /// Calls `each` with every cell that the triangle overlaps (or comes within the slack of), once.
    fn overlapped(
        &self,
        tri: &[Vec3; 3],
        cancel: &Cancel,
        each: &mut impl FnMut(usize) -> Result<(), Cancelled>,
    ) -> Result<(), Cancelled>;
}

/// How a structure says that it does not fit.
#[derive(Clone, Copy, Debug)]
pub struct Refusal {
    /// Its id.
    pub structure: &'static str,
    /// What would fit.
    pub remedy: &'static str,
}

impl Refusal {
    /// Over the memory budget.
    pub fn too_large(&self, over: OverBudget) -> BuildError {
        BuildError::Memory { structure: self.structure, over, remedy: self.remedy, fits: Fits::default() }
    }

    /// That many cells or references, if they can be numbered.
    pub fn numbered(&self, count: u64, what: &'static str, cx: &BuildCx) -> Result<usize, BuildError> {
        let limit = cx.most(num::MAX_INDEX) as u64;
        let fits = usize::try_from(count).ok().filter(|_| count <= limit);
        fits.ok_or(BuildError::TooMany { structure: self.structure, what, limit, remedy: self.remedy })
    }
}

/// The references of all cells, one cell after the other.
#[derive(Debug)]
pub struct Contents {
    /// Where each cell's references begin, and one past the last.
    starts: Vec<u32>,
    /// The cells' references, ascending in each.
    refs: Vec<PrimRef>,
    /// The memory of both.
    _charge: Charge,
}

/// Triangles handled between two looks at the cancel flag.
const CHUNK: usize = 1 << 12;
/// Numbers filled in or summed up between two looks.
const FILL: usize = 1 << 18;

impl Contents {
    /// Sorts the live triangles into `cells` cells. The memory is charged before it is taken: for
    /// the cells at once, for the references when they are counted.
    ///
    /// # Errors
    /// Cancelled, over the memory budget, or more references than 32 bits can number.
    pub fn sort(
        geometry: &Geometry,
        cells: usize,
        by: &impl Overlapped,
        refusal: &Refusal,
        cx: &BuildCx,
    ) -> Result<Self, BuildError> {
        let charge = |bytes: usize| cx.budget.charge(bytes as u64).map_err(|over| refusal.too_large(over));
        let counting = charge(cells * size_of::<u32>())?;
        let mut kept = charge((cells + 1) * size_of::<u32>())?;
        cx.progress.start("count", geometry.live_count() as u64);
        let counts = counts(geometry, cells, by, cx)?;
        let (starts, total) = sum_up(&counts, refusal, cx)?;
        kept.grow((total * size_of::<PrimRef>()) as u64).map_err(|over| refusal.too_large(over))?;

        cx.progress.start("place", geometry.live_count() as u64);
        let places = zeros(total, cx)?;
        for_each_overlap(geometry, by, cx, |cell, prim| {
            // What was a count is by now the cell's next free place.
            let place = counts[cell].fetch_add(1, Ordering::Relaxed);
            places[place as usize].store(prim, Ordering::Relaxed);
        })?;
        drop((counts, counting));
        let mut refs: Vec<PrimRef> = places.into_iter().map(AtomicU32::into_inner).collect();
        cx.progress.start("sort", 0);
        cx.pool.run(|| sort_cells(&mut refs, &starts, &cx.cancel))?;
        Ok(Self { starts, refs, _charge: kept })
    }

    /// The references of a cell.
    #[inline(always)]
    pub fn of(&self, cell: usize) -> &[PrimRef] {
        &self.refs[self.starts[cell] as usize..self.starts[cell + 1] as usize]
    }

    /// Tests a ray that has entered a cell against all that is in it. True if the search is over.
    #[inline(always)]
    pub fn test<T: TriTest, Q: Query, P: Probe>(
        &self,
        cell: usize,
        geometry: &Geometry,
        ray: &T,
        best: &mut Best,
        (query, probe): (&Q, &mut P),
    ) -> bool {
        let refs = self.of(cell);
        if refs.is_empty() {
            return false;
        }
        probe.leaf();
        best.test_all(ray, geometry, refs, (query, probe))
    }

    /// Bytes by part.
    pub fn memory(&self) -> [MemoryPart; 2] {
        [
            MemoryPart { name: "cells", bytes: size_of_val(&self.starts[..]) as u64 },
            MemoryPart { name: "references", bytes: size_of_val(&self.refs[..]) as u64 },
        ]
    }
}

/// How many triangles belong into each cell; no count exceeds the number of triangles.
pub fn counts(geometry: &Geometry, cells: usize, by: &impl Overlapped, cx: &BuildCx) -> Result<Vec<AtomicU32>, BuildError> {
    let counts = zeros(cells, cx)?;
    for_each_overlap(geometry, by, cx, |cell, _| {
        counts[cell].fetch_add(1, Ordering::Relaxed);
    })?;
    Ok(counts)
}

fn zeros(n: usize, cx: &BuildCx) -> Result<Vec<AtomicU32>, Cancelled> {
    let mut all = Vec::with_capacity(n);
    while all.len() < n {
        cx.cancel.check()?;
        let end = n.min(all.len() + FILL);
        all.resize_with(end, || AtomicU32::new(0));
    }
    Ok(all)
}

/// Where each cell's references begin, and one past the last, which is how many there are in all;
/// each count becomes its cell's start as well. In parallel: chunks are summed up, then the chunks'
/// sums, then each chunk is filled in.
fn sum_up(counts: &[AtomicU32], refusal: &Refusal, cx: &BuildCx) -> Result<(Vec<u32>, usize), BuildError> {
    let sum = |chunk: &[AtomicU32]| {
        cx.cancel.check().map(|()| chunk.iter().map(|count| u64::from(count.load(Ordering::Relaxed))).sum::<u64>())
    };
    let sums: Vec<u64> = cx.pool.run(|| counts.par_chunks(FILL).map(sum).collect::<Result<_, _>>())?;
    let mut total = 0;
    let before: Vec<u64> = sums.iter().map(|sum| (total, total += sum).0).collect();
    let total = refusal.numbered(total, "references", cx)?;
    let mut starts = vec![0u32; counts.len() + 1];
    starts[counts.len()] = num::index(total);
    let fill = |((starts, counts), before): ((&mut [u32], &[AtomicU32]), &u64)| {
        let mut sum = u32::try_from(*before).unwrap_or(u32::MAX); // at most the total, which fits
        for (start, count) in starts.iter_mut().zip(counts) {
            *start = sum;
            sum += count.swap(sum, Ordering::Relaxed);
        }
        cx.cancel.check()
    };
    let chunks = starts[..counts.len()].par_chunks_mut(FILL).zip(counts.par_chunks(FILL)).zip(&before);
    cx.pool.run(|| chunks.try_for_each(fill))?;
    Ok((starts, total))
}

/// Threads place references in any order; the result must not depend on it. `refs` are those of the
/// cells that start at all but the last of `starts`.
fn sort_cells(refs: &mut [PrimRef], starts: &[u32], cancel: &Cancel) -> Result<(), Cancelled> {
    let cells = starts.len() - 1;
    if cells > CHUNK {
        let mid = cells / 2;
        let (low, high) = refs.split_at_mut((starts[mid] - starts[0]) as usize);
        let (low, high) = rayon::join(|| sort_cells(low, &starts[..=mid], cancel), || sort_cells(high, &starts[mid..], cancel));
        return low.and(high);
    }
    for pair in starts.windows(2) {
        cancel.check()?;
        refs[(pair[0] - starts[0]) as usize..(pair[1] - starts[0]) as usize].sort_unstable();
    }
    Ok(())
}

/// Calls `each` with every cell and every triangle that belongs into it, in parallel over the
/// triangles.
fn for_each_overlap(
    geometry: &Geometry,
    by: &impl Overlapped,
    cx: &BuildCx,
    each: impl Fn(usize, PrimRef) + Sync,
) -> Result<(), Cancelled> {
    let n = geometry.live_count();
    let chunk = |c: usize| -> Result<(), Cancelled> {
        let chunk = c * CHUNK..n.min((c + 1) * CHUNK);
        let len = chunk.len() as u64;
        for i in chunk {
            let prim = geometry.live(i);
            by.overlapped(&geometry.corners(prim), &cx.cancel, &mut |cell| {
                each(cell, prim);
                Ok(())
            })?;
        }
        cx.progress.advance(len);
        cx.cancel.check()
    };
    cx.cancel.check()?;
    cx.pool.run(|| (0..n.div_ceil(CHUNK)).into_par_iter().try_for_each(chunk))
}
