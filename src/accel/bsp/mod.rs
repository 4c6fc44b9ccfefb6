//! Binary space partition: space is divided by planes of any direction, taken from the faces and edges
//! of the triangles beside planes perpendicular to the axes, by the surface area heuristic (Ize, Wald
//! and Parker 2008, "Ray Tracing with the BSP Tree").
//!
//! [`tree`] holds the nodes and the traversal, [`crossing`] where a ray meets a plane and how sure that
//! is, [`builder`] the loop, [`costs`] the choice of a plane, [`plane`] the planes and their sides,
//! [`pieces`] the triangles of a cell, [`polytope`] its form, [`clip`] how both are cut.

mod builder;
mod clip;
mod costs;
mod crossing;
mod pieces;
mod plane;
mod polytope;
mod tree;

use std::sync::Arc;

use super::params::{C_ISECT, C_PLANE, C_TRAV, Kind, Param, ParamValues};
use super::{Accel, BuildCx, BuildError};
use crate::geometry::tri::TriTest;
use crate::scene::Geometry;
use costs::{Costs, Offered};

/// What can be set.
pub const PARAMS: &[Param] = &[
    Param {
        id: "planes",
        label: "Planes",
        help: "Which planes are tried beside those perpendicular to the axes: those of faces, and those through edges, upright on the face.",
        unit: "",
        kind: Kind::Choice { options: &["faces+edges", "faces", "axis"] },
    },
    Param {
        id: "samples",
        label: "Samples",
        help: "Triangles of a cell, evenly spread, whose planes are tried.",
        unit: "triangles",
        kind: Kind::Int { min: 1, max: 256, default: 8 },
    },
    Param {
        id: "bins",
        label: "Bins",
        help: "Candidate planes on each axis in large cells; small cells try every face of every triangle's box.",
        unit: "",
        kind: Kind::Int { min: 2, max: costs::MAX_BINS, default: 64 },
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
    C_PLANE,
    Param { kind: Kind::Float { min: 0.01, max: 100.0, default: 1.5 }, ..C_ISECT },
    Param {
        id: "empty_bonus",
        label: "Empty bonus",
        help: "The share of the cost that is forgiven when a plane perpendicular to an axis cuts off empty space.",
        unit: "",
        kind: Kind::Float { min: 0.0, max: 0.95, default: 0.2 },
    },
];

/// Builds a binary space partition.
pub fn build<T: TriTest>(geometry: &Arc<Geometry>, p: &ParamValues, cx: &BuildCx) -> Result<Box<dyn Accel>, BuildError> {
    let offered = match p.choice("planes") {
        "axis" => Offered::Axis,
        "faces" => Offered::Faces,
        _ => Offered::FacesAndEdges,
    };
    let costs = Costs {
        offered,
        samples: p.int("samples") as usize,
        bins: p.int("bins") as usize,
        c_trav: p.float("c_trav"),
        c_plane: p.float("c_plane"),
        c_isect: p.float("c_isect"),
        empty_bonus: p.float("empty_bonus"),
    };
    let limits = builder::Limits { max_leaf: p.int("max_leaf"), max_depth: p.int("max_depth") };
    let built = builder::build(geometry, &costs, limits, cx)?;
    Ok(Box::new(tree::Bsp::<T>::new(built)))
}
