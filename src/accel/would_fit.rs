//! What would fit where a structure did not: those of which it is known beforehand what building them takes, and a grid with
//! fewer cells.

use super::build::{BuildCx, Fit, Fits};
use super::grid;
use crate::scene::Geometry;
use crate::task::Cancelled;

/// Bytes that building asks for at most, by structure, for each triangle, wherever these lie: with the parameters that are
/// set by default. `tests/memory.rs` and `tests/budget.rs` hold them.
pub const KNOWN: [(&str, u64); 3] = [("wide", 280), ("bvh", 220), ("brute", 36)];

/// Looks what could be built over the same triangles instead of `refused` with the memory that is left now.
pub fn look(refused: &str, geometry: &Geometry, cx: &BuildCx) -> Result<Fits, Cancelled> {
    let left = cx.budget.limit().saturating_sub(cx.budget.used());
    let triangles = geometry.live_count() as u64;
    let known = KNOWN.iter().filter(|(id, each)| *id != refused && each * triangles <= left);
    let mut fits: Vec<Fit> = known.map(|(id, each)| Fit { structure: (*id).to_owned(), bytes: each * triangles }).collect();
    // A grid that was refused had more cells than these.
    if let Some((density, bytes)) = grid::within(geometry, left, cx)? {
        fits.push(Fit { structure: format!("grid with density={density}"), bytes });
    }
    Ok(Fits(fits))
}
