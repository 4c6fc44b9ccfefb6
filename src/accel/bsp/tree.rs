//! The nodes of a binary space partition and how a ray walks them.
//!
//! ```text
//!              plane 7: n . p = d
//!             ┌──────┴───────┐
//!   node + 1: below       above: named by the node
//! ```
//!
//! A node takes eight bytes, as in a k-d tree; the planes of any direction are in a list of their own,
//! so that a node which is divided by an axis, or not at all, does not pay for them.

use std::marker::PhantomData;
use std::ops::ControlFlow;
use std::sync::Arc;

use super::crossing::{Crossings, Row};
use super::plane::Slack;
use crate::accel::best::Best;
use crate::accel::cell::{Cell, CellId, CellKind, Cells, Form as CellForm, Layout, MemoryPart, Shape, Split};
use crate::accel::probe::Probe;
use crate::accel::{PrimHit, Query, Structure};
use crate::geometry::polytope::Plane;
use crate::geometry::tri::TriTest;
use crate::geometry::{Aabb, Axis, Polyhedron, Ray};
use crate::scene::{Geometry, PrimRef};
use crate::task::Charge;
use glam::DVec3;

/// The deepest leaf there can be, so that the traversal's stack has a fixed size.
pub const MAX_DEPTH: u32 = 64;

/// Eight bytes. The three lowest bits of `tag` are the axis, 3 for a leaf or 4 for a general plane; the
/// rest is the index of the child above the plane, or the number of references.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BspNode {
    tag: u32,
    /// The plane's position as bits, its index, or where the leaf's references begin.
    data: u32,
}

/// The most nodes, and the most references in a leaf, that a tag can hold.
pub const MAX_COUNT: usize = (1 << 29) - 1;

const KIND: u32 = 7;
const LEAF: u32 = 3;
const GENERAL: u32 = 4;

impl BspNode {
    /// A leaf with `count` references from `first` on.
    pub const fn leaf(first: u32, count: u32) -> Self {
        Self { tag: count << 3 | LEAF, data: first }
    }

    /// A division perpendicular to an axis; the child below is the next node.
    pub const fn axis(axis: Axis, pos: f32, above: u32) -> Self {
        Self { tag: above << 3 | axis as u32, data: pos.to_bits() }
    }

    /// A division by a general plane; the child below is the next node.
    pub const fn general(plane: u32, above: u32) -> Self {
        Self { tag: above << 3 | GENERAL, data: plane }
    }

    /// The same node with its child above, its plane, or its references, moved.
    pub const fn moved(self, nodes: u32, planes: u32, refs: u32) -> Self {
        match self.kind() {
            LEAF => Self { data: self.data + refs, ..self },
            GENERAL => Self { tag: self.tag + (nodes << 3), data: self.data + planes },
            _ => Self { tag: self.tag + (nodes << 3), ..self },
        }
    }

    #[inline(always)]
    const fn kind(self) -> u32 {
        self.tag & KIND
    }

    #[inline(always)]
    const fn is_leaf(self) -> bool {
        self.kind() == LEAF
    }

    #[inline(always)]
    const fn count(self) -> u32 {
        self.tag >> 3
    }

    #[inline(always)]
    const fn above(self) -> u32 {
        self.tag >> 3
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

/// The form of a cell as far as walks over the cells ask for it; rays never look at it. To find it
/// again from the planes above would take a polytope cut for each of them, at every step of a walk.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Form {
    /// A box around the cell and the parts of triangles in it.
    pub bounds: Aabb,
    /// The area of its surface.
    pub area: f32,
}

/// What the builder makes.
#[derive(Debug)]
pub struct Built {
    /// What it was built over.
    pub geometry: Arc<Geometry>,
    /// The root first; the child below a plane follows its parent.
    pub nodes: Vec<BspNode>,
    /// The general planes.
    pub planes: Vec<Row>,
    /// What the leaves hold.
    pub refs: Vec<PrimRef>,
    /// Of each node.
    pub forms: Vec<Form>,
    /// The memory of all four.
    pub _charge: Charge,
}

/// A binary space partition traced with the triangle test `T`.
#[derive(Debug)]
pub struct Bsp<T> {
    built: Built,
    test: PhantomData<T>,
}

impl<T: TriTest> Bsp<T> {
    /// Takes what the builder made.
    pub const fn new(built: Built) -> Self {
        Self { built, test: PhantomData }
    }

    fn cell(&self, node: u32, depth: u32) -> Cell {
        let n = self.built.nodes[node as usize];
        let Form { bounds, area } = self.built.forms[node as usize];
        let (split, kind) = match n.kind() {
            LEAF => (None, CellKind::Leaf { prims: n.count() }),
            GENERAL => {
                let Row { normal, offset } = self.built.planes[n.data as usize];
                (Some(Split::Plane { normal, offset }), CellKind::Inner)
            }
            axis => (Some(Split::Axis { axis: Axis::ALL[axis as usize], pos: n.pos() }), CellKind::Inner),
        };
        let shape = Shape::Convex { bounds, area: f64::from(area) };
        Cell { id: CellId { instance: 0, node }, depth, shape, split, kind }
    }
}

impl<T> Bsp<T> {
    /// The half-spaces below and above the plane of a node; `None` for a leaf.
    fn sides(&self, node: BspNode) -> Option<[Plane; 2]> {
        let (normal, offset) = match node.kind() {
            LEAF => return None,
            GENERAL => {
                let Row { normal, offset } = self.built.planes[node.data as usize];
                (normal.as_dvec3(), offset)
            }
            axis => (DVec3::AXES[axis as usize], node.pos()),
        };
        Some([Plane::new(normal, offset.into()), Plane::new(-normal, -f64::from(offset))])
    }

    /// The cell of a node, cut out of the whole by the planes above it. What is below a plane has lower numbers than what is
    /// above it, so the way down is known.
    fn polyhedron(&self, node: u32) -> Polyhedron {
        let bounds = self.built.geometry.bounds();
        let slack = Slack::new(bounds).corner;
        let (mut cell, mut at) = (Polyhedron::of_box(bounds), 0);
        while at < node {
            let here = self.built.nodes[at as usize];
            let Some([below, above]) = self.sides(here) else { break };
            if node < here.above() {
                cell.cut(&below, slack);
                at += 1;
            } else {
                cell.cut(&above, slack);
                at = here.above();
            }
        }
        cell
    }
}

/// A child put aside, and the part of the ray that may be in it.
#[derive(Clone, Copy)]
struct Aside {
    node: u32,
    entry: f32,
    exit: f32,
}

impl<T: TriTest> Structure for Bsp<T> {
    fn geometry(&self) -> &Arc<Geometry> {
        &self.built.geometry
    }

    /// Front to back, as in the k-d tree: a plane is met in an interval of t, its stated error. The
    /// nearer child gets the ray up to the latest crossing, the farther one from the earliest, so what
    /// touches the plane is found on either side; a ray along the plane visits both. Hits are tested
    /// against the ray's interval, never the cell's; a cell is skipped when the best hit lies before
    /// its earliest entry.
    #[inline]
    fn trace_one<Q: Query, P: Probe>(&self, ray: &Ray, query: &Q, probe: &mut P) -> Option<PrimHit> {
        let bounds = self.built.geometry.bounds();
        let test = T::prepare(ray, bounds);
        let (slabs, crossings) = (test.slabs(), Crossings::new(ray, bounds));
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
        loop {
            probe.node();
            probe.at(current);
            let node = self.built.nodes[current as usize];
            if !node.is_leaf() {
                let (early, late, from_above) = if node.kind() == GENERAL {
                    let c = crossings.of(&self.built.planes[node.data as usize]);
                    (c.early, c.late, c.from_above)
                } else {
                    let along = &along[node.kind() as usize];
                    let (early, late) = along.plane(node.pos());
                    (early, late, along.backward())
                };
                let (below, above) = (current + 1, node.above());
                let (near, far) = if from_above { (above, below) } else { (below, above) };
                if late < entry {
                    current = far;
                } else {
                    if early <= exit {
                        stack[top] = Aside { node: far, entry: entry.max(early), exit };
                        top += 1;
                        probe.waiting(top);
                        exit = exit.min(late);
                    }
                    current = near;
                }
                continue;
            }
            probe.leaf();
            if best.test_all(&test, &self.built.geometry, &self.built.refs[node.refs()], (query, probe)) {
                return best.found();
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
            }
            Aside { node: current, entry, exit } = stack[top];
        }
    }
}

impl<T: TriTest> Cells for Bsp<T> {
    fn root(&self) -> Cell {
        self.cell(0, 0)
    }

    fn children(&self, cell: &Cell, each: &mut dyn FnMut(Cell) -> ControlFlow<()>) {
        let node = self.built.nodes[cell.id.node as usize];
        if !node.is_leaf() && each(self.cell(cell.id.node + 1, cell.depth + 1)).is_continue() {
            let _ = each(self.cell(node.above(), cell.depth + 1));
        }
    }

    fn form(&self, cell: &Cell) -> CellForm {
        CellForm::Polyhedron(self.polyhedron(cell.id.node))
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

    fn memory(&self) -> Vec<MemoryPart> {
        let part = |name, bytes: usize| MemoryPart { name, bytes: bytes as u64 };
        vec![
            part("nodes", size_of_val(&self.built.nodes[..])),
            part("planes", size_of_val(&self.built.planes[..])),
            part("references", size_of_val(&self.built.refs[..])),
            part("cell forms, for walks only", size_of_val(&self.built.forms[..])),
        ]
    }
}

const _: () = assert!(size_of::<BspNode>() == 8 && size_of::<Row>() == 16 && size_of::<Form>() == 28);
