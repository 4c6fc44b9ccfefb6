//! What a traversal does, counted in a pass of its own: rays that are timed are traced uncounted.

use rayon::prelude::*;

use super::measure::Contestant;
use super::rays::RaySet;
use super::sample::pick;
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

/// Counts over `n` evenly spread rays; returns the sums and how many rays there were.
pub fn count(
    contestant: &Contestant,
    set: &RaySet,
    n: usize,
    pool: &Pool,
    cancel: &Cancel,
) -> Result<(Counts, usize), Cancelled> {
    let rays = pick(&set.rays, n);
    let watch = |ray| {
        cancel.check()?;
        let mut counts = Counts::default();
        contestant.accel.trace_watched(ray, set.mode, &mut counts);
        Ok(counts)
    };
    let sum = |mut a: Counts, b| {
        a += b;
        Ok(a)
    };
    let counts = pool.run(|| rays.par_iter().map(watch).try_reduce(Counts::default, sum))?;
    Ok((counts, rays.len()))
}
