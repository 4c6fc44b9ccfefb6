//! The Compare workspace: time against the number of triangles, measured in the background on the open model in growing sizes.

use super::State;
use super::finished::sentence;
use crate::accel::BuildCx;
use crate::geometry::tri::TestKind;
use crate::job::{Job, Outcome};
use crate::lab::everything::Amount;
use crate::lab::scaling::{BuildRounds, Candidate, Scaling, Sizes, scaling};
use crate::lab::{MeasureOptions, RaySet};
use crate::scene::LoadCx;
use crate::task::{Cancel, Progress};
use crate::viewer::workers::Shared;

/// Triangles that a built-in scene is made of, at least, and of anything at most unless it has more.
const TRIANGLES: [u64; 2] = [1_000, 200_000];
/// Sizes of a built-in scene.
const STEPS: u32 = 5;
/// Random lines that are timed, the same for all sizes.
const LINES: u64 = 1 << 15;
/// How often structures are built.
const BUILDS: BuildRounds = BuildRounds { rounds: 3, secs: 0.5 };

impl State {
    /// Starts it.
    pub(super) fn measure_scaling(&mut self) {
        if self.is_measuring() || self.is_checking() {
            return;
        }
        let pause = self.begin_measuring();
        let Some(model) = &self.model else { return };
        let (name, triangles) = (model.scene.name.clone(), model.geometry.counts().triangles);
        // A scene that is made in each size is asked for without one.
        let name = name.split_once("?triangles=").map_or(name.clone(), |(base, _)| base.to_owned());
        // A model is taken as it is and once cut finer, at least.
        let sizes = Sizes { from: TRIANGLES[0], to: TRIANGLES[1].max(triangles.saturating_mul(4)), steps: STEPS };
        let entries = Amount::of(false).entries();
        let of = |entry: &'static crate::accel::registry::Entry| Candidate { entry, params: self.settings.params_of(entry) };
        let candidates: Vec<Candidate> = entries.into_iter().map(of).collect();
        let test = self.settings.common_test();
        let shared = self.shared.clone();
        self.building = None;
        let work = move |cancel: &Cancel, progress: &Progress| {
            pause.wait();
            grow(&name, &sizes, (&candidates, test), &shared, (cancel, progress))
        };
        match Job::spawn("scaling", self.shared.waker(), work) {
            Ok(job) => self.tradeoffs.growing = Some(job),
            Err(e) => self.fail(format!("Can't measure: {e}.")),
        }
    }

    /// Takes in what was measured.
    pub(super) fn advance_scaling(&mut self) {
        let Some(job) = &self.tradeoffs.growing else { return };
        match job.poll() {
            Outcome::Running => return,
            Outcome::Done(Ok(rows)) => {
                if !rows.is_empty() {
                    self.tradeoffs.scaling = rows;
                }
            }
            Outcome::Done(Err(why)) => self.fail(format!("Can't measure time against triangles: {}", sentence(&why))),
            Outcome::Died => self.fail("Can't measure time against triangles: it failed. Please report this.".to_owned()),
        }
        self.tradeoffs.growing = None;
    }
}

/// Makes the model in all sizes, builds the structures over each, and times them; nothing if it is stopped.
fn grow(
    model: &str,
    sizes: &Sizes,
    (candidates, test): (&[Candidate], TestKind),
    shared: &Shared,
    (cancel, progress): (&Cancel, &Progress),
) -> Result<Vec<Scaling>, String> {
    let Shared { pool, budget, .. } = shared.clone();
    let cx = LoadCx::new(cancel.clone(), progress.clone(), budget.clone(), pool.clone());
    let grown = match sizes.of(model, &cx) {
        Ok(grown) => grown,
        Err(why) if why.is_cancelled() => return Ok(Vec::new()),
        Err(why) => return Err(why.to_string()),
    };
    let [_, .., largest] = &grown.geometries[..] else {
        return Err("the model has one size alone".to_owned());
    };
    let Ok(set) = RaySet::lines(largest, LINES, &pool, cancel) else { return Ok(Vec::new()) };
    let options = MeasureOptions { min_rounds: 3, min_secs: 0.1, cap_secs: 1.0, ..MeasureOptions::default() };
    let cx = BuildCx::new(cancel.clone(), Progress::new(), pool, budget);
    // What can't be built says so in its row; there is no other error but that it was stopped.
    Ok(scaling(candidates, &grown.geometries, &set, test, (&BUILDS, &options), (&cx, progress)).unwrap_or_default())
}
