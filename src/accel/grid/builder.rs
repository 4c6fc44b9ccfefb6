//! Builds a uniform grid: as many cells as the density says, the triangles sorted into them.

use std::sync::Arc;

use super::affordable;
use super::contents::{Contents, Refusal};
use super::uniform::Built;
use crate::accel::{BuildCx, BuildError};
use crate::scene::Geometry;

const REFUSAL: Refusal = Refusal { structure: "grid", remedy: "Lower the density, or raise the memory budget." };

/// Builds a grid with about `density` cells a triangle.
///
/// # Errors
/// Cancelled, over the memory budget, which is asked before anything is taken, or more cells or
/// references than 32 bits can number.
pub fn build(geometry: &Arc<Geometry>, density: f64, cx: &BuildCx) -> Result<Built, BuildError> {
    cx.cancel.check()?;
    let (lattice, remark) = affordable::lattice(geometry, density, cx)?;
    let cells = REFUSAL.numbered(lattice.count() as u64, "cells", cx)?;
    let contents = Contents::sort(geometry, cells, &lattice, &REFUSAL, cx)?;
    Ok(Built { geometry: Arc::clone(geometry), lattice, contents, remarks: remark.into_iter().collect() })
}
