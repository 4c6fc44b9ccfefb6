//! An octree (Glassner 1984, "Space Subdivision for Fast Ray Tracing") and how a ray walks it.

use std::marker::PhantomData;
use std::ops::ControlFlow;
use std::sync::Arc;

use super::frame::{Frame, Visit};
use super::node::{Node, middle, octants, part};
use crate::accel::best::Best;
use crate::accel::cell::{Cell, CellId, CellKind, Cells, Layout, MemoryPart, Shape};
use crate::accel::probe::Probe;
use crate::accel::{PrimHit, Query, Structure};
use crate::geometry::tri::TriTest;
use crate::geometry::{Aabb, Ray, num};
use crate::scene::{Geometry, PrimRef};
use crate::task::Charge;

/// The deepest leaf there can be, so that the traversal's stack has a fixed size.
pub const MAX_DEPTH: u32 = 24;

/// The most nodes, so that octants without one can be numbered as well.
pub const MAX_NODES: usize = num::MAX_INDEX / 9;

/// What the builder makes.
#[derive(Debug)]
pub struct Built {
    /// What it was built over.
    pub geometry: Arc<Geometry>,
    /// The root first, siblings side by side.
    pub nodes: Vec<Node>,
    /// What the leaves hold.
    pub refs: Vec<PrimRef>,
    /// The memory of both.
    pub _charge: Charge,
}

/// An octree traced with the triangle test `T`.
#[derive(Debug)]
pub struct Octree<T> {
    built: Built,
    test: PhantomData<T>,
}

impl<T: TriTest> Octree<T> {
    /// Takes what the builder made.
    pub const fn new(built: Built) -> Self {
        Self { built, test: PhantomData }
    }

    fn cell(&self, node: u32, depth: u32, bounds: Aabb) -> Cell {
        let n = self.built.nodes[node as usize];
        let kind = if n.is_leaf() { CellKind::Leaf { prims: n.count() } } else { CellKind::Inner };
        Cell { id: CellId { instance: 0, node }, depth, shape: Shape::Box(bounds), split: None, kind }
    }

    /// An octant without triangles has no node; it is numbered after all that have one.
    fn empty_cell(&self, parent: u32, octant: u8, depth: u32, bounds: Aabb) -> Cell {
        let node = num::index(self.built.nodes.len() + parent as usize * 8 + usize::from(octant));
        Cell { id: CellId { instance: 0, node }, depth, shape: Shape::Box(bounds), split: None, kind: CellKind::Void }
    }
}

impl<T: TriTest> Structure for Octree<T> {
    fn geometry(&self) -> &Arc<Geometry> {
        &self.built.geometry
    }

    /// Front to back, one frame a level. Hits are tested against the ray's interval, never the
    /// cell's; an octant is skipped when the best hit lies before its earliest entry, so a hit
    /// before all that is still ahead ends the search.
    #[inline]
    fn trace_one<Q: Query, P: Probe>(&self, ray: &Ray, query: &Q, probe: &mut P) -> Option<PrimHit> {
        let geometry = &self.built.geometry;
        let test = T::prepare(ray, geometry.bounds());
        let mut best = Best::new(ray.tmin, ray.tmax);
        let (entry, exit) = test.slabs().interval(geometry.bounds());
        let (entry, exit) = (entry.max(ray.tmin), exit.min(ray.tmax));
        if entry > exit {
            return None;
        }
        let mut visit = Visit { node: 0, cell: *geometry.bounds(), entry, exit };
        let along = [test.slabs().along(0), test.slabs().along(1), test.slabs().along(2)];
        let mut frames = [Frame::NONE; MAX_DEPTH as usize];
        let mut top = 0;
        loop {
            probe.node();
            probe.at(visit.node);
            let node = self.built.nodes[visit.node as usize];
            if node.is_leaf() {
                probe.leaf();
                if best.test_all(&test, geometry, &self.built.refs[node.refs()], (query, probe)) {
                    return best.found();
                }
            } else {
                frames[top] = Frame::new(node, &visit, &along);
                top += 1;
                probe.waiting(top);
            }
            visit = loop {
                if top == 0 {
                    return best.found();
                }
                if let Some(next) = frames[top - 1].next(best.t()) {
                    break next;
                }
                top -= 1;
            };
        }
    }
}

impl<T: TriTest> Cells for Octree<T> {
    fn root(&self) -> Cell {
        self.cell(0, 0, *self.built.geometry.bounds())
    }

    fn children(&self, cell: &Cell, each: &mut dyn FnMut(Cell) -> ControlFlow<()>) {
        let Some(node) = self.built.nodes.get(cell.id.node as usize).filter(|node| !node.is_leaf()) else { return };
        let (bounds, parts) = (cell.shape.bounds(), node.octants());
        let _ = octants(parts.axes).try_for_each(|octant| {
            let part = part(bounds, middle(bounds), parts.axes, octant);
            each(if parts.filled >> octant & 1 == 1 {
                self.cell(node.child(octant), cell.depth + 1, part)
            } else {
                self.empty_cell(cell.id.node, octant, cell.depth + 1, part)
            })
        });
    }

    fn prims(&self, cell: &Cell, each: &mut dyn FnMut(PrimRef)) {
        if let Some(leaf) = self.built.nodes.get(cell.id.node as usize).filter(|node| node.is_leaf()) {
            self.built.refs[leaf.refs()].iter().for_each(|prim| each(*prim));
        }
    }

    fn layout(&self) -> Layout {
        Layout::Partition
    }

    fn memory(&self) -> Vec<MemoryPart> {
        vec![
            MemoryPart { name: "nodes", bytes: size_of_val(&self.built.nodes[..]) as u64 },
            MemoryPart { name: "references", bytes: size_of_val(&self.built.refs[..]) as u64 },
        ]
    }
}
