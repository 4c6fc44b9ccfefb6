//! Grids: space is cut into equal cells, and a ray steps from cell to cell.
//!
//! [`lattice`] knows where cells are, [`overlap`] which of them a triangle belongs into, [`contents`]
//! what they hold, [`affordable`] how many there may be, [`walk`] how a ray steps through them. A [`uniform`] grid is one lattice, a
//! [`two_level`] grid has lattices in the cells of a coarse one.

mod affordable;
mod builder;
mod contents;
mod lattice;
mod overlap;
mod two_level;
mod two_level_builder;
mod uniform;
mod walk;

pub use affordable::within;

use std::sync::Arc;

use super::params::{Kind, Param, ParamValues};
use super::{Accel, BuildCx, BuildError};
use crate::geometry::tri::TriTest;
use crate::scene::Geometry;

/// Cells for each triangle of a uniform grid, unless set otherwise.
pub const DENSITY: f64 = 2.0;
/// The fewest.
pub const LEAST_DENSITY: f64 = 0.01;

/// What can be set of a uniform grid.
pub const PARAMS: &[Param] = &[Param {
    id: "density",
    label: "Density λ",
    help: "Cells for each triangle: more cells mean fewer tests in each, and more steps and memory.",
    unit: "cells/triangle",
    kind: Kind::Float { min: LEAST_DENSITY, max: 64.0, default: DENSITY },
}];

/// What can be set of a two-level grid.
pub const TWO_LEVEL_PARAMS: &[Param] = &[
    Param {
        id: "density",
        label: "Top density λ",
        help: "Cells of the coarse grid for each triangle.",
        unit: "cells/triangle",
        kind: Kind::Float { min: 0.001, max: 16.0, default: 0.25 },
    },
    Param {
        id: "leaf_density",
        label: "Leaf density λ",
        help: "Cells that a coarse cell is cut into, for each triangle in it.",
        unit: "cells/triangle",
        kind: Kind::Float { min: 0.01, max: 64.0, default: 2.0 },
    },
];

/// Builds a uniform grid.
pub fn build<T: TriTest>(geometry: &Arc<Geometry>, p: &ParamValues, cx: &BuildCx) -> Result<Box<dyn Accel>, BuildError> {
    let built = builder::build(geometry, p.float("density"), cx)?;
    Ok(Box::new(uniform::Grid::<T>::new(built)))
}

/// Builds a two-level grid.
pub fn build_two_level<T: TriTest>(
    geometry: &Arc<Geometry>,
    p: &ParamValues,
    cx: &BuildCx,
) -> Result<Box<dyn Accel>, BuildError> {
    let densities = two_level_builder::Densities { top: p.float("density"), leaf: p.float("leaf_density") };
    let built = two_level_builder::build(geometry, densities, cx)?;
    Ok(Box::new(two_level::TwoLevel::<T>::new(built)))
}
