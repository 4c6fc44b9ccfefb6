//! The k-d tree: space is divided by planes perpendicular to the axes, chosen by the surface area
//! heuristic; a triangle is in every leaf it overlaps.
//!
//! [`tree`] holds the nodes and the traversal, [`mailbox`] what a ray remembers on its way;
//! [`builder`] the loop, [`large`] and [`serial`] its large cells and small subtrees; [`costs`] weighs a plane, [`sweep`] finds the
//! best of all over sorted [`events`], [`bins`] the best of few; [`deal`] gives each side its
//! triangles, clipped.

mod bins;
mod builder;
mod costs;
mod deal;
mod events;
mod large;
mod mailbox;
mod serial;
mod sort;
mod sweep;
mod tree;

use std::sync::Arc;

use super::params::{C_ISECT, C_TRAV, Kind, Param, ParamValues};
use super::{Accel, BuildCx, BuildError};
use crate::geometry::tri::TriTest;
use crate::scene::Geometry;
use builder::Search;

/// What can be set.
pub const PARAMS: &[Param] = &[
    Param {
        id: "builder",
        label: "Builder",
        help: "How planes are searched for: sah tries every face of every clipped triangle's box, binned tries equal bins in \
               large cells, auto takes sah up to two million triangles.",
        unit: "",
        kind: Kind::Choice { options: &["auto", "sah", "binned"] },
    },
    Param {
        id: "bins",
        label: "Bins",
        help: "Candidate planes on each axis of large cells, plus one, where the builder bins.",
        unit: "",
        kind: Kind::Int { min: 2, max: bins::MAX_BINS, default: 64 },
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
    Param { kind: Kind::Float { min: 0.01, max: 100.0, default: 0.5 }, ..C_ISECT },
    Param {
        id: "empty_bonus",
        label: "Empty bonus",
        help: "The share of the cost that is forgiven when a plane cuts off empty space.",
        unit: "",
        kind: Kind::Float { min: 0.0, max: 0.95, default: 0.2 },
    },
    Param {
        id: "mailbox",
        label: "Mailbox",
        help: "Whether a ray remembers the last triangles it was tested against, so that one in several cells is not tested again.",
        unit: "",
        kind: Kind::Choice { options: &["on", "off"] },
    },
];

/// The most triangles for which `auto` searches exactly.
const EXACT: usize = 2_000_000;
/// Cells of fewer references are searched exactly even by `binned`.
const LEAST_BINNED: u32 = 256;

/// Builds a k-d tree and puts the traversal together that the parameters ask for.
pub fn build<T: TriTest>(geometry: &Arc<Geometry>, p: &ParamValues, cx: &BuildCx) -> Result<Box<dyn Accel>, BuildError> {
    let costs = costs::Costs { c_trav: p.float("c_trav"), c_isect: p.float("c_isect"), empty_bonus: p.float("empty_bonus") };
    let limits = builder::Limits { max_leaf: p.int("max_leaf"), max_depth: p.int("max_depth") };
    let (search, remarks) = search(p, geometry.live_count());
    let built = builder::build(geometry, &costs, search, limits, remarks, cx)?;
    Ok(match p.choice("mailbox") {
        "off" => Box::new(tree::KdTree::<T, false>::new(built)),
        _ => Box::new(tree::KdTree::<T, true>::new(built)),
    })
}

/// How planes are searched for, and what is to be said of it.
fn search(p: &ParamValues, triangles: usize) -> (Search, Vec<String>) {
    let binned = Search::Binned { bins: p.int("bins"), least: LEAST_BINNED };
    match p.choice("builder") {
        "sah" => (Search::Exact, Vec::new()),
        "binned" => (binned, Vec::new()),
        _ if triangles <= EXACT => (Search::Exact, vec![format!("builder sah, as there are at most {EXACT} triangles")]),
        _ => (binned, vec![format!("builder binned, as there are more than {EXACT} triangles")]),
    }
}
