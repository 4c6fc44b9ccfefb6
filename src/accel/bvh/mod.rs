//! The bounding volume hierarchy: a binary tree of boxes.
//!
//! [`tree`] holds the nodes and the traversal, [`topdown`] the one top-down build loop, and each
//! way to choose a split is a file of its own that plugs into it ([`binned`]).

mod binned;
mod topdown;
mod tree;

pub use binned::Binned;
pub use topdown::{Limits, build as build_topdown};
pub use tree::{Built, Bvh, MAX_DEPTH, Node, Packed};

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
        help: "Candidate split planes on each axis, plus one: triangles are sorted into this many buckets by their centres.",
        unit: "",
        kind: Kind::Int { min: 2, max: binned::MAX_BINS, default: 32 },
    },
    Param {
        id: "max_leaf",
        label: "Leaf size",
        help: "The most triangles a leaf may hold.",
        unit: "triangles",
        kind: Kind::Int { min: 1, max: 64, default: 4 },
    },
    Param {
        id: "max_depth",
        label: "Maximum depth",
        help: "Steps from the root to the deepest leaf; there a leaf holds whatever is left.",
        unit: "levels",
        kind: Kind::Int { min: 1, max: tree::MAX_DEPTH, default: tree::MAX_DEPTH },
    },
    C_TRAV,
    C_ISECT,
    Param {
        id: "order",
        label: "Order",
        help: "Which child is visited first: the nearer one, or always the left one, to see what the order is worth.",
        unit: "",
        kind: Kind::Choice { options: &["near", "fixed"] },
    },
    Param {
        id: "early_out",
        label: "Early out",
        help: "Whether nodes behind the best hit are skipped; off shows what that is worth.",
        unit: "",
        kind: Kind::Choice { options: &["on", "off"] },
    },
];

/// Builds with binned SAH and puts the traversal together that the parameters ask for.
pub fn build<T: TriTest>(geometry: &Arc<Geometry>, p: &ParamValues, cx: &BuildCx) -> Result<Box<dyn Accel>, BuildError> {
    let binned = Binned { bins: p.int("bins"), c_trav: p.float("c_trav"), c_isect: p.float("c_isect") };
    let limits = topdown::Limits { max_leaf: p.int("max_leaf"), max_depth: p.int("max_depth") };
    let built = topdown::build(geometry, &binned, limits, cx)?;
    Ok(match (p.choice("order"), p.choice("early_out")) {
        ("fixed", "off") => Box::new(Bvh::<T, false, false>::new(built)),
        ("fixed", _) => Box::new(Bvh::<T, false, true>::new(built)),
        (_, "off") => Box::new(Bvh::<T, true, false>::new(built)),
        _ => Box::new(Bvh::<T, true, true>::new(built)),
    })
}
