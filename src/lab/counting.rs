//! What a traversal does, counted in a pass of its own: rays that are timed are traced uncounted.

use rayon::prelude::*;

use super::measure::Contestant;
use super::rays::RaySet;
use super::sample::pick;
use super::statistics::Moments;
use crate::accel::probe::Counts;
use crate::task::{Cancel, Cancelled, Pool};

/// Rays counted at most: their mean is within about a percent of the set's.
pub const MOST: usize = 20_000;

/// Seconds that counting may take for one structure.
const SECS: f64 = 1.0;

/// How many rays to count where one takes so long, watched rays taking about twice.
pub fn how_many(secs_per_ray: f64) -> usize {
    super::estimate::rays_within(SECS, 2, secs_per_ray).min(MOST)
}

/// What rays did, summed up.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Counted {
    /// Nodes and cells entered by a ray.
    pub nodes: Moments,
    /// Leaves entered by a ray.
    pub leaves: Moments,
    /// Primitives tested by a ray.
    pub prims: Moments,
}

impl Counted {
    /// Adds a ray.
    pub fn add(&mut self, ray: Counts) {
        self.nodes.add(ray.nodes);
        self.leaves.add(ray.leaves);
        self.prims.add(ray.prims);
    }

    /// Adds other rays.
    pub fn join(&mut self, other: &Self) {
        self.nodes.join(&other.nodes);
        self.leaves.join(&other.leaves);
        self.prims.join(&other.prims);
    }
}

/// Counts over `n` evenly spread rays.
pub fn count(contestant: &Contestant, set: &RaySet, n: usize, pool: &Pool, cancel: &Cancel) -> Result<Counted, Cancelled> {
    let rays = pick(&set.rays, n);
    let watch = |mut sum: Counted, ray| {
        let mut counts = Counts::default();
        contestant.accel.trace_watched(ray, set.mode, &mut counts, cancel)?;
        sum.add(counts);
        Ok(sum)
    };
    let join = |mut a: Counted, b: Counted| {
        a.join(&b);
        Ok(a)
    };
    pool.run(|| rays.par_iter().try_fold(Counted::default, watch).try_reduce(Counted::default, join))
}
