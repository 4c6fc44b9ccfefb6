//! What a step and a test cost on this machine, fitted to rays that were both timed and counted:
//!
//! ```text
//! seconds of a ray = C_trav nodes + C_isect tests + C_0
//! ```
//!
//! by least squares without negative costs, over blocks of neighbouring rays of several kinds: their
//! mixture of steps and tests differs, which is what tells the two costs apart. C_trav is charged for
//! every node entered, leaves among them, since that is what is counted.

use std::time::Instant;

use super::estimate::secs_per_ray;
use super::least_squares::non_negative;
use super::measure::{Contestant, Fairness};
use super::rays::{RayKind, RaySet};
use super::sample::spread;
use crate::accel::Mode;
use crate::accel::probe::Counts;
use crate::geometry::{Ray, num};
use crate::task::{Cancel, Cancelled, Pool, Progress};

/// The costs of one structure on this machine.
#[derive(Clone, Debug, Default, PartialEq, serde::Serialize)]
pub struct Costs {
    /// Nanoseconds for entering a node or cell.
    pub c_trav_ns: f64,
    /// Its standard error; NaN (`null` in JSON) where the cost was held at 0.
    pub c_trav_error_ns: f64,
    /// Nanoseconds for testing a triangle.
    pub c_isect_ns: f64,
    /// Its standard error.
    pub c_isect_error_ns: f64,
    /// Nanoseconds for a ray, whatever it does.
    pub c0_ns: f64,
    /// Its standard error.
    pub c0_error_ns: f64,
    /// The share of the variance between blocks that the three costs explain; NaN if there is none.
    pub r_squared: f64,
    /// Blocks of rays that were timed.
    pub blocks: usize,
    /// Rays in each.
    pub rays_per_block: usize,
}

impl Costs {
    /// C_isect where C_trav is 1; `None` if one of them is 0 or not known.
    pub fn ratio(&self) -> Option<f64> {
        let ratio = self.c_isect_ns / self.c_trav_ns;
        (ratio.is_finite() && ratio > 0.0).then_some(ratio)
    }
}

/// How long to time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FitOptions {
    /// Timed passes over all blocks; the fastest of each block counts, since a machine is only ever
    /// disturbed in one direction.
    pub rounds: usize,
    /// The most seconds for one structure.
    pub cap_secs: f64,
}

impl Default for FitOptions {
    fn default() -> Self {
        Self { rounds: 7, cap_secs: 10.0 }
    }
}

/// Blocks of each set of rays.
const BLOCKS: usize = 64;
/// Rays in a block: enough for the clock, few enough that blocks differ.
const RAYS: usize = 256;

/// Fits the costs of each structure; `None` for one that is too slow for that, or where the rays do
/// not determine them. One thread traces, and structures take turns.
///
/// # Errors
/// [`Cancelled`] if asked to stop.
pub fn fit_costs(
    contestants: &[Contestant],
    sets: &[&RaySet],
    options: &FitOptions,
    pool: &Pool,
    cancel: &Cancel,
    progress: &Progress,
) -> Result<Vec<Option<Costs>>, Cancelled> {
    let mut lanes = Vec::new();
    for contestant in contestants {
        lanes.push(Lane::new(contestant, sets, options, pool, cancel)?);
    }
    let rounds = options.rounds.max(1) + 1;
    progress.start("fit costs", (rounds * lanes.len()) as u64);
    for round in 0..rounds {
        for lane in &mut lanes {
            pool.run(|| lane.round(round > 0, cancel))?;
            progress.advance(1);
        }
    }
    let fitted = lanes.iter().map(|lane| lane.fit(cancel)).collect();
    progress.finish();
    fitted
}

/// Neighbouring rays of one kind.
struct Block {
    mode: Mode,
    rays: Vec<Ray>,
    /// The least seconds of all passes.
    secs: f64,
}

/// A structure and its blocks of rays.
struct Lane<'a> {
    contestant: &'a Contestant,
    rays_per_block: usize,
    blocks: Vec<Block>,
}

impl<'a> Lane<'a> {
    fn new(
        contestant: &'a Contestant,
        sets: &[&RaySet],
        options: &FitOptions,
        pool: &Pool,
        cancel: &Cancel,
    ) -> Result<Self, Cancelled> {
        let mut slowest = 0.0f64;
        for set in sets {
            let secs = secs_per_ray(contestant, set, Fairness::LikeForLike, pool, cancel)?;
            slowest = slowest.max(if secs.is_finite() { secs * pool.threads() as f64 } else { 0.0 });
        }
        // Beside the timed passes one to warm up, and two that count.
        let passes = ((options.rounds + 3) * sets.len().max(1) * BLOCKS) as f64;
        let rays_per_block = num::floor_index(options.cap_secs / (passes * slowest.max(1e-12)), RAYS);
        let mut blocks = Vec::new();
        for set in sets {
            let rays = match set.kind {
                RayKind::Lines | RayKind::Shuffled => by_mixture(contestant, set, rays_per_block, cancel)?,
                _ => neighbours(set, rays_per_block),
            };
            let of = |rays: &[Ray]| Block { mode: set.mode, rays: rays.to_vec(), secs: f64::INFINITY };
            blocks.extend(rays.chunks_exact(rays_per_block.max(1)).map(of));
        }
        Ok(Self { contestant, rays_per_block, blocks })
    }

    /// Traces every block once.
    fn round(&mut self, timed: bool, cancel: &Cancel) -> Result<(), Cancelled> {
        let mut hits = vec![None; self.rays_per_block];
        for Block { mode, rays, secs } in &mut self.blocks {
            let start = Instant::now();
            self.contestant.accel.trace_like_for_like(rays, *mode, &mut hits, cancel)?;
            if timed {
                *secs = secs.min(start.elapsed().as_secs_f64());
            }
        }
        Ok(())
    }

    fn fit(&self, cancel: &Cancel) -> Result<Option<Costs>, Cancelled> {
        let (mut rows, mut nanos) = (Vec::new(), Vec::new());
        for Block { mode, rays, secs } in &self.blocks {
            let mut counts = Counts::default();
            for ray in rays {
                self.contestant.accel.trace_watched(ray, *mode, &mut counts, cancel)?;
            }
            let n = rays.len() as f64;
            rows.push([counts.nodes as f64 / n, counts.prims as f64 / n, 1.0]);
            nanos.push(secs / n * 1e9);
        }
        let Some(fit) = non_negative(&rows, &nanos) else { return Ok(None) };
        let ([c_trav_ns, c_isect_ns, c0_ns], [c_trav_error_ns, c_isect_error_ns, c0_error_ns]) = (fit.coefficients, fit.errors);
        Ok(Some(Costs {
            c_trav_ns,
            c_trav_error_ns,
            c_isect_ns,
            c_isect_error_ns,
            c0_ns,
            c0_error_ns,
            r_squared: fit.explained,
            blocks: rows.len(),
            rays_per_block: self.rays_per_block,
        }))
    }
}

/// Runs of neighbouring rays, evenly spread over the set, one after the other; none if the set is
/// shorter than one.
fn neighbours(set: &RaySet, rays: usize) -> Vec<Ray> {
    let places = set.rays.len().checked_div(rays).unwrap_or(0);
    spread(places, BLOCKS).into_iter().flat_map(|place| &set.rays[place * rays..(place + 1) * rays]).copied().collect()
}

/// Rays that are no neighbours anyway, sorted by how many tests there are to a step: so blocks differ
/// in what they mix, and the costs are told apart. Which rays share a block goes by counts alone, never
/// by times, so it favours no cost.
fn by_mixture(contestant: &Contestant, set: &RaySet, rays: usize, cancel: &Cancel) -> Result<Vec<Ray>, Cancelled> {
    let mut mixed = Vec::new();
    for ray in set.rays.iter().take(rays * BLOCKS) {
        let mut counts = Counts::default();
        contestant.accel.trace_watched(ray, set.mode, &mut counts, cancel)?;
        mixed.push((counts.prims as f64 / counts.nodes.max(1) as f64, *ray));
    }
    mixed.sort_by(|a, b| a.0.total_cmp(&b.0));
    Ok(mixed.into_iter().map(|(_, ray)| ray).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ratio_needs_both_costs() {
        let costs = |c_trav_ns, c_isect_ns| Costs { c_trav_ns, c_isect_ns, ..Costs::default() };
        assert_eq!(costs(4.0, 10.0).ratio(), Some(2.5));
        assert!([costs(0.0, 1.0), costs(1.0, 0.0), costs(0.0, 0.0), costs(f64::NAN, 1.0)].iter().all(|c| c.ratio().is_none()));
    }

    #[test]
    fn blocks_are_whole_and_evenly_spread() {
        let ray = |i: u16| Ray::new(glam::Vec3::X * f32::from(i), glam::Vec3::X);
        let set = RaySet { kind: RayKind::Primary, mode: Mode::Closest, rays: (0..1000).map(ray).collect() };
        let few = neighbours(&set, 5);
        assert_eq!(few.len(), BLOCKS * 5);
        assert!(few.chunks(5).all(|block| block.windows(2).all(|pair| pair[1].origin.x == pair[0].origin.x + 1.0)));
        assert!(neighbours(&set, 0).is_empty() && neighbours(&set, 1001).is_empty() && neighbours(&set, 1000).len() == 1000);
    }
}
