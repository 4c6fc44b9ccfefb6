//! What a step and a test cost on this machine, fitted to rays that were both timed and counted:
//!
//! ```text
//! seconds of a ray = C_trav nodes + C_isect tests + C_0
//! ```
//!
//! by least squares without negative costs, over blocks of neighbouring rays of several kinds: their
//! mixture of steps and tests differs, which is what tells the two costs apart. C_trav is charged for
//! every node entered, leaves among them, since that is what is counted.

use std::ops::Range;
use std::time::Instant;

use super::estimate::secs_per_ray;
use super::least_squares::non_negative;
use super::measure::Contestant;
use super::rays::RaySet;
use super::sample::spread;
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
    let fitted = lanes.iter().map(|lane| pool.run(|| lane.fit(cancel))).collect();
    progress.finish();
    fitted
}

/// A structure, its blocks of rays and the least seconds of each.
struct Lane<'a> {
    contestant: &'a Contestant,
    sets: &'a [&'a RaySet],
    rays_per_block: usize,
    blocks: Vec<(usize, Range<usize>)>,
    secs: Vec<f64>,
}

impl<'a> Lane<'a> {
    fn new(
        contestant: &'a Contestant,
        sets: &'a [&'a RaySet],
        options: &FitOptions,
        pool: &Pool,
        cancel: &Cancel,
    ) -> Result<Self, Cancelled> {
        let mut slowest = 0.0f64;
        for set in sets {
            let secs = secs_per_ray(contestant, set, pool, cancel)?;
            slowest = slowest.max(if secs.is_finite() { secs * pool.threads() as f64 } else { 0.0 });
        }
        let passes = ((options.rounds + 2) * sets.len().max(1) * BLOCKS) as f64;
        let rays_per_block = num::floor_index(options.cap_secs / (passes * slowest.max(1e-12)), RAYS);
        let blocks = (0..sets.len()).flat_map(|set| blocks_of(sets[set], rays_per_block).map(move |block| (set, block)));
        let blocks: Vec<(usize, Range<usize>)> = blocks.collect();
        Ok(Self { contestant, sets, rays_per_block, secs: vec![f64::INFINITY; blocks.len()], blocks })
    }

    fn rays(&self, block: &(usize, Range<usize>)) -> &'a [Ray] {
        &self.sets[block.0].rays[block.1.clone()]
    }

    /// Traces every block once.
    fn round(&mut self, timed: bool, cancel: &Cancel) -> Result<(), Cancelled> {
        let mut hits = vec![None; self.rays_per_block];
        for i in 0..self.blocks.len() {
            let (rays, mode) = (self.rays(&self.blocks[i]), self.sets[self.blocks[i].0].mode);
            let start = Instant::now();
            self.contestant.accel.trace(rays, mode, &mut hits[..rays.len()], cancel)?;
            let secs = start.elapsed().as_secs_f64();
            if timed {
                self.secs[i] = self.secs[i].min(secs);
            }
        }
        Ok(())
    }

    fn fit(&self, cancel: &Cancel) -> Result<Option<Costs>, Cancelled> {
        let (mut rows, mut nanos) = (Vec::new(), Vec::new());
        for (block, secs) in self.blocks.iter().zip(&self.secs) {
            let (rays, mode) = (self.rays(block), self.sets[block.0].mode);
            let mut counts = Counts::default();
            for ray in rays {
                cancel.check()?;
                self.contestant.accel.trace_watched(ray, mode, &mut counts);
            }
            let n = rays.len() as f64;
            rows.push([counts.nodes as f64 / n, counts.prims as f64 / n, 1.0]);
            nanos.push(secs / n * 1e9);
        }
        let Some(fit) = non_negative(&rows, &nanos) else { return Ok(None) };
        let ([c_trav_ns, c_isect_ns, c0_ns], [c_trav_error_ns, c_isect_error_ns, c0_error_ns]) = (fit.coefficients, fit.errors);
        let (r_squared, blocks, rays_per_block) = (fit.explained, rows.len(), self.rays_per_block);
        Ok(Some(Costs {
            c_trav_ns,
            c_trav_error_ns,
            c_isect_ns,
            c_isect_error_ns,
            c0_ns,
            c0_error_ns,
            r_squared,
            blocks,
            rays_per_block,
        }))
    }
}

/// Runs of neighbouring rays, evenly spread over the set; none if the set is shorter than one.
fn blocks_of(set: &RaySet, rays: usize) -> impl Iterator<Item = Range<usize>> + use<> {
    let places = set.rays.len().checked_div(rays).unwrap_or(0);
    spread(places, BLOCKS).into_iter().map(move |place| place * rays..(place + 1) * rays)
}
