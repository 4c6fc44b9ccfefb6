//! The tree of eights, and how one ray walks it.

use std::marker::PhantomData;
use std::ops::ControlFlow;
use std::sync::Arc;

use super::batch::{Batch, TURNS, with_open};
use super::child::Child;
use super::leaf::Pack;
use super::node::Node;
use super::ray::{Open, Walk};
use super::slots::bits;
use crate::accel::cell::{Cell, CellId, CellKind, Cells, Layout, MemoryPart, Shape};
use crate::accel::probe::{Off, Probe};
use crate::accel::{Hit, PrimHit, Query, Structure, Traced, one_by_one};
use crate::geometry::tri::TriTest;
use crate::geometry::{Aabb, Ray};
use crate::scene::{Geometry, PrimRef};
use crate::simd::{Kernel, Portable, Road, Simd};
use crate::task::{Cancel, Cancelled, Charge};

/// A BVH of eight children a node, traced with the triangle test `T`, triangles packed as `B`.
#[derive(Debug)]
pub struct Tree<T, B> {
    pub geometry: Arc<Geometry>,
    /// Parents before their children, depth first.
    pub nodes: Vec<Node>,
    /// In the order of the leaves.
    pub blocks: Vec<B>,
    /// [`Child::NONE`] for a scene without triangles.
    pub root: Child,
    /// Whether triangles are in several leaves.
    pub splits: bool,
    /// What the builder decided by itself.
    pub remarks: Vec<String>,
    /// What it is traced with.
    pub road: Road,
    pub _charge: Charge,
    pub test: PhantomData<T>,
}

impl<T: TriTest, B: Pack> Tree<T, B> {
    /// Asks for what a ray visits next. No branch: whether that is a node is not known yet.
    #[inline(always)]
    pub fn prefetch<S: Simd>(&self, s: S, child: Child) {
        let from = [self.nodes.as_ptr().addr(), self.blocks.as_ptr().addr()];
        let size = [size_of::<Node>(), size_of::<B>()];
        let kind = usize::from(!child.is_node());
        let at = from[kind] + child.place() * size[kind];
        for line in 0..4 {
            s.prefetch(at + line * 64);
        }
    }

    #[inline(always)]
    fn walk<S: Simd, Q: Query, P: Probe>(&self, s: S, ray: &Ray, query: &Q, probe: &mut P, open: &mut Open) -> Option<PrimHit> {
        if self.root == Child::NONE {
            return None;
        }
        let mut walk = Walk::<T>::idle(&self.geometry, open);
        walk.begin(ray, &self.geometry, self.root);
        while walk.step(s, &self.nodes, &self.blocks, query, probe) {}
        walk.found()
    }

    /// One ray on the tree's road.
    fn one<Q: Query, P: Probe>(&self, ray: &Ray, query: &Q, probe: &mut P) -> Option<PrimHit> {
        with_open(1, |open| self.road.run(One { tree: self, ray, query, probe, open: &mut open[0] }))
    }

    /// One ray on the plain road.
    fn plainly<Q: Query, P: Probe>(&self, ray: &Ray, query: &Q, probe: &mut P) -> Option<PrimHit> {
        with_open(1, |open| self.walk(Portable, ray, query, probe, &mut open[0]))
    }

    /// Triangles from a block on.
    fn prims_from(&self, block: usize) -> impl Iterator<Item = PrimRef> + '_ {
        self.blocks[block..].iter().flat_map(|block| bits(block.lanes()).map(|lane| block.prim(lane)))
    }

    fn cell(&self, child: Child, bounds: Aabb, depth: u32) -> Cell {
        let kind = if child.is_node() {
            CellKind::Inner
        } else {
            let lanes = self.blocks[child.blocks()].iter().map(|block| block.lanes().count_ones());
            CellKind::Leaf { prims: lanes.sum() }
        };
        let id = CellId { instance: 0, node: child.id(self.nodes.len()) };
        Cell { id, depth, shape: Shape::Box(bounds), split: None, kind }
    }
}

/// One ray on a road.
struct One<'a, T, B, Q, P> {
    tree: &'a Tree<T, B>,
    ray: &'a Ray,
    query: &'a Q,
    probe: &'a mut P,
    open: &'a mut Open,
}

impl<T: TriTest, B: Pack, Q: Query, P: Probe> Kernel for One<'_, T, B, Q, P> {
    type Out = Option<PrimHit>;

    #[inline(always)]
    fn run<S: Simd>(self, s: S) -> Option<PrimHit> {
        self.tree.walk(s, self.ray, self.query, self.probe, self.open)
    }
}

impl<T: TriTest, B: Pack> Structure for Tree<T, B> {
    fn geometry(&self) -> &Arc<Geometry> {
        &self.geometry
    }

    #[inline]
    fn trace_one<Q: Query, P: Probe>(&self, ray: &Ray, query: &Q, probe: &mut P) -> Option<PrimHit> {
        // Rays that are watched are not timed: the plain road is enough for them.
        if P::WATCHES { self.plainly(ray, query, probe) } else { self.one(ray, query, probe) }
    }

    fn trace_batch<Q: Query>(
        &self,
        rays: &[Ray],
        query: &Q,
        hits: &mut [Option<Hit>],
        cancel: &Cancel,
    ) -> Result<Traced, Cancelled> {
        if self.root == Child::NONE {
            hits.fill(None);
            let invalid = rays.iter().filter(|ray| !ray.is_valid()).count() as u64;
            return Ok(Traced { invalid });
        }
        // One ray has nobody to take turns with.
        if rays.len() == 1 {
            return one_by_one(&self.geometry, rays, hits, cancel, |ray| self.trace_one(ray, query, &mut Off));
        }
        with_open(TURNS.min(rays.len()), |open| self.road.run(Batch { tree: self, rays, query, hits, cancel, open }))
    }

    fn trace_plain<Q: Query>(
        &self,
        rays: &[Ray],
        query: &Q,
        hits: &mut [Option<Hit>],
        cancel: &Cancel,
    ) -> Result<Traced, Cancelled> {
        one_by_one(&self.geometry, rays, hits, cancel, |ray| self.plainly(ray, query, &mut Off))
    }
}

impl<T: TriTest, B: Pack> Cells for Tree<T, B> {
    fn root(&self) -> Cell {
        let bounds = *self.geometry.bounds();
        if self.root == Child::NONE {
            let shape = Shape::Box(bounds);
            return Cell { id: CellId { instance: 0, node: 0 }, depth: 0, shape, split: None, kind: CellKind::Leaf { prims: 0 } };
        }
        self.cell(self.root, bounds, 0)
    }

    fn children(&self, cell: &Cell, each: &mut dyn FnMut(Cell) -> ControlFlow<()>) {
        if cell.is_leaf() {
            return;
        }
        let Some(node) = self.nodes.get(cell.id.node as usize) else { return };
        for (slot, child) in node.children().iter().enumerate().filter(|(_, child)| **child != Child::NONE) {
            if each(self.cell(*child, node.bounds(slot), cell.depth + 1)).is_break() {
                return;
            }
        }
    }

    fn prims(&self, cell: &Cell, each: &mut dyn FnMut(PrimRef)) {
        let first = (cell.id.node as usize).checked_sub(self.nodes.len()).filter(|first| *first < self.blocks.len());
        if let Some(first) = first {
            self.prims_from(first).take(cell.prims() as usize).for_each(each);
        }
    }

    fn layout(&self) -> Layout {
        if self.splits { Layout::SplitHierarchy } else { Layout::Hierarchy }
    }

    fn remarks(&self) -> Vec<String> {
        self.remarks.clone()
    }

    fn memory(&self) -> Vec<MemoryPart> {
        vec![
            MemoryPart { name: "nodes", bytes: size_of_val(&self.nodes[..]) as u64 },
            MemoryPart { name: "packed triangles", bytes: size_of_val(&self.blocks[..]) as u64 },
        ]
    }
}
