//! Parallel reinsertion (Meister and Bittner 2018, "Parallel Reinsertion for Bounding Volume
//! Hierarchy Optimization"): every node looks for the place in the tree where it would cost least;
//! the moves that gain most and do not touch each other are made; and again, until a round gains
//! little, or the time is up.
//!
//! ```text
//!     P              S                 X               X'
//!    / \     ─►     (P's place)       (anywhere)  ─►  / \
//!   S   N                                            X   N
//! ```
//!
//! Taking N out frees the pair (S, N): S moves into P's place, and the pair becomes (X, N) below the
//! place where X was.

use std::time::Instant;

use rayon::prelude::*;

use super::draft::Draft;
use super::tree::Node;
use crate::accel::{BuildCx, BuildError};
use crate::geometry::{Aabb, num};

/// When to stop.
#[derive(Clone, Copy, Debug)]
pub struct Patience {
    /// A round that lowers the sum of areas by less than this share is the last.
    pub gain: f64,
    /// No round begins after so many seconds; 0 for no limit.
    pub secs: f64,
}

/// The most rounds.
const ROUNDS: usize = 32;
/// Nodes looked at between two looks at the cancel flag.
const CHUNK: usize = 1 << 8;
/// Steps of one node's search: a search that goes on for longer finds hardly anything any more, and
/// where all boxes overlap it would visit the whole tree.
const STEPS: usize = 4096;

/// A move that was made. Boxes are in the space that the tree is in.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Moved {
    /// The node that was moved.
    pub node: Aabb,
    /// What is below it: references to triangles.
    pub references: u32,
    /// Its parent before, which is gone.
    pub from: Aabb,
    /// Its parent since, which was made for it.
    pub to: Aabb,
    /// The area that was saved, of all inner nodes together.
    pub gain: f64,
}

/// What one round did.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Round {
    /// Moves that were made.
    pub made: u32,
    /// The area that they saved together.
    pub gain: f64,
    /// The first of them: in the order in which they were made, which is that of what they promised to gain.
    pub moves: Vec<Moved>,
}

/// Keeps what is moved, for those who want to see it.
#[derive(Clone, Debug)]
pub struct Log {
    /// Round by round; those that moved nothing are left out.
    pub rounds: Vec<Round>,
    /// The most moves of a round that are kept one by one.
    most: usize,
}

impl Log {
    /// Keeps so many moves of a round at most; the others are counted.
    pub const fn new(most: usize) -> Self {
        Self { rounds: Vec::new(), most }
    }

    /// What it takes at most.
    pub const fn bytes(most: usize) -> usize {
        ROUNDS * most * size_of::<Moved>()
    }
}

/// Moves nodes until it pays no more; returns the share of the sum of areas that was saved.
pub fn optimise(draft: &mut Draft, patience: Patience, mut log: Option<&mut Log>, cx: &BuildCx) -> Result<f64, BuildError> {
    cx.progress.start("reinsert", ROUNDS as u64);
    let start = Instant::now();
    let mut tree = Tree::new(draft);
    let before = tree.sum_of_areas();
    let mut sum = before;
    for _ in 0..ROUNDS {
        if tree.draft.nodes.len() < 5 || (patience.secs > 0.0 && start.elapsed().as_secs_f64() > patience.secs) {
            break;
        }
        let moves = tree.moves(cx)?;
        let round = tree.make(&moves, log.as_ref().map_or(0, |log| log.most));
        if let Some(log) = log.as_deref_mut().filter(|_| round.made > 0) {
            log.rounds.push(round);
        }
        let now = tree.sum_of_areas();
        cx.progress.advance(1);
        let gained = (sum - now) / sum;
        sum = now;
        if gained.is_nan() || gained < patience.gain {
            break;
        }
    }
    tree.order()?;
    Ok(if before > 0.0 { 1.0 - sum / before } else { 0.0 })
}

/// A move: the node, the place, and the area that is saved.
#[derive(Clone, Copy)]
struct Move {
    node: u32,
    to: u32,
    gain: f64,
}

struct Tree<'a> {
    draft: &'a mut Draft,
    /// Of each pair of siblings (by the index of the right one, halved): their parent.
    parents: Vec<u32>,
}

/// Siblings are at `2k + 1` and `2k + 2`.
const fn pair(node: u32) -> usize {
    (node as usize - 1) / 2
}

const fn sibling(node: u32) -> u32 {
    if node % 2 == 1 { node + 1 } else { node - 1 }
}

impl<'a> Tree<'a> {
    fn new(draft: &'a mut Draft) -> Self {
        let mut parents = vec![0; draft.nodes.len() / 2];
        for (i, node) in draft.nodes.iter().enumerate() {
            if let Some(left) = node.left() {
                parents[pair(left)] = num::index(i);
            }
        }
        Self { draft, parents }
    }

    fn node(&self, at: u32) -> &Node {
        &self.draft.nodes[at as usize]
    }

    fn bounds(&self, at: u32) -> Aabb {
        self.node(at).bounds()
    }

    fn parent(&self, at: u32) -> u32 {
        self.parents[pair(at)]
    }

    /// Of all nodes but the leaves, whose areas do not change.
    fn sum_of_areas(&self) -> f64 {
        self.draft.nodes.iter().filter(|n| n.left().is_some()).map(|n| n.bounds().area()).sum()
    }

    /// The best move of every node, the greatest gain first.
    fn moves(&self, cx: &BuildCx) -> Result<Vec<Move>, BuildError> {
        let nodes: Vec<u32> = (1..num::index(self.draft.nodes.len())).collect();
        let chunk = |nodes: &[u32]| {
            let mut stack = Vec::new();
            let moves: Vec<Move> = nodes.iter().filter_map(|node| self.best(*node, &mut stack)).collect();
            cx.cancel.check().map(|()| moves)
        };
        let found: Result<Vec<Vec<Move>>, _> = cx.pool.run(|| nodes.par_chunks(CHUNK).map(chunk).collect());
        let mut moves = found?.concat();
        moves.sort_unstable_by(|a, b| b.gain.total_cmp(&a.gain).then(a.node.cmp(&b.node)));
        Ok(moves)
    }

    /// Where a node would cost least: below the sibling of each of its ancestors in turn, from the
    /// nearest up, leaving out what cannot gain more than the best so far.
    fn best(&self, node: u32, stack: &mut Vec<(f64, u32)>) -> Option<Move> {
        let own = self.bounds(node);
        let own_area = own.area();
        let parent = self.parent(node);
        if parent == 0 {
            return None; // its parent is the root, whose area nothing changes
        }
        let mut best = Move { node, to: 0, gain: 0.0 };
        // Without the node its parent is gone, and what its ancestors bound shrinks.
        let mut gain = self.bounds(parent).area();
        let mut side = sibling(node);
        let mut pivot = parent;
        let mut rest = self.bounds(side);
        let mut steps = STEPS;
        loop {
            stack.push((gain, side));
            while let Some((gain, at)) = stack.pop() {
                // At best the place holds the node already, and costs one box of its size.
                if gain - own_area <= best.gain || steps == 0 {
                    continue;
                }
                steps -= 1;
                let bounds = self.bounds(at);
                let merged = bounds.union(own).area();
                if gain - merged > best.gain && at != sibling(node) {
                    best = Move { node, to: at, gain: gain - merged };
                }
                if let Some(left) = self.node(at).left() {
                    // Going deeper, this box grows to hold the node.
                    let below = gain - (merged - bounds.area());
                    stack.extend([(below, left), (below, left + 1)]);
                }
            }
            if pivot == 0 {
                break;
            }
            // Up: the ancestor shrinks to what is left in it.
            if pivot != parent {
                rest = rest.union(self.bounds(side));
                gain += self.bounds(pivot).area() - rest.area();
            }
            (side, pivot) = (sibling(pivot), self.parent(pivot));
        }
        (best.to != 0).then_some(best)
    }

    /// Makes the moves that touch no node of a better one, and still gain after those before them; tells the first of them.
    fn make(&mut self, moves: &[Move], most: usize) -> Round {
        let mut round = Round::default();
        let mut touched = vec![false; self.draft.nodes.len()];
        for m in moves {
            let parent = self.parent(m.node);
            if parent == 0 || m.to == parent {
                continue;
            }
            let concerned = [m.node, sibling(m.node), parent, m.to, self.parent(m.to), sibling(parent), self.parent(parent)];
            if concerned.iter().any(|n| touched[*n as usize]) {
                continue;
            }
            let Some(gain) = self.gain(m.node, m.to).filter(|gain| *gain > 0.0) else { continue };
            concerned.into_iter().for_each(|n| touched[n as usize] = true);
            (round.made, round.gain) = (round.made + 1, round.gain + gain);
            if round.moves.len() < most {
                let [node, from, to] = [m.node, parent, m.to].map(|n| self.bounds(n));
                let references = self.draft.references(m.node);
                round.moves.push(Moved { node, references, from, to: to.union(node), gain });
            }
            self.reinsert(m.node, m.to);
        }
        round
    }

    /// What a move saves in the tree as it is; `None` if the place is above the node or below it.
    fn gain(&self, node: u32, to: u32) -> Option<f64> {
        let own = self.bounds(node);
        let (mut a, mut b) = (node, to);
        let (mut a_depth, mut b_depth) = (self.depth(a), self.depth(b));
        // What the node leaves: its parent goes, the ancestors below the common one shrink.
        let parent = self.parent(node);
        let (mut gain, mut rest) = (self.bounds(parent).area(), Aabb::EMPTY);
        // What it comes to: a box around it and the place, and the ancestors grow.
        let mut cost = self.bounds(to).union(own).area();
        while a != b {
            if a_depth >= b_depth {
                if a != node && a != parent {
                    gain += self.bounds(a).area() - rest.area();
                }
                // The common ancestor's other child is where the place is, and does not count.
                rest = rest.union(self.bounds(sibling(a)));
                a = self.parent(a);
                a_depth -= 1;
            } else {
                if b != to {
                    cost += self.bounds(b).union(own).area() - self.bounds(b).area();
                }
                b = self.parent(b);
                b_depth -= 1;
            }
        }
        (a != node && a != to).then_some(gain - cost)
    }

    fn depth(&self, mut at: u32) -> u32 {
        let mut depth = 0;
        while at != 0 {
            at = self.parent(at);
            depth += 1;
        }
        depth
    }

    fn reinsert(&mut self, node: u32, to: u32) {
        let (parent, side) = (self.parent(node), sibling(node));
        let left = num::index(2 * pair(node) + 1);
        let (moved, kept, place) = (*self.node(node), *self.node(side), *self.node(to));
        self.put(parent, kept);
        // If the place was the sibling's child or the like, it is still where it was: pairs do not move.
        self.put(left, place);
        self.put(left + 1, moved);
        self.put(to, Node::inner(&place.bounds().union(moved.bounds()), left));
        self.refit(self.parent_or_root(parent));
        self.refit(self.parent_or_root(to));
    }

    fn parent_or_root(&self, at: u32) -> u32 {
        if at == 0 { 0 } else { self.parent(at) }
    }

    /// Writes a node, and tells its children where their parent is.
    fn put(&mut self, at: u32, node: Node) {
        self.draft.nodes[at as usize] = node;
        if let Some(left) = node.left() {
            self.parents[pair(left)] = at;
        }
    }

    /// Tightens the boxes from here to the root.
    fn refit(&mut self, mut at: u32) {
        loop {
            if let Some(left) = self.node(at).left() {
                let bounds = self.bounds(left).union(self.bounds(left + 1));
                self.draft.nodes[at as usize] = self.node(at).bounded(&bounds);
            }
            if at == 0 {
                return;
            }
            at = self.parent(at);
        }
    }

    /// Children after their parents again.
    fn order(self) -> Result<(), BuildError> {
        let from = &self.draft.nodes;
        let mut nodes = Vec::with_capacity(from.len());
        nodes.push(from[0]);
        let mut at = 0;
        while at < nodes.len() {
            if let Some(left) = nodes[at].left() {
                let pair = num::index(nodes.len());
                nodes.extend_from_slice(&from[left as usize..left as usize + 2]);
                nodes[at] = Node::inner(&nodes[at].bounds(), pair);
            }
            at += 1;
        }
        self.draft.nodes = nodes;
        Ok(())
    }
}
