//! From a binary tree to one of eights.

use std::marker::PhantomData;
use std::sync::Arc;

use super::ID;
use super::child::{Child, MAX_BLOCKS, MAX_INDEX};
use super::collapse::{Collapse, Costs};
use super::leaf::{Pack, Patch};
use super::node::Node;
use super::slots;
use super::tree::Tree;
use crate::accel::bvh::{self, Drafted};
use crate::accel::params::ParamValues;
use crate::accel::{BuildCx, BuildError};
use crate::geometry::{Aabb, num};
use crate::scene::{Geometry, PrimRef};
use crate::simd::{LANES, Road};
use crate::sys::list_in_large_pages;
use crate::task::OverBudget;
use rayon::prelude::*;

/// Parts that are packed side by side.
const PARTS: usize = 64;

/// Whether patches suit the triangles, and a remark: not where neighbours share few corners, as in a
/// soup. Some lists of eight are looked at, as they lie next to each other in the leaves.
pub fn suit(geometry: &Geometry, draft: &bvh::Draft) -> (bool, Option<String>) {
    const LOOKED_AT: usize = 256;
    /// With fewer a patch takes more memory than plain triangles in a block half full.
    const ENOUGH: f64 = 2.5;
    let lists = draft.refs.len().div_ceil(LANES);
    let (mut triangles, mut patches) = (0, 0);
    for list in draft.refs.chunks(LANES).step_by(lists.div_ceil(LOOKED_AT).max(1)) {
        let mut prims = list.to_vec();
        let mut left = &mut prims[..];
        while !left.is_empty() {
            let (_, count) = Patch::pack(geometry, left);
            left = &mut left[count..];
            patches += 1;
        }
        triangles += list.len();
    }
    if patches == 0 {
        return (true, None);
    }
    let each = f64::from(triangles as u32) / f64::from(patches);
    let suit = each >= ENOUGH;
    let taken = if suit { "patches" } else { "plain" };
    (suit, Some(format!("Leaves: auto took {taken}, since {each:.1} triangles fit into a patch.")))
}

/// Makes a tree of eights of a binary one, triangles packed as `B`.
///
/// # Errors
/// Cancelled, or it would not fit.
pub fn build<T, B: Pack>(
    geometry: &Arc<Geometry>,
    drafted: Drafted,
    p: &ParamValues,
    cx: &BuildCx,
) -> Result<Tree<T, B>, BuildError> {
    let Drafted { draft, splits, remarks, peak } = drafted;
    let (mut nodes, mut blocks, mut root) = (Vec::new(), Vec::new(), Child::NONE);
    if !draft.nodes.is_empty() {
        let costs =
            Costs { node: 1.0, block: p.float("c_block") as f32, max_leaf: p.int("wide_leaf") as u8, per_block: B::USUAL };
        cx.progress.start("collapse", draft.nodes.len() as u64);
        let _charge = cx.budget.charge(Collapse::bytes(draft.nodes.len()) as u64).map_err(too_large)?;
        let collapse = Collapse::of(&draft, &costs, cx)?;
        cx.progress.start("pack", draft.refs.len() as u64);
        let packer = Packer { geometry, draft: &draft, collapse: &collapse, cx };
        let mut whole = Packed::default();
        root = packer.pack(&mut whole)?;
        (nodes, blocks) = (whole.nodes, whole.blocks);
    }
    drop((draft, peak));
    let bytes = nodes.capacity() * size_of::<Node>() + blocks.capacity() * size_of::<B>();
    let charge = cx.budget.charge(bytes as u64).map_err(too_large)?;
    let geometry = Arc::clone(geometry);
    Ok(Tree { geometry, nodes, blocks, root, splits, remarks, road: Road::best(), _charge: charge, test: PhantomData })
}

fn too_large(over: OverBudget) -> BuildError {
    BuildError::Memory { structure: ID, over, remedy: "Raise the memory budget, or use grid, which packs no triangles." }
}

/// Nodes and blocks that several threads make: each its own, put together at the end.
#[derive(Debug)]
struct Packed<B> {
    nodes: Vec<Node>,
    blocks: Vec<B>,
}

impl<B> Default for Packed<B> {
    fn default() -> Self {
        Self { nodes: Vec::new(), blocks: Vec::new() }
    }
}

/// A part of the tree that is packed on its own: its node in the binary tree, and whose slot it is.
struct Part {
    from: u32,
    slot: Option<(usize, usize)>,
}

struct Packer<'a> {
    geometry: &'a Geometry,
    draft: &'a bvh::Draft,
    collapse: &'a Collapse<'a>,
    cx: &'a BuildCx,
}

impl Packer<'_> {
    /// The upper nodes first, until there are parts enough for all threads; then the parts, side by
    /// side.
    fn pack<B: Pack>(&self, whole: &mut Packed<B>) -> Result<Child, BuildError> {
        let mut open = std::collections::VecDeque::from([Part { from: 0, slot: None }]);
        let mut parts = Vec::new();
        while let Some(part) = open.pop_front() {
            if open.len() + parts.len() >= PARTS || self.collapse.is_leaf(part.from) {
                parts.push(part);
                continue;
            }
            let index = whole.nodes.len();
            refer(whole, part.slot, Child::node(num::index(index)));
            let slots = self.slots(part.from);
            whole.nodes.push(Node::new(&slots));
            let used = slots.iter().enumerate().filter(|(_, (child, _))| *child != Child::NONE);
            open.extend(used.map(|(slot, (child, _))| Part { from: num::index(child.index()), slot: Some((index, slot)) }));
        }
        let pack = |part: &Part| {
            let mut list = Packed::<B>::default();
            self.child(part.from, &mut list, &mut Vec::new()).map(|root| (list, root))
        };
        let packed: Result<Vec<_>, _> = self.cx.pool.run(|| parts.par_iter().map(pack).collect());
        let packed: Vec<(Packed<B>, Child)> = packed?;
        let nodes = packed.iter().map(|(list, _)| list.nodes.len()).sum::<usize>();
        let blocks = packed.iter().map(|(list, _)| list.blocks.len()).sum();
        let mut all = list_in_large_pages(whole.nodes.len() + nodes);
        all.append(&mut whole.nodes);
        whole.nodes = all;
        whole.blocks = list_in_large_pages(blocks);
        if whole.nodes.len() + nodes > MAX_INDEX || blocks > MAX_INDEX {
            return Err(too_many());
        }
        let mut root = Child::node(0);
        for (part, (list, child)) in parts.iter().zip(packed) {
            let (by, from) = (num::index(whole.nodes.len()), num::index(whole.blocks.len()));
            let child = child.moved(by, from);
            refer(whole, part.slot, child);
            if part.slot.is_none() {
                root = child;
            }
            whole.nodes.extend(list.nodes.iter().map(|node| node.moved(by, from)));
            whole.blocks.extend_from_slice(&list.blocks);
        }
        Ok(root)
    }

    /// The children of a node in their slots, by their numbers in the binary tree.
    fn slots(&self, at: u32) -> [(Child, Aabb); LANES] {
        let bounds = |at: u32| self.draft.nodes[at as usize].bounds();
        let mut below = Vec::with_capacity(LANES);
        self.collapse.slots(at, &mut below);
        let children: Vec<(Child, Aabb)> = below.iter().map(|at| (Child::node(*at), bounds(*at))).collect();
        slots::assign(&bounds(at), &children)
    }

    /// Writes all below a node of the binary tree, depth first, and returns what refers to it.
    fn child<B: Pack>(&self, at: u32, list: &mut Packed<B>, prims: &mut Vec<PrimRef>) -> Result<Child, BuildError> {
        if self.collapse.is_leaf(at) {
            prims.clear();
            self.gather(at, prims);
            self.cx.progress.advance(prims.len() as u64);
            return Ok(self.leaf(prims, list));
        }
        self.cx.cancel.check()?;
        let index = list.nodes.len();
        let mut slots = self.slots(at);
        list.nodes.push(Node::new(&slots));
        for (child, _) in slots.iter_mut().filter(|(child, _)| *child != Child::NONE) {
            *child = self.child(num::index(child.index()), list, prims)?;
        }
        list.nodes[index] = Node::new(&slots);
        Ok(Child::node(num::index(index)))
    }

    /// The blocks of one leaf. One that does not fit into the most there can be becomes several
    /// below a node of its own.
    fn leaf<B: Pack>(&self, prims: &mut [PrimRef], list: &mut Packed<B>) -> Child {
        let first = list.blocks.len();
        let mut done = 0;
        while done < prims.len() && list.blocks.len() - first < MAX_BLOCKS {
            let (block, count) = B::pack(self.geometry, &mut prims[done..]);
            list.blocks.push(block);
            done += count;
        }
        if done == prims.len() {
            return Child::leaf(num::index(first), num::index(list.blocks.len() - first));
        }
        list.blocks.truncate(first);
        let index = list.nodes.len();
        let mut slots = [(Child::NONE, Aabb::EMPTY); LANES];
        list.nodes.push(Node::new(&slots));
        let each = prims.len().div_ceil(LANES);
        for (slot, part) in slots.iter_mut().zip(prims.chunks_mut(each)) {
            let bounds = part.iter().fold(Aabb::EMPTY, |b, prim| b.union(Aabb::of_triangle(&self.geometry.corners(*prim))));
            *slot = (self.leaf(part, list), bounds);
        }
        list.nodes[index] = Node::new(&slots);
        Child::node(num::index(index))
    }

    /// All triangles below a node, each once.
    fn gather(&self, at: u32, prims: &mut Vec<PrimRef>) {
        let mut open = vec![at];
        let mut leaves = 0;
        while let Some(at) = open.pop() {
            let node = &self.draft.nodes[at as usize];
            match node.left() {
                Some(left) => open.extend([left + 1, left]),
                None => {
                    prims.extend_from_slice(&self.draft.refs[node.range()]);
                    leaves += 1;
                }
            }
        }
        if leaves > 1 {
            // Two leaves that become one may hold parts of the same triangle.
            prims.sort_unstable();
            prims.dedup();
        }
    }
}

/// Writes what a slot refers to.
fn refer<B>(whole: &mut Packed<B>, slot: Option<(usize, usize)>, child: Child) {
    if let Some((node, slot)) = slot {
        whole.nodes[node].refer(slot, child);
    }
}

fn too_many() -> BuildError {
    BuildError::TooMany { structure: ID, what: "nodes", limit: MAX_INDEX as u64, remedy: "Use a smaller model." }
}
