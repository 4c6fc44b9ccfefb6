//! The race: builds in turns, then each set of rays in turns, hits compared before anything is timed.

use rayon::prelude::*;
use serde::Serialize;
use std::borrow::Cow;
use std::collections::BTreeMap;
use std::sync::Arc;
use std::time::Instant;

use super::{Ask, Built, Call, Entrant, Found, Hits, Label, NotBuilt, RayPairs, Rays, Recipe, same};
use crate::accel::params::Value;
use crate::geometry::num::floor_index;
use crate::lab::estimate::rays_within;
use crate::lab::measure::chunk_len;
use crate::lab::sample::spread;
use crate::lab::statistics::{half_iqr, median};
use crate::lab::turns::{self, DONE, Racer};
use crate::lab::{MeasureOptions, RayKind};
use crate::scene::Geometry;
use crate::task::{Cancel, Cancelled, Pool, Progress};

/// One structure, built and traced, with its rays handed over in one way.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PeerRow {
    /// What it is called.
    pub id: String,
    /// Whose it is, and which version.
    pub library: String,
    /// Whether it is another library's.
    pub peer: bool,
    /// Whether no ray slips between triangles: our test of that name, Embree's robust scenes.
    pub watertight: bool,
    /// How its rays are handed over.
    pub call: Call,
    /// Threads that built and traced.
    pub threads: usize,
    /// The parameters of ours.
    pub params: BTreeMap<&'static str, Value>,
    /// The builds.
    #[serde(flatten)]
    pub build: Option<BuildSecs>,
    /// Bytes of the structure, where they are known.
    pub bytes: Option<u64>,
    /// Rays, of all sets, whose hit is not that of the reference.
    pub differing_rays: u64,
    /// One for each set.
    pub rays: BTreeMap<RayKind, RayRow>,
    /// Why it is missing, in words for the user.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub error: Option<String>,
}

/// What the builds of a structure took.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct BuildSecs {
    /// The median of their wall-clock seconds.
    #[serde(rename = "build_secs")]
    pub median: f64,
    /// Half the interquartile range of those.
    #[serde(rename = "build_spread")]
    pub half_iqr: f64,
    /// How many.
    pub builds: usize,
}

/// A set of rays.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct RayRow {
    /// Rays traced in each round.
    pub count: usize,
    /// Rays of the whole set; more where the structure is too slow for all.
    pub of: usize,
    /// Rays of a round that hit something.
    pub hits: u64,
    /// Rounds that were timed.
    pub rounds: usize,
    /// The median over rounds of the seconds of one; NaN (`null` in JSON) if there are no rays.
    pub secs: f64,
    /// Half the interquartile range of those seconds.
    pub secs_spread: f64,
    /// The least.
    pub secs_min: f64,
    /// The greatest.
    pub secs_max: f64,
    /// Rays of a round over its median seconds, in millions.
    pub mrays_per_sec: f64,
    /// Rays whose hit is not that of the reference.
    pub differing_rays: u64,
}

/// What is raced, and how.
pub struct PeerRace<'a> {
    /// Who takes part.
    pub recipes: &'a [Box<dyn Recipe>],
    /// The triangles.
    pub geometry: &'a Arc<Geometry>,
    /// The rays.
    pub sets: &'a [RayPairs],
    /// Rounds, and seconds, of each set.
    pub options: &'a MeasureOptions,
    /// Builds of each; one that takes longer than five seconds is done once.
    pub builds: usize,
}

/// No further build follows one that took so long.
const LONG_BUILD_SECS: f64 = 5.0;

/// Builds everything and traces all sets; a row for each way in which rays can be handed over.
///
/// # Errors
/// [`Cancelled`]; what cannot be built is told in its row. A peer's build cannot be stopped.
pub fn race(race: &PeerRace<'_>, pool: &Pool, cancel: &Cancel, progress: &Progress) -> Result<Vec<PeerRow>, Cancelled> {
    let built = build(race, pool, cancel, progress)?;
    let mut rows = Vec::new();
    let mut entrants: Vec<(&dyn Entrant, Call)> = Vec::new();
    let mut lanes = Vec::new();
    for (recipe, lane) in race.recipes.iter().zip(&built) {
        for call in recipe.calls() {
            if let Some(entrant) = &lane.entrant {
                lanes.push(rows.len());
                entrants.push((entrant.as_ref(), *call));
            }
            rows.push(lane.row(recipe.label(), *call, pool.threads()));
        }
    }
    for set in race.sets {
        let timed = trace(race, &entrants, set, pool, cancel, progress)?;
        for (row, timed) in lanes.iter().zip(timed) {
            rows[*row].differing_rays += timed.differing_rays;
            rows[*row].rays.insert(set.kind, timed);
        }
    }
    Ok(rows)
}

/// A structure after its builds.
#[derive(Default)]
struct BuildLane {
    entrant: Option<Box<dyn Entrant>>,
    secs: Vec<f64>,
    error: Option<String>,
}

impl BuildLane {
    fn row(&self, label: Label, call: Call, threads: usize) -> PeerRow {
        let secs = &self.secs;
        let build = || BuildSecs { median: median(secs), half_iqr: half_iqr(secs), builds: secs.len() };
        PeerRow {
            id: label.id,
            library: label.library,
            peer: label.peer,
            watertight: label.watertight,
            call,
            threads,
            params: label.params,
            build: (!secs.is_empty()).then(build),
            bytes: self.entrant.as_ref().and_then(|entrant| entrant.bytes()),
            differing_rays: 0,
            rays: BTreeMap::new(),
            error: self.error.clone(),
        }
    }

    fn build(&mut self, recipe: &dyn Recipe, geometry: &Arc<Geometry>, pool: &Pool) -> Result<(), Cancelled> {
        // The one before goes first: two at a time may not fit.
        self.entrant = None;
        match recipe.build(geometry, pool) {
            Ok(Built { entrant, secs }) => {
                self.secs.push(secs);
                self.entrant = Some(entrant);
            }
            Err(NotBuilt::Cancelled(cancelled)) => return Err(cancelled),
            Err(NotBuilt::Because(why)) => self.error = Some(why),
        }
        Ok(())
    }

    fn wants_more(&self) -> bool {
        self.error.is_none() && self.secs.last().is_none_or(|secs| *secs <= LONG_BUILD_SECS)
    }
}

fn build(race: &PeerRace<'_>, pool: &Pool, cancel: &Cancel, progress: &Progress) -> Result<Vec<BuildLane>, Cancelled> {
    let n = race.recipes.len();
    let mut lanes: Vec<BuildLane> = (0..n).map(|_| BuildLane::default()).collect();
    progress.start("build", (n * race.builds.max(1)) as u64);
    for round in 0..race.builds.max(1) {
        for i in 0..n {
            cancel.check()?;
            let i = (round + i) % n;
            if lanes[i].wants_more() {
                lanes[i].build(race.recipes[i].as_ref(), race.geometry, pool)?;
            }
            progress.advance(1);
        }
    }
    Ok(lanes)
}

/// Times one set of rays.
fn trace(
    race: &PeerRace<'_>,
    entrants: &[(&dyn Entrant, Call)],
    set: &RayPairs,
    pool: &Pool,
    cancel: &Cancel,
    progress: &Progress,
) -> Result<Vec<RayRow>, Cancelled> {
    progress.start("compare hits", entrants.len() as u64);
    let mut lanes = Vec::with_capacity(entrants.len());
    for (entrant, call) in entrants {
        let ask = Ask { mode: set.mode, call: *call, coherent: set.kind == RayKind::Primary };
        lanes.push(Lane::compared(*entrant, ask, set, race, pool, cancel)?);
        progress.advance(1);
    }
    progress.start(set.kind.id(), lanes.len() as u64 * DONE);
    let mut racers: Vec<&mut dyn Racer> = lanes.iter_mut().map(|lane| lane as &mut dyn Racer).collect();
    turns::take(&mut racers, race.options, pool, cancel, progress)?;
    Ok(lanes.iter().map(Lane::row).collect())
}

/// A structure with its rays and the rounds it has done.
struct Lane<'a> {
    entrant: &'a dyn Entrant,
    ask: Ask,
    /// The whole set, or a part of it.
    set: Cow<'a, RayPairs>,
    of: usize,
    hits: u64,
    differing: u64,
    secs: Vec<f64>,
}

impl<'a> Lane<'a> {
    /// Takes as many rays as the time allows, and compares their hits, which also warms up.
    fn compared(
        entrant: &'a dyn Entrant,
        ask: Ask,
        set: &'a RayPairs,
        race: &PeerRace<'_>,
        pool: &Pool,
        cancel: &Cancel,
    ) -> Result<Self, Cancelled> {
        const TRIED: usize = 4096;
        let of = set.len();
        let mut lane = Self { entrant, ask, set: Cow::Borrowed(set), of, hits: 0, differing: 0, secs: Vec::new() };
        if of > TRIED {
            let few = Self { set: Cow::Owned(set.picked(&spread(of, TRIED))), secs: Vec::new(), ..lane };
            few.pass(pool, cancel)?;
            let start = Instant::now();
            few.pass(pool, cancel)?;
            let secs_per_ray = start.elapsed().as_secs_f64() / few.set.len().max(1) as f64;
            let most = rays_within(race.options.cap_secs, race.options.min_rounds + 1, secs_per_ray);
            lane = Self { set: Cow::Borrowed(set), ..few };
            if most < of {
                lane.set = Cow::Owned(set.picked(&spread(of, floor_index(most as f64, of))));
            }
        }
        lane.compare(race.geometry, pool, cancel)?;
        Ok(lane)
    }

    fn compare(&mut self, geometry: &Geometry, pool: &Pool, cancel: &Cancel) -> Result<(), Cancelled> {
        let (entrant, ask) = (self.entrant, self.ask);
        let expected = self.set.expected().par_chunks(self.chunk(pool));
        let chunk = |hits: &mut Hits, (rays, expected): (Rays<'_>, &[Found])| {
            cancel.check()?;
            let met = entrant.trace(rays, ask, hits);
            entrant.settle(rays, ask, geometry, hits);
            let differing = expected.iter().zip(&hits.found).filter(|(a, b)| same::differs(**a, **b, ask.mode)).count();
            Ok((met, differing as u64))
        };
        let sum = |a: (u64, u64), b: (u64, u64)| Ok((a.0 + b.0, a.1 + b.1));
        let all = || self.chunks(pool).zip(expected).map_init(Hits::default, chunk).try_reduce(|| (0, 0), sum);
        (self.hits, self.differing) = pool.run(all)?;
        Ok(())
    }

    /// Rays of a chunk: packets of eight are not cut.
    fn chunk(&self, pool: &Pool) -> usize {
        chunk_len(self.set.len(), pool.threads()).next_multiple_of(8)
    }

    fn chunks(&self, pool: &Pool) -> impl IndexedParallelIterator<Item = Rays<'_>> {
        let (Rays { world, scaled }, chunk) = (self.set.rays(), self.chunk(pool));
        world.par_chunks(chunk).zip(scaled.par_chunks(chunk)).map(|(world, scaled)| Rays { world, scaled })
    }

    /// Traces all rays once; hits go to a buffer of each thread's, small enough for its cache.
    fn pass(&self, pool: &Pool, cancel: &Cancel) -> Result<u64, Cancelled> {
        let (entrant, ask) = (self.entrant, self.ask);
        let trace = |hits: &mut Hits, rays: Rays<'_>| cancel.check().map(|()| entrant.trace(rays, ask, hits));
        pool.run(|| self.chunks(pool).map_init(Hits::default, trace).try_reduce(|| 0, |a, b| Ok(a + b)))
    }

    fn row(&self) -> RayRow {
        let (secs, count) = (&self.secs, self.set.len());
        RayRow {
            count,
            of: self.of,
            hits: self.hits,
            rounds: secs.len(),
            secs: median(secs),
            secs_spread: half_iqr(secs),
            secs_min: secs.iter().copied().fold(f64::NAN, f64::min),
            secs_max: secs.iter().copied().fold(f64::NAN, f64::max),
            mrays_per_sec: count as f64 / median(secs) * 1e-6,
            differing_rays: self.differing,
        }
    }
}

impl Racer for Lane<'_> {
    fn round(&mut self, pool: &Pool, cancel: &Cancel) -> Result<(), Cancelled> {
        let start = Instant::now();
        self.pass(pool, cancel)?;
        self.secs.push(start.elapsed().as_secs_f64());
        Ok(())
    }

    fn share_done(&self, options: &MeasureOptions) -> u64 {
        // No rays need nothing.
        if self.set.is_empty() { DONE } else { turns::share(&self.secs, options) }
    }
}
