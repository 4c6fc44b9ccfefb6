//! One case: every structure and every test on the same rays, judged, counted and timed.

use std::sync::Arc;
use std::time::Instant;

use rayon::prelude::*;
use serde::Serialize;

use super::cases::{Case, Trial};
use super::judge::{Expected, Wrong, expected};
use super::oracle::{Passing, passings};
use super::visits::visits;
use crate::accel::registry::Entry;
use crate::accel::{Accel, BuildCx, BuildError, Hit, Mode};
use crate::geometry::Ray;
use crate::geometry::space::Entered;
use crate::geometry::tri::TestKind;
use crate::lab::building::build_timed;
use crate::lab::statistics::{median, quantile};
use crate::scene::{Geometry, LoadCx, Reason};
use crate::task::{Cancel, Cancelled};

/// What is run.
#[derive(Clone, Debug)]
pub struct Options {
    /// Makes the cases; the same for the same seed.
    pub seed: u64,
    /// About so many rays a case.
    pub rays: usize,
    /// Which structures.
    pub structures: Vec<&'static Entry>,
    /// The least seconds timed of each structure and test.
    pub secs: f64,
}

/// What came out of a case.
#[derive(Clone, Debug, Serialize)]
pub struct CaseRow {
    /// Its name.
    pub id: &'static str,
    /// Triangles that structures hold.
    pub triangles: usize,
    /// A row for each structure and test.
    pub structures: Vec<Row>,
}

/// What came out of one structure with one test.
#[derive(Clone, Debug, Serialize)]
pub struct Row {
    /// The structure.
    pub id: &'static str,
    /// The triangle test.
    pub test: TestKind,
    /// Rays traced.
    pub rays: usize,
    /// Of those, the ones whose answer is a matter of rounding.
    pub near: usize,
    /// Of those, the ones through an edge or a corner, or in a triangle's plane, to the bit.
    pub boundary: usize,
    /// Wrong answers where rounding decides nothing.
    pub clear_wrong: usize,
    /// Answers that rounding does not explain.
    pub boundary_wrong: usize,
    /// Of those, rays that went through a closed surface.
    pub slipped: usize,
    /// The greatest error of t, of clear hits, in units of the last place.
    pub max_ulps: f64,
    /// That which one in a thousand exceeds.
    pub p999_ulps: f64,
    /// The most nodes that a ray entered.
    pub max_nodes: u64,
    /// Nodes entered that should not have been, or the other way round: see docs/stability.md.
    pub astray: u64,
    /// On one thread, in batches.
    pub ns_per_ray: f64,
    /// Of the build.
    pub build_secs: f64,
    /// All in all.
    pub verdict: Verdict,
    /// The first rays that were answered wrongly.
    pub wrong: Vec<WrongRay>,
    /// Why it could not be built, if it could not.
    pub error: Option<String>,
}

/// A ray and what is wrong with its answer.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct WrongRay {
    /// Which ray of the case.
    pub ray: usize,
    /// What is wrong.
    pub why: Wrong,
}

/// What is thought of a row.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// Nothing wrong.
    Pass,
    /// Rays slipped through edges, by a test that does not promise that they do not.
    Warn,
    /// A wrong answer.
    Fail,
}

/// Wrong rays kept of a row.
const KEPT: usize = 16;
/// Rays that are watched, evenly spread.
const WATCHED: usize = 64;

/// A case made ready: its geometry, and its rays with what they pass.
pub struct Ground {
    geometry: Arc<Geometry>,
    rays: Vec<Ray>,
    entered: Vec<Option<Entered>>,
    passings: Vec<Vec<Passing>>,
    closed: bool,
}

/// Runs a case. `done` is called after each row.
///
/// # Errors
/// Cancelled, or the case's scene would not fit.
pub fn check_case(case: &Case, options: &Options, cx: &BuildCx, done: &dyn Fn()) -> Result<CaseRow, Reason> {
    let ground = Ground::new(case.id, &case.trial(options.seed, options.rays), cx)?;
    let mut structures = Vec::new();
    for test in TestKind::ALL {
        let expected = ground.expected(test, cx)?;
        for entry in &options.structures {
            structures.push(ground.row(entry, test, &expected, options.secs, cx)?);
            done();
        }
    }
    Ok(CaseRow { id: case.id, triangles: ground.geometry.live_count(), structures })
}

impl Ground {
    /// Works out what the rays pass.
    pub fn new(name: &str, trial: &Trial, cx: &BuildCx) -> Result<Self, Reason> {
        let load =
            LoadCx { cancel: cx.cancel.clone(), progress: cx.progress.clone(), budget: cx.budget.clone(), pool: cx.pool.clone() };
        let geometry = Arc::new(Geometry::new(&trial.scene(name), &load)?);
        let enter = |ray: &Ray| ray.is_valid().then(|| geometry.space().enter(ray)).filter(|e| e.ray.tmin <= e.ray.tmax);
        let entered: Vec<Option<Entered>> = trial.rays.iter().map(enter).collect();
        let pass = |entered: &Option<Entered>| {
            cx.cancel.check()?;
            Ok(entered.as_ref().map(|entered| passings(&geometry, &entered.ray)).unwrap_or_default())
        };
        let passings: Result<Vec<Vec<Passing>>, Cancelled> = cx.pool.run(|| entered.par_iter().map(pass).collect());
        Ok(Self { passings: passings?, geometry, rays: trial.rays.clone(), entered, closed: trial.closed })
    }

    /// What a test may report of each ray; of one that is not valid, nothing.
    pub fn expected(&self, test: TestKind, cx: &BuildCx) -> Result<Vec<Option<Expected>>, Cancelled> {
        let of = |(entered, passings): (&Option<Entered>, &Vec<Passing>)| {
            cx.cancel.check()?;
            Ok(entered.as_ref().map(|entered| expected(test, &self.geometry, self.closed, &entered.ray, passings)))
        };
        cx.pool.run(|| self.entered.par_iter().zip(&self.passings).map(of).collect())
    }

    /// One structure with one test.
    pub fn row(
        &self,
        entry: &'static Entry,
        test: TestKind,
        expected: &[Option<Expected>],
        secs: f64,
        cx: &BuildCx,
    ) -> Result<Row, Cancelled> {
        let count = |of: fn(&Expected) -> bool| expected.iter().flatten().filter(|e| of(e)).count();
        let mut row = Row {
            id: entry.id,
            test,
            rays: self.rays.len(),
            near: count(|e| e.clear.is_none()),
            boundary: count(|e| e.boundary),
            clear_wrong: 0,
            boundary_wrong: 0,
            slipped: 0,
            max_ulps: 0.0,
            p999_ulps: 0.0,
            max_nodes: 0,
            astray: 0,
            ns_per_ray: 0.0,
            build_secs: 0.0,
            verdict: Verdict::Pass,
            wrong: Vec::new(),
            error: None,
        };
        let accel = match build_timed(entry, &self.geometry, test, &entry.defaults(), cx) {
            Ok(built) => {
                row.build_secs = built.build_secs;
                built.accel
            }
            Err(BuildError::Cancelled(cancelled)) => return Err(cancelled),
            Err(error) => {
                (row.error, row.verdict) = (Some(error.to_string()), Verdict::Fail);
                return Ok(row);
            }
        };
        let mut hits = vec![None; self.rays.len()];
        accel.trace(&self.rays, Mode::Closest, &mut hits, &cx.cancel)?;
        let some = self.rays.iter().step_by(self.rays.len().div_ceil(WATCHED).max(1));
        let visits = visits(accel.as_ref(), some, &cx.cancel)?;
        (row.max_nodes, row.astray) = (visits.most, visits.astray);
        self.judge(&mut row, expected, &hits);
        row.ns_per_ray = self.time(accel.as_ref(), secs, &cx.cancel)? * 1e9 / self.rays.len().max(1) as f64;
        Ok(row)
    }

    fn judge(&self, row: &mut Row, expected: &[Option<Expected>], hits: &[Option<Hit>]) {
        let mut ulps = Vec::new();
        for (i, (expected, hit)) in expected.iter().zip(hits).enumerate() {
            let judged = match (expected, &self.entered[i]) {
                (Some(expected), Some(entered)) => expected.judge(&self.geometry, &entered.back, hit.as_ref()),
                _ if hit.is_some() => Err(Wrong::Clear),
                _ => Ok(None),
            };
            match judged {
                Ok(off) => ulps.extend(off),
                Err(why) => {
                    row.clear_wrong += usize::from(why.is_clear());
                    row.boundary_wrong += usize::from(!why.is_clear());
                    row.slipped += usize::from(why == Wrong::Slipped);
                    if row.wrong.len() < KEPT {
                        row.wrong.push(WrongRay { ray: i, why });
                    }
                }
            }
        }
        row.max_ulps = ulps.iter().copied().fold(0.0, f64::max);
        row.p999_ulps = if ulps.is_empty() { 0.0 } else { quantile(&ulps, 0.999) };
        // The fast test does not promise that no ray slips through an edge.
        let may_slip = row.test == TestKind::Fast && row.boundary_wrong == row.slipped;
        row.verdict = match (row.clear_wrong, row.boundary_wrong, row.astray) {
            (0, 0, 0) => Verdict::Pass,
            (0, _, 0) if may_slip => Verdict::Warn,
            _ => Verdict::Fail,
        };
    }

    /// Seconds of a round over the rays, the median.
    fn time(&self, accel: &dyn Accel, secs: f64, cancel: &Cancel) -> Result<f64, Cancelled> {
        const ROUNDS: usize = 3;
        let mut hits = vec![None; self.rays.len()];
        let (mut rounds, begin) = (Vec::new(), Instant::now());
        while rounds.len() < ROUNDS || begin.elapsed().as_secs_f64() < secs {
            let start = Instant::now();
            accel.trace(&self.rays, Mode::Closest, &mut hits, cancel)?;
            rounds.push(start.elapsed().as_secs_f64());
            // What is slow anyway is not timed again and again.
            if begin.elapsed().as_secs_f64() > 10.0 * secs {
                break;
            }
        }
        Ok(median(&rounds))
    }
}
