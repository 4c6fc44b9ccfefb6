//! Parallel locally-ordered clustering (Meister and Bittner 2018, "Parallel Locally-Ordered
//! Clustering for Bounding Volume Hierarchy Construction"; Benthin et al. 2022, PLOC++): clusters
//! lie along the Morton curve; each finds its nearest neighbour within a radius, by the area of the
//! box around both; two that are each other's nearest merge; and again, until one is left.
//!
//! A round is three passes over the clusters in chunks: neighbours; how many merge in each chunk,
//! hence where everything goes; and the merging itself.

use rayon::prelude::*;

use super::boxes::{PrimBox, in_chunks};
use super::draft::Draft;
use super::morton;
use super::nearest::neighbours;
use super::tree::Node;
use crate::accel::{BuildCx, BuildError};
use crate::geometry::num;

/// Clusters handled between two looks at the cancel flag.
const CHUNK: usize = 1 << 12;
/// If fewer than one cluster in so many merges in a round (boxes that grow along the curve all choose
/// the one before), neighbours that were left over are merged as they lie, or it would never end.
const LEAST_SHARE: usize = 16;

/// Builds over some triangles, at least one, with a leaf for each; called on the pool.
pub fn build(boxes: &[PrimBox], radius: usize, cx: &BuildCx) -> Result<Draft, BuildError> {
    let order = morton::sorted(boxes, cx)?;
    let prim = |i: usize| &boxes[order[i].1 as usize];
    let mut clusters = in_chunks(order.len(), cx, |i| Node::leaf(&prim(i).bounds().aabb(), num::index(i), 1))?;
    let refs = in_chunks(order.len(), cx, |i| prim(i).prim())?;
    // Before the nodes are there, too.
    drop(order);
    let mut nodes = in_chunks(2 * refs.len() - 1, cx, |_| clusters[0])?;
    // Pairs are written from the end towards the root, so that children come after their parent.
    let mut free = nodes.len();
    while clusters.len() > 1 {
        let mates = Mates::new(neighbours(&clusters, radius, cx)?);
        cx.progress.advance(mates.pairs as u64);
        let from = free - 2 * mates.pairs;
        clusters = mates.merge(&clusters, &mut nodes[from..free], from, cx)?;
        free = from;
    }
    nodes[0] = clusters[0];
    Ok(Draft { nodes, refs })
}

/// Which clusters of a round merge: two that are each other's nearest.
struct Mates {
    nearest: Vec<u32>,
    /// Pairs in all.
    pairs: usize,
    /// Pairs whose first cluster is in a chunk.
    in_chunk: Vec<usize>,
}

impl Mates {
    fn new(nearest: Vec<u32>) -> Self {
        let mut mates = Self { nearest, pairs: 0, in_chunk: Vec::new() };
        mates.count();
        if mates.pairs * LEAST_SHARE < mates.nearest.len() {
            mates.force();
            mates.count();
        }
        mates
    }

    fn count(&mut self) {
        let leads = |c: usize| self.range(c).filter(|i| self.of(*i) > *i).count();
        self.in_chunk = (0..self.nearest.len().div_ceil(CHUNK)).into_par_iter().map(leads).collect();
        self.pairs = self.in_chunk.iter().sum();
    }

    /// The clusters of a chunk.
    fn range(&self, chunk: usize) -> std::ops::Range<usize> {
        chunk * CHUNK..self.nearest.len().min((chunk + 1) * CHUNK)
    }

    /// What a cluster merges with; itself if with none.
    #[inline(always)]
    fn of(&self, i: usize) -> usize {
        let mate = self.nearest[i] as usize;
        if self.nearest[mate] as usize == i { mate } else { i }
    }

    /// Merges what is left over with its neighbour.
    fn force(&mut self) {
        for i in (0..self.nearest.len() - 1).step_by(2) {
            if self.of(i) == i && self.of(i + 1) == i + 1 {
                (self.nearest[i], self.nearest[i + 1]) = (num::index(i + 1), num::index(i));
            }
        }
    }

    /// The clusters of the next round, each at the place of the first it was made of; merged ones go
    /// to `pairs`, which begin at `at` in the list of all nodes.
    fn merge(&self, clusters: &[Node], pairs: &mut [Node], at: usize, cx: &BuildCx) -> Result<Vec<Node>, BuildError> {
        let seconds = |c: usize| self.range(c).filter(|i| self.of(*i) < *i).count();
        let gone: Vec<usize> = (0..self.in_chunk.len()).into_par_iter().map(seconds).collect();
        let mut next = vec![clusters[0]; self.nearest.len() - self.pairs];
        // Every chunk writes into its own part of both lists.
        let mut jobs = Vec::with_capacity(gone.len());
        let (mut pairs_left, mut next_left, mut first) = (pairs, &mut next[..], at);
        for (c, (leads, gone)) in self.in_chunk.iter().zip(gone).enumerate() {
            let (pairs, next);
            (pairs, pairs_left) = pairs_left.split_at_mut(2 * leads);
            (next, next_left) = next_left.split_at_mut(self.range(c).len() - gone);
            jobs.push((self.range(c), pairs, next, first));
            first += 2 * leads;
        }
        jobs.into_par_iter().try_for_each(|(range, pairs, next, first)| {
            self.merge_chunk(clusters, range, pairs, next, first);
            cx.cancel.check()
        })?;
        Ok(next)
    }

    fn merge_chunk(&self, clusters: &[Node], range: std::ops::Range<usize>, pairs: &mut [Node], next: &mut [Node], first: usize) {
        let (mut pair, mut to) = (0, 0);
        for i in range {
            let mate = self.of(i);
            if mate < i {
                continue;
            }
            next[to] = clusters[i];
            if mate > i {
                (pairs[pair], pairs[pair + 1]) = (clusters[i], clusters[mate]);
                let bounds = clusters[i].bounds().union(clusters[mate].bounds());
                next[to] = Node::inner(&bounds, num::index(first + pair));
                pair += 2;
            }
            to += 1;
        }
    }
}
