//! The figures of both levels together.

use super::Instanced;
use crate::accel::stats::{SahWeights, Stats};
use crate::accel::{Accel, Cells};
use crate::geometry::Aabb;
use crate::task::{Cancel, Cancelled};

impl Instanced {
    /// Nodes, leaves and references are counted as they are stored: below a mesh once, however often it stands
    /// somewhere. What is expected of a line goes by places: a line that meets the box around one does there what it would
    /// do in the mesh's own structure. (Exact where the transform keeps angles; a stretched mesh has other areas.) Overlap
    /// is that of the upper level.
    ///
    /// # Errors
    /// [`Cancelled`] if asked to stop.
    pub fn stats(&self, weights: SahWeights, cancel: &Cancel) -> Result<Stats, Cancelled> {
        let of = |accel: &dyn Accel| Stats::of(accel, weights, cancel);
        let parts = self.parts.iter().map(|part| of(&**part)).collect::<Result<Vec<_>, _>>()?;
        let rest = self.rest().map(of).transpose()?;
        let mut stats = Stats::default();
        parts.iter().chain(&rest).for_each(|below| stats.add_stored(below));
        stats.memory = self.memory();
        let (shared, inner) = self.top_sums(weights, &mut stats);
        stats.overlap = Some(if inner > 0.0 { shared / inner } else { 0.0 });
        let whole = self.geometry.space().bounds().area();
        let places = self.places().iter().map(|place| (place.bounds, &parts[place.part as usize]));
        for (bounds, below) in places.chain(rest.iter().map(|rest| (*self.geometry.bounds(), rest))) {
            let chance = over(bounds.area(), whole).min(1.0);
            stats.sah += chance * below.sah;
            stats.expected_nodes += chance * below.expected_nodes;
            stats.expected_tests += chance * below.expected_tests;
        }
        Ok(stats)
    }

    /// Adds the upper level's nodes; returns the summed areas of what two siblings share, and of inner nodes.
    fn top_sums(&self, weights: SahWeights, stats: &mut Stats) -> (f64, f64) {
        let (nodes, whole) = (&self.top.nodes, self.geometry.space().bounds().area());
        let (mut shared, mut inner, mut depths) = (0.0, 0.0, vec![0u32; nodes.len()]);
        for (at, node) in nodes.iter().enumerate() {
            let chance = over(node.bounds().area(), whole).min(1.0);
            stats.expected_nodes += chance;
            let Some(left) = node.left() else { continue };
            stats.sah += weights.c_trav * chance;
            inner += node.bounds().area();
            let [a, b]: [Aabb; 2] = [left, left + 1].map(|child| nodes[child as usize].bounds());
            let both = a.intersection(b);
            shared += if both.is_empty() { 0.0 } else { both.area() };
            // Children come after their parent.
            depths[left as usize] = depths[at] + 1;
            depths[left as usize + 1] = depths[at] + 1;
        }
        stats.nodes += nodes.len() as u64;
        stats.max_depth += depths.iter().max().map_or(0, |deepest| deepest + 1);
        (shared, inner)
    }
}

fn over(part: f64, whole: f64) -> f64 {
    if whole > 0.0 { part / whole } else { 0.0 }
}
