//! From a binary tree to one of eights.

use std::marker::PhantomData;
use std::sync::Arc;

use super::ID;
use super::child::{Child, MAX_BLOCKS, MAX_UNITS};
use super::collapse::{Collapse, Costs};
use super::leaf::{Pack, Patch};
use super::node::Node;
use super::slots;
use super::tree::Tree;
use super::unit::{self, Unit};
use crate::accel::bvh::{self, Drafted};
use crate::accel::params::ParamValues;
use crate::accel::{BuildCx, BuildError, Fits};
use crate::geometry::{Aabb, num};
use crate::scene::{Geometry, PrimRef};
use crate::simd::{LANES, Road};
use crate::sys::zeros_in_large_pages;
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
    let parts = if draft.nodes.is_empty() {
        None
    } else {
        let costs =
            Costs { node: 1.0, block: p.float("c_block") as f32, max_leaf: p.int("wide_leaf") as u8, per_block: B::USUAL };
        cx.progress.start("collapse", draft.nodes.len() as u64);
        let _charge = cx.budget.charge(Collapse::bytes(draft.nodes.len()) as u64).map_err(too_large)?;
        let collapse = Collapse::of(&draft, &costs, cx)?;
        cx.progress.start("pack", draft.refs.len() as u64);
        Some(Packer { geometry, draft: &draft, collapse: &collapse, cx }.pack::<B>()?)
    };
    // Before the parts exist twice.
    drop((draft, peak));
    let (whole, root) = match parts {
        Some(parts) => parts.together(cx)?,
        None => (Packed::new(Vec::new()), Child::NONE),
    };
    let bytes = whole.units.capacity() * unit::BYTES;
    let charge = cx.budget.charge(bytes as u64).map_err(too_large)?;
    let geometry = Arc::clone(geometry);
    let Packed { units, nodes, .. } = whole;
    Ok(Tree { geometry, units, nodes, root, splits, remarks, road: Road::best(), _charge: charge, test: PhantomData })
}

fn too_large(over: OverBudget) -> BuildError {
    BuildError::Memory {
        structure: ID,
        over,
        remedy: "Raise the memory budget, or use grid, which packs no triangles.",
        fits: Fits::default(),
    }
}

/// Nodes and blocks that several threads make: each its own, put together at the end.
#[derive(Debug)]
struct Packed<N> {
    units: Vec<Unit>,
    /// How many nodes are among them.
    nodes: usize,
    of: PhantomData<N>,
}

impl<N: Node> Packed<N> {
    const fn new(units: Vec<Unit>) -> Self {
        Self { units, nodes: 0, of: PhantomData }
    }

    /// Appends a node; where it lies.
    fn push_node(&mut self, slots: &[(Child, Aabb); LANES]) -> u32 {
        self.nodes += 1;
        num::index(unit::push(&mut self.units, &N::new(slots)))
    }

    /// Writes what a slot of a node refers to.
    fn refer(&mut self, slot: Option<(u32, usize)>, child: Child) {
        if let Some((node, slot)) = slot {
            N::at_mut(&mut self.units, node).refer(slot, child);
        }
    }

    /// Moves what nodes refer to, from this child on, `by` units on.
    fn move_all(&mut self, root: Child, by: u32) {
        let mut open = vec![root];
        while let Some(child) = open.pop().filter(|child| child.is_node()) {
            let node = N::at_mut(&mut self.units, child.place());
            open.extend(node.children().iter().filter(|child| child.is_node()));
            for slot in 0..LANES {
                node.refer(slot, node.children()[slot].moved(by));
            }
        }
    }
}

/// A part of the tree that is packed on its own: its node in the binary tree, and whose slot it is.
struct Part {
    from: u32,
    slot: Option<(u32, usize)>,
}

/// All parts, packed, and the nodes above them.
struct Parts<N> {
    upper: Packed<N>,
    below: Vec<Below<N>>,
}

/// A part, whose slot it is, and what refers to it.
struct Below<N> {
    slot: Option<(u32, usize)>,
    list: Packed<N>,
    root: Child,
}

impl<N: Node> Parts<N> {
    /// One list of all, and its root.
    fn together(self, cx: &BuildCx) -> Result<(Packed<N>, Child), BuildError> {
        let Self { mut upper, below } = self;
        let units = upper.units.len() + below.iter().map(|part| part.list.units.len()).sum::<usize>();
        let most = cx.most(MAX_UNITS);
        if units > most {
            return Err(BuildError::TooMany {
                structure: ID,
                what: "units of 32 bytes",
                limit: most as u64,
                remedy: "Use a smaller model.",
            });
        }
        let _twice = cx.budget.charge((2 * units * unit::BYTES) as u64).map_err(too_large)?;
        let mut whole = Packed { nodes: upper.nodes, ..Packed::new(zeros_in_large_pages(units)) };
        let (first, mut rest) = whole.units.split_at_mut(upper.units.len());
        let (mut root, mut place, mut rooms) = (Child::node(0), first.len(), Vec::with_capacity(below.len()));
        for part in &below {
            let (room, others) = std::mem::take(&mut rest).split_at_mut(part.list.units.len());
            let by = num::index(place);
            upper.refer(part.slot, part.root.moved(by));
            if part.slot.is_none() {
                root = part.root.moved(by);
            }
            place += room.len();
            rest = others;
            rooms.push((room, by));
        }
        first.copy_from_slice(&upper.units);
        whole.nodes += below.iter().map(|part| part.list.nodes).sum::<usize>();
        let write = |(Below { mut list, root, .. }, (room, by)): (Below<N>, (&mut [Unit], u32))| {
            list.move_all(root, by);
            room.copy_from_slice(&list.units);
        };
        cx.pool.run(|| below.into_par_iter().zip(rooms).for_each(write));
        Ok((whole, root))
    }
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
    fn pack<B: Pack>(&self) -> Result<Parts<B::Node>, BuildError> {
        let mut upper = Packed::new(Vec::new());
        let mut open = std::collections::VecDeque::from([Part { from: 0, slot: None }]);
        let mut parts = Vec::new();
        while let Some(part) = open.pop_front() {
            if open.len() + parts.len() >= PARTS || self.collapse.is_leaf(part.from) {
                parts.push(part);
                continue;
            }
            let slots = self.slots(part.from);
            let place = upper.push_node(&slots);
            upper.refer(part.slot, Child::node(place));
            let used = slots.iter().enumerate().filter(|(_, (child, _))| *child != Child::NONE);
            open.extend(used.map(|(slot, (child, _))| Part { from: child.place(), slot: Some((place, slot)) }));
        }
        // A list that grows is moved again and again: each thread keeps one for all of its parts.
        let pack = |list: &mut Packed<B::Node>, part: &Part| {
            let root = self.child::<B>(part.from, list, &mut Vec::new())?;
            let packed = Packed { nodes: list.nodes, ..Packed::new(list.units.clone()) };
            list.units.clear();
            list.nodes = 0;
            Ok(Below { slot: part.slot, list: packed, root })
        };
        let none = || Packed::new(Vec::new());
        let below: Result<Vec<_>, BuildError> = self.cx.pool.run(|| parts.par_iter().map_init(none, pack).collect());
        Ok(Parts { upper, below: below? })
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
    fn child<B: Pack>(&self, at: u32, list: &mut Packed<B::Node>, prims: &mut Vec<PrimRef>) -> Result<Child, BuildError> {
        if self.collapse.is_leaf(at) {
            prims.clear();
            self.gather(at, prims);
            self.cx.progress.advance(prims.len() as u64);
            return Ok(self.leaf::<B>(prims, list));
        }
        self.cx.cancel.check()?;
        let slots = self.slots(at);
        let place = list.push_node(&slots);
        for (slot, (child, _)) in slots.iter().enumerate().filter(|(_, (child, _))| *child != Child::NONE) {
            let child = self.child::<B>(child.place(), list, prims)?;
            list.refer(Some((place, slot)), child);
        }
        Ok(Child::node(place))
    }

    /// The blocks of one leaf. One that does not fit into the most there can be becomes several
    /// below a node of its own.
    fn leaf<B: Pack>(&self, prims: &mut [PrimRef], list: &mut Packed<B::Node>) -> Child {
        let first = list.units.len();
        let (mut done, mut blocks) = (0, 0);
        while done < prims.len() && blocks < MAX_BLOCKS {
            let (block, count) = B::pack(self.geometry, &mut prims[done..]);
            unit::push(&mut list.units, &block);
            done += count;
            blocks += 1;
        }
        if done == prims.len() {
            return Child::leaf(num::index(first), num::index(blocks));
        }
        list.units.truncate(first);
        let place = list.push_node(&[(Child::NONE, Aabb::EMPTY); LANES]);
        let mut slots = [(Child::NONE, Aabb::EMPTY); LANES];
        let each = prims.len().div_ceil(LANES);
        for (slot, part) in slots.iter_mut().zip(prims.chunks_mut(each)) {
            let bounds = part.iter().fold(Aabb::EMPTY, |b, prim| b.union(Aabb::of_triangle(&self.geometry.corners(*prim))));
            *slot = (self.leaf::<B>(part, list), bounds);
        }
        *B::Node::at_mut(&mut list.units, place) = B::Node::new(&slots);
        Child::node(place)
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
