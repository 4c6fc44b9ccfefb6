//! A tree as builders make it, and how it becomes the tree that rays walk: leaves are collapsed where
//! the surface area heuristic says so, what is too deep is built anew, and nodes and triangles are
//! laid out in the order of a walk.

use super::boxes::{Bounds, PrimBox, in_chunks};
use super::costs::Costs;
use super::median::ObjectMedian;
use super::slice::{InPlace, Slice};
use super::subtree::{PLACE, Subtree};
use super::topdown::{self, Limits};
use super::tree::{Node, Packed};
use crate::accel::{BuildCx, BuildError};
use crate::geometry::{Aabb, num};
use crate::scene::{Geometry, PrimRef};

/// Nodes, the root first and siblings side by side, and the triangles of the leaves. Children come
/// after their parent.
#[derive(Debug)]
pub struct Draft {
    pub nodes: Vec<Node>,
    pub refs: Vec<PrimRef>,
}

impl Draft {
    /// One leaf for each triangle would come to so many bytes.
    pub const fn bytes(triangles: usize) -> usize {
        2 * triangles * size_of::<Node>() + triangles * size_of::<PrimRef>()
    }

    /// What [`Self::arranged`] takes beside both drafts.
    pub const fn arranging_bytes(triangles: usize) -> usize {
        2 * triangles * (size_of::<Summary>() + size_of::<f64>())
    }

    /// The chance that a random line that meets an inner node meets both of its children at once.
    pub fn overlap(&self) -> f64 {
        let (mut shared, mut inner) = (0.0, 0.0);
        for node in &self.nodes {
            let Some(left) = node.left() else { continue };
            let [a, b] = [left, left + 1].map(|child| self.nodes[child as usize].bounds());
            let both = a.intersection(b);
            shared += if both.is_empty() { 0.0 } else { both.area() };
            inner += node.bounds().area();
        }
        if inner > 0.0 { shared / inner } else { 0.0 }
    }

    /// The SAH cost as it is, times the root's area.
    pub fn sum(&self, costs: &Costs) -> f64 {
        let own = |node: &Node| match node.left() {
            Some(_) => costs.c_trav * node.bounds().area(),
            None => costs.triangles(node.bounds().area(), node.count() as usize),
        };
        self.nodes.iter().map(own).sum()
    }

    /// References to triangles below a node.
    pub fn references(&self, at: u32) -> u32 {
        let (mut references, mut open) = (0, vec![at]);
        while let Some(at) = open.pop() {
            let node = &self.nodes[at as usize];
            references += node.count();
            open.extend(node.left().into_iter().flat_map(|left| [left, left + 1]));
        }
        references
    }

    /// The packed triangles in the order of the leaves.
    pub fn pack(&self, geometry: &Geometry, cx: &BuildCx) -> Result<Vec<Packed>, BuildError> {
        in_chunks(self.refs.len(), cx, |i| Packed { corners: geometry.corners(self.refs[i]), prim: self.refs[i] })
    }

    /// The SAH cost once leaves are collapsed, times the root's area.
    pub fn cost(&self, costs: &Costs, max_leaf: u32, cx: &BuildCx) -> Result<f64, BuildError> {
        Ok(summaries(self, costs, max_leaf, cx)?.1)
    }

    /// Brings a tree of any builder into the order of a walk, within the limits. Nodes become leaves
    /// where that is cheaper: decided from the leaves up, so no other choice of leaves costs less.
    pub fn arranged(self, geometry: &Geometry, costs: &Costs, limits: Limits, cx: &BuildCx) -> Result<Self, BuildError> {
        cx.progress.start("arrange", self.refs.len() as u64);
        let (summaries, _) = summaries(&self, costs, limits.max_leaf, cx)?;
        let arranger = Arranger { from: &self, summaries: &summaries, geometry, limits, cx };
        let arranged = cx.pool.run(|| arranger.subtree(0, 0))?;
        // The nodes are to exist no more than twice.
        drop((summaries, self));
        Ok(cx.pool.run(|| arranged.joined(&cx.cancel))?)
    }
}

/// What is below a node, once leaves are collapsed.
#[derive(Clone, Copy, Default)]
struct Summary {
    triangles: u32,
    /// Steps to the deepest leaf, saturating.
    height: u8,
    is_leaf: bool,
}

/// Of all nodes, and the SAH cost of the tree times the root's area. From the last node to the first, so
/// that children come before their parent.
fn summaries(draft: &Draft, costs: &Costs, max_leaf: u32, cx: &BuildCx) -> Result<(Vec<Summary>, f64), BuildError> {
    let mut summaries = vec![Summary::default(); draft.nodes.len()];
    let mut cost = vec![0.0; draft.nodes.len()];
    for at in (0..draft.nodes.len()).rev() {
        if at.is_multiple_of(1 << 14) {
            cx.cancel.check()?;
        }
        let node = &draft.nodes[at];
        let area = node.bounds().area();
        (summaries[at], cost[at]) = match node.left() {
            None => {
                let triangles = node.count();
                (Summary { triangles, height: 0, is_leaf: true }, costs.triangles(area, triangles as usize))
            }
            Some(left) => {
                let (left, right) = (left as usize, left as usize + 1);
                let (a, b) = (summaries[left], summaries[right]);
                let triangles = a.triangles + b.triangles;
                let inner = costs.c_trav * area + cost[left] + cost[right];
                let leaf = costs.triangles(area, triangles as usize);
                let is_leaf = triangles <= max_leaf && leaf <= inner;
                let height = if is_leaf { 0 } else { a.height.max(b.height).saturating_add(1) };
                (Summary { triangles, height, is_leaf }, if is_leaf { leaf } else { inner })
            }
        };
    }
    let whole = cost.first().copied().unwrap_or(0.0);
    Ok((summaries, whole))
}

struct Arranger<'a> {
    from: &'a Draft,
    summaries: &'a [Summary],
    geometry: &'a Geometry,
    limits: Limits,
    cx: &'a BuildCx,
}

/// What is written where, and how deep that is.
struct Open {
    from: u32,
    to: usize,
    depth: u32,
}

/// Triangles below which a subtree is arranged by one thread.
const FORK: u32 = 1 << 14;

impl Arranger<'_> {
    /// No deeper than the limit, whatever the tree is like.
    fn subtree(&self, from: u32, depth: u32) -> Result<Subtree, BuildError> {
        self.cx.cancel.check()?;
        let here = &self.summaries[from as usize];
        match self.from.nodes[from as usize].left() {
            Some(left) if here.triangles >= FORK && !here.is_leaf && self.fits(left, depth) => {
                let (left, right) = rayon::join(|| self.subtree(left, depth + 1), || self.subtree(left + 1, depth + 1));
                Ok(Subtree::Fork(Box::new((left?, right?))))
            }
            _ => self.list(from, depth).map(Subtree::List),
        }
    }

    /// The same by one thread.
    fn list(&self, from: u32, depth: u32) -> Result<Draft, BuildError> {
        let count = self.summaries[from as usize].triangles as usize;
        let mut list = Draft { nodes: Vec::with_capacity(count), refs: Vec::with_capacity(count) };
        list.nodes.push(PLACE);
        let mut open = vec![Open { from, to: 0, depth }];
        while let Some(Open { from, to, depth }) = open.pop() {
            let node = self.from.nodes[from as usize];
            match node.left() {
                Some(left) if !self.summaries[from as usize].is_leaf => {
                    if !self.fits(left, depth) {
                        self.rebuild(&mut list, from, to, depth)?;
                        continue;
                    }
                    let pair = list.nodes.len();
                    list.nodes[to] = Node::inner(&node.bounds(), num::index(pair));
                    list.nodes.extend([PLACE; 2]);
                    open.push(Open { from: left + 1, to: pair + 1, depth: depth + 1 });
                    open.push(Open { from: left, to: pair, depth: depth + 1 });
                }
                _ => self.leaf(&mut list, from, to),
            }
        }
        self.cx.progress.advance(count as u64);
        Ok(list)
    }

    /// Whether both children at `left` either end in time or can still be halved down to size.
    fn fits(&self, left: u32, depth: u32) -> bool {
        [left, left + 1].into_iter().all(|child| {
            let s = &self.summaries[child as usize];
            let below = self.limits.max_depth.saturating_sub(depth + 1);
            depth < self.limits.max_depth
                && (u32::from(s.height) <= below || (below > 0 && self.limits.leave_room(s.triangles as usize, below)))
        })
    }

    fn leaf(&self, list: &mut Draft, from: u32, to: usize) {
        let first = list.refs.len();
        self.gather(list, from);
        if self.from.nodes[from as usize].left().is_some() {
            // Two leaves that become one may hold parts of the same triangle.
            let mut all = list.refs.split_off(first);
            all.sort_unstable();
            all.dedup();
            list.refs.append(&mut all);
        }
        let count = list.refs.len() - first;
        let bounds = self.from.nodes[from as usize].bounds();
        list.nodes[to] = Node::leaf(&bounds, num::index(first), num::index(count));
    }

    /// Appends all triangles below a node.
    fn gather(&self, list: &mut Draft, from: u32) {
        let mut open = vec![from];
        while let Some(at) = open.pop() {
            let node = &self.from.nodes[at as usize];
            match node.left() {
                Some(left) => open.extend([left + 1, left]),
                None => list.refs.extend_from_slice(&self.from.refs[node.range()]),
            }
        }
    }

    /// Builds what would be too deep anew, halving: as shallow as can be.
    fn rebuild(&self, list: &mut Draft, from: u32, to: usize, depth: u32) -> Result<(), BuildError> {
        let first = list.refs.len();
        self.gather(list, from);
        let boxed = |prim: PrimRef| PrimBox::new(&Bounds::from(&Aabb::of_triangle(&self.geometry.corners(prim))), prim);
        let mut prims: Vec<PrimBox> = list.refs.drain(first..).map(boxed).collect();
        let limits = Limits { max_depth: self.limits.max_depth - depth, ..self.limits };
        let built =
            topdown::build(&InPlace::new(ObjectMedian), Slice::new(&mut prims), limits, self.cx)?.joined(&self.cx.cancel)?;
        let by = num::index(list.nodes.len() - 1);
        list.nodes[to] = built.nodes[0].moved(by, num::index(first));
        list.nodes.extend(built.nodes[1..].iter().map(|node| node.moved(by, num::index(first))));
        list.refs.extend_from_slice(&built.refs);
        Ok(())
    }
}
