//! The one top-down build loop: split the triangles in two, and again, until a leaf is better.
//! Which split is a [`Heuristic`]'s choice.
//!
//! Large nodes fork onto the pool; a subtree below [`FORK`] triangles is built by one thread into a
//! list of its own, and the lists are joined at the end. So nothing is shared while building, and
//! the tree does not depend on the number of threads.

use std::sync::Arc;

use rayon::prelude::*;

use super::tree::{Built, Node, Packed};
use crate::accel::{BuildCx, BuildError};
use crate::geometry::{Aabb, num};
use crate::scene::{Geometry, PrimRef};
use crate::task::OverBudget;

/// A triangle as builders see it.
#[derive(Clone, Copy, Debug)]
pub struct PrimBox {
    /// The tightest box around the triangle.
    pub bounds: Aabb,
    /// The triangle.
    pub prim: PrimRef,
}

/// Where to split a node.
pub trait Heuristic: Sync {
    /// Decides for each triangle on which side it goes.
    type Split: SplitRule;

    /// The best split of these triangles, or `None` if a leaf is better, or if all of them would
    /// end on one side. `bounds` is the box around them, `may_be_leaf` whether a leaf is allowed.
    fn choose(
        &self,
        prims: &[PrimBox],
        bounds: &Aabb,
        may_be_leaf: bool,
        cx: &BuildCx,
    ) -> Result<Option<Self::Split>, BuildError>;
}

/// A split that was chosen.
pub trait SplitRule {
    /// Whether the triangle belongs to the left child.
    fn goes_left(&self, prim: &PrimBox) -> bool;
}

/// When to stop.
#[derive(Clone, Copy, Debug)]
pub struct Limits {
    /// The most triangles in a leaf above the maximum depth.
    pub max_leaf: u32,
    /// No node is deeper.
    pub max_depth: u32,
}

/// Triangles below which a subtree is built by one thread.
const FORK: usize = 4096;
/// Triangles handled between two looks at the cancel flag.
const CHUNK: usize = 1 << 14;

/// A subtree whose upper part is still linked.
enum Subtree {
    Fork(Aabb, Box<(Self, Self)>),
    /// The root is at 0; children are numbered within the list.
    List(Vec<Node>),
}

/// Builds a BVH over all live triangles.
///
/// # Errors
/// Cancelled, or over the memory budget.
pub fn build<H: Heuristic>(geometry: &Arc<Geometry>, heuristic: &H, limits: Limits, cx: &BuildCx) -> Result<Built, BuildError> {
    let n = geometry.live_count();
    // At most 2n - 1 nodes, twice while the lists are joined.
    let (nodes, packed, temporary) =
        (2 * n * size_of::<Node>(), n * size_of::<Packed>(), n * (size_of::<PrimBox>() + 2 * size_of::<Node>()));
    let peak = cx.budget.charge((nodes + packed + temporary) as u64).map_err(too_large)?;

    cx.progress.start("bound", n as u64);
    let mut prims = prim_boxes(geometry, cx)?;
    cx.progress.start("split", n as u64);
    let builder = Builder { heuristic, limits, cx };
    let tree = if n == 0 { None } else { Some(cx.pool.run(|| builder.subtree(&mut prims, 0, 0))?) };
    cx.progress.start("pack", n as u64);
    let nodes = tree.map_or_else(Vec::new, |tree| join(tree, n));
    let packed = pack(geometry, &prims, cx)?;
    drop((peak, prims));
    let charge = cx.budget.charge((nodes.capacity() * size_of::<Node>() + size_of_val(&packed[..])) as u64).map_err(too_large)?;
    Ok(Built { geometry: Arc::clone(geometry), nodes, packed, _charge: charge })
}

fn too_large(over: OverBudget) -> BuildError {
    BuildError::Memory {
        structure: "bvh",
        over,
        remedy: "Raise the memory budget, or use a structure that packs nothing, such as bound.",
    }
}

fn prim_boxes(geometry: &Geometry, cx: &BuildCx) -> Result<Vec<PrimBox>, BuildError> {
    in_chunks(geometry.live_count(), cx, |i| {
        let prim = geometry.live(i);
        PrimBox { bounds: Aabb::of_triangle(&geometry.corners(prim)), prim }
    })
}

fn pack(geometry: &Geometry, prims: &[PrimBox], cx: &BuildCx) -> Result<Vec<Packed>, BuildError> {
    in_chunks(prims.len(), cx, |i| Packed { corners: geometry.corners(prims[i].prim), prim: prims[i].prim })
}

/// A list made in parallel by index, with a look at the cancel flag every chunk.
fn in_chunks<V: Send + Copy>(n: usize, cx: &BuildCx, make: impl Fn(usize) -> V + Sync) -> Result<Vec<V>, BuildError> {
    let chunk = |c: usize| {
        cx.progress.advance(CHUNK as u64);
        cx.cancel.check().map(|()| (c * CHUNK..n.min((c + 1) * CHUNK)).map(&make).collect::<Vec<V>>())
    };
    let chunks: Result<Vec<Vec<V>>, _> = cx.pool.run(|| (0..n.div_ceil(CHUNK)).into_par_iter().map(chunk).collect());
    Ok(chunks?.concat())
}

struct Builder<'a, H> {
    heuristic: &'a H,
    limits: Limits,
    cx: &'a BuildCx,
}

impl<H: Heuristic> Builder<'_, H> {
    /// Builds over `prims`, which start at `first` in the whole list, and sorts them as the leaves
    /// want them.
    fn subtree(&self, prims: &mut [PrimBox], first: usize, depth: u32) -> Result<Subtree, BuildError> {
        if prims.len() < FORK {
            let mut list = Vec::with_capacity(2 * prims.len());
            list.push(Node::leaf(&Aabb::EMPTY, 0, 1));
            self.fill(&mut list, 0, prims, first, depth)?;
            return Ok(Subtree::List(list));
        }
        let bounds = self.bounds(prims)?;
        let Some(mid) = self.split(prims, &bounds, depth)? else {
            self.cx.progress.advance(prims.len() as u64);
            return Ok(Subtree::List(vec![Node::leaf(&bounds, num::index(first), num::index(prims.len()))]));
        };
        let (left, right) = prims.split_at_mut(mid);
        let (left, right) = rayon::join(|| self.subtree(left, first, depth + 1), || self.subtree(right, first + mid, depth + 1));
        Ok(Subtree::Fork(bounds, Box::new((left?, right?))))
    }

    /// The same by one thread: writes node `at`, appends what is below it.
    fn fill(&self, list: &mut Vec<Node>, at: usize, prims: &mut [PrimBox], first: usize, depth: u32) -> Result<(), BuildError> {
        let bounds = prims.iter().fold(Aabb::EMPTY, |b, p| b.union(p.bounds));
        let Some(mid) = self.split(prims, &bounds, depth)? else {
            self.cx.progress.advance(prims.len() as u64);
            list[at] = Node::leaf(&bounds, num::index(first), num::index(prims.len()));
            return Ok(());
        };
        let left = list.len();
        list[at] = Node::inner(&bounds, num::index(left));
        list.extend([list[at]; 2]);
        let (l, r) = prims.split_at_mut(mid);
        self.fill(list, left, l, first, depth + 1)?;
        self.fill(list, left + 1, r, first + mid, depth + 1)
    }

    fn bounds(&self, prims: &[PrimBox]) -> Result<Aabb, BuildError> {
        self.cx.cancel.check()?;
        let chunk = |prims: &[PrimBox]| prims.iter().fold(Aabb::EMPTY, |b, p| b.union(p.bounds));
        Ok(prims.par_chunks(CHUNK).map(chunk).reduce(|| Aabb::EMPTY, Aabb::union))
    }

    /// Sorts `prims` into left and right and returns where the right ones begin; `None` for a leaf.
    fn split(&self, prims: &mut [PrimBox], bounds: &Aabb, depth: u32) -> Result<Option<usize>, BuildError> {
        self.cx.cancel.check()?;
        let below = self.limits.max_depth.saturating_sub(depth);
        let may_be_leaf = prims.len() <= self.limits.max_leaf as usize;
        if prims.len() <= 1 || below == 0 {
            return Ok(None);
        }
        // With few levels left only halving still brings every leaf down to size.
        let fits = (prims.len() as u64).div_ceil(1 << (below - 1).min(40)) <= u64::from(self.limits.max_leaf);
        if fits && let Some(rule) = self.heuristic.choose(prims, bounds, may_be_leaf, self.cx)? {
            let mid = partition(prims, &rule);
            debug_assert!(0 < mid && mid < prims.len(), "a heuristic chose a split with an empty side");
            return Ok(Some(mid));
        }
        Ok((!may_be_leaf).then(|| halve(prims)))
    }
}

/// Moves what goes left to the front, and says where it ends.
fn partition(prims: &mut [PrimBox], rule: &impl SplitRule) -> usize {
    let (mut lo, mut hi) = (0, prims.len());
    loop {
        while lo < hi && rule.goes_left(&prims[lo]) {
            lo += 1;
        }
        while lo < hi && !rule.goes_left(&prims[hi - 1]) {
            hi -= 1;
        }
        if lo >= hi {
            return lo;
        }
        prims.swap(lo, hi - 1);
    }
}

/// The object median along the axis on which the centres spread most: the way out when no plane
/// divides them (equal centres), or when the depth runs out.
fn halve(prims: &mut [PrimBox]) -> usize {
    let spread = Aabb::of_points(prims.iter().map(|p| p.bounds.centre_twice()));
    let axis = spread.longest_axis().index();
    let key = |p: &PrimBox| p.bounds.centre_twice()[axis];
    let mid = prims.len() / 2;
    prims.select_nth_unstable_by(mid, |a, b| key(a).total_cmp(&key(b)).then(a.prim.cmp(&b.prim)));
    mid
}

/// Copies the forks and lists into one: a node first, then what is below its left child, then what
/// is below its right one.
fn join(tree: Subtree, n: usize) -> Vec<Node> {
    let mut nodes = Vec::with_capacity(2 * n);
    nodes.push(Node::leaf(&Aabb::EMPTY, 0, 1));
    let mut open = vec![(0usize, tree)];
    while let Some((at, tree)) = open.pop() {
        match tree {
            Subtree::Fork(bounds, children) => {
                let left = nodes.len();
                nodes[at] = Node::inner(&bounds, num::index(left));
                nodes.extend([nodes[at]; 2]);
                let (l, r) = *children;
                open.extend([(left + 1, r), (left, l)]);
            }
            Subtree::List(list) => {
                // The root goes to its place, so its list moves by one less.
                let by = num::index(nodes.len() - 1);
                nodes[at] = list[0].moved(by);
                nodes.extend(list[1..].iter().map(|node| node.moved(by)));
            }
        }
    }
    nodes.shrink_to_fit();
    nodes
}
