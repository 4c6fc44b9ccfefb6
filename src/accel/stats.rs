//! What a structure looks like in figures, from one walk over its cells.

use std::ops::ControlFlow;

use super::cell::{Cells, Descend, MemoryPart, walk};
use super::params::{C_ISECT, C_TRAV, Param, ParamValues, Value};
use crate::task::{Cancel, Cancelled};

/// The weights of the surface area heuristic.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SahWeights {
    /// Cost of entering an inner node or stepping into a grid cell.
    pub c_trav: f64,
    /// Cost of testing a triangle.
    pub c_isect: f64,
}

impl Default for SahWeights {
    fn default() -> Self {
        Self { c_trav: 1.0, c_isect: 1.0 }
    }
}

impl SahWeights {
    /// The weights that a structure was built with, so that its SAH cost is stated in them; 1 where
    /// it has none.
    pub fn of(params: &ParamValues) -> Self {
        let weight = |of: &Param| match params.iter().find(|(param, _)| param.id == of.id) {
            Some((_, Value::Float(weight))) => weight,
            _ => 1.0,
        };
        Self { c_trav: weight(&C_TRAV), c_isect: weight(&C_ISECT) }
    }
}

/// Figures of a built structure.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Stats {
    /// Nodes and cells, leaves and empty cells among them.
    pub nodes: u64,
    /// Leaves, empty ones among them.
    pub leaves: u64,
    /// Leaves without a reference.
    pub empty_leaves: u64,
    /// Steps from the root to the deepest leaf.
    pub max_depth: u32,
    /// References in all leaves.
    pub references: u64,
    /// The expected cost of a random line through the root (MacDonald and Booth 1990):
    /// `sum over inner nodes of C_trav A(n)/A(root) + sum over leaves of C_isect prims A(n)/A(root)`;
    /// a grid charges C_trav for every cell but the root instead, since a ray steps into each.
    pub sah: f64,
    /// The number of leaves with k references at k; the last entry counts all larger ones.
    pub leaf_sizes: Vec<u64>,
    /// The number of leaves at each depth.
    pub leaf_depths: Vec<u64>,
    /// Bytes by part, the shared geometry not counted.
    pub memory: Vec<MemoryPart>,
}

/// Leaf sizes counted one by one.
pub const LEAF_SIZES: usize = 17;

impl Stats {
    /// Walks the whole structure.
    ///
    /// # Errors
    /// [`Cancelled`] if asked to stop.
    pub fn of(cells: &dyn Cells, weights: SahWeights, cancel: &Cancel) -> Result<Self, Cancelled> {
        let stepped = cells.layout().slack().is_some();
        let mut stats = Self { memory: cells.memory(), leaf_sizes: vec![0; LEAF_SIZES], ..Self::default() };
        let mut cost = 0.0;
        let mut cancelled = Ok(());
        walk(cells, &mut |cell| {
            stats.nodes += 1;
            if stats.nodes.is_multiple_of(4096) {
                cancelled = cancel.check();
            }
            let area = cell.shape.area();
            if cell.is_leaf() {
                let prims = cell.prims();
                stats.leaf(cell.depth, prims);
                cost += area * weights.c_isect * f64::from(prims);
            }
            if if stepped { cell.depth > 0 } else { !cell.is_leaf() } {
                cost += area * weights.c_trav;
            }
            if cancelled.is_err() { ControlFlow::Break(()) } else { ControlFlow::Continue(Descend::Yes) }
        });
        cancelled?;
        let root = cells.root().shape.area();
        stats.sah = if root > 0.0 { cost / root } else { 0.0 };
        Ok(stats)
    }

    fn leaf(&mut self, depth: u32, prims: u32) {
        self.leaves += 1;
        self.empty_leaves += u64::from(prims == 0);
        self.references += u64::from(prims);
        self.leaf_sizes[(prims as usize).min(LEAF_SIZES - 1)] += 1;
        self.max_depth = self.max_depth.max(depth);
        let depth = depth as usize;
        if self.leaf_depths.len() <= depth {
            self.leaf_depths.resize(depth + 1, 0);
        }
        self.leaf_depths[depth] += 1;
    }

    /// Bytes of all parts.
    pub fn bytes(&self) -> u64 {
        self.memory.iter().map(|part| part.bytes).sum()
    }
}
