//! The nodes of a binary BVH and how a ray walks them.
//!
//! ```text
//! nodes   0: inner ─► 1: inner ─► 3, 4      siblings side by side
//!                     2: leaf  ─► triangles 7..9 of the packed list
//! ```

use std::marker::PhantomData;
use std::ops::ControlFlow;
use std::sync::Arc;

use crate::accel::best::Best;
use crate::accel::cell::{Cell, CellId, CellKind, Cells, Layout, MemoryPart, Shape};
use crate::accel::probe::{Probe, Prune};
use crate::accel::{PrimHit, Query, Structure};
use crate::geometry::tri::TriTest;
use crate::geometry::{Aabb, Ray};
use crate::scene::{Geometry, PrimRef};
use crate::task::Charge;
use glam::Vec3;

/// The deepest leaf there can be, so that the traversal's stack has a fixed size.
pub const MAX_DEPTH: u32 = 64;

/// 32 bytes: two to a cache line, siblings together.
#[derive(Clone, Copy, Debug, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C, align(32))]
pub struct Node {
    min: Vec3,
    /// The left child (the right one follows), or a leaf's first triangle.
    first: u32,
    max: Vec3,
    /// Triangles of a leaf; 0 for an inner node.
    count: u32,
}

impl Node {
    /// A leaf over `count` triangles, at least one.
    pub const fn leaf(b: &Aabb, first: u32, count: u32) -> Self {
        Self { min: b.min, first, max: b.max, count }
    }

    /// An inner node whose children are at `left` and `left + 1`.
    pub const fn inner(b: &Aabb, left: u32) -> Self {
        Self { min: b.min, first: left, max: b.max, count: 0 }
    }

    /// The index of the left child, `None` for a leaf.
    pub const fn left(&self) -> Option<u32> {
        if self.count == 0 { Some(self.first) } else { None }
    }

    /// Triangles of a leaf; 0 for an inner node.
    pub const fn count(&self) -> u32 {
        self.count
    }

    /// A leaf's triangles in the list; none for an inner node.
    #[inline(always)]
    pub const fn range(&self) -> std::ops::Range<usize> {
        let first = self.first as usize;
        if self.count == 0 { 0..0 } else { first..first + self.count as usize }
    }

    /// The same node in longer lists: an inner node's children moved by `by`, a leaf's triangles by
    /// `from`.
    pub const fn moved(&self, by: u32, from: u32) -> Self {
        let first = if self.count == 0 { self.first + by } else { self.first + from };
        Self { first, ..*self }
    }

    /// The same node with other bounds.
    pub const fn bounded(&self, b: &Aabb) -> Self {
        Self { min: b.min, max: b.max, ..*self }
    }

    /// The left child, or a leaf's first triangle; and the triangles of a leaf, 0 for an inner node.
    pub const fn first_and_count(&self) -> (u32, u32) {
        (self.first, self.count)
    }

    /// Its box.
    #[inline(always)]
    pub const fn bounds(&self) -> Aabb {
        Aabb { min: self.min, max: self.max }
    }
}

/// A triangle where its leaf is: the corners are not fetched through indices.
#[derive(Clone, Copy, Debug)]
pub struct Packed {
    /// The corners in the scaled space.
    pub corners: [Vec3; 3],
    /// The triangle's flattened index.
    pub prim: PrimRef,
}

/// What a builder makes: no node at all for a scene without triangles.
#[derive(Debug)]
pub struct Built {
    /// What it was built over.
    pub geometry: Arc<Geometry>,
    /// The root first, siblings side by side.
    pub nodes: Vec<Node>,
    /// In the order of the leaves.
    pub packed: Vec<Packed>,
    /// Whether leaves hold parts of triangles, which may then be in several.
    pub splits: bool,
    /// What the builder decided by itself, in words for the user.
    pub remarks: Vec<String>,
    /// The memory of both.
    pub _charge: Charge,
}

/// A BVH traced with the triangle test `T`, near child first if `ORDERED`, skipping what lies
/// behind the best hit if `EARLY_OUT`.
#[derive(Debug)]
pub struct Bvh<T, const ORDERED: bool, const EARLY_OUT: bool> {
    built: Built,
    test: PhantomData<T>,
}

impl<T: TriTest, const ORDERED: bool, const EARLY_OUT: bool> Bvh<T, ORDERED, EARLY_OUT> {
    /// Takes what a builder made.
    pub const fn new(built: Built) -> Self {
        Self { built, test: PhantomData }
    }

    /// Whether the node at an index is of interest, and where the ray enters it.
    #[inline(always)]
    fn enter<P: Probe>(&self, test: &T, at: u32, best: &Best, tmax: f32, probe: &mut P) -> (bool, f32) {
        let (entry, exit) = test.slabs().interval(&self.built.nodes[at as usize].bounds());
        let end = if EARLY_OUT { best.t() } else { tmax };
        // `&`, not `&&`: three comparisons cost less than a branch that cannot be foreseen.
        let inside = (entry <= exit) & (entry <= end) & (exit >= best.tmin());
        if P::LISTENS && !inside {
            let why = if entry > exit {
                Prune::Missed
            } else if entry > tmax || exit < best.tmin() {
                Prune::Outside
            } else {
                Prune::BehindHit
            };
            probe.pruned(at, why);
        }
        (inside, entry)
    }

    fn cell(&self, node: u32, depth: u32) -> Cell {
        let n = &self.built.nodes[node as usize];
        let kind = if n.count == 0 { CellKind::Inner } else { CellKind::Leaf { prims: n.count } };
        Cell { id: CellId { instance: 0, node }, depth, shape: Shape::Box(n.bounds()), split: None, kind }
    }
}

impl<T: TriTest, const ORDERED: bool, const EARLY_OUT: bool> Structure for Bvh<T, ORDERED, EARLY_OUT> {
    fn geometry(&self) -> &Arc<Geometry> {
        &self.built.geometry
    }

    #[inline]
    fn trace_one<Q: Query, P: Probe>(&self, ray: &Ray, query: &Q, probe: &mut P) -> Option<PrimHit> {
        let nodes = &self.built.nodes[..];
        let test = T::prepare(ray, self.built.geometry.bounds());
        let mut best = Best::new(ray.tmin, ray.tmax);
        let mut stack = [(0u32, 0f32); MAX_DEPTH as usize];
        let mut top = 0;
        let mut current = 0u32;
        if nodes.is_empty() || !self.enter(&test, 0, &best, ray.tmax, probe).0 {
            return None;
        }
        loop {
            let node = &nodes[current as usize];
            probe.node();
            probe.at(current);
            if node.count == 0 {
                let (left, right) = (node.first, node.first + 1);
                let (in_left, at_left) = self.enter(&test, left, &best, ray.tmax, probe);
                let (in_right, at_right) = self.enter(&test, right, &best, ray.tmax, probe);
                if in_left & in_right {
                    let swap = ORDERED && at_right < at_left;
                    let (near, far) = if swap { (right, (left, at_left)) } else { (left, (right, at_right)) };
                    stack[top] = far;
                    top += 1;
                    probe.waiting(top);
                    current = near;
                    continue;
                }
                if in_left | in_right {
                    current = if in_left { left } else { right };
                    continue;
                }
            } else {
                probe.leaf();
                let first = node.first as usize;
                for tri in &self.built.packed[first..first + node.count as usize] {
                    if best.test(&test, &tri.corners, tri.prim, query, probe) {
                        return best.found();
                    }
                }
            }
            // The nearest of what was put aside, if it is not behind the best hit by now.
            loop {
                if top == 0 {
                    return best.found();
                }
                top -= 1;
                let (node, entry) = stack[top];
                if !EARLY_OUT || entry <= best.t() {
                    current = node;
                    break;
                }
                probe.pruned(node, Prune::BehindHit);
            }
        }
    }
}

impl<T: TriTest, const ORDERED: bool, const EARLY_OUT: bool> Cells for Bvh<T, ORDERED, EARLY_OUT> {
    fn root(&self) -> Cell {
        if self.built.nodes.is_empty() {
            let shape = Shape::Box(*self.built.geometry.bounds());
            return Cell { id: CellId { instance: 0, node: 0 }, depth: 0, shape, split: None, kind: CellKind::Leaf { prims: 0 } };
        }
        self.cell(0, 0)
    }

    fn children(&self, cell: &Cell, each: &mut dyn FnMut(Cell) -> ControlFlow<()>) {
        let Some(left) = self.built.nodes.get(cell.id.node as usize).and_then(Node::left) else { return };
        if each(self.cell(left, cell.depth + 1)).is_continue() {
            let _ = each(self.cell(left + 1, cell.depth + 1));
        }
    }

    fn prims(&self, cell: &Cell, each: &mut dyn FnMut(PrimRef)) {
        if let Some(node) = self.built.nodes.get(cell.id.node as usize) {
            self.built.packed[node.range()].iter().for_each(|tri| each(tri.prim));
        }
    }

    fn layout(&self) -> Layout {
        if self.built.splits { Layout::SplitHierarchy } else { Layout::Hierarchy }
    }

    fn remarks(&self) -> Vec<String> {
        self.built.remarks.clone()
    }

    fn memory(&self) -> Vec<MemoryPart> {
        vec![
            MemoryPart { name: "nodes", bytes: size_of_val(&self.built.nodes[..]) as u64 },
            MemoryPart { name: "packed triangles", bytes: size_of_val(&self.built.packed[..]) as u64 },
        ]
    }
}

const _: () = assert!(size_of::<Node>() == 32 && size_of::<Packed>() == 40);
