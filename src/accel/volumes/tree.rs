//! The tree and how a ray walks it: as the BVH's, but for the volume around a node.

use std::marker::PhantomData;
use std::ops::ControlFlow;
use std::sync::Arc;

use super::volume::Volume;
use crate::accel::best::Best;
use crate::accel::bvh::{MAX_DEPTH, Packed};
use crate::accel::cell::{Cell, CellId, CellKind, Cells, Form, Layout, MemoryPart, Shape};
use crate::accel::probe::{Probe, Prune};
use crate::accel::{PrimHit, Query, Structure};
use crate::geometry::tri::TriTest;
use crate::geometry::{Line, Ray};
use crate::scene::{Geometry, PrimRef};
use crate::task::Charge;

/// A volume and what it is around.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub struct Node<V> {
    pub volume: V,
    /// The left child (the right one follows), or a leaf's first triangle.
    pub first: u32,
    /// Triangles of a leaf; 0 for an inner node.
    pub count: u32,
}

/// A hierarchy of volumes `V`, traced with the triangle test `T`.
#[derive(Debug)]
pub struct Tree<T, V: Volume> {
    pub geometry: Arc<Geometry>,
    /// The root first, siblings side by side; none for a scene without triangles.
    pub nodes: Vec<Node<V>>,
    pub shared: V::Shared,
    /// In the order of the leaves.
    pub packed: Vec<Packed>,
    /// Whether triangles are in several leaves.
    pub splits: bool,
    /// What the builder decided by itself.
    pub remarks: Vec<String>,
    pub _charge: Charge,
    pub test: PhantomData<T>,
}

impl<T: TriTest, V: Volume> Tree<T, V> {
    /// Where the ray enters what may be hit in the node; `None` if that is nothing of interest.
    #[inline(always)]
    fn enter<P: Probe>(&self, node: u32, ray: &V::Ray, best: &Best, probe: &mut P) -> Option<f32> {
        probe.bounds(node);
        let Some((entry, exit)) = self.nodes[node as usize].volume.interval(&self.shared, ray) else {
            probe.pruned(node, Prune::Missed);
            return None;
        };
        let inside = (entry <= best.t()) & (exit >= best.tmin());
        if P::LISTENS && !inside {
            probe.pruned(node, if exit < best.tmin() { Prune::Outside } else { Prune::BehindHit });
        }
        inside.then_some(entry)
    }

    fn cell(&self, node: u32, depth: u32) -> Cell {
        let n = &self.nodes[node as usize];
        let kind = if n.count == 0 { CellKind::Inner } else { CellKind::Leaf { prims: n.count } };
        let shape = n.volume.shape(&self.shared, self.geometry.bounds().centre());
        Cell { id: CellId { instance: 0, node }, depth, shape, split: None, kind }
    }
}

impl<T: TriTest, V: Volume> Structure for Tree<T, V> {
    fn geometry(&self) -> &Arc<Geometry> {
        &self.geometry
    }

    #[inline]
    fn trace_one<Q: Query, P: Probe>(&self, ray: &Ray, query: &Q, probe: &mut P) -> Option<PrimHit> {
        let bounds = self.geometry.bounds();
        let test = T::prepare(ray, bounds);
        let line = V::ray(&Line::new(ray, bounds));
        let mut best = Best::new(ray.tmin, ray.tmax);
        let mut stack = [(0u32, 0f32); MAX_DEPTH as usize];
        let mut top = 0;
        let mut current = 0u32;
        if self.nodes.is_empty() {
            return None;
        }
        self.enter(0, &line, &best, probe)?;
        loop {
            let node = &self.nodes[current as usize];
            probe.node();
            probe.at(current);
            if node.count == 0 {
                let (left, right) = (node.first, node.first + 1);
                let at_left = self.enter(left, &line, &best, probe);
                let at_right = self.enter(right, &line, &best, probe);
                match (at_left, at_right) {
                    (Some(at_left), Some(at_right)) => {
                        let swap = at_right < at_left;
                        let (near, far) = if swap { (right, (left, at_left)) } else { (left, (right, at_right)) };
                        stack[top] = far;
                        top += 1;
                        probe.waiting(top);
                        current = near;
                        continue;
                    }
                    (Some(_), None) => {
                        current = left;
                        continue;
                    }
                    (None, Some(_)) => {
                        current = right;
                        continue;
                    }
                    (None, None) => {}
                }
            } else {
                probe.leaf();
                let first = node.first as usize;
                for tri in &self.packed[first..first + node.count as usize] {
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
                if entry <= best.t() {
                    current = node;
                    break;
                }
                probe.pruned(node, Prune::BehindHit);
            }
        }
    }
}

impl<T: TriTest, V: Volume> Cells for Tree<T, V> {
    fn root(&self) -> Cell {
        if self.nodes.is_empty() {
            let shape = Shape::Box(*self.geometry.bounds());
            return Cell { id: CellId { instance: 0, node: 0 }, depth: 0, shape, split: None, kind: CellKind::Leaf { prims: 0 } };
        }
        self.cell(0, 0)
    }

    fn children(&self, cell: &Cell, each: &mut dyn FnMut(Cell) -> ControlFlow<()>) {
        let Some(node) = self.nodes.get(cell.id.node as usize).filter(|node| node.count == 0) else { return };
        if each(self.cell(node.first, cell.depth + 1)).is_continue() {
            let _ = each(self.cell(node.first + 1, cell.depth + 1));
        }
    }

    fn form(&self, cell: &Cell) -> Form {
        match self.nodes.get(cell.id.node as usize) {
            Some(node) => node.volume.form(&self.shared, self.geometry.bounds().centre()),
            None => Form::Box(*cell.shape.bounds()),
        }
    }

    fn prims(&self, cell: &Cell, each: &mut dyn FnMut(PrimRef)) {
        if let Some(node) = self.nodes.get(cell.id.node as usize).filter(|node| node.count > 0) {
            let first = node.first as usize;
            self.packed[first..first + node.count as usize].iter().for_each(|tri| each(tri.prim));
        }
    }

    fn layout(&self) -> Layout {
        if self.splits { Layout::SplitHierarchy } else { Layout::Hierarchy }
    }

    fn remarks(&self) -> Vec<String> {
        self.remarks.clone()
    }

    fn memory(&self) -> Vec<MemoryPart> {
        let mut parts = vec![MemoryPart { name: "nodes", bytes: size_of_val(&self.nodes[..]) as u64 }];
        let shared = V::shared_bytes(&self.shared);
        if shared > 0 {
            parts.push(MemoryPart { name: "faces", bytes: shared });
        }
        parts.push(MemoryPart { name: "packed triangles", bytes: size_of_val(&self.packed[..]) as u64 });
        parts
    }
}
