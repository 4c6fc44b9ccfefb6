//! The build loop of the binary space partition: divide a cell where it is cheapest, give each side
//! the triangles that reach it, and again, until a leaf is better.
//!
//! A cell whose best plane costs more than a leaf is divided a few times more in the hope of a
//! better one further down (Pharr, Jakob and Humphreys 2016, §4.4.2: bad refines).

use std::sync::Arc;

use rayon::prelude::*;

use super::costs::{Choice, Content, Costs};
use super::crossing::Row;
use super::pieces::{Piece, Pieces};
use super::plane::{Plane, Slack};
use super::polytope::Polytope;
use super::tree::{BspNode, Built, Form, MAX_COUNT, MAX_DEPTH};
use crate::accel::{BuildCx, BuildError, Fits};
use crate::geometry::{Aabb, num};
use crate::scene::{Geometry, PrimRef};
use crate::task::{Charge, OverBudget};

/// When to stop.
#[derive(Clone, Copy, Debug)]
pub struct Limits {
    /// Cells with no more triangles are not divided.
    pub max_leaf: u32,
    /// No cell is deeper; 0 to go by the number of triangles.
    pub max_depth: u32,
}

/// Triangles below which a subtree is built by one thread.
const FORK: usize = 2048;
/// Triangles bounded between two looks at the cancel flag.
const CHUNK: usize = 1 << 14;
/// Planes in a row that may cost more than a leaf.
const BAD_REFINES: u32 = 3;

/// A subtree whose upper part is still linked.
enum Subtree {
    Fork(Plane, Form, Box<(Self, Self)>),
    List(List),
}

/// A subtree as it will be, numbered within itself, with the memory it took.
struct List {
    nodes: Vec<BspNode>,
    planes: Vec<Row>,
    refs: Vec<PrimRef>,
    forms: Vec<Form>,
    charge: Charge,
}

/// Builds a binary space partition over all live triangles.
///
/// # Errors
/// Cancelled, over the memory budget, or more nodes or references than fit their indices.
pub fn build(geometry: &Arc<Geometry>, costs: &Costs, limits: Limits, cx: &BuildCx) -> Result<Built, BuildError> {
    let n = geometry.live_count();
    cx.progress.start("bound", n as u64);
    let slack = Slack::new(geometry.bounds());
    let piece = |i| Piece::whole(geometry.live(i), geometry, &slack);
    let chunk = |c: usize| cx.cancel.check().map(|()| (c * CHUNK..n.min((c + 1) * CHUNK)).map(piece).collect::<Vec<_>>());
    let held = cx.budget.charge((n * size_of::<Piece>() * 2) as u64).map_err(too_large)?;
    let chunks: Result<Vec<_>, _> = cx.pool.run(|| (0..n.div_ceil(CHUNK)).into_par_iter().map(chunk).collect());
    let pieces = Pieces::whole(chunks?.concat());
    drop(held);

    cx.progress.start("split", n as u64);
    let max_depth = if limits.max_depth == 0 { auto_depth(n) } else { limits.max_depth };
    let builder = Builder { geometry, costs, slack, max_leaf: limits.max_leaf as usize, max_depth, cx };
    let polytope = Polytope::of_box(geometry.bounds());
    let form = Form { bounds: *geometry.bounds(), area: num::narrow(polytope.area()) };
    let root = Work { polytope, form, depth: 0, bad: 0, share: n as f64 };
    let tree = cx.pool.run(|| builder.subtree(&root, pieces))?;
    cx.progress.start("join", 0);
    let list = join(tree, cx)?;
    Ok(Built {
        geometry: Arc::clone(geometry),
        nodes: list.nodes,
        planes: list.planes,
        refs: list.refs,
        forms: list.forms,
        _charge: list.charge,
    })
}

/// 8 + 1.3 log2 n (Havran and Bittner 2002, for k-d trees).
fn auto_depth(n: usize) -> u32 {
    let depth = 8.0 + 1.3 * (n.max(1) as f64).log2();
    num::index(num::floor_index(depth.round(), MAX_DEPTH as usize))
}

fn too_large(over: OverBudget) -> BuildError {
    BuildError::Memory {
        structure: "bsp",
        over,
        remedy: "Raise the memory budget, lower max_depth, or use bvh.",
        fits: Fits::default(),
    }
}

fn too_many(what: &'static str, limit: usize) -> BuildError {
    BuildError::TooMany { structure: "bsp", what, limit: limit as u64, remedy: "Lower max_depth, or use bvh." }
}

/// A cell to be divided, and what is known of it.
struct Work {
    polytope: Polytope,
    form: Form,
    depth: u32,
    bad: u32,
    /// The progress its end stands for, in triangles of the scene.
    share: f64,
}

/// A cell that was divided.
struct Divided {
    plane: Plane,
    below: (Work, Pieces),
    above: (Work, Pieces),
}

struct Builder<'a> {
    geometry: &'a Geometry,
    costs: &'a Costs,
    slack: Slack,
    max_leaf: usize,
    max_depth: u32,
    cx: &'a BuildCx,
}

impl Builder<'_> {
    fn subtree(&self, work: &Work, pieces: Pieces) -> Result<Subtree, BuildError> {
        if pieces.list().len() < FORK {
            let mut list = List::new(self.cx)?;
            self.fill(&mut list, work, pieces)?;
            return Ok(Subtree::List(list));
        }
        let _held = self.cx.budget.charge(pieces.bytes()).map_err(too_large)?;
        let Some(divided) = self.divide(work, &pieces)? else {
            let mut list = List::new(self.cx)?;
            self.leaf(&mut list, work, &pieces)?;
            return Ok(Subtree::List(list));
        };
        drop(pieces);
        let Divided { plane, below, above } = divided;
        let (below, above) = rayon::join(|| self.subtree(&below.0, below.1), || self.subtree(&above.0, above.1));
        Ok(Subtree::Fork(plane, work.form, Box::new((below?, above?))))
    }

    /// The same by one thread, appended to a list.
    fn fill(&self, list: &mut List, work: &Work, pieces: Pieces) -> Result<(), BuildError> {
        let Some(divided) = self.divide(work, &pieces)? else { return self.leaf(list, work, &pieces) };
        drop(pieces);
        let Divided { plane, below, above } = divided;
        let at = list.open(work.form);
        self.fill(list, &below.0, below.1)?;
        list.divide(at, &plane);
        self.fill(list, &above.0, above.1)
    }

    /// The cell's two parts; `None` for a leaf.
    fn divide(&self, work: &Work, pieces: &Pieces) -> Result<Option<Divided>, BuildError> {
        self.cx.cancel.check()?;
        let n = pieces.list().len();
        if n <= self.max_leaf || work.depth >= self.max_depth {
            return Ok(None);
        }
        let content = Content {
            form: &work.polytope,
            area: work.polytope.area(),
            bounds: &work.form.bounds,
            pieces,
            geometry: self.geometry,
            slack: &self.slack,
        };
        let Some(Choice { plane, cost }) = self.costs.best(&content) else { return Ok(None) };
        let leaf = self.costs.leaf(n);
        let bad = if cost < leaf { work.bad } else { work.bad + 1 };
        if (cost > 4.0 * leaf && n < 16) || bad >= BAD_REFINES {
            return Ok(None);
        }
        let Some((low, high)) = work.polytope.cut(&plane, &self.slack) else { return Ok(None) };
        let (below, above) = pieces.deal(&plane, &self.slack, self.geometry, &self.cx.cancel)?;
        let part = |polytope: Polytope, pieces: Pieces| {
            let form = form(&polytope, &pieces, &work.form.bounds);
            (Work { polytope, form, depth: work.depth + 1, bad, share: work.share * 0.5 }, pieces)
        };
        Ok(Some(Divided { plane, below: part(low, below), above: part(high, above) }))
    }

    fn leaf(&self, list: &mut List, work: &Work, pieces: &Pieces) -> Result<(), BuildError> {
        let pieces = pieces.list();
        // A leaf, the division above it, and the references.
        let growth = 2 * (size_of::<BspNode>() + size_of::<Form>()) + size_of::<Row>() + size_of_val(pieces);
        list.charge.grow(growth as u64).map_err(too_large)?;
        list.nodes.push(BspNode::leaf(num::index(list.refs.len()), num::index(pieces.len())));
        list.forms.push(work.form);
        list.refs.extend(pieces.iter().map(|piece| piece.prim));
        if work.share >= 1.0 {
            self.cx.progress.advance(num::floor_index(work.share, num::MAX_INDEX) as u64);
        }
        Ok(())
    }
}

/// The form of a part of a cell inside `parent`. The box also holds what is left there of the
/// triangles: they may reach over a plane by its band.
fn form(polytope: &Polytope, pieces: &Pieces, parent: &Aabb) -> Form {
    let bounds = pieces.list().iter().fold(polytope.bounds(), |b, piece| b.union(piece.bounds));
    Form { bounds: bounds.intersection(*parent), area: num::narrow(polytope.area()) }
}

impl List {
    fn new(cx: &BuildCx) -> Result<Self, BuildError> {
        let charge = cx.budget.charge(0).map_err(too_large)?;
        Ok(Self { nodes: Vec::new(), planes: Vec::new(), refs: Vec::new(), forms: Vec::new(), charge })
    }

    /// Appends an inner node, to be finished by [`Self::divide`].
    fn open(&mut self, form: Form) -> usize {
        self.nodes.push(BspNode::leaf(0, 0));
        self.forms.push(form);
        self.nodes.len() - 1
    }

    /// Makes an open node a division, the child above being the next node.
    fn divide(&mut self, at: usize, plane: &Plane) {
        let above = num::index(self.nodes.len());
        self.nodes[at] = match *plane {
            Plane::Axis { axis, pos } => BspNode::axis(axis, pos, above),
            Plane::General { normal, offset } => {
                self.planes.push(Row { normal, offset });
                BspNode::general(num::index(self.planes.len() - 1), above)
            }
        };
    }

    /// Bytes that it holds.
    fn bytes(&self) -> u64 {
        let refs = size_of_val(&self.planes[..]) + size_of_val(&self.refs[..]);
        (size_of_val(&self.nodes[..]) + size_of_val(&self.forms[..]) + refs) as u64
    }

    /// Appends a subtree.
    fn append(&mut self, list: &Self) {
        let [by, planes, refs] = [self.nodes.len(), self.planes.len(), self.refs.len()].map(num::index);
        self.nodes.extend(list.nodes.iter().map(|node| node.moved(by, planes, refs)));
        self.planes.extend_from_slice(&list.planes);
        self.refs.extend_from_slice(&list.refs);
        self.forms.extend_from_slice(&list.forms);
    }
}

/// An empty list with room for all of a tree, charged.
fn room_for(tree: &Subtree, cx: &BuildCx) -> Result<List, BuildError> {
    let most = cx.most(MAX_COUNT);
    let (mut nodes, mut planes, mut refs) = (0, 0, 0);
    let mut open = vec![tree];
    while let Some(next) = open.pop() {
        match next {
            Subtree::Fork(plane, _, children) => {
                nodes += 1;
                planes += usize::from(matches!(plane, Plane::General { .. }));
                open.extend([&children.0, &children.1]);
            }
            Subtree::List(list) => {
                nodes += list.nodes.len();
                planes += list.planes.len();
                refs += list.refs.len();
                if list.refs.len() > most {
                    return Err(too_many("references", most));
                }
            }
        }
    }
    if nodes > most {
        return Err(too_many("nodes", most));
    }
    if refs > cx.most(num::MAX_INDEX) {
        return Err(too_many("references", cx.most(num::MAX_INDEX)));
    }
    let bytes = nodes * (size_of::<BspNode>() + size_of::<Form>()) + planes * size_of::<Row>() + refs * size_of::<PrimRef>();
    let charge = cx.budget.charge(bytes as u64).map_err(too_large)?;
    Ok(List {
        nodes: Vec::with_capacity(nodes),
        planes: Vec::with_capacity(planes),
        refs: Vec::with_capacity(refs),
        forms: Vec::with_capacity(nodes),
        charge,
    })
}

/// Copies the forks and lists into one, the child below a plane right after its parent.
fn join(tree: Subtree, cx: &BuildCx) -> Result<List, BuildError> {
    enum Step {
        Visit(Subtree),
        Above(usize, Plane),
    }
    let mut all = room_for(&tree, cx)?;
    let mut open = vec![Step::Visit(tree)];
    while let Some(step) = open.pop() {
        match step {
            Step::Visit(Subtree::Fork(plane, form, children)) => {
                let at = all.open(form);
                let (below, above) = *children;
                open.extend([Step::Visit(above), Step::Above(at, plane), Step::Visit(below)]);
            }
            Step::Above(at, plane) => all.divide(at, &plane),
            Step::Visit(Subtree::List(list)) => {
                cx.cancel.check()?;
                all.append(&list);
            }
        }
    }
    debug_assert_eq!(all.bytes(), all.charge.bytes());
    Ok(all)
}
