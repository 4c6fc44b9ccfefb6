//! Fair timing: every contestant traces the same rays, on the same threads, in turns.
//!
//! A round of a contestant is one pass over the rays. Rounds are interleaved ([`turns`]).
//! A contestant leaves when it has its rounds and its seconds; the first, untimed round warms up
//! caches and pages. A structure that is too slow for that traces an evenly spread part of the rays.

use rayon::prelude::*;
use std::borrow::Cow;
use std::sync::Arc;
use std::time::Instant;

use super::counting;
use super::estimate::{rays_within, secs_per_ray};
use super::format::{count, duration};
use super::rays::RaySet;
use super::sample::pick;
use super::timing::Timing;
use super::turns::{self, DONE, Racer};
use crate::accel::{Accel, Mode};
use crate::geometry::Ray;
use crate::task::{Cancel, Cancelled, Pool, Progress};

/// A structure that takes part.
#[derive(Clone)]
pub struct Contestant {
    /// What its row is called.
    pub id: String,
    /// The structure.
    pub accel: Arc<dyn Accel>,
}

/// On which terms structures are compared. Every table says which.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Fairness {
    /// Plain code that every processor runs, one ray at a time, the same triangle test: what is compared
    /// is the structure.
    #[default]
    LikeForLike,
    /// Each structure in the fastest form there is of it: batches of rays, the processor's own
    /// instructions.
    Best,
}

impl Fairness {
    /// The name in tables.
    pub const fn label(self) -> &'static str {
        match self {
            Self::LikeForLike => "like for like (plain code, single ray, same triangle test)",
            Self::Best => "each at its best",
        }
    }

    /// Both, in the order of menus.
    pub const ALL: [Self; 2] = [Self::LikeForLike, Self::Best];

    /// The same in a few words.
    pub const fn name(self) -> &'static str {
        match self {
            Self::LikeForLike => "Like for like",
            Self::Best => "Each at its best",
        }
    }

    /// What it means, in a sentence.
    pub const fn help(self) -> &'static str {
        match self {
            Self::LikeForLike => "Plain code, one ray at a time, the same triangle test: what is compared is the structure.",
            Self::Best => "Each structure in the fastest form there is of it: batches of rays, the processor's own instructions.",
        }
    }
}

/// How long and on which terms to measure.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeasureOptions {
    /// The fewest timed rounds of a structure.
    pub min_rounds: usize,
    /// The least seconds of timed tracing of a structure.
    pub min_secs: f64,
    /// The most seconds a structure shall take, warm-up included; beyond it traces fewer rays.
    pub cap_secs: f64,
    /// The terms.
    pub fairness: Fairness,
}

impl Default for MeasureOptions {
    fn default() -> Self {
        Self { min_rounds: 5, min_secs: 1.0, cap_secs: 20.0, fairness: Fairness::LikeForLike }
    }
}

/// Measures all contestants with one set of rays; the rows are in the contestants' order.
///
/// The caller sees to it that nothing else keeps the processors busy.
///
/// # Errors
/// [`Cancelled`] within 100 ms of the request.
pub fn measure(
    contestants: &[Contestant],
    set: &RaySet,
    options: &MeasureOptions,
    pool: &Pool,
    cancel: &Cancel,
    progress: &Progress,
) -> Result<Vec<Timing>, Cancelled> {
    measure_beside(contestants, None, set, options, pool, cancel, progress)
}

/// The same, with one more that takes its turn among them, warmed up already.
pub(super) fn measure_beside(
    contestants: &[Contestant],
    other: Option<&mut dyn Racer>,
    set: &RaySet,
    options: &MeasureOptions,
    pool: &Pool,
    cancel: &Cancel,
    progress: &Progress,
) -> Result<Vec<Timing>, Cancelled> {
    let lanes = contestants.len() as u64;
    progress.start("warm up", lanes);
    let mut all =
        contestants.iter().map(|c| Lane::warmed_up(c, set, options, pool, cancel, progress)).collect::<Result<Vec<_>, _>>()?;

    let mut racers: Vec<&mut dyn Racer> = Vec::new();
    racers.extend(all.iter_mut().map(|lane| lane as &mut dyn Racer));
    racers.extend(other.map(|other| other as &mut dyn Racer));
    progress.start("measure", racers.len() as u64 * DONE);
    turns::take(&mut racers, options, pool, cancel, progress)?;

    progress.start("count", lanes);
    let rows = all.iter().map(|lane| lane.counted(set, pool, cancel, progress)).collect();
    progress.finish();
    rows
}

/// A contestant with its rays and the rounds it has done.
struct Lane<'a> {
    contestant: &'a Contestant,
    /// The whole set, or a part of it.
    rays: Cow<'a, [Ray]>,
    mode: Mode,
    of: usize,
    secs_per_ray: f64,
    hits: u64,
    terms: Fairness,
    secs: Vec<f64>,
}

impl<'a> Lane<'a> {
    fn warmed_up(
        contestant: &'a Contestant,
        set: &'a RaySet,
        options: &MeasureOptions,
        pool: &Pool,
        cancel: &Cancel,
        progress: &Progress,
    ) -> Result<Self, Cancelled> {
        let within = |secs_per_ray| rays_within(options.cap_secs, options.min_rounds + 1, secs_per_ray);
        let terms = options.fairness;
        let mut secs_per_ray = secs_per_ray(contestant, set, terms, pool, cancel)?;
        let mut rays = part(set, within(secs_per_ray));
        let start = Instant::now();
        let mut hits = trace_all(contestant, &rays, set.mode, terms, pool, cancel)?;
        let found = start.elapsed().as_secs_f64() / rays.len().max(1) as f64;
        // The few rays of the estimate may have been the easy ones.
        if within(found) < rays.len() / 3 * 2 {
            (secs_per_ray, rays) = (found, part(set, within(found)));
            hits = trace_all(contestant, &rays, set.mode, terms, pool, cancel)?;
        }
        progress.advance(1);
        Ok(Self { contestant, rays, mode: set.mode, of: set.rays.len(), secs_per_ray, hits, terms, secs: Vec::new() })
    }

    fn counted(&self, set: &RaySet, pool: &Pool, cancel: &Cancel, progress: &Progress) -> Result<Timing, Cancelled> {
        let counted = counting::count(self.contestant, set, counting::how_many(self.secs_per_ray), pool, cancel)?;
        progress.advance(1);
        let row = Timing::of_rounds(&self.contestant.id, self.rays.len(), self.of, self.hits, &self.secs);
        Ok(Timing {
            nodes_per_ray: counted.nodes.mean(),
            leaves_per_ray: counted.leaves.mean(),
            prims_per_ray: counted.prims.mean(),
            lcv: counted.leaves.deviation(),
            counted: counted.nodes.n as usize,
            capped: self.why_capped(),
            ..row
        })
    }

    fn why_capped(&self) -> Option<String> {
        if self.of == 0 {
            return Some("there are no such rays: nothing is hit in this view".to_owned());
        }
        let whole = self.secs_per_ray * self.of as f64;
        let (part, of) = (self.rays.len(), self.of);
        let why =
            || format!("{} of {} rays, spread evenly: all would take {}", count(part as u64), count(of as u64), duration(whole));
        (part < of).then(|| why() + " a round")
    }
}

impl Racer for Lane<'_> {
    fn round(&mut self, pool: &Pool, cancel: &Cancel) -> Result<(), Cancelled> {
        let start = Instant::now();
        trace_all(self.contestant, &self.rays, self.mode, self.terms, pool, cancel)?;
        self.secs.push(start.elapsed().as_secs_f64());
        Ok(())
    }

    fn share_done(&self, options: &MeasureOptions) -> u64 {
        // No rays need nothing.
        if self.rays.is_empty() { DONE } else { turns::share(&self.secs, options) }
    }
}

/// So many rays of the set, spread evenly, or all of them.
fn part(set: &RaySet, most: usize) -> Cow<'_, [Ray]> {
    if most < set.rays.len() { Cow::Owned(pick(&set.rays, most)) } else { Cow::Borrowed(&set.rays) }
}

/// Rays that a thread takes at a time: few enough that no thread waits long for the last one, enough to
/// cost nothing.
pub(super) fn chunk_len(rays: usize, threads: usize) -> usize {
    (rays / (threads * 32)).clamp(1, 4096)
}

/// Traces the rays in chunks on the pool; returns how many hit something. Hits go to a buffer of
/// each thread's, small enough for its cache, so that writing them costs every structure the same
/// little.
pub(super) fn trace_all(
    contestant: &Contestant,
    rays: &[Ray],
    mode: Mode,
    terms: Fairness,
    pool: &Pool,
    cancel: &Cancel,
) -> Result<u64, Cancelled> {
    let chunk = chunk_len(rays.len(), pool.threads());
    let trace = |hits: &mut Vec<Option<crate::accel::Hit>>, rays: &[Ray]| {
        hits.resize(rays.len(), None);
        match terms {
            Fairness::LikeForLike => contestant.accel.trace_like_for_like(rays, mode, hits, cancel)?,
            Fairness::Best => contestant.accel.trace(rays, mode, hits, cancel)?,
        };
        Ok(hits.iter().filter(|hit| hit.is_some()).count() as u64)
    };
    pool.run(|| rays.par_chunks(chunk).map_init(Vec::new, trace).try_reduce(|| 0, |a, b| Ok(a + b)))
}
