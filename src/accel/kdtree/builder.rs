//! The build loop of the k-d tree: divide a cell where it is cheapest, give each side the triangles
//! that overlap it, and again, until a leaf is better.
//!
//! A cell whose best plane costs more than a leaf is divided a few times more in the hope of a
//! better one further down (Pharr, Jakob and Humphreys 2016, §4.4.2: bad refines).

use std::sync::Arc;

use rayon::prelude::*;

use super::planes::{Costs, KdRef, Plane};
use super::tree::{Built, KdNode, MAX_COUNT, MAX_DEPTH};
use crate::accel::{BuildCx, BuildError};
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
const FORK: usize = 4096;
/// Triangles handled between two looks at the cancel flag.
const CHUNK: usize = 1 << 14;
/// Planes in a row that may cost more than a leaf.
const BAD_REFINES: u32 = 3;

/// A subtree whose upper part is still linked.
enum Subtree {
    Fork(Plane, Box<(Self, Self)>),
    List(List),
}

/// A subtree as it will be, numbered within itself, with the memory it took.
struct List {
    nodes: Vec<KdNode>,
    refs: Vec<PrimRef>,
    charge: Charge,
}

/// Builds a k-d tree over all live triangles.
///
/// # Errors
/// Cancelled, over the memory budget, or more nodes or references than fit their indices.
pub fn build(geometry: &Arc<Geometry>, costs: &Costs, limits: Limits, cx: &BuildCx) -> Result<Built, BuildError> {
    let n = geometry.live_count();
    cx.progress.start("bound", n as u64);
    let chunk = |c: usize| {
        cx.cancel.check().map(|()| (c * CHUNK..n.min((c + 1) * CHUNK)).map(|i| reference(geometry, i)).collect::<Vec<_>>())
    };
    let held = cx.budget.charge((n * size_of::<KdRef>() * 2) as u64).map_err(too_large)?;
    let chunks: Result<Vec<_>, _> = cx.pool.run(|| (0..n.div_ceil(CHUNK)).into_par_iter().map(chunk).collect());
    let refs = chunks?.concat();
    drop(held);

    cx.progress.start("split", n as u64);
    let max_depth = if limits.max_depth == 0 { auto_depth(n) } else { limits.max_depth };
    let builder = Builder { costs, max_leaf: limits.max_leaf as usize, max_depth, cx };
    let cell = Work { cell: *geometry.bounds(), depth: 0, bad: 0, share: n as f64 };
    let tree = cx.pool.run(|| builder.subtree(cell, refs))?;
    cx.progress.start("join", 0);
    let (nodes, refs) = join(tree)?;
    let bytes = (nodes.capacity() * size_of::<KdNode>() + refs.capacity() * size_of::<PrimRef>()) as u64;
    Ok(Built { geometry: Arc::clone(geometry), nodes, refs, _charge: cx.budget.charge(bytes).map_err(too_large)? })
}

/// 8 + 1.3 log2 n (Havran and Bittner 2002).
fn auto_depth(n: usize) -> u32 {
    let depth = 8.0 + 1.3 * (n.max(1) as f64).log2();
    num::index(num::floor_index(depth.round(), MAX_DEPTH as usize))
}

fn reference(geometry: &Geometry, i: usize) -> KdRef {
    let prim = geometry.live(i);
    KdRef { bounds: Aabb::of_triangle(&geometry.corners(prim)), prim }
}

fn too_large(over: OverBudget) -> BuildError {
    BuildError::Memory { structure: "kdtree", over, remedy: "Raise the memory budget, lower max_depth, or use bvh." }
}

fn too_many(what: &'static str) -> BuildError {
    BuildError::TooMany { structure: "kdtree", what, limit: MAX_COUNT as u64, remedy: "Lower max_depth, or use bvh." }
}

/// A cell to be divided, and what is known of it.
#[derive(Clone, Copy)]
struct Work {
    cell: Aabb,
    depth: u32,
    bad: u32,
    /// The progress its end stands for, in triangles of the scene.
    share: f64,
}

struct Builder<'a> {
    costs: &'a Costs,
    max_leaf: usize,
    max_depth: u32,
    cx: &'a BuildCx,
}

impl Builder<'_> {
    fn subtree(&self, work: Work, refs: Vec<KdRef>) -> Result<Subtree, BuildError> {
        if refs.len() < FORK {
            let charge = self.cx.budget.charge(0).map_err(too_large)?;
            let mut list = List { nodes: Vec::new(), refs: Vec::new(), charge };
            self.fill(&mut list, work, &refs)?;
            return Ok(Subtree::List(list));
        }
        let _held = self.cx.budget.charge(size_of_val(&refs[..]) as u64).map_err(too_large)?;
        let Some((plane, bad)) = self.divide(&work, &refs)? else {
            let charge = self.cx.budget.charge(0).map_err(too_large)?;
            let mut list = List { nodes: Vec::new(), refs: Vec::new(), charge };
            self.leaf(&mut list, &work, &refs)?;
            return Ok(Subtree::List(list));
        };
        let (below, above) = deal(&refs, &plane);
        drop(refs);
        let (low, high) = self.sides(&work, &plane, bad);
        let (low, high) = rayon::join(|| self.subtree(low, below), || self.subtree(high, above));
        Ok(Subtree::Fork(plane, Box::new((low?, high?))))
    }

    /// The same by one thread, appended to a list.
    fn fill(&self, list: &mut List, work: Work, refs: &[KdRef]) -> Result<(), BuildError> {
        let Some((plane, bad)) = self.divide(&work, refs)? else { return self.leaf(list, &work, refs) };
        let at = list.nodes.len();
        list.nodes.push(KdNode::leaf(0, 0));
        let (below, above) = deal(refs, &plane);
        let (low, high) = self.sides(&work, &plane, bad);
        self.fill(list, low, &below)?;
        drop(below);
        list.nodes[at] = KdNode::inner(plane.axis, plane.pos, num::index(list.nodes.len()));
        self.fill(list, high, &above)
    }

    /// The plane to divide at, and how many bad ones in a row that makes; `None` for a leaf.
    fn divide(&self, work: &Work, refs: &[KdRef]) -> Result<Option<(Plane, u32)>, BuildError> {
        self.cx.cancel.check()?;
        if refs.len() <= self.max_leaf || work.depth >= self.max_depth {
            return Ok(None);
        }
        let Some(plane) = self.costs.best_plane(&work.cell, refs) else { return Ok(None) };
        let leaf = self.costs.leaf(refs.len());
        let bad = if plane.cost < leaf { work.bad } else { work.bad + 1 };
        let hopeless = (plane.cost > 4.0 * leaf && refs.len() < 16) || bad >= BAD_REFINES;
        Ok((!hopeless).then_some((plane, bad)))
    }

    fn sides(&self, work: &Work, plane: &Plane, bad: u32) -> (Work, Work) {
        let (low, high) = work.cell.split(plane.axis, plane.pos);
        let side = |cell| Work { cell, depth: work.depth + 1, bad, share: work.share * 0.5 };
        (side(low), side(high))
    }

    fn leaf(&self, list: &mut List, work: &Work, refs: &[KdRef]) -> Result<(), BuildError> {
        // A leaf, the division above it, and the references.
        let growth = size_of::<KdNode>() * 2 + refs.len() * size_of::<PrimRef>();
        list.charge.grow(growth as u64).map_err(too_large)?;
        list.nodes.push(KdNode::leaf(num::index(list.refs.len()), num::index(refs.len())));
        list.refs.extend(refs.iter().map(|r| r.prim));
        if work.share >= 1.0 {
            self.cx.progress.advance(num::floor_index(work.share, num::MAX_INDEX) as u64);
        }
        Ok(())
    }
}

/// Each side's triangles, their boxes cut at the plane. One that lies in the plane is below.
fn deal(refs: &[KdRef], plane: &Plane) -> (Vec<KdRef>, Vec<KdRef>) {
    let (k, pos) = (plane.axis.index(), plane.pos);
    let (mut below, mut above) = (Vec::new(), Vec::new());
    for r in refs {
        let is_above = r.bounds.max[k] > pos;
        if r.bounds.min[k] < pos || !is_above {
            let mut low = *r;
            low.bounds.max[k] = low.bounds.max[k].min(pos);
            below.push(low);
        }
        if is_above {
            let mut high = *r;
            high.bounds.min[k] = high.bounds.min[k].max(pos);
            above.push(high);
        }
    }
    (below, above)
}

/// Copies the forks and lists into one, the child below a plane right after its parent.
fn join(tree: Subtree) -> Result<(Vec<KdNode>, Vec<PrimRef>), BuildError> {
    enum Step {
        Visit(Subtree),
        Above(usize, Plane),
    }
    let (mut nodes, mut refs) = (Vec::new(), Vec::new());
    let mut open = vec![Step::Visit(tree)];
    while let Some(step) = open.pop() {
        match step {
            Step::Visit(Subtree::Fork(plane, children)) => {
                let at = nodes.len();
                nodes.push(KdNode::leaf(0, 0));
                let (low, high) = *children;
                open.extend([Step::Visit(high), Step::Above(at, plane), Step::Visit(low)]);
            }
            Step::Above(at, plane) => nodes[at] = KdNode::inner(plane.axis, plane.pos, num::index(nodes.len())),
            Step::Visit(Subtree::List(list)) => {
                if nodes.len() + list.nodes.len() > MAX_COUNT {
                    return Err(too_many("nodes"));
                }
                if refs.len() + list.refs.len() > num::MAX_INDEX || list.refs.len() > MAX_COUNT {
                    return Err(too_many("references"));
                }
                let (by, from) = (num::index(nodes.len()), num::index(refs.len()));
                nodes.extend(list.nodes.iter().map(|n| n.moved(by, from)));
                refs.extend_from_slice(&list.refs);
            }
        }
    }
    Ok((nodes, refs))
}
