//! The bounding volume hierarchy: a binary tree of boxes.
//!
//! [`tree`] holds the nodes and the traversal. All builders make a [`draft`] of the same nodes:
//! [`topdown`] is the one top-down loop, into which [`median`], [`binned`], [`sweep`], [`sbvh`] and
//! [`lbvh`] plug; [`ploc`] works from the leaves up. [`reinsertion`] optimises what any of them made,
//! and the draft chooses leaves and lays the nodes out. [`build`] puts it together.

mod binned;
mod boxes;
mod build;
mod costs;
mod draft;
mod few;
mod lbvh;
mod median;
mod morton;
mod nearest;
mod ploc;
mod preset;
mod reinsertion;
mod sbvh;
mod slice;
mod subtree;
mod sweep;
mod topdown;
mod tree;

pub use build::{Auto, Drafted, bytes_over_boxes, over_boxes};
pub use draft::Draft;
pub use reinsertion::{Moved, Round};
pub use tree::{Built, MAX_DEPTH, Node, Packed};

use std::sync::Arc;

use super::params::{C_ISECT, C_TRAV, Kind, Param, ParamValues};
use super::{Accel, BuildCx, BuildError};
use crate::geometry::tri::{TriTest, Watertight};
use crate::scene::Geometry;
use tree::Bvh;

/// The name it is registered by.
pub const ID: &str = "bvh";

/// What can be set.
pub const PARAMS: &[Param] = &[
    Param {
        id: "builder",
        label: "Builder",
        help: "How the tree is made: auto picks by the number of triangles, and says what it took; for the wide BVH it also cuts triangles where siblings overlap much.",
        unit: "",
        kind: Kind::Choice { options: preset::OPTIONS },
    },
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
        id: "alpha",
        label: "Overlap for splits",
        help: "Builder sbvh: triangles are cut where the children overlap by more than this share of the root's area.",
        unit: "",
        kind: Kind::Float { min: 0.0, max: 1.0, default: 1e-5 },
    },
    Param {
        id: "duplication",
        label: "Duplication",
        help: "Builder sbvh: the most references that cutting may add, per triangle.",
        unit: "",
        kind: Kind::Float { min: 0.0, max: 8.0, default: 0.5 },
    },
    Param {
        id: "radius",
        label: "Search radius",
        help: "Builder ploc: how far along the Morton curve a cluster looks for its nearest neighbour.",
        unit: "clusters",
        kind: Kind::Int { min: 1, max: nearest::MAX_RADIUS as u32, default: 14 },
    },
    Param {
        id: "reinsertion",
        label: "Reinsertion",
        help: "Whether nodes are moved to where they cost less once the tree is built.",
        unit: "",
        kind: Kind::Choice { options: &["off", "on"] },
    },
    Param {
        id: "reinsertion_gain",
        label: "Least gain",
        help: "Reinsertion ends with a round that lowers the sum of areas by less than this share.",
        unit: "",
        kind: Kind::Float { min: 0.0, max: 1.0, default: 0.005 },
    },
    Param {
        id: "reinsertion_secs",
        label: "Time limit",
        help: "Reinsertion begins no round after so many seconds; 0 for no limit, which makes the tree independent of the machine.",
        unit: "s",
        kind: Kind::Float { min: 0.0, max: 3600.0, default: 0.0 },
    },
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

/// The bare tree, for structures that put something else around its nodes. Parameters that they do
/// not have are at their defaults.
pub fn tree(geometry: &Arc<Geometry>, p: &ParamValues, cx: &BuildCx) -> Result<Built, BuildError> {
    build::build(geometry, &completed(p), cx)
}

/// The same before it is packed, for structures that pack it in their own way.
pub fn draft(geometry: &Geometry, p: &ParamValues, auto: Auto, cx: &BuildCx) -> Result<Drafted, BuildError> {
    build::draft(geometry, &completed(p), auto, cx)
}

/// How a tree came to be whose nodes were moved once it was built.
pub struct Recorded {
    /// The tree before, with one triangle in a leaf.
    pub before: Box<dyn Accel>,
    /// What was moved, round by round; nothing if it gained nothing and was undone.
    pub rounds: Vec<Round>,
    /// The SAH cost of the finished tree, from which it is seen whether it is the one that was built before.
    pub sah: f64,
}

/// Builds the tree anew and watches its nodes being moved by reinsertion, keeping at most so many moves of each round; nothing if the
/// parameters do not ask for that.
///
/// # Errors
/// Cancelled, or over the memory budget.
pub fn recorded(geometry: &Arc<Geometry>, p: &ParamValues, most: usize, cx: &BuildCx) -> Result<Option<Recorded>, BuildError> {
    let recorded = build::recorded(geometry, p, most, cx)?;
    Ok(recorded.map(|build::Recorded { before, rounds, sah }| {
        // Nobody traces it: any road over its nodes will do.
        let before = Box::new(Bvh::<Watertight, true, true>::new(before));
        Recorded { before, rounds, sah }
    }))
}

fn completed(p: &ParamValues) -> ParamValues {
    let mut all = ParamValues::defaults(PARAMS);
    for (param, value) in all.iter_mut() {
        *value = p.iter().find(|(given, _)| given.id == param.id).map_or(*value, |(_, given)| given);
    }
    all
}

/// Builds and puts the traversal together that the parameters ask for.
pub fn build<T: TriTest>(geometry: &Arc<Geometry>, p: &ParamValues, cx: &BuildCx) -> Result<Box<dyn Accel>, BuildError> {
    let built = build::build(geometry, p, cx)?;
    Ok(match (p.choice("order"), p.choice("early_out")) {
        ("fixed", "off") => Box::new(Bvh::<T, false, false>::new(built)),
        ("fixed", _) => Box::new(Bvh::<T, false, true>::new(built)),
        (_, "off") => Box::new(Bvh::<T, true, false>::new(built)),
        _ => Box::new(Bvh::<T, true, true>::new(built)),
    })
}
