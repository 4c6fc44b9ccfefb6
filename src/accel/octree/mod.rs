//! The octree: a cell is divided in the middle on each axis; a triangle is in every leaf it overlaps.
//!
//! [`node`] says what a node is and where a cell is divided, [`tree`] holds the nodes and the
//! traversal, [`frame`] the step from octant to octant; [`builder`] is the loop, [`division`] one
//! division and its cost, [`join`] puts together what was built apart.

mod builder;
mod division;
mod frame;
mod join;
mod node;
mod tree;

use std::sync::Arc;

use super::params::{C_ISECT, C_TRAV, Kind, Param, ParamValues};
use super::{Accel, BuildCx, BuildError};
use crate::geometry::tri::TriTest;
use crate::scene::Geometry;

/// What can be set.
pub const PARAMS: &[Param] = &[
    Param {
        id: "max_leaf",
        label: "Leaf size",
        help: "Cells with no more triangles than this are not divided.",
        unit: "triangles",
        kind: Kind::Int { min: 1, max: 64, default: 8 },
    },
    Param {
        id: "max_depth",
        label: "Maximum depth",
        help: "Steps from the root to the deepest leaf.",
        unit: "levels",
        kind: Kind::Int { min: 0, max: tree::MAX_DEPTH, default: 20 },
    },
    Param {
        id: "max_refs",
        label: "Most references",
        help: "References for each triangle of the scene, on average: no cell is divided that would take more than its share.",
        unit: "references/triangle",
        kind: Kind::Float { min: 1.0, max: 256.0, default: 16.0 },
    },
    C_TRAV,
    C_ISECT,
];

/// Builds an octree.
pub fn build<T: TriTest>(geometry: &Arc<Geometry>, p: &ParamValues, cx: &BuildCx) -> Result<Box<dyn Accel>, BuildError> {
    let costs = division::Costs { c_trav: p.float("c_trav"), c_isect: p.float("c_isect") };
    let limits = builder::Limits { max_leaf: p.int("max_leaf"), max_depth: p.int("max_depth"), max_refs: p.float("max_refs") };
    let built = builder::build(geometry, costs, limits, cx)?;
    Ok(Box::new(tree::Octree::<T>::new(built)))
}
