//! Which nodes of a binary tree become nodes of eight, and which leaves: what costs least of all
//! choices, by dynamic programming from the leaves up (Ylitie, Karras and Laine 2017, section 3.1).
//!
//! `cost[i - 1]` of a node is what at most `i` trees cost at least that hold all below it:
//!
//! ```text
//! cost(n, 1) = min( A(n) C_block blocks(n),  A(n) C_node + least of cost(left, k) + cost(right, 8 - k) )
//! cost(n, i) = min( cost(n, i - 1),                        least of cost(left, k) + cost(right, i - k) )
//! ```

use crate::accel::bvh::{Draft, Node};
use crate::accel::{BuildCx, BuildError};
use crate::simd::LANES;

/// What things cost, by the surface area heuristic.
#[derive(Clone, Copy, Debug)]
pub struct Costs {
    /// Of a node: eight boxes at once.
    pub node: f32,
    /// Of a block of up to eight triangles.
    pub block: f32,
    /// The most triangles of a leaf, at most 254.
    pub max_leaf: u8,
    /// The triangles that a block usually holds.
    pub per_block: u8,
}

/// The best choices for one node of the binary tree.
#[derive(Clone, Copy, Debug, Default)]
struct Choice {
    /// The trees that go to the left child, of `i + 2`; 0 if one tree less costs no more.
    left: [u8; LANES - 2],
    /// The same of the eight that become the slots of a node here; 0 for a leaf.
    of_node: u8,
    /// Triangles below, saturating.
    triangles: u8,
}

/// A choice and what it costs: `cost[i - 1]` for at most `i` trees.
#[derive(Clone, Copy)]
struct Priced {
    choice: Choice,
    cost: [f32; LANES - 1],
}

/// The choices for all nodes of a binary tree.
#[derive(Debug)]
pub struct Collapse<'a> {
    draft: &'a Draft,
    choices: Vec<Choice>,
}

/// Nodes below which a subtree is worked out by one thread.
const FORK: usize = 1 << 12;

impl<'a> Collapse<'a> {
    /// Bytes for a tree of so many nodes.
    pub const fn bytes(nodes: usize) -> usize {
        nodes * size_of::<Choice>()
    }

    /// Of a tree that is not empty.
    pub fn of(draft: &'a Draft, costs: &Costs, cx: &BuildCx) -> Result<Self, BuildError> {
        let mut choices = vec![Choice::default(); draft.nodes.len()];
        let (root, below) = choices.split_at_mut(1);
        root[0] = cx.pool.run(|| priced(draft, 0, below, costs, cx)).choice;
        cx.cancel.check()?;
        Ok(Self { draft, choices })
    }

    /// Whether all below a node go into one leaf.
    pub fn is_leaf(&self, at: u32) -> bool {
        self.choices[at as usize].of_node == 0
    }

    /// Appends the nodes that become the slots of a node.
    pub fn slots(&self, at: u32, into: &mut Vec<u32>) {
        if let Some(left) = self.draft.nodes[at as usize].left() {
            let k = self.choices[at as usize].of_node;
            self.trees(left, k, into);
            self.trees(left + 1, LANES as u8 - k, into);
        }
    }

    /// Appends the roots of the `i` trees or fewer that hold all below a node.
    fn trees(&self, at: u32, i: u8, into: &mut Vec<u32>) {
        let choice = &self.choices[at as usize];
        let divided = (2..=i).rev().map(|i| (i, choice.left[usize::from(i) - 2])).find(|(_, k)| *k > 0);
        match (divided, self.draft.nodes[at as usize].left()) {
            (Some((i, k)), Some(left)) => {
                self.trees(left, k, into);
                self.trees(left + 1, i - k, into);
            }
            _ => into.push(at),
        }
    }
}

/// The choice for a node, and those for the nodes below it, which lie together in a draft: first its
/// two children, then what is below the left one, then what is below the right one.
fn priced(draft: &Draft, at: usize, below: &mut [Choice], costs: &Costs, cx: &BuildCx) -> Priced {
    let node = &draft.nodes[at];
    let Some(left) = node.left() else { return leaf(node, costs) };
    let (left, right) = (left as usize, left as usize + 1);
    let parallel = below.len() >= FORK;
    if parallel && cx.cancel.is_cancelled() {
        return leaf(node, costs);
    }
    let (pair, rest) = below.split_at_mut(2);
    let of_left = draft.nodes[right].left().map_or(rest.len(), |first| first as usize - (right + 1));
    let (below_left, below_right) = rest.split_at_mut(of_left);
    let mut price_left = || priced(draft, left, below_left, costs, cx);
    let mut price_right = || priced(draft, right, below_right, costs, cx);
    let (a, b) = if parallel { rayon::join(price_left, price_right) } else { (price_left(), price_right()) };
    (pair[0], pair[1]) = (a.choice, b.choice);
    inner(node, &a, &b, costs)
}

fn leaf_cost(area: f32, triangles: u8, costs: &Costs) -> f32 {
    area * costs.block * f32::from(triangles.div_ceil(costs.per_block))
}

fn leaf(node: &Node, costs: &Costs) -> Priced {
    let triangles = u8::try_from(node.count()).unwrap_or(u8::MAX);
    let cost = leaf_cost(node.bounds().area() as f32, triangles, costs);
    Priced { choice: Choice { triangles, ..Choice::default() }, cost: [cost; LANES - 1] }
}

fn inner(node: &Node, left: &Priced, right: &Priced, costs: &Costs) -> Priced {
    let area = node.bounds().area() as f32;
    let triangles = left.choice.triangles.saturating_add(right.choice.triangles);
    let mut choice = Choice { triangles, ..Choice::default() };
    let mut cost = [0.0; LANES - 1];
    // `i` trees, of which k go to the left.
    let divided = |i: usize| {
        (1..i).fold((f32::INFINITY, 1), |best: (f32, u8), k| {
            let cost = left.cost[k - 1] + right.cost[i - k - 1];
            if cost < best.0 { (cost, k as u8) } else { best }
        })
    };
    let (below, k) = divided(LANES);
    let (inner, whole) = (area * costs.node + below, leaf_cost(area, triangles, costs));
    let is_leaf = triangles <= costs.max_leaf && whole <= inner;
    (cost[0], choice.of_node) = if is_leaf { (whole, 0) } else { (inner, k) };
    for i in 2..LANES {
        let (divided, k) = divided(i);
        let fewer = cost[i - 2];
        (cost[i - 1], choice.left[i - 2]) = if divided < fewer { (divided, k) } else { (fewer, 0) };
    }
    Priced { choice, cost }
}
