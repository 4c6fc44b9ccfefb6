//! How fine a grid may be. Cells go with the number of triangles, as on a surface, where each triangle is in a few
//! cells. Where triangles lie upon each other, or reach across the scene, each is in as many cells as all of
//! them ask for: then there are fewer cells.

use std::sync::atomic::{AtomicU32, Ordering};

use super::contents::Overlapped;
use super::lattice::Lattice;
use super::{DENSITY, LEAST_DENSITY};
use crate::accel::BuildCx;
use crate::geometry::num;
use crate::scene::Geometry;
use crate::task::Cancelled;

/// References for each triangle that a level of a grid may make, about.
const MOST: f64 = 64.0;
/// Triangles in more coarse cells than this, on average, reach across the cells.
const LARGE: f64 = 8.0;
/// Triangles looked at to find out how many they are.
const SAMPLE: usize = 1024;
/// Cells summed up between two looks at the cancel flag.
const CHUNK: usize = 1 << 14;

/// A triangle is in about `c^(2/3)` of `c` cells; the share of the cells that leaves `most` of `references`.
fn share(references: f64, most: f64) -> f64 {
    if references > most { (most / references).powf(1.5) } else { 1.0 }
}

/// A lattice of about `density` cells a triangle, or of fewer, and what is to be said of it.
pub fn lattice(geometry: &Geometry, density: f64, cx: &BuildCx) -> Result<(Lattice, Option<String>), Cancelled> {
    let triangles = geometry.live_count();
    let wanted = Lattice::new(geometry.bounds(), triangles, density);
    let references = references(&wanted, geometry, cx)?;
    let share = share(references, MOST);
    if share == 1.0 {
        return Ok((wanted, None));
    }
    let fewer = Lattice::new(geometry.bounds(), triangles, density * share);
    let remark =
        format!("{} cells instead of {}, as a triangle would be in {references:.0} of them.", fewer.count(), wanted.count());
    Ok((fewer, Some(remark)))
}

/// Cells that a triangle is in, about; 0 if there is no triangle.
fn references(lattice: &Lattice, geometry: &Geometry, cx: &BuildCx) -> Result<f64, Cancelled> {
    let triangles = geometry.live_count();
    let (mut looked_at, mut references) = (0.0, 0.0);
    for i in (0..triangles).step_by(triangles.div_ceil(SAMPLE).max(1)) {
        cx.cancel.check()?;
        looked_at += 1.0;
        lattice.overlapped(&geometry.corners(geometry.live(i)), &cx.cancel, &mut |_| {
            references += 1.0;
            Ok(())
        })?;
    }
    Ok(references / f64::max(looked_at, 1.0))
}

/// The greatest density, halved again and again from the usual one, whose grid is built in `bytes`, and how many it takes,
/// about; `None` if no grid is.
pub fn within(geometry: &Geometry, bytes: u64, cx: &BuildCx) -> Result<Option<(f64, u64)>, Cancelled> {
    let mut tried = DENSITY;
    while tried >= LEAST_DENSITY {
        let (lattice, _) = lattice(geometry, tried, cx)?;
        let references = references(&lattice, geometry, cx)? * geometry.live_count() as f64;
        // As `Contents::sort` takes it; a tenth more references, since they are an estimate.
        let needed = num::floor_index(8.0 * lattice.count() as f64 + 4.4 * references, usize::MAX) as u64;
        if needed <= bytes {
            return Ok(Some((tried, needed)));
        }
        tried *= 0.5;
    }
    Ok(None)
}

/// The density that the cells of a coarse grid can be cut with, and what is to be said of it.
pub fn cuts(counts: &[AtomicU32], density: f64, triangles: usize, cx: &BuildCx) -> Result<(f64, Option<String>), Cancelled> {
    let coarse = sum(counts, cx, |refs| refs)?;
    let each = coarse / triangles.max(1) as f64;
    // Triangles in few coarse cells are small, and in few of their cuts.
    if each <= LARGE {
        return Ok((density, None));
    }
    let cut = sum(counts, cx, |refs| refs * (density * refs).max(1.0).powf(2.0 / 3.0))?;
    let share = share(cut, f64::max(MOST * triangles as f64, 2.0 * coarse));
    let remark = format!("Coarse cells are cut less finely, as a triangle is in {each:.0} of them.");
    Ok((density * share, (share < 1.0).then_some(remark)))
}

/// The sum over all cells of what their references come to.
fn sum(counts: &[AtomicU32], cx: &BuildCx, of: impl Fn(f64) -> f64) -> Result<f64, Cancelled> {
    let chunk = |chunk: &[AtomicU32]| {
        cx.cancel.check().map(|()| chunk.iter().map(|count| of(f64::from(count.load(Ordering::Relaxed)))).sum::<f64>())
    };
    counts.chunks(CHUNK).map(chunk).sum()
}
