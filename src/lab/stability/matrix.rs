//! One case: every structure and every test on the same rays.

use serde::Serialize;

use super::boxes::{BoxRow, box_rows};
use super::cases::Case;
use super::ground::Ground;
use super::row::{Row, Tried};
use crate::accel::BuildCx;
use crate::accel::registry::Entry;
use crate::geometry::tri::TestKind;
use crate::scene::Reason;

/// What is run.
#[derive(Clone, Debug)]
pub struct Options {
    /// Makes the cases; the same for the same seed.
    pub seed: u64,
    /// About so many rays a case.
    pub rays: usize,
    /// Which structures.
    pub structures: Vec<&'static Entry>,
    /// With which tests, as far as a structure has them.
    pub tests: Vec<TestKind>,
    /// The least seconds timed of each structure and test.
    pub secs: f64,
}

impl Options {
    /// The structures and tests that go together.
    pub fn pairs(&self) -> impl Iterator<Item = (&'static Entry, TestKind)> {
        let of = |test: TestKind| self.structures.iter().map(move |entry| (*entry, test));
        self.tests.iter().copied().flat_map(of).filter(|(entry, test)| entry.tests().any(|t| t == *test))
    }
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
    /// A row for each test of boxes.
    pub boxes: Vec<BoxRow>,
}

/// Runs a case. `done` is called once for each of [`Options::pairs`].
///
/// # Errors
/// Cancelled, or the case's scene would not fit.
pub fn check_case(case: &Case, options: &Options, cx: &BuildCx, done: &dyn Fn()) -> Result<CaseRow, Reason> {
    let trial = case.trial(options.seed, options.rays);
    let ground = Ground::new(case.id, &trial, cx)?;
    let limited = BuildCx { indices: trial.indices.unwrap_or(cx.indices), ..cx.clone() };
    let (rays, may_refuse) = (trial.rays.len(), trial.indices.is_some());
    let build = |(entry, test)| Tried::build(entry, test, &ground.geometry, rays, may_refuse, &limited);
    let mut tried = options.pairs().map(build).collect::<Result<Vec<_>, _>>()?;
    let mut boxes = Vec::new();
    let at_once = ground.rays_at_once();
    for (chunk, rays) in trial.rays.chunks(at_once).enumerate() {
        let shots = ground.shots(chunk * at_once, rays, cx)?;
        for test in &options.tests {
            let expected = shots.expected(*test, cx)?;
            for tried in tried.iter_mut().filter(|tried| tried.test() == *test) {
                tried.shoot(&shots, &expected, options.secs, &cx.cancel)?;
                if shots.first + rays.len() == trial.rays.len() {
                    done();
                }
            }
        }
        if chunk == 0 {
            boxes = box_rows(&shots, cx)?;
        }
    }
    if trial.rays.is_empty() {
        tried.iter().for_each(|_| done());
    }
    let structures = tried.into_iter().map(Tried::finish).collect();
    Ok(CaseRow { id: case.id, triangles: ground.geometry.live_count(), structures, boxes })
}
