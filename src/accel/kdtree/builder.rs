//! The build loop of the k-d tree: divide a cell where it is cheapest, give each side the triangles
//! that overlap it, and again, until a leaf is better.
//!
//! Planes are searched for exactly, over events that are sorted once and kept in order while cells
//! are divided, in O(N log N) (Wald and Havran 2006, §4.3); or by bins down to cells of [`Search`]'s
//! size. Large cells fork onto the pool, and their own work is done in parallel portions (`large`); a subtree
//! below [`FORK`] references is built by one thread into a list of its own (`serial`), and the lists
//! are joined at the end. So nothing is shared while building, and the tree does not depend on the
//! number of threads.
//!
//! A cell whose best plane costs more than a leaf is divided a few times more in the hope of a
//! better one further down (Pharr, Jakob and Humphreys 2016, §4.4.2: bad refines). Empty space is
//! cut off at a rebate when planes are compared, but whether a plane is a bad one goes by its full
//! cost: otherwise cells of a few triangles would be whittled down without end, for nothing.

use std::sync::Arc;

use super::costs::{Costs, Plane};
use super::deal::KdRef;
use super::events::{Event, MAX_REFS};
use super::large::Part;
use super::serial::Bench;
use super::tree::{Built, KdNode, MAX_COUNT, MAX_DEPTH};
use super::{bins, sweep};
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

/// How planes are searched for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Search {
    /// Every place where a box begins or ends.
    Exact,
    /// Only between bins, until a cell has few enough references for the exact search.
    Binned {
        /// Bins on each axis.
        bins: u32,
        /// The fewest references that are binned.
        least: u32,
    },
}

/// References below which a subtree is built by one thread.
pub const FORK: usize = 4096;
/// Planes in a row that may cost more than a leaf.
const BAD_REFINES: u32 = 3;

/// A subtree whose upper part is still linked.
enum Subtree {
    Fork(Plane, Box<(Self, Self)>),
    List(List),
}

/// A subtree as it will be, numbered within itself, with the memory it took.
pub struct List {
    /// Its nodes.
    pub nodes: Vec<KdNode>,
    refs: Vec<PrimRef>,
    charge: Charge,
}

/// Builds a k-d tree over all live triangles.
///
/// # Errors
/// Cancelled, over the memory budget, or more nodes or references than fit their indices.
pub fn build(
    geometry: &Arc<Geometry>,
    costs: &Costs,
    search: Search,
    limits: Limits,
    remarks: Vec<String>,
    cx: &BuildCx,
) -> Result<Built, BuildError> {
    let n = geometry.live_count();
    if n >= MAX_REFS {
        return Err(too_many("references in a cell", MAX_REFS));
    }
    let max_depth = if limits.max_depth == 0 { auto_depth(n) } else { limits.max_depth };
    let builder = Builder { geometry, costs, search, max_leaf: limits.max_leaf as usize, max_depth, cx };
    cx.progress.start("bound", n as u64);
    let all = builder.everything()?;
    cx.progress.start("split", n as u64);
    let work = Work { cell: *geometry.bounds(), depth: 0, bad: 0, share: n as f64 };
    let tree = cx.pool.run(|| builder.subtree(work, all))?;
    cx.progress.start("join", 0);
    let (nodes, refs) = join(tree, cx)?;
    let bytes = (nodes.capacity() * size_of::<KdNode>() + refs.capacity() * size_of::<PrimRef>()) as u64;
    let charge = cx.budget.charge(bytes).map_err(too_large)?;
    Ok(Built { geometry: Arc::clone(geometry), nodes, refs, remarks, _charge: charge })
}

/// 8 + 1.3 log2 n (Havran and Bittner 2002).
fn auto_depth(n: usize) -> u32 {
    let depth = 8.0 + 1.3 * (n.max(1) as f64).log2();
    num::index(num::floor_index(depth.round(), MAX_DEPTH as usize))
}

/// What to say of a build over its memory.
pub fn too_large(over: OverBudget) -> BuildError {
    BuildError::Memory {
        structure: "kdtree",
        over,
        remedy: "Raise the memory budget, lower max_depth, or use bvh.",
        fits: Fits::default(),
    }
}

fn too_many(what: &'static str, limit: usize) -> BuildError {
    BuildError::TooMany { structure: "kdtree", what, limit: limit as u64, remedy: "Lower max_depth, or use bvh." }
}

/// A cell to be divided, and what is known of it.
#[derive(Clone, Copy)]
pub struct Work {
    /// Its box.
    pub cell: Aabb,
    depth: u32,
    bad: u32,
    /// The progress its end stands for, in triangles of the scene.
    share: f64,
}

/// What every step of a build needs.
pub struct Builder<'a> {
    /// What it is built over.
    pub geometry: &'a Geometry,
    costs: &'a Costs,
    search: Search,
    max_leaf: usize,
    max_depth: u32,
    /// Cancel, progress, pool and budget.
    pub cx: &'a BuildCx,
}

impl Builder<'_> {
    /// Whether a cell of so many references is searched exactly.
    pub fn is_exact(&self, refs: usize) -> bool {
        match self.search {
            Search::Exact => true,
            Search::Binned { least, .. } => refs < least as usize,
        }
    }

    /// Takes memory for as long as the charge is held.
    pub fn charge(&self, bytes: usize) -> Result<Charge, BuildError> {
        self.cx.budget.charge(bytes as u64).map_err(too_large)
    }

    fn subtree(&self, work: Work, part: Part) -> Result<Subtree, BuildError> {
        let mut list = List { nodes: Vec::new(), refs: Vec::new(), charge: self.charge(0)? };
        if part.refs.len() < FORK {
            let events = part.lists.is_some();
            let mut bench = Bench::new(part.refs, part.lists.unwrap_or_default(), part.charge);
            self.fill(&mut list, &mut bench, work, events)?;
            return Ok(Subtree::List(list));
        }
        let Some((plane, bad)) =
            self.divide(&work, &part.refs, part.lists.as_ref().map(|lists| lists.each_ref().map(|l| &l[..])))?
        else {
            self.leaf(&mut list, &work, &part.refs)?;
            return Ok(Subtree::List(list));
        };
        let (below, above) = self.deal_large(&work, part, &plane)?;
        let (low, high) = self.sides(&work, &plane, bad);
        let (low, high) = rayon::join(|| self.subtree(low, below), || self.subtree(high, above));
        Ok(Subtree::Fork(plane, Box::new((low?, high?))))
    }

    /// The plane to divide at, and how many bad ones in a row that makes; `None` for a leaf.
    pub fn divide(&self, work: &Work, refs: &[KdRef], lists: Option<[&[Event]; 3]>) -> Result<Option<(Plane, u32)>, BuildError> {
        let cancel = &self.cx.cancel;
        cancel.check()?;
        if refs.len() <= self.max_leaf || work.depth >= self.max_depth {
            return Ok(None);
        }
        let found = match (lists, self.search) {
            (None, Search::Binned { bins, .. }) => bins::best_plane(self.costs, &work.cell, refs, bins, cancel)?,
            (lists, _) => sweep::best_plane(self.costs, &work.cell, refs.len(), lists.unwrap_or_default(), cancel)?,
        };
        let Some(plane) = found else { return Ok(None) };
        let leaf = self.costs.leaf(refs.len());
        let bad = if plane.cost < leaf { work.bad } else { work.bad + 1 };
        let hopeless = (plane.forgiven > 4.0 * leaf && refs.len() < 16) || bad >= BAD_REFINES;
        Ok((!hopeless).then_some((plane, bad)))
    }

    /// The cells on both sides of a plane.
    pub fn sides(&self, work: &Work, plane: &Plane, bad: u32) -> (Work, Work) {
        let (low, high) = work.cell.split(plane.axis, plane.pos);
        let side = |cell| Work { cell, depth: work.depth + 1, bad, share: work.share * 0.5 };
        (side(low), side(high))
    }

    /// Appends a leaf.
    pub fn leaf(&self, list: &mut List, work: &Work, refs: &[KdRef]) -> Result<(), BuildError> {
        // A leaf, the division above it, and the references.
        let growth = size_of::<KdNode>() * 2 + size_of_val(refs) / size_of::<KdRef>() * size_of::<PrimRef>();
        list.charge.grow(growth as u64).map_err(too_large)?;
        list.nodes.push(KdNode::leaf(num::index(list.refs.len()), num::index(refs.len())));
        list.refs.extend(refs.iter().map(|r| r.prim));
        if work.share >= 1.0 {
            self.cx.progress.advance(num::floor_index(work.share, num::MAX_INDEX) as u64);
        }
        Ok(())
    }
}

/// Copies the forks and lists into one, the child below a plane right after its parent.
fn join(tree: Subtree, cx: &BuildCx) -> Result<(Vec<KdNode>, Vec<PrimRef>), BuildError> {
    enum Step {
        Visit(Subtree),
        Above(usize, Plane),
    }
    let most = cx.most(MAX_COUNT);
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
                cx.cancel.check()?;
                if nodes.len() + list.nodes.len() > most {
                    return Err(too_many("nodes", most));
                }
                if refs.len() + list.refs.len() > cx.most(num::MAX_INDEX) || list.refs.len() > most {
                    return Err(too_many("references", most));
                }
                let (by, from) = (num::index(nodes.len()), num::index(refs.len()));
                nodes.extend(list.nodes.iter().map(|n| n.moved(by, from)));
                refs.extend_from_slice(&list.refs);
            }
        }
    }
    Ok((nodes, refs))
}
