//! Sorts the triangles into the cells of a grid in O(N): count, sum up, place (counting sort).

use std::sync::Arc;
use std::sync::atomic::{AtomicU32, AtomicU64, Ordering};

use rayon::prelude::*;

use super::lattice::Lattice;
use super::uniform::Built;
use crate::accel::{BuildCx, BuildError};
use crate::geometry::{Aabb, num, triangle_overlaps_box};
use crate::scene::{Geometry, PrimRef};
use crate::task::{Cancelled, OverBudget};
use glam::Vec3;

/// Triangles handled between two looks at the cancel flag.
const CHUNK: usize = 1 << 12;
/// Cells a large triangle is tested against between two looks.
const CELLS_PER_CHECK: usize = 1 << 16;

/// Builds a grid with about `density` cells a triangle.
///
/// # Errors
/// Cancelled, or over the memory budget, which is asked before anything is taken.
pub fn build(geometry: &Arc<Geometry>, density: f64, cx: &BuildCx) -> Result<Built, BuildError> {
    let n = geometry.live_count();
    let lattice = Lattice::new(geometry.bounds(), n, density);
    let cells = lattice.count();
    if cells > num::MAX_INDEX {
        return Err(too_many("cells"));
    }
    let mut charge = cx.budget.charge(cells as u64 * 8).map_err(too_large)?;

    cx.progress.start("count", n as u64);
    let counts: Vec<AtomicU32> = (0..cells).map(|_| AtomicU32::new(0)).collect();
    let total = AtomicU64::new(0);
    for_each_overlap(geometry, &lattice, cx, |cell, _| {
        counts[cell].fetch_add(1, Ordering::Relaxed);
        total.fetch_add(1, Ordering::Relaxed);
    })?;
    let total = total.into_inner();
    if total > num::MAX_INDEX as u64 {
        return Err(too_many("references"));
    }
    charge.grow(total * size_of::<PrimRef>() as u64).map_err(too_large)?;

    cx.progress.start("place", n as u64);
    let starts = sum_up(counts);
    let next: Vec<AtomicU32> = starts[..cells].iter().map(|s| AtomicU32::new(*s)).collect();
    let places: Vec<AtomicU32> = (0..total).map(|_| AtomicU32::new(0)).collect();
    for_each_overlap(geometry, &lattice, cx, |cell, prim| {
        let place = next[cell].fetch_add(1, Ordering::Relaxed);
        places[place as usize].store(prim, Ordering::Relaxed);
    })?;
    drop(next);
    let mut refs: Vec<PrimRef> = places.into_iter().map(AtomicU32::into_inner).collect();
    sort_cells(&mut refs, &starts, cx)?;
    Ok(Built { geometry: Arc::clone(geometry), lattice, starts, refs, _charge: charge })
}

fn too_large(over: OverBudget) -> BuildError {
    BuildError::Memory { structure: "grid", over, remedy: "Lower the density, or raise the memory budget." }
}

fn too_many(what: &'static str) -> BuildError {
    BuildError::TooMany { structure: "grid", what, limit: num::MAX_INDEX as u64, remedy: "Lower the density." }
}

/// Where each cell's references begin, and one past the last.
fn sum_up(counts: Vec<AtomicU32>) -> Vec<u32> {
    let mut starts = Vec::with_capacity(counts.len() + 1);
    let mut sum = 0;
    for count in counts {
        starts.push(sum);
        sum += count.into_inner();
    }
    starts.push(sum);
    starts
}

/// Threads place references in any order; the result must not depend on it.
fn sort_cells(refs: &mut [PrimRef], starts: &[u32], cx: &BuildCx) -> Result<(), BuildError> {
    cx.progress.start("sort", 0);
    let mut cells: Vec<&mut [PrimRef]> = Vec::with_capacity(starts.len());
    let mut rest = refs;
    for pair in starts.windows(2) {
        let (cell, tail) = std::mem::take(&mut rest).split_at_mut((pair[1] - pair[0]) as usize);
        if cell.len() > 1 {
            cells.push(cell);
        }
        rest = tail;
    }
    let chunk = |cells: &mut [&mut [PrimRef]]| {
        cells.iter_mut().for_each(|cell| cell.sort_unstable());
        cx.cancel.check()
    };
    Ok(cx.pool.run(|| cells.par_chunks_mut(CHUNK).try_for_each(chunk))?)
}

/// Calls `each` with every cell that a triangle overlaps (or comes within the slack of), in parallel
/// over the triangles.
fn for_each_overlap(
    geometry: &Geometry,
    lattice: &Lattice,
    cx: &BuildCx,
    each: impl Fn(usize, PrimRef) + Sync,
) -> Result<(), BuildError> {
    let n = geometry.live_count();
    let chunk = |c: usize| -> Result<(), Cancelled> {
        cx.cancel.check()?;
        for i in c * CHUNK..n.min((c + 1) * CHUNK) {
            let prim = geometry.live(i);
            overlapped_cells(&geometry.corners(prim), lattice, cx, |cell| each(cell, prim))?;
        }
        cx.progress.advance(CHUNK as u64);
        Ok(())
    };
    Ok(cx.pool.run(|| (0..n.div_ceil(CHUNK)).into_par_iter().try_for_each(chunk))?)
}

fn overlapped_cells(tri: &[Vec3; 3], lattice: &Lattice, cx: &BuildCx, mut each: impl FnMut(usize)) -> Result<(), Cancelled> {
    let b = Aabb::of_triangle(tri);
    let [x, y, z] = [0, 1, 2].map(|k| lattice.layers(k, b.min[k], b.max[k]));
    // A triangle within one layer on two axes overlaps every cell of its box.
    let in_a_row = [x, y, z].iter().filter(|l| l.0 == l.1).count() >= 2;
    let slack = Vec3::splat(num::narrow(lattice.slack).next_up());
    let mut seen = 0;
    for k in z.0..=z.1 {
        for j in y.0..=y.1 {
            seen += x.1 - x.0 + 1;
            if seen >= CELLS_PER_CHECK {
                cx.cancel.check()?;
                seen = 0;
            }
            for i in x.0..=x.1 {
                let at = [i, j, k];
                let cell = lattice.bounds(at);
                let near = Aabb { min: cell.min - slack, max: cell.max + slack };
                if in_a_row || triangle_overlaps_box(tri, &near) {
                    each(lattice.index(at));
                }
            }
        }
    }
    Ok(())
}
