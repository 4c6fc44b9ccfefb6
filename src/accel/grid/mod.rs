//! The uniform grid: space is cut into equal cells, about as many as there are triangles; a ray
//! steps from cell to cell.
//!
//! [`lattice`] knows where the cells are, [`uniform`] holds them and walks a ray through them,
//! [`builder`] sorts the triangles into them.

mod builder;
mod lattice;
mod uniform;

use std::sync::Arc;

use super::params::{Kind, Param, ParamValues};
use super::{Accel, BuildCx, BuildError};
use crate::geometry::tri::TriTest;
use crate::scene::Geometry;

/// What can be set.
pub const PARAMS: &[Param] = &[Param {
    id: "density",
    label: "Density λ",
    help: "Cells for each triangle: more cells mean fewer tests in each, and more steps and memory.",
    unit: "cells/triangle",
    kind: Kind::Float { min: 0.01, max: 64.0, default: 4.0 },
}];

/// Builds a uniform grid.
pub fn build<T: TriTest>(geometry: &Arc<Geometry>, p: &ParamValues, cx: &BuildCx) -> Result<Box<dyn Accel>, BuildError> {
    let built = builder::build(geometry, p.float("density"), cx)?;
    Ok(Box::new(uniform::Grid::<T>::new(built)))
}
