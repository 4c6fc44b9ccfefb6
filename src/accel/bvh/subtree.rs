//! A tree that several threads make: each a list of its own for what is below a node, joined to one at
//! the end. So nothing is shared meanwhile, and the tree does not depend on the number of threads.

use super::draft::Draft;
use super::tree::Node;
use crate::geometry::{Aabb, num};
use crate::scene::PrimRef;
use crate::sys::zeros_in_large_pages;
use crate::task::{Cancel, Cancelled};

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

    /// Copies the forks and lists into one, on the threads of the pool that it is called on: a node first, then
    /// what is below its left child, then what is below its right one.
    ///
    /// # Errors
    /// [`Cancelled`] if asked to stop.
    pub fn joined(self, cancel: &Cancel) -> Result<Draft, Cancelled> {
        if let Self::List(list) = self {
            return Ok(list);
        }
        let (node_count, ref_count) = self.sizes();
        let (mut nodes, mut refs) = (zeros_in_large_pages(node_count), zeros_in_large_pages(ref_count));
        let (root, below) = nodes.split_at_mut(1);
        self.write(&mut root[0], Room { nodes: below, first_node: 1, refs: &mut refs, first_ref: 0 }, cancel);
        // What was not written then is of no use.
        cancel.check().map(|()| Draft { nodes, refs })
    }

    fn write(self, root: &mut Node, room: Room<'_>, cancel: &Cancel) {
        match self {
            _ if cancel.is_cancelled() => {}
            Self::List(list) => {
                // The root goes to its place, so its list moves by one less.
                let (by, from) = (num::index(room.first_node - 1), num::index(room.first_ref));
                *root = list.nodes[0].moved(by, from);
                room.nodes.iter_mut().zip(&list.nodes[1..]).for_each(|(to, node)| *to = node.moved(by, from));
                room.refs.copy_from_slice(&list.refs);
            }
            Self::Fork(children) => {
                let (left, right) = *children;
                *root = Node::inner(&left.bounds().union(right.bounds()), num::index(room.first_node));
                let ([l, r], rooms) = room.divided(left.sizes());
                let [left_room, right_room] = rooms;
                rayon::join(|| left.write(l, left_room, cancel), || right.write(r, right_room, cancel));
            }
        }
    }
}

/// Where what is below a node is written, and where that is in the whole.
struct Room<'a> {
    nodes: &'a mut [Node],
    first_node: usize,
    refs: &'a mut [PrimRef],
    first_ref: usize,
}

impl<'a> Room<'a> {
    /// Two children, and the rooms for what is below them; so many nodes and references are the left one's.
    fn divided(self, (nodes, refs): (usize, usize)) -> ([&'a mut Node; 2], [Self; 2]) {
        let (pair, below) = self.nodes.split_at_mut(2);
        let (l, r) = pair.split_at_mut(1);
        let (left_nodes, right_nodes) = below.split_at_mut(nodes - 1);
        let (left_refs, right_refs) = self.refs.split_at_mut(refs);
        let first_node = self.first_node + 2;
        let left = Room { nodes: left_nodes, first_node, refs: left_refs, first_ref: self.first_ref };
        let (first_node, first_ref) = (first_node + nodes - 1, self.first_ref + refs);
        let right = Room { nodes: right_nodes, first_node, refs: right_refs, first_ref };
        ([&mut l[0], &mut r[0]], [left, right])
    }
}
