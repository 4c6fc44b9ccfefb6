//! The k-d tree: space is divided by planes perpendicular to the axes, chosen by the surface area
//! heuristic; a triangle is in every leaf it overlaps.
//!
//! [`tree`] holds the nodes and the traversal, [`builder`] the loop, [`planes`] the choice of a plane.

mod builder;
mod planes;
mod tree;

use std::sync::Arc;

use super::params::{C_ISECT, C_TRAV, Kind, Param, ParamValues};
use super::{Accel, BuildCx, BuildError};
use crate::geometry::tri::TriTest;
use crate::scene::Geometry;

/// What can be set.
pub const PARAMS: &[Param] = &[
    Param {
        id: "bins",
        label: "Bins",
        help: "Candidate planes on each axis in large cells; small cells try every face of every triangle's box.",
        unit: "",
        kind: Kind::Int { min: 2, max: planes::MAX_BINS, default: 64 },
    },
    Param {
        id: "max_leaf",
        label: "Leaf size",
        help: "Cells with no more triangles than this are not divided.",
        unit: "triangles",
        kind: Kind::Int { min: 1, max: 64, default: 2 },
    },
    Param {
        id: "max_depth",
        label: "Maximum depth",
        help: "Steps from the root to the deepest leaf; 0 means 8 + 1.3 log2 of the number of triangles.",
        unit: "levels",
        kind: Kind::Int { min: 0, max: tree::MAX_DEPTH, default: 0 },
    },
    C_TRAV,
    Param { kind: Kind::Float { min: 0.01, max: 100.0, default: 1.5 }, ..C_ISECT },
    Param {
        id: "empty_bonus",
        label: "Empty bonus",
        help: "The share of the cost that is forgiven when a plane cuts off empty space.",
        unit: "",
        kind: Kind::Float { min: 0.0, max: 0.95, default: 0.2 },
    },
];

/// Builds a k-d tree.
pub fn build<T: TriTest>(geometry: &Arc<Geometry>, p: &ParamValues, cx: &BuildCx) -> Result<Box<dyn Accel>, BuildError> {
    let costs = planes::Costs {
        bins: p.int("bins"),
        c_trav: p.float("c_trav"),
        c_isect: p.float("c_isect"),
        empty_bonus: p.float("empty_bonus"),
    };
    let limits = builder::Limits { max_leaf: p.int("max_leaf"), max_depth: p.int("max_depth") };
    let built = builder::build(geometry, &costs, limits, cx)?;
    Ok(Box::new(tree::KdTree::<T>::new(built)))
}
