//! The tree of eights, and how one ray walks it.

use std::marker::PhantomData;
use std::ops::ControlFlow;
use std::sync::Arc;

use super::batch::{Batch, with_open, with_under_way};
use super::child::Child;
use super::leaf::Pack;
use super::node::Node;
use super::open::Open;
use super::ray::{self, Ground};
use super::slots::bits;
use super::unit::{self, Unit};
use crate::accel::cell::{Cell, CellId, CellKind, Cells, Layout, MemoryPart, Shape};
use crate::accel::probe::{Off, Probe};
use crate::accel::{Hit, PrimHit, Query, Structure, Traced, in_scaled_space, one_by_one};
use crate::geometry::tri::TriTest;
use crate::geometry::{Aabb, Ray};
use crate::scene::{Geometry, PrimRef};
use crate::simd::{Kernel, Portable, Road, Simd};
use crate::task::{Cancel, Cancelled, Charge};
use glam::Vec3;

/// A BVH of eight children a node, traced with the triangle test `T`, triangles packed as `B`.
#[derive(Debug)]
pub struct Tree<T, B> {
    pub geometry: Arc<Geometry>,
    /// Nodes and the blocks of leaves, parents before their children, depth first.
    pub units: Vec<Unit>,
    /// How many of them are nodes.
    pub nodes: usize,
    /// [`Child::NONE`] for a scene without triangles.
    pub root: Child,
    /// Whether triangles are in several leaves.
    pub splits: bool,
    /// What the builder decided by itself.
    pub remarks: Vec<String>,
    /// What it is traced with.
    pub road: Road,
    pub _charge: Charge,
    pub test: PhantomData<fn() -> (T, B)>,
}

impl<T: TriTest, B: Pack> Tree<T, B> {
    /// The points of the geometry.
    #[inline(always)]
    pub fn points(&self) -> &[Vec3] {
        self.geometry.indexed().0
    }

    /// The cache lines that a node or a block takes at most, wherever it begins.
    const LINES: usize = {
        let (node, block) = (size_of::<B::Node>(), size_of::<B>());
        ((if node > block { node } else { block }) + 64 - unit::BYTES).div_ceil(64)
    };

    /// Asks for what a ray visits next. No branch: whether that is a node is not known yet.
    #[inline(always)]
    pub fn prefetch<S: Simd>(&self, s: S, child: Child) {
        let at = self.units.as_ptr().addr() + child.place() as usize * unit::BYTES;
        for line in 0..Self::LINES {
            s.prefetch(at + line * 64);
        }
    }

    #[inline(always)]
    fn walk<S: Simd, Q: Query, P: Probe>(&self, s: S, ray: &Ray, query: &Q, probe: &mut P, open: &mut Open) -> Option<PrimHit> {
        if self.root == Child::NONE {
            return None;
        }
        let (units, points) = (&self.units[..], self.points());
        let ground = Ground { units, root: self.root, bounds: self.geometry.bounds(), points };
        ray::walk::<S, T, B, Q, P>(s, ground, ray, query, probe, open)
    }

    /// One ray on the tree's road.
    #[inline(always)]
    fn one<Q: Query, P: Probe>(&self, ray: &Ray, query: &Q, probe: &mut P) -> Option<PrimHit> {
        with_open(|open| self.road.run(One { tree: self, ray, query, probe, open }))
    }

    /// One ray on the plain road.
    fn plainly<Q: Query, P: Probe>(&self, ray: &Ray, query: &Q, probe: &mut P) -> Option<PrimHit> {
        with_open(|open| Portable.run(One { tree: self, ray, query, probe, open }))
    }

    /// The blocks from a place on.
    fn blocks_from(&self, place: u32) -> impl Iterator<Item = &B> {
        (place..).step_by(B::UNITS as usize).map(|place| B::at(&self.units, place))
    }

    fn cell(&self, child: Child, bounds: Aabb, depth: u32) -> Cell {
        let kind = if child.is_node() {
            CellKind::Inner
        } else {
            let blocks = self.blocks_from(child.place()).take(child.blocks() as usize);
            CellKind::Leaf { prims: blocks.map(|block| block.lanes().count_ones()).sum() }
        };
        let id = CellId { instance: 0, node: child.place() };
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

    fn trace_alone<Q: Query>(&self, ray: &Ray, query: &Q, off: Off, cancel: &Cancel) -> Result<Option<PrimHit>, Cancelled> {
        cancel.check()?;
        Ok(if off.is_plain() { self.plainly(ray, query, &mut Off::plain()) } else { self.one(ray, query, &mut Off::plain()) })
    }

    fn trace_batch<Q: Query>(
        &self,
        rays: &[Ray],
        query: &Q,
        hits: &mut [Option<Hit>],
        cancel: &Cancel,
    ) -> Result<Traced, Cancelled> {
        // One ray has nobody to go with.
        if let ([ray], [hit]) = (rays, &mut *hits) {
            let mut traced = Traced::default();
            *hit = in_scaled_space(&self.geometry, ray, &mut traced, |ray| self.trace_alone(ray, query, Off::best(), cancel))?;
            return Ok(traced);
        }
        if self.root == Child::NONE {
            return one_by_one(&self.geometry, rays, hits, |_| cancel.check().map(|()| None));
        }
        with_under_way(|under_way| match self.road.run_wide(Batch { tree: self, rays, query, hits, cancel, under_way }) {
            Ok(traced) => traced,
            Err(Batch { hits, .. }) => {
                one_by_one(&self.geometry, rays, hits, |ray| self.trace_alone(ray, query, Off::plain(), cancel))
            }
        })
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
        let node = B::Node::at(&self.units, cell.id.node);
        for (slot, child) in node.children().iter().enumerate().filter(|(_, child)| **child != Child::NONE) {
            // A ray visits what lies in the boxes of all nodes above.
            let bounds = node.bounds(slot).intersection(*cell.shape.bounds());
            if each(self.cell(*child, bounds, cell.depth + 1)).is_break() {
                return;
            }
        }
    }

    fn prims(&self, cell: &Cell, each: &mut dyn FnMut(PrimRef)) {
        // As many blocks as hold them all.
        let mut left = cell.prims();
        let mut blocks = self.blocks_from(cell.id.node);
        while left > 0
            && let Some(block) = blocks.next()
        {
            bits(block.lanes()).for_each(|lane| each(block.prim(lane)));
            left -= block.lanes().count_ones();
        }
    }

    fn layout(&self) -> Layout {
        if self.splits { Layout::SplitHierarchy } else { Layout::Hierarchy }
    }

    fn remarks(&self) -> Vec<String> {
        self.remarks.clone()
    }

    fn memory(&self) -> Vec<MemoryPart> {
        let nodes = self.nodes * size_of::<B::Node>();
        let triangles = size_of_val(&self.units[..]) - nodes;
        vec![MemoryPart { name: "nodes", bytes: nodes as u64 }, MemoryPart { name: "packed triangles", bytes: triangles as u64 }]
    }
}
