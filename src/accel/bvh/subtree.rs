//! A tree that several threads make: each a list of its own for what is below a node, joined to one at
//! the end. So nothing is shared meanwhile, and the tree does not depend on the number of threads.

use super::draft::Draft;
use super::tree::Node;
use crate::geometry::{Aabb, num};

/// A node that is written once its children are.
pub const PLACE: Node = Node::leaf(&Aabb::EMPTY, 0, 1);

/// A subtree whose upper part is still linked.
pub enum Subtree {
    Fork(Box<(Self, Self)>),
    /// The root is at 0; children and references are numbered within the draft.
    List(Draft),
}

impl Subtree {
    fn bounds(&self) -> Aabb {
        match self {
            Self::Fork(children) => children.0.bounds().union(children.1.bounds()),
            Self::List(list) => list.nodes[0].bounds(),
        }
    }

    /// Nodes and references in all.
    fn sizes(&self) -> (usize, usize) {
        match self {
            Self::Fork(children) => {
                let (left, right) = (children.0.sizes(), children.1.sizes());
                (1 + left.0 + right.0, left.1 + right.1)
            }
            Self::List(list) => (list.nodes.len(), list.refs.len()),
        }
    }

    /// Copies the forks and lists into one: a node first, then what is below its left child, then what
    /// is below its right one.
    pub fn joined(self) -> Draft {
        if let Self::List(list) = self {
            return list;
        }
        let (node_count, ref_count) = self.sizes();
        let (mut nodes, mut refs) = (Vec::with_capacity(node_count), Vec::with_capacity(ref_count));
        nodes.push(PLACE);
        let mut open = vec![(0usize, self)];
        while let Some((at, tree)) = open.pop() {
            match tree {
                Self::Fork(children) => {
                    let left = nodes.len();
                    let bounds = children.0.bounds().union(children.1.bounds());
                    nodes[at] = Node::inner(&bounds, num::index(left));
                    nodes.extend([PLACE; 2]);
                    let (l, r) = *children;
                    open.extend([(left + 1, r), (left, l)]);
                }
                Self::List(list) => {
                    // The root goes to its place, so its list moves by one less.
                    let (by, from) = (num::index(nodes.len() - 1), num::index(refs.len()));
                    nodes[at] = list.nodes[0].moved(by, from);
                    nodes.extend(list.nodes[1..].iter().map(|node| node.moved(by, from)));
                    refs.extend_from_slice(&list.refs);
                }
            }
        }
        Draft { nodes, refs }
    }
}
