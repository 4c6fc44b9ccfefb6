//! The wide bounding volume hierarchy: eight boxes a node, met all at once, triangles packed eight
//! together, and many rays on their way at a time.
//!
//! [`collapse`] makes nodes of eight of the tree of any builder of [`super::bvh`], [`slots`] orders
//! their children so that rays need not sort them; [`node`], [`compressed`] and [`leaf`] are what is met and tested,
//! [`ray`] is one ray's way through the tree and [`batch`] that of many, taking turns.

mod batch;
mod beam;
mod build;
mod child;
mod collapse;
mod compressed;
mod leaf;
mod node;
mod open;
mod ray;
mod slots;
#[cfg(test)]
mod tests;
mod tree;
mod unit;
mod way;

use std::sync::Arc;

use super::params::{Kind, Param, ParamValues};
use super::{Accel, BuildCx, BuildError, bvh};
use crate::geometry::tri::TriTest;
use crate::scene::Geometry;
use leaf::{Indexed, Patch, Plain};

/// The name it is registered by.
const ID: &str = "wide";

/// What can be set.
pub const PARAMS: &[Param] = &[
    bvh::PARAMS[0],
    Param {
        id: "layout",
        label: "Layout",
        help: "Full: boxes and triangles as they are. Compressed: boxes in steps of 16 bits, and leaves that refer to the points of the model; three fifths of the memory, a quarter slower.",
        unit: "",
        kind: Kind::Choice { options: &["full", "compressed"] },
    },
    Param {
        id: "leaves",
        label: "Leaves",
        help: "How triangles are packed in the full layout: as patches of neighbours that share corners, or each with its own; auto looks at some.",
        unit: "",
        kind: Kind::Choice { options: &["auto", "patches", "plain"] },
    },
    Param {
        id: "wide_leaf",
        label: "Leaf size",
        help: "The most triangles a leaf may hold.",
        unit: "triangles",
        kind: Kind::Int { min: 1, max: 32, default: 8 },
    },
    Param {
        id: "c_block",
        label: "C_block",
        help: "Cost of testing up to eight triangles at once; stepping into a node of eight costs 1.",
        unit: "",
        kind: Kind::Float { min: 0.0, max: 100.0, default: 1.0 },
    },
    bvh::PARAMS[1],
    bvh::PARAMS[6],
    bvh::PARAMS[7],
    bvh::PARAMS[8],
    bvh::PARAMS[9],
    bvh::PARAMS[10],
    bvh::PARAMS[11],
];

/// Builds it with the leaves that the parameters ask for.
pub fn build<T: TriTest>(geometry: &Arc<Geometry>, p: &ParamValues, cx: &BuildCx) -> Result<Box<dyn Accel>, BuildError> {
    let compressed = p.choice("layout") == "compressed";
    // Parts of triangles take memory, which whoever compresses wants to save.
    let auto = if compressed { bvh::Auto::Whole } else { bvh::Auto::MayCut };
    let mut drafted = bvh::draft(geometry, p, auto, cx)?;
    if compressed {
        return Ok(Box::new(build::build::<T, Indexed>(geometry, drafted, p, cx)?));
    }
    let patches = match p.choice("leaves") {
        "plain" => false,
        "patches" => true,
        _ => {
            let (patches, remark) = build::suit(geometry, &drafted.draft);
            drafted.remarks.extend(remark);
            patches
        }
    };
    Ok(if patches {
        Box::new(build::build::<T, Patch>(geometry, drafted, p, cx)?)
    } else {
        Box::new(build::build::<T, Plain>(geometry, drafted, p, cx)?)
    })
}
