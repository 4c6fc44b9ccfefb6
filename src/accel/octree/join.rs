//! Subtrees that are built apart, and how they become one list.

use super::builder::too_large;
use super::node::{MAX_LEAF, Node, Octants};
use super::tree::MAX_NODES;
use crate::accel::{BuildCx, BuildError};
use crate::geometry::num;
use crate::scene::PrimRef;
use crate::task::{Charge, OverBudget};

/// A subtree whose upper part is still linked.
pub enum Subtree {
    /// The parts of a cell that have triangles, in order.
    Fork(Octants, Vec<Self>),
    /// Built by one thread.
    List(List),
}

/// A subtree as it will be, numbered within itself, with the memory it took.
pub struct List {
    /// The root first.
    pub nodes: Vec<Node>,
    /// What the leaves hold.
    pub refs: Vec<PrimRef>,
    charge: Charge,
}

impl List {
    /// A root without triangles. `charge` grows as the list does.
    pub fn new(charge: Charge) -> Self {
        Self { nodes: vec![Node::leaf(0, 0)], refs: Vec::new(), charge }
    }

    /// Charges what it has grown by.
    pub fn charge(&mut self) -> Result<(), OverBudget> {
        let needs = bytes(self.nodes.capacity(), self.refs.capacity());
        self.charge.grow(needs.saturating_sub(self.charge.bytes()))
    }
}

fn bytes(nodes: usize, refs: usize) -> u64 {
    (nodes * size_of::<Node>() + refs * size_of::<PrimRef>()) as u64
}

fn too_many(what: &'static str, limit: usize) -> BuildError {
    let remedy = "Lower max_refs or max_depth, or use bvh.";
    BuildError::TooMany { structure: "octree", what, limit: limit as u64, remedy }
}

/// Copies the forks and lists into one, with the memory it takes: the children of a fork side by
/// side, then what is below the first of them, and so on.
pub fn join(tree: Subtree, cx: &BuildCx) -> Result<(Vec<Node>, Vec<PrimRef>, Charge), BuildError> {
    let (node_count, ref_count) = size(&tree);
    for (what, count, most) in [("nodes", node_count, cx.most(MAX_NODES)), ("references", ref_count, cx.most(MAX_LEAF))] {
        if count > most {
            return Err(too_many(what, most));
        }
    }
    let charge = cx.budget.charge(bytes(node_count, ref_count)).map_err(too_large)?;
    let (mut nodes, mut refs) = (Vec::with_capacity(node_count), Vec::with_capacity(ref_count));
    nodes.push(Node::leaf(0, 0));
    let mut open = vec![(0usize, tree)];
    while let Some((at, tree)) = open.pop() {
        cx.cancel.check()?;
        match tree {
            Subtree::Fork(octants, children) => {
                let first = nodes.len();
                nodes[at] = Node::inner(octants, num::index(first));
                nodes.resize(first + children.len(), Node::leaf(0, 0));
                open.extend(children.into_iter().enumerate().map(|(i, child)| (first + i, child)).rev());
            }
            Subtree::List(list) => {
                // The root goes to its place, so what is below it moves by one less.
                let (by, from) = (num::index(nodes.len() - 1), num::index(refs.len()));
                nodes[at] = list.nodes[0].moved(by, from);
                nodes.extend(list.nodes[1..].iter().map(|node| node.moved(by, from)));
                refs.extend_from_slice(&list.refs);
            }
        }
    }
    Ok((nodes, refs, charge))
}

/// The nodes and references of a subtree.
fn size(tree: &Subtree) -> (usize, usize) {
    let (mut nodes, mut refs) = (1, 0);
    let mut open = vec![tree];
    while let Some(tree) = open.pop() {
        match tree {
            Subtree::Fork(_, children) => {
                nodes += children.len();
                open.extend(children);
            }
            Subtree::List(list) => {
                nodes += list.nodes.len() - 1;
                refs += list.refs.len();
            }
        }
    }
    (nodes, refs)
}
