//! Parallel locally-ordered clustering (Meister and Bittner 2018, "Parallel Locally-Ordered
//! Clustering for Bounding Volume Hierarchy Construction"; Benthin et al. 2022, PLOC++): clusters
//! lie along the Morton curve; each finds its nearest neighbour within a radius, by the area of the
//! box around both; two that are each other's nearest merge; and again, until one is left.
//!
//! A round is three passes over the clusters in chunks: neighbours; how many merge in each chunk,
//! hence where everything goes; and the merging itself.

use rayon::prelude::*;

use super::boxes::PrimBox;
use super::draft::Draft;
use super::morton;
use super::tree::Node;
use crate::accel::{BuildCx, BuildError};
use crate::geometry::{Aabb, num};

/// Clusters handled between two looks at the cancel flag.
const CHUNK: usize = 1 << 12;
/// If fewer than one cluster in so many merges in a round (boxes that grow along the curve all choose
/// the one before), neighbours that were left over are merged as they lie, or it would never end.
const LEAST_SHARE: usize = 16;

/// Builds over some triangles, at least one, with a leaf for each; called on the pool.
pub fn build(boxes: &[PrimBox], radius: usize, cx: &BuildCx) -> Result<Draft, BuildError> {
    let order = morton::sorted(boxes, cx)?;
    let prim = |at: usize| &boxes[order[at].1 as usize];
    let mut clusters: Vec<Node> = (0..order.len()).map(|i| Node::leaf(&prim(i).bounds().aabb(), num::index(i), 1)).collect();
    let refs = (0..order.len()).map(|i| prim(i).prim()).collect();
    let mut nodes = vec![clusters[0]; 2 * order.len() - 1];
    // Pairs are written from the end towards the root, so that children come after their parent.
    let mut free = nodes.len();
    while clusters.len() > 1 {
        let neighbours = neighbours(&clusters, radius, cx)?;
        let plan = Plan::new(neighbours);
        let pairs = plan.merging;
        cx.progress.advance(pairs as u64);
        let from = free - 2 * pairs;
        clusters = plan.merge(&clusters, &mut nodes[from..free], from, cx)?;
        free = from;
    }
    nodes[0] = clusters[0];
    Ok(Draft { nodes, refs })
}

/// Each cluster's nearest within the radius. Of equally near ones the partner in even pairs, then the
/// one that lies nearer, then the lower: so equal clusters pair up, and some pair always agrees.
fn neighbours(clusters: &[Node], radius: usize, cx: &BuildCx) -> Result<Vec<u32>, BuildError> {
    let nearest = |i: usize| {
        let own = clusters[i].bounds();
        let (first, last) = (i.saturating_sub(radius), (i + radius).min(clusters.len() - 1));
        let mut best = (f32::INFINITY, usize::MAX, i);
        for j in (first..=last).filter(|j| *j != i) {
            let area = half_area(&own.union(clusters[j].bounds()));
            if area > best.0 {
                continue;
            }
            let rank = if j == i ^ 1 { 0 } else { i.abs_diff(j) };
            if area < best.0 || rank < best.1 {
                best = (area, rank, j);
            }
        }
        num::index(best.2)
    };
    let mut found = vec![0; clusters.len()];
    found.par_chunks_mut(CHUNK).enumerate().try_for_each(|(c, found)| {
        found.iter_mut().enumerate().for_each(|(k, found)| *found = nearest(c * CHUNK + k));
        cx.cancel.check()
    })?;
    Ok(found)
}

/// Half the surface area; single precision decides near ties one way or the other, no more.
#[inline(always)]
fn half_area(b: &Aabb) -> f32 {
    let d = b.max - b.min;
    d.x * (d.y + d.z) + d.y * d.z
}

/// Which clusters of a round merge.
struct Plan {
    /// What each cluster merges with; itself if it does not.
    partner: Vec<u32>,
    merging: usize,
}

impl Plan {
    fn new(mut partner: Vec<u32>) -> Self {
        let mutual = |partner: &[u32], i: usize| partner[partner[i] as usize] as usize == i;
        let agreed: Vec<bool> = (0..partner.len()).map(|i| mutual(&partner, i)).collect();
        for (i, agreed) in agreed.iter().enumerate().filter(|(_, agreed)| !**agreed) {
            debug_assert!(!agreed);
            partner[i] = num::index(i);
        }
        let merging = agreed.iter().filter(|a| **a).count() / 2;
        let mut plan = Self { partner, merging };
        if plan.merging * LEAST_SHARE < plan.partner.len() {
            plan.force();
        }
        plan
    }

    /// Merges what is left over with its neighbour.
    fn force(&mut self) {
        for pair in (0..self.partner.len() - 1).step_by(2) {
            if self.alone(pair) && self.alone(pair + 1) {
                (self.partner[pair], self.partner[pair + 1]) = (num::index(pair + 1), num::index(pair));
                self.merging += 1;
            }
        }
    }

    fn alone(&self, i: usize) -> bool {
        self.partner[i] as usize == i
    }

    /// The clusters of the next round, each at the place of the first it was made of; merged ones go
    /// to `pairs`, which begin at `at` in the list of all nodes.
    fn merge(&self, clusters: &[Node], pairs: &mut [Node], at: usize, cx: &BuildCx) -> Result<Vec<Node>, BuildError> {
        let chunks = self.partner.len().div_ceil(CHUNK);
        let range = |c: usize| c * CHUNK..self.partner.len().min((c + 1) * CHUNK);
        let leads = |c: usize| range(c).filter(|i| self.partner[*i] as usize > *i).count();
        let kept = |c: usize| range(c).filter(|i| self.partner[*i] as usize >= *i).count();
        let counts: Vec<(usize, usize)> = (0..chunks).into_par_iter().map(|c| (leads(c), kept(c))).collect();
        let mut next = vec![clusters[0]; self.partner.len() - self.merging];
        // Every chunk writes into its own part of both lists.
        let mut jobs = Vec::with_capacity(chunks);
        let (mut pairs_left, mut next_left, mut first) = (pairs, &mut next[..], at);
        for (c, (leads, kept)) in counts.into_iter().enumerate() {
            let (pairs, next);
            (pairs, pairs_left) = pairs_left.split_at_mut(2 * leads);
            (next, next_left) = next_left.split_at_mut(kept);
            jobs.push((range(c), pairs, next, first));
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
            let j = self.partner[i] as usize;
            if j < i {
                continue;
            }
            next[to] = clusters[i];
            if j > i {
                (pairs[pair], pairs[pair + 1]) = (clusters[i], clusters[j]);
                let bounds = clusters[i].bounds().union(clusters[j].bounds());
                next[to] = Node::inner(&bounds, num::index(first + pair));
                pair += 2;
            }
            to += 1;
        }
    }
}
