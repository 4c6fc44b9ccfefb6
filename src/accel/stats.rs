//! What a structure looks like in figures, from one walk over its cells.

use std::ops::ControlFlow;

use super::Accel;
use super::cell::{Cell, CellKind, Cells, Descend, Layout, MemoryPart, Shape, walk};
use super::params::{C_ISECT, C_TRAV, Param, ParamValues, Value};
use crate::geometry::Aabb;
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
        let weight = |of: &Param| if let Some(Value::Float(weight)) = params.get(of.id) { weight } else { 1.0 };
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
    /// Nodes and cells that a random line through the root enters, leaves among them, if nothing ends
    /// it early: `sum over nodes of A(n)/A(root)`, for cells that nest; a grid enters cells alone, and space
    /// without a node is passed by.
    pub expected_nodes: f64,
    /// Triangle tests of the same line: `sum over leaves of prims A(n)/A(root)`.
    pub expected_tests: f64,
    /// The chance that a random line that meets a node meets the overlap of two of its children:
    /// `sum over inner nodes and pairs of children of A(a and b) / sum over inner nodes of A(n)`; 0
    /// where cells divide space, `None` where volumes are no boxes.
    pub overlap: Option<f64>,
    /// The volume of the leaves that hold triangles over the root's, leaves that overlap counted as
    /// often as they are; `None` for a flat scene, or where volumes are no boxes.
    pub leaf_volume: Option<f64>,
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
        let mut stats = Self { memory: cells.memory(), leaf_sizes: vec![0; LEAF_SIZES], ..Self::default() };
        let mut sums = Sums { layout: Some(cells.layout()), ..Sums::default() };
        let mut cancelled = Ok(());
        walk(cells, &mut |cell| {
            stats.nodes += 1;
            if stats.nodes.is_multiple_of(4096) {
                cancelled = cancel.check();
            }
            if cell.is_leaf() {
                stats.leaf(cell.depth, cell.prims());
            }
            sums.add(cells, cell, weights);
            if cancelled.is_err() { ControlFlow::Break(()) } else { ControlFlow::Continue(Descend::Yes) }
        });
        cancelled?;
        sums.over(&cells.root().shape, &mut stats);
        Ok(stats)
    }

    /// The share of the root's volume that no leaf with triangles claims; where leaves overlap, at
    /// least so much is empty.
    pub fn empty_volume(&self) -> Option<f64> {
        self.leaf_volume.map(|claimed| (1.0 - claimed).max(0.0))
    }

    /// In how many leaves a triangle is, in the mean, of `live` that the structure holds.
    pub fn duplication(&self, live: usize) -> Option<f64> {
        (live > 0).then(|| self.references as f64 / live as f64)
    }

    /// Of any structure: of both levels together, where there are two.
    ///
    /// # Errors
    /// [`Cancelled`] if asked to stop.
    pub fn of_structure(accel: &dyn Accel, weights: SahWeights, cancel: &Cancel) -> Result<Self, Cancelled> {
        match accel.levels() {
            Some(levels) => levels.stats(weights, cancel),
            None => Self::of(accel, weights, cancel),
        }
    }

    /// Adds what is counted of another structure beside this one.
    pub(super) fn add_stored(&mut self, other: &Self) {
        self.nodes += other.nodes;
        self.leaves += other.leaves;
        self.empty_leaves += other.empty_leaves;
        self.references += other.references;
        self.max_depth = self.max_depth.max(other.max_depth);
        for (ours, theirs) in [(&mut self.leaf_sizes, &other.leaf_sizes), (&mut self.leaf_depths, &other.leaf_depths)] {
            ours.resize(ours.len().max(theirs.len()), 0);
            ours.iter_mut().zip(theirs).for_each(|(ours, theirs)| *ours += theirs);
        }
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

/// How the SAH cost is worked out, for tables.
pub const SAH_FORMULA: &str = "sum over inner nodes of C_trav A(n)/A(root) + sum over leaves of C_isect prims A(n)/A(root)";

/// Areas and volumes, summed over cells.
#[derive(Debug, Default)]
struct Sums {
    layout: Option<Layout>,
    cost: f64,
    nodes: f64,
    tests: f64,
    inner: f64,
    shared: f64,
    claimed: f64,
    /// Some volume is no box.
    convex: bool,
    /// The children of one node.
    boxes: Vec<Aabb>,
}

impl Sums {
    fn add(&mut self, cells: &dyn Cells, cell: &Cell, weights: SahWeights) {
        // Where the ray steps from cell to cell it enters all but the root.
        let stepped = self.layout.is_some_and(|l| l.slack().is_some());
        let area = cell.shape.area();
        let prims = f64::from(cell.prims());
        self.convex |= matches!(cell.shape, Shape::Convex { .. });
        self.cost += area * weights.c_isect * prims;
        self.tests += area * prims;
        if if stepped { cell.depth > 0 } else { !cell.is_leaf() } {
            self.cost += area * weights.c_trav;
        }
        if (cell.depth > 0 || !stepped) && cell.kind != CellKind::Void {
            self.nodes += area;
        }
        if prims > 0.0 {
            self.claimed += volume(cell.shape.bounds());
        }
        if !cell.is_leaf() && self.layout.is_some_and(|l| l.nests()) {
            self.inner += area;
            self.shared += self.shared_by_children(cells, cell);
        }
    }

    /// The summed areas of what any two children both hold.
    fn shared_by_children(&mut self, cells: &dyn Cells, cell: &Cell) -> f64 {
        let boxes = &mut self.boxes;
        boxes.clear();
        cells.children(cell, &mut |child| {
            boxes.push(*child.shape.bounds());
            ControlFlow::Continue(())
        });
        let pairs = boxes.iter().enumerate().flat_map(|(i, a)| boxes[..i].iter().map(move |b| a.intersection(*b)));
        pairs.map(|both| both.area()).sum()
    }

    /// Writes what they come to over the root's.
    fn over(&self, root: &Shape, stats: &mut Stats) {
        let over = |sum: f64, whole: f64| if whole > 0.0 { sum / whole } else { 0.0 };
        stats.sah = over(self.cost, root.area());
        stats.expected_nodes = over(self.nodes, root.area());
        stats.expected_tests = over(self.tests, root.area());
        let divided = self.layout.is_none_or(|l| !l.nests());
        stats.overlap = (divided || !self.convex).then(|| over(self.shared, self.inner));
        let whole = volume(root.bounds());
        stats.leaf_volume = (!self.convex && whole > 0.0).then(|| self.claimed / whole);
    }
}

fn volume(b: &Aabb) -> f64 {
    let d = b.max.as_dvec3() - b.min.as_dvec3();
    if b.is_empty() { 0.0 } else { d.x * d.y * d.z }
}
