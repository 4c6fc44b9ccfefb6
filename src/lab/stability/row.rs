//! One structure with one test on a case: built, traced, judged, counted and timed.

use std::sync::Arc;
use std::time::Instant;

use serde::Serialize;

use super::ground::Shots;
use super::judge::{Expected, Wrong};
use super::ulps::Tail;
use super::visits::visits;
use crate::accel::registry::Entry;
use crate::accel::{Accel, BuildCx, BuildError, Hit, Mode};
use crate::geometry::tri::TestKind;
use crate::lab::building::build_timed;
use crate::lab::statistics::median;
use crate::scene::{Geometry, Reason};
use crate::task::{Cancel, Cancelled};

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
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
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
/// The quantile of errors that is told.
const QUANTILE: f64 = 0.999;

/// A structure under trial.
pub struct Tried {
    row: Row,
    ulps: Tail,
    accel: Option<Arc<dyn Accel>>,
}

impl Tried {
    /// Builds it, to be shot at with about so many rays. Where `may_refuse`, it may say that it would need too many indices.
    ///
    /// # Errors
    /// Cancelled, or over the memory budget.
    pub fn build(
        entry: &'static Entry,
        test: TestKind,
        geometry: &Arc<Geometry>,
        rays: usize,
        may_refuse: bool,
        cx: &BuildCx,
    ) -> Result<Self, Reason> {
        let mut row = Row {
            id: entry.id,
            test,
            rays: 0,
            near: 0,
            boundary: 0,
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
        let accel = match build_timed(entry, geometry, test, &entry.defaults(), cx) {
            Ok(built) => {
                row.build_secs = built.build_secs;
                Some(built.accel)
            }
            Err(BuildError::Cancelled(cancelled)) => return Err(cancelled.into()),
            // Nothing is wrong with a structure that its neighbours leave no memory.
            Err(BuildError::Memory { over, .. }) => return Err(over.into()),
            Err(error) => {
                let refused = may_refuse && matches!(error, BuildError::TooMany { .. });
                (row.error, row.verdict) = (Some(error.to_string()), if refused { Verdict::Pass } else { Verdict::Fail });
                None
            }
        };
        Ok(Self { row, ulps: Tail::new(rays, QUANTILE), accel })
    }

    /// Its test.
    pub const fn test(&self) -> TestKind {
        self.row.test
    }

    /// Traces rays and judges the answers. Of the first rays some are watched, and they are timed for as many seconds.
    ///
    /// # Errors
    /// Cancelled.
    pub fn shoot(
        &mut self,
        shots: &Shots<'_>,
        expected: &[Option<Expected>],
        secs: f64,
        cancel: &Cancel,
    ) -> Result<(), Cancelled> {
        let Some(accel) = self.accel.clone() else { return Ok(()) };
        let count = |of: fn(&Expected) -> bool| expected.iter().flatten().filter(|e| of(e)).count();
        self.row.rays += shots.rays.len();
        self.row.near += count(|e| e.clear.is_none());
        self.row.boundary += count(|e| e.boundary);
        let mut hits = vec![None; shots.rays.len()];
        accel.trace(shots.rays, Mode::Closest, &mut hits, cancel)?;
        self.judge(shots, expected, &hits);
        if shots.first == 0 && !shots.rays.is_empty() {
            let some = shots.rays.iter().step_by(shots.rays.len().div_ceil(WATCHED).max(1));
            let visits = visits(accel.as_ref(), some, cancel)?;
            (self.row.max_nodes, self.row.astray) = (visits.most, visits.astray);
            self.row.ns_per_ray = time(accel.as_ref(), shots, secs, &mut hits, cancel)? * 1e9 / shots.rays.len() as f64;
        }
        Ok(())
    }

    fn judge(&mut self, shots: &Shots<'_>, expected: &[Option<Expected>], hits: &[Option<Hit>]) {
        for (i, (expected, hit)) in expected.iter().zip(hits).enumerate() {
            let judged = match (expected, &shots.entered[i]) {
                (Some(expected), Some(entered)) => expected.judge(&shots.ground.geometry, &entered.back, hit.as_ref()),
                _ if hit.is_some() => Err(Wrong::Clear),
                _ => Ok(None),
            };
            match judged {
                Ok(off) => off.into_iter().for_each(|off| self.ulps.add(off)),
                Err(why) => {
                    let row = &mut self.row;
                    row.clear_wrong += usize::from(why.is_clear());
                    row.boundary_wrong += usize::from(!why.is_clear());
                    row.slipped += usize::from(why == Wrong::Slipped);
                    if row.wrong.len() < KEPT {
                        row.wrong.push(WrongRay { ray: shots.first + i, why });
                    }
                }
            }
        }
    }

    /// What came out.
    pub fn finish(mut self) -> Row {
        let row = &mut self.row;
        if self.accel.is_some() {
            (row.max_ulps, row.p999_ulps) = (self.ulps.max(), self.ulps.quantile(QUANTILE));
            let may_slip = !row.test.is_watertight() && row.boundary_wrong == row.slipped;
            row.verdict = match (row.clear_wrong, row.boundary_wrong, row.astray) {
                (0, 0, 0) => Verdict::Pass,
                (0, _, 0) if may_slip => Verdict::Warn,
                _ => Verdict::Fail,
            };
        }
        self.row
    }
}

/// Seconds of a round over the rays, the median.
fn time(accel: &dyn Accel, shots: &Shots<'_>, secs: f64, hits: &mut [Option<Hit>], cancel: &Cancel) -> Result<f64, Cancelled> {
    const ROUNDS: usize = 3;
    let (mut rounds, begin) = (Vec::new(), Instant::now());
    while rounds.len() < ROUNDS || begin.elapsed().as_secs_f64() < secs {
        let start = Instant::now();
        accel.trace(shots.rays, Mode::Closest, hits, cancel)?;
        rounds.push(start.elapsed().as_secs_f64());
        // What is slow anyway is not timed again and again.
        if begin.elapsed().as_secs_f64() > 10.0 * secs {
            break;
        }
    }
    Ok(median(&rounds))
}
