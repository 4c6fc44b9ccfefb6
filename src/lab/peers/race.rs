//! The race: builds in turns, then each set of rays in turns, hits compared before anything is timed.

use serde::Serialize;
use std::collections::BTreeMap;
use std::sync::Arc;

use super::lane::Lane;
use super::{Ask, Built, Call, Entrant, Label, NotBuilt, RayPairs, Recipe};
use crate::accel::params::Value;
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
    /// Whether no ray slips between triangles: all our tests but the fast one, Embree's robust scenes.
    pub watertight: bool,
    /// The triangle test, or what a peer calls it.
    pub test: &'static str,
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
            test: label.test,
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
        lanes.push(Lane::compared(*entrant, ask, set, (race.options, race.geometry), pool, cancel)?);
        progress.advance(1);
    }
    progress.start(set.kind.id(), lanes.len() as u64 * DONE);
    let mut racers: Vec<&mut dyn Racer> = lanes.iter_mut().map(|lane| lane as &mut dyn Racer).collect();
    turns::take(&mut racers, race.options, pool, cancel, progress)?;
    Ok(lanes.iter().map(Lane::row).collect())
}
