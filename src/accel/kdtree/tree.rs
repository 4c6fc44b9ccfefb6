//! The nodes of a k-d tree and how a ray walks them (Pharr, Jakob and Humphreys 2016, §4.4; Havran
//! 2000, §4).
//!
//! ```text
//!              axis x at 0.4
//!             ┌──────┴───────┐
//!   node + 1: below       above: named by the node
//! ```

use std::marker::PhantomData;
use std::ops::ControlFlow;
use std::sync::Arc;

use super::mailbox::Mailbox;
use crate::accel::best::Best;
use crate::accel::cell::{Cell, CellId, CellKind, Cells, Layout, MemoryPart, Shape, Split};
use crate::accel::probe::{Probe, Prune};
use crate::accel::{PrimHit, Query, Structure};
use crate::geometry::tri::TriTest;
use crate::geometry::{Aabb, Axis, Ray};
use crate::scene::{Geometry, PrimRef};
use crate::simd::LANES;
use crate::task::Charge;

/// The deepest leaf there can be, so that the traversal's stack has a fixed size.
pub const MAX_DEPTH: u32 = 64;

/// Eight bytes. The two lowest bits of `tag` are the axis, or 3 for a leaf; the rest is the index
/// of the child above the plane, or the number of references.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct KdNode {
    tag: u32,
    /// The plane's position as bits, or where the leaf's references begin.
    data: u32,
}

/// The most nodes, and the most references in a leaf, that a tag can hold.
pub const MAX_COUNT: usize = (1 << 30) - 1;

const LEAF: u32 = 3;

impl KdNode {
    /// A leaf with `count` references from `first` on.
    pub const fn leaf(first: u32, count: u32) -> Self {
        Self { tag: count << 2 | LEAF, data: first }
    }

    /// A division; the child below is the next node.
    pub const fn inner(axis: Axis, pos: f32, above: u32) -> Self {
        Self { tag: above << 2 | axis as u32, data: pos.to_bits() }
    }

    /// The same node with its child above, or its references, moved.
    pub const fn moved(self, nodes: u32, refs: u32) -> Self {
        if self.tag & 3 == LEAF { Self { data: self.data + refs, ..self } } else { Self { tag: self.tag + (nodes << 2), ..self } }
    }

    #[inline(always)]
    const fn is_leaf(self) -> bool {
        self.tag & 3 == LEAF
    }

    #[inline(always)]
    const fn count(self) -> u32 {
        self.tag >> 2
    }

    #[inline(always)]
    const fn above(self) -> u32 {
        self.tag >> 2
    }

    #[inline(always)]
    const fn axis(self) -> usize {
        (self.tag & 3) as usize
    }

    #[inline(always)]
    const fn pos(self) -> f32 {
        f32::from_bits(self.data)
    }

    #[inline(always)]
    const fn refs(self) -> std::ops::Range<usize> {
        self.data as usize..self.data as usize + self.count() as usize
    }
}

/// What the builder makes.
#[derive(Debug)]
pub struct Built {
    /// What it was built over.
    pub geometry: Arc<Geometry>,
    /// The root first; the child below a plane follows its parent.
    pub nodes: Vec<KdNode>,
    /// What the leaves hold.
    pub refs: Vec<PrimRef>,
    /// What the builder decided, in words.
    pub remarks: Vec<String>,
    /// The memory of both.
    pub _charge: Charge,
}

/// A k-d tree traced with the triangle test `T`; if `MAILBOX`, each ray remembers the last triangles
/// it was tested against.
#[derive(Debug)]
pub struct KdTree<T, const MAILBOX: bool> {
    built: Built,
    test: PhantomData<T>,
}

impl<T: TriTest, const MAILBOX: bool> KdTree<T, MAILBOX> {
    /// Takes what the builder made.
    pub const fn new(built: Built) -> Self {
        Self { built, test: PhantomData }
    }

    fn cell(&self, node: u32, depth: u32, bounds: Aabb) -> Cell {
        let n = self.built.nodes[node as usize];
        let (split, kind) = if n.is_leaf() {
            (None, CellKind::Leaf { prims: n.count() })
        } else {
            (Some(Split::Axis { axis: Axis::ALL[n.axis()], pos: n.pos() }), CellKind::Inner)
        };
        Cell { id: CellId { instance: 0, node }, depth, shape: Shape::Box(bounds), split, kind }
    }
}

/// A child put aside, and the part of the ray that may be in it.
#[derive(Clone, Copy)]
struct Aside {
    node: u32,
    entry: f32,
    exit: f32,
}

impl<T: TriTest, const MAILBOX: bool> Structure for KdTree<T, MAILBOX> {
    fn geometry(&self) -> &Arc<Geometry> {
        &self.built.geometry
    }

    /// Front to back. A plane is met in an interval of t, its stated error: the nearer child gets
    /// the ray up to the latest crossing, the farther one from the earliest, so what touches the
    /// plane is found on either side. Hits are tested against the ray's interval, never the cell's;
    /// a cell is skipped when the best hit lies before its earliest entry.
    #[inline]
    fn trace_one<Q: Query, P: Probe>(&self, ray: &Ray, query: &Q, probe: &mut P) -> Option<PrimHit> {
        let geometry = &*self.built.geometry;
        let bounds = geometry.bounds();
        let test = T::prepare(ray, bounds);
        let slabs = test.slabs();
        let along = [slabs.along(0), slabs.along(1), slabs.along(2)];
        let mut best = Best::new(ray.tmin, ray.tmax);
        let (entry, exit) = slabs.interval(bounds);
        let (mut entry, mut exit) = (entry.max(ray.tmin), exit.min(ray.tmax));
        if entry > exit {
            return None;
        }
        let mut stack = [Aside { node: 0, entry: 0.0, exit: 0.0 }; MAX_DEPTH as usize];
        let mut top = 0;
        let mut current = 0u32;
        let mut mailbox = Mailbox::new();
        loop {
            probe.node();
            probe.at(current);
            let node = self.built.nodes[current as usize];
            if !node.is_leaf() {
                let along = &along[node.axis()];
                let (early, late) = along.plane(node.pos());
                let (below, above) = (current + 1, node.above());
                let (near, far) = if along.backward() { (above, below) } else { (below, above) };
                if late < entry {
                    probe.pruned(near, Prune::Missed);
                    current = far;
                } else {
                    if early <= exit {
                        stack[top] = Aside { node: far, entry: if early > entry { early } else { entry }, exit };
                        top += 1;
                        probe.waiting(top);
                        exit = if late < exit { late } else { exit };
                    } else {
                        probe.pruned(far, Prune::Missed);
                    }
                    current = near;
                }
                continue;
            }
            probe.leaf();
            for refs in self.built.refs[node.refs()].chunks(LANES) {
                let (mut fresh, mut count) = ([0; LANES], 0);
                for prim in refs {
                    if !(MAILBOX && mailbox.holds_or_takes(*prim)) {
                        fresh[count] = *prim;
                        count += 1;
                    }
                }
                let known = best.prim();
                if best.test_all(&test, geometry, &fresh[..count], (query, probe)) {
                    return best.found();
                }
                if best.prim() != known && !(entry <= best.t() && best.t() <= exit) {
                    probe.outside();
                }
            }
            // The next cell in front of the best hit. Cells come front to back but for those on both
            // sides of a plane that the ray runs along, so one behind the hit does not end it all.
            loop {
                if top == 0 {
                    return best.found();
                }
                top -= 1;
                if stack[top].entry <= best.t() {
                    break;
                }
                probe.pruned(stack[top].node, Prune::BehindHit);
            }
            Aside { node: current, entry, exit } = stack[top];
        }
    }
}

impl<T: TriTest, const MAILBOX: bool> Cells for KdTree<T, MAILBOX> {
    fn root(&self) -> Cell {
        self.cell(0, 0, *self.built.geometry.bounds())
    }

    fn children(&self, cell: &Cell, each: &mut dyn FnMut(Cell) -> ControlFlow<()>) {
        let node = self.built.nodes[cell.id.node as usize];
        if node.is_leaf() {
            return;
        }
        let (below, above) = cell.shape.bounds().split(Axis::ALL[node.axis()], node.pos());
        if each(self.cell(cell.id.node + 1, cell.depth + 1, below)).is_continue() {
            let _ = each(self.cell(node.above(), cell.depth + 1, above));
        }
    }

    fn prims(&self, cell: &Cell, each: &mut dyn FnMut(PrimRef)) {
        let node = self.built.nodes[cell.id.node as usize];
        if node.is_leaf() {
            self.built.refs[node.refs()].iter().for_each(|prim| each(*prim));
        }
    }

    fn layout(&self) -> Layout {
        Layout::Partition
    }

    fn remarks(&self) -> Vec<String> {
        self.built.remarks.clone()
    }

    fn memory(&self) -> Vec<MemoryPart> {
        vec![
            MemoryPart { name: "nodes", bytes: size_of_val(&self.built.nodes[..]) as u64 },
            MemoryPart { name: "references", bytes: size_of_val(&self.built.refs[..]) as u64 },
        ]
    }
}

const _: () = assert!(size_of::<KdNode>() == 8);
