//! The upper level: a BVH over the boxes of places.

use crate::accel::bvh::{self, Node};
use crate::accel::{BuildCx, BuildError, Fits};
use crate::geometry::{Aabb, num};
use crate::scene::{Geometry, Placed};
use crate::task::Charge;

/// The places, each an entry by its number; what was flattened comes after them.
#[derive(Debug)]
pub(super) struct Top {
    /// The root first, siblings side by side; none where every entry is visited.
    pub nodes: Vec<Node>,
    /// The entries in the order of the leaves.
    pub entries: Vec<u32>,
    _memory: Charge,
}

impl Top {
    /// Over all places, and the rest if there is one. Of `all` entries every one is visited by every ray.
    pub fn build(geometry: &Geometry, placed: &Placed, rest: bool, all: bool, cx: &BuildCx) -> Result<Self, BuildError> {
        let count = placed.places().len() + usize::from(rest);
        let bytes = if all { count * 4 } else { bvh::bytes_over_boxes(count) };
        let too_large = |over| BuildError::Memory {
            structure: "upper level",
            over,
            remedy: "Raise the memory budget.",
            fits: Fits::default(),
        };
        let memory = cx.budget.charge(bytes as u64).map_err(too_large)?;
        cx.progress.start("top level", count as u64);
        if all {
            return Ok(Self { nodes: Vec::new(), entries: (0..num::index(count)).collect(), _memory: memory });
        }
        let boxes: Vec<Aabb> = placed.places().iter().map(|p| p.bounds).chain(rest.then_some(*geometry.bounds())).collect();
        let draft = bvh::over_boxes(&boxes, cx)?;
        Ok(Self { nodes: draft.nodes, entries: draft.refs, _memory: memory })
    }
}
