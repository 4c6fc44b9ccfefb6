//! The one top-down build loop: divide the triangles in two, and again, until a leaf is better. What
//! a node's triangles are kept in, and where they are divided, is a [`Divide`]'s choice.
//!
//! Large nodes fork onto the pool; a subtree below [`FORK`] triangles is built by one thread into
//! lists of its own, and the lists are joined at the end. So nothing is shared while building, and
//! the tree does not depend on the number of threads.

use super::draft::Draft;
use super::subtree::{PLACE, Subtree};
use super::tree::Node;
use crate::accel::{BuildCx, BuildError};
use crate::geometry::{Aabb, num};
use crate::scene::PrimRef;

/// How nodes are divided.
pub trait Divide: Sync {
    /// The triangles of one node.
    type Work: Send;

    /// How many there are.
    fn count(&self, work: &Self::Work) -> usize;

    /// Divides them where it is best, into two that are not empty; or not, if a leaf is better or no
    /// plane divides them.
    fn divide(&self, work: Self::Work, may_be_leaf: bool, cx: &BuildCx) -> Result<Divided<Self::Work>, BuildError>;

    /// Divides two or more in the middle: the way out when no plane does, or the depth runs out.
    fn halve(&self, work: Self::Work) -> (Self::Work, Self::Work);

    /// Appends them to a list, and returns the box around them.
    fn leaf(&self, work: Self::Work, refs: &mut Vec<PrimRef>) -> Aabb;
}

/// What became of a node.
pub enum Divided<W> {
    /// Two children.
    Two(W, W),
    /// Nothing.
    Whole(W),
}

/// When to stop.
#[derive(Clone, Copy, Debug)]
pub struct Limits {
    /// The most triangles in a leaf above the maximum depth.
    pub max_leaf: u32,
    /// No node is deeper.
    pub max_depth: u32,
}

impl Limits {
    /// Whether so many triangles still come down to size in `below` levels if they are halved from
    /// the next one on.
    pub fn leave_room(&self, triangles: usize, below: u32) -> bool {
        (triangles as u64).div_ceil(1 << (below.saturating_sub(1)).min(40)) <= u64::from(self.max_leaf)
    }
}

/// Triangles below which a subtree is built by one thread.
const FORK: usize = 4096;

/// Builds over some triangles, at least one; called on the pool. What is left to do is to join the lists.
///
/// # Errors
/// Cancelled, or what the divider says.
pub fn build<D: Divide>(divider: &D, work: D::Work, limits: Limits, cx: &BuildCx) -> Result<Subtree, BuildError> {
    Builder { divider, limits, cx }.subtree(work, 0)
}

struct Builder<'a, D> {
    divider: &'a D,
    limits: Limits,
    cx: &'a BuildCx,
}

impl<D: Divide> Builder<'_, D> {
    fn subtree(&self, work: D::Work, depth: u32) -> Result<Subtree, BuildError> {
        if self.divider.count(&work) < FORK {
            let count = self.divider.count(&work);
            let mut list = Draft { nodes: Vec::with_capacity(2 * count), refs: Vec::with_capacity(count) };
            list.nodes.push(PLACE);
            self.fill(&mut list, 0, work, depth)?;
            // Leaves of several triangles leave room.
            list.nodes.shrink_to_fit();
            return Ok(Subtree::List(list));
        }
        match self.divide(work, depth)? {
            Divided::Two(left, right) => {
                let (left, right) = rayon::join(|| self.subtree(left, depth + 1), || self.subtree(right, depth + 1));
                Ok(Subtree::Fork(Box::new((left?, right?))))
            }
            Divided::Whole(work) => {
                let mut list = Draft { nodes: vec![PLACE], refs: Vec::new() };
                self.leaf(&mut list, 0, work);
                Ok(Subtree::List(list))
            }
        }
    }

    /// The same by one thread: writes node `at`, appends what is below it.
    fn fill(&self, list: &mut Draft, at: usize, work: D::Work, depth: u32) -> Result<(), BuildError> {
        match self.divide(work, depth)? {
            Divided::Two(l, r) => {
                let left = list.nodes.len();
                list.nodes.extend([PLACE; 2]);
                self.fill(list, left, l, depth + 1)?;
                self.fill(list, left + 1, r, depth + 1)?;
                let bounds = list.nodes[left].bounds().union(list.nodes[left + 1].bounds());
                list.nodes[at] = Node::inner(&bounds, num::index(left));
            }
            Divided::Whole(work) => self.leaf(list, at, work),
        }
        Ok(())
    }

    fn leaf(&self, list: &mut Draft, at: usize, work: D::Work) {
        let first = list.refs.len();
        let bounds = self.divider.leaf(work, &mut list.refs);
        let count = list.refs.len() - first;
        self.cx.progress.advance(count as u64);
        list.nodes[at] = Node::leaf(&bounds, num::index(first), num::index(count));
    }

    fn divide(&self, work: D::Work, depth: u32) -> Result<Divided<D::Work>, BuildError> {
        self.cx.cancel.check()?;
        let count = self.divider.count(&work);
        let below = self.limits.max_depth.saturating_sub(depth);
        let may_be_leaf = count <= self.limits.max_leaf as usize;
        if count <= 1 || below == 0 {
            return Ok(Divided::Whole(work));
        }
        // With few levels left only halving still brings every leaf down to size.
        let work = if self.limits.leave_room(count, below) {
            match self.divider.divide(work, may_be_leaf, self.cx)? {
                Divided::Whole(work) => work,
                two => return Ok(two),
            }
        } else {
            work
        };
        if may_be_leaf {
            return Ok(Divided::Whole(work));
        }
        let (left, right) = self.divider.halve(work);
        Ok(Divided::Two(left, right))
    }
}
