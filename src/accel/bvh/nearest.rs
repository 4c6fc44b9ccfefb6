//! For each cluster along the Morton curve its nearest neighbour within a radius, by the area of the
//! box around both (Benthin et al. 2022, "PLOC++", §3.2): each pair is looked at once, for both of
//! its clusters, and which neighbour it is is kept in the low bits of the area, so that the nearest
//! one is a minimum of numbers.
//!
//! All pairs of one distance along the curve are worked out before those of the next, over plain
//! lists of coordinates: so the loops run over several pairs at once.

use rayon::prelude::*;

use super::tree::Node;
use crate::accel::{BuildCx, BuildError};
use crate::geometry::num;

/// The farthest that a cluster can look.
pub const MAX_RADIUS: usize = 128;

/// Clusters of a piece: its lists stay in the nearest cache.
const PIECE: usize = 512;

/// Each cluster's nearest within the radius, for two clusters or more; called on the pool.
///
/// Of equally near ones the partner in even pairs, then the one that lies nearer along the curve, then
/// the lower: so equal clusters pair up, and some pair always agrees. Areas are told apart to about
/// four digits.
pub fn neighbours(clusters: &[Node], radius: usize, cx: &BuildCx) -> Result<Vec<u32>, BuildError> {
    let mut found = vec![0; clusters.len()];
    found.par_chunks_mut(PIECE).enumerate().try_for_each_init(Piece::new, |piece, (c, found)| {
        piece.fill(clusters, c * PIECE, found.len(), radius);
        piece.nearest(found);
        cx.cancel.check()
    })?;
    Ok(found)
}

const LONGEST: usize = PIECE + 2 * MAX_RADIUS;

/// A run of clusters with those beside it that they can see.
struct Piece {
    min: [[f32; LONGEST]; 3],
    max: [[f32; LONGEST]; 3],
    /// The least key of each cluster so far, as a float: an area with a code in its lowest bits.
    keys: [f32; LONGEST],
    /// The lowest bits.
    mask: u32,
    /// The cluster that comes first, and how many of the list are before the piece itself.
    first: usize,
    before: usize,
}

impl Piece {
    fn new() -> Box<Self> {
        let none = [[0.0; LONGEST]; 3];
        Box::new(Self { min: none, max: none, keys: [0.0; LONGEST], mask: 0, first: 0, before: 0 })
    }

    /// Takes `len` clusters from `at` on, and works out their keys.
    fn fill(&mut self, clusters: &[Node], at: usize, len: usize, radius: usize) {
        let radius = radius.min(MAX_RADIUS);
        self.first = at.saturating_sub(radius);
        self.before = at - self.first;
        let last = (at + len + radius).min(clusters.len());
        let count = last - self.first;
        for (i, node) in clusters[self.first..last].iter().enumerate() {
            let b = node.bounds();
            for k in 0..3 {
                (self.min[k][i], self.max[k][i]) = (b.min[k], b.max[k]);
            }
        }
        self.mask = num::index((2 * radius + 2).next_power_of_two()) - 1;
        self.keys[..count].fill(f32::INFINITY);
        for distance in 1..=radius.min(count - 1) {
            self.pairs(count, distance);
        }
    }

    /// All pairs that lie so far apart.
    fn pairs(&mut self, count: usize, distance: usize) {
        let Self { min: [min_x, min_y, min_z], max: [max_x, max_y, max_z], keys, mask, first, .. } = self;
        let pairs = count - distance;
        // Both of a pair see the same area; the code says the distance, and on which side.
        let (above, below) = (code(distance, false), code(distance, true));
        let even = u32::from(*first % 2 == 0);
        let size = |min: &[f32], max: &[f32], i: usize| {
            let (a, b) = (min[i], min[i + distance]);
            let low = if a < b { a } else { b };
            let (a, b) = (max[i], max[i + distance]);
            (if a > b { a } else { b }) - low
        };
        for i in 0..pairs {
            let x = size(&min_x[..count], &max_x[..count], i);
            let y = size(&min_y[..count], &max_y[..count], i);
            let z = size(&min_z[..count], &max_z[..count], i);
            let area = (x * (y + z) + y * z).to_bits() & !*mask;
            // The partner in even pairs has the code 0.
            let apart = u32::from(distance > 1) | ((num::index(i) & 1) ^ even ^ 1);
            let (up, down) = (f32::from_bits(area | (above * apart)), f32::from_bits(area | (below * apart)));
            keys[i] = if up < keys[i] { up } else { keys[i] };
            keys[i + distance] = if down < keys[i + distance] { down } else { keys[i + distance] };
        }
    }

    /// What the keys say.
    fn nearest(&self, found: &mut [u32]) {
        for (i, found) in found.iter_mut().enumerate() {
            let at = self.first + self.before + i;
            let code = (self.keys[self.before + i].to_bits() & self.mask) as usize;
            *found = num::index(match code {
                0 => at ^ 1,
                _ if code.is_multiple_of(2) => at - code / 2,
                _ => at + code / 2,
            });
        }
    }
}

/// Nearer ones are less, and of two as near the lower one.
const fn code(distance: usize, below: bool) -> u32 {
    (2 * distance + if below { 0 } else { 1 }) as u32
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Aabb;
    use glam::Vec3;

    fn half_area(b: &Aabb) -> f32 {
        let d = b.max - b.min;
        d.x * (d.y + d.z) + d.y * d.z
    }

    fn clusters(n: usize, grid: u32) -> Vec<Node> {
        let mut seed = 9u32;
        let mut next = || {
            seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            ((seed >> 8) % grid) as f32
        };
        let mut corner = || Vec3::new(next(), next(), next());
        let boxed = |a: Vec3, b: Vec3| Aabb { min: a.min(b), max: a.max(b) };
        (0..n).map(|i| Node::leaf(&boxed(corner(), corner()), num::index(i), 1)).collect()
    }

    /// By the words of the rule, one cluster at a time; areas rounded as the keys round them.
    fn plain(clusters: &[Node], i: usize, radius: usize) -> usize {
        let mask = num::index((2 * radius + 2).next_power_of_two()) - 1;
        let last = (i + radius).min(clusters.len() - 1);
        let others = (i.saturating_sub(radius)..=last).filter(|j| *j != i);
        let area = |j: usize| half_area(&clusters[i].bounds().union(clusters[j].bounds())).to_bits() & !mask;
        let rank = |j: usize| if j == i ^ 1 { 0 } else { i.abs_diff(j) };
        others.min_by_key(|j| (area(*j), rank(*j), *j)).expect("there are two at least")
    }

    #[test]
    fn the_nearest_is_found_with_ties_as_ruled() {
        let cx = BuildCx::unattended(2);
        for (n, grid) in [(2, 9), (3, 2), (41, 3), (PIECE + 1, 4), (3 * PIECE - 5, 1000)] {
            let clusters = clusters(n, grid);
            for radius in [1, 2, 14, MAX_RADIUS] {
                let found = cx.pool.run(|| neighbours(&clusters, radius, &cx)).expect("not cancelled");
                for (i, found) in found.iter().enumerate() {
                    assert_eq!(*found as usize, plain(&clusters, i, radius), "{i} of {n}, radius {radius}");
                }
                let agree = (0..n).any(|i| found[found[i] as usize] as usize == i);
                assert!(agree, "{n}, radius {radius}");
            }
        }
    }
}
