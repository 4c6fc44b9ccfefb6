//! How long a ray takes, roughly, found in a moment: what decides whether a row must be capped.

use std::time::Instant;

use super::measure::{Contestant, Fairness, trace_all};
use super::rays::RaySet;
use super::sample::pick;
use crate::task::{Cancel, Cancelled, Pool};

/// Tracing for so long gives an estimate that is good enough.
const ENOUGH_SECS: f64 = 0.02;

/// So many tries at least, unless they take ten times too long: the machine may be disturbed in one.
const TRIES: usize = 3;

/// The fewest rays that are tried, and timed in a capped row.
pub const FEWEST: usize = 16;

/// Wall-clock seconds for one ray on this pool, from ever larger parts of the set, evenly spread:
/// the least of all tries.
pub fn secs_per_ray(
    contestant: &Contestant,
    set: &RaySet,
    terms: Fairness,
    pool: &Pool,
    cancel: &Cancel,
) -> Result<f64, Cancelled> {
    let (mut n, mut total, mut best) = (FEWEST, 0.0, f64::INFINITY);
    for tries in 1.. {
        let rays = pick(&set.rays, n);
        let start = Instant::now();
        trace_all(contestant, &rays, set.mode, terms, pool, cancel)?;
        let secs = start.elapsed().as_secs_f64();
        total += secs;
        best = best.min(secs / rays.len().max(1) as f64);
        let enough = total >= ENOUGH_SECS || n >= set.rays.len();
        if (enough && tries >= TRIES) || total >= 10.0 * ENOUGH_SECS {
            break;
        }
        n = if enough { n } else { n * 4 };
    }
    Ok(best)
}

/// How many rays a round may have if `rounds` of them, one to warm up included, shall end within
/// `cap_secs`.
pub fn rays_within(cap_secs: f64, rounds: usize, secs_per_ray: f64) -> usize {
    let rays = cap_secs / (rounds.max(1) as f64 * secs_per_ray.max(1e-12));
    crate::geometry::num::floor_index(rays, usize::MAX).max(FEWEST)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slow_rays_shrink_the_round_but_never_to_nothing() {
        assert_eq!(rays_within(20.0, 6, 1e-3), 3333);
        assert_eq!(rays_within(20.0, 6, 100.0), FEWEST);
        assert!(rays_within(20.0, 6, 0.0) > 1_000_000_000);
    }
}
