//! How the time of a build and of a ray grows with the number of triangles: a straight line through
//! the logarithms, whose slope is the exponent. A tree that is built in N log N has a build exponent a
//! little above 1 over any range that can be measured; brute force has exponent 1 in the time of a ray.

use serde::Serialize;
use std::sync::Arc;

use super::building::{BuiltRow, build_timed};
use super::least_squares::{Line, line};
use super::measure::{Contestant, MeasureOptions, measure};
use super::rays::RaySet;
use super::statistics::{half_iqr, median};
use crate::accel::params::ParamValues;
use crate::accel::registry::Entry;
use crate::accel::{Accel, BuildCx, BuildError};
use crate::geometry::num::floor_index;
use crate::geometry::tri::TestKind;
use crate::scene::{self, Geometry, LoadCx, LoadError, Scene, builtin, subdivide};
use crate::task::Progress;

/// One structure over models of growing size.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Scaling {
    /// The registered name.
    pub id: String,
    /// One for each size that it could be built for, the smallest first.
    pub points: Vec<Point>,
    /// The exponent of the build time; `None` for fewer than two sizes.
    pub build: Option<Exponent>,
    /// The exponent of the time of a ray.
    pub ray: Option<Exponent>,
    /// Why it is missing at some size, in words for the user.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub error: Option<String>,
}

/// One structure over one model.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Point {
    /// Triangles in the structure.
    pub triangles: u64,
    /// The median over builds of their wall-clock seconds.
    pub build_secs: f64,
    /// Half the interquartile range of those.
    pub build_spread: f64,
    /// How often it was built.
    pub builds: usize,
    /// The median over rounds of the wall-clock seconds of a round over its rays.
    pub ray_secs: f64,
    /// Half the interquartile range of those.
    pub ray_spread: f64,
    /// Rays in a round.
    pub rays: usize,
    /// Rounds that were timed.
    pub rounds: usize,
}

/// Time grows as the number of triangles to this power.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Exponent {
    /// The power.
    pub value: f64,
    /// Its standard error; NaN (`null` in JSON) for two sizes.
    pub error: f64,
}

impl Exponent {
    /// Of times over numbers of triangles; what is not positive has no logarithm and is left out.
    pub fn of(points: impl IntoIterator<Item = (f64, f64)>) -> Option<Self> {
        let positive = points.into_iter().filter(|(n, secs)| *n > 0.0 && *secs > 0.0);
        let logs: Vec<(f64, f64)> = positive.map(|(n, secs)| (n.ln(), secs.ln())).collect();
        let Line { slope, slope_error, .. } = line(&logs)?;
        Some(Self { value: slope, error: slope_error })
    }
}

/// Which sizes a model is taken in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Sizes {
    /// The fewest triangles of a scene that is made in each size.
    pub from: u64,
    /// The most triangles.
    pub to: u64,
    /// Sizes of a scene that is made in each, at least two, the ratio from one to the next being the same.
    pub steps: u32,
}

/// A model in growing sizes.
#[derive(Clone, Debug)]
pub struct Grown {
    /// Its triangles in each, the smallest first.
    pub geometries: Vec<Arc<Geometry>>,
    /// The largest as a whole.
    pub scene: Arc<Scene>,
}

impl Sizes {
    /// Makes a built-in scene that is named without a size in each; anything else is taken as it is, and cut finer and finer,
    /// each triangle into four. There may be fewer than two in the range.
    ///
    /// # Errors
    /// Asked to stop, or the model can't be opened or does not fit.
    pub fn of(&self, model: &str, cx: &LoadCx) -> Result<Grown, LoadError> {
        let scales = |name: &str| builtin::all().iter().any(|s| s.id == name && !matches!(s.size, builtin::Size::Fixed(_)));
        if model.strip_prefix(builtin::SCHEME).is_some_and(scales) { self.made(model, cx) } else { self.subdivided(model, cx) }
    }

    /// Sizes that the construction makes one are taken once.
    fn made(&self, model: &str, cx: &LoadCx) -> Result<Grown, LoadError> {
        let (from, to) = (self.from.min(self.to) as f64, self.to as f64);
        let sized = |step: u32| {
            let share = f64::from(step) / f64::from(self.steps.max(2) - 1);
            let triangles = floor_index((from * (to / from).powf(share)).round(), builtin::MAX_TRIANGLES);
            flat(&format!("{model}?triangles={triangles}"), cx)
        };
        let (scene, geometry) = sized(0)?;
        let mut grown = Grown { geometries: vec![geometry], scene };
        for step in 1..self.steps.max(2) {
            let (scene, geometry) = sized(step)?;
            if grown.geometries.last().is_none_or(|last| last.live_count() < geometry.live_count()) {
                grown.geometries.push(geometry);
                grown.scene = scene;
            }
        }
        Ok(grown)
    }

    fn subdivided(&self, model: &str, cx: &LoadCx) -> Result<Grown, LoadError> {
        let whole = |scene: &Scene| Geometry::new(scene, cx).map(Arc::new).map_err(|reason| reason.of(model));
        let mut scene = scene::open(model, cx)?;
        let mut geometries = vec![whole(&scene)?];
        while scene.triangle_count() * 4 <= self.to {
            let finer = subdivide(&scene, cx).map_err(|reason| reason.of(model))?;
            // What is wrong with the model stays wrong with all sizes of it.
            scene = Scene { warnings: scene.warnings, ..finer };
            geometries.push(whole(&scene)?);
        }
        Ok(Grown { geometries, scene: Arc::new(scene) })
    }
}

/// A model without instances.
fn flat(model: &str, cx: &LoadCx) -> Result<(Arc<Scene>, Arc<Geometry>), LoadError> {
    let mut scene = scene::open(model, cx)?;
    let geometry = scene.gather(true, cx).map_err(|reason| reason.of(model))?;
    Ok((Arc::new(scene), Arc::new(geometry)))
}

/// A structure to be built, and how.
#[derive(Clone, Debug)]
pub struct Candidate {
    /// Which.
    pub entry: &'static Entry,
    /// Its parameters.
    pub params: ParamValues,
}

/// How often to build.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BuildRounds {
    /// Builds of one structure over one model, at most.
    pub rounds: usize,
    /// No further one is begun after so many seconds of its builds.
    pub secs: f64,
}

/// A structure over one model, after its builds.
#[derive(Clone, Default)]
struct Lane {
    accel: Option<Arc<dyn Accel>>,
    secs: Vec<f64>,
    error: Option<String>,
}

impl Lane {
    fn wants_more(&self, rounds: &BuildRounds) -> bool {
        let enough = self.secs.len() >= rounds.rounds.max(1) || self.secs.iter().sum::<f64>() >= rounds.secs;
        self.error.is_none() && (self.secs.is_empty() || !enough)
    }

    fn build(&mut self, candidate: &Candidate, geometry: &Arc<Geometry>, test: TestKind, cx: &BuildCx) -> Result<(), BuildError> {
        // The one before goes first: two at a time may not fit.
        self.accel = None;
        match build_timed(candidate.entry, geometry, test, &candidate.params, cx) {
            Ok(BuiltRow { accel, build_secs, .. }) => {
                self.secs.push(build_secs);
                self.accel = Some(accel);
            }
            Err(BuildError::Cancelled(cancelled)) => return Err(cancelled.into()),
            Err(why) => self.error = Some(format!("{} triangles: {why}", geometry.live_count())),
        }
        Ok(())
    }
}

/// Builds every candidate over every model, in rounds that take turns, and then times all of them on
/// one set of rays, in turns too: whatever drifts meanwhile meets every size and every structure.
///
/// `progress` hears of the rounds; the builds have their own.
///
/// # Errors
/// [`BuildError::Cancelled`] alone: what cannot be built is told in its row.
pub fn scaling(
    candidates: &[Candidate],
    models: &[Arc<Geometry>],
    set: &RaySet,
    test: TestKind,
    (rounds, options): (&BuildRounds, &MeasureOptions),
    (cx, progress): (&BuildCx, &Progress),
) -> Result<Vec<Scaling>, BuildError> {
    let mut lanes = vec![Lane::default(); candidates.len() * models.len()];
    for _ in 0..rounds.rounds.max(1) {
        progress.start("build", lanes.len() as u64);
        for (i, lane) in lanes.iter_mut().enumerate() {
            let (candidate, model) = (&candidates[i / models.len()], &models[i % models.len()]);
            if lane.wants_more(rounds) {
                let quiet = BuildCx { progress: Progress::new(), ..cx.clone() };
                lane.build(candidate, model, test, &quiet)?;
            }
            progress.advance(1);
        }
    }
    let built = || lanes.iter().enumerate().filter_map(|(i, lane)| Some((i, lane.accel.clone()?)));
    let contestants: Vec<Contestant> = built().map(|(i, accel)| Contestant { id: i.to_string(), accel }).collect();
    let timings = measure(&contestants, set, options, &cx.pool, &cx.cancel, progress)?;
    let mut points = vec![None; lanes.len()];
    for ((i, _), timing) in built().zip(timings) {
        let per_ray = |secs: f64| secs / timing.rays as f64;
        points[i] = Some(Point {
            triangles: models[i % models.len()].live_count() as u64,
            build_secs: median(&lanes[i].secs),
            build_spread: half_iqr(&lanes[i].secs),
            builds: lanes[i].secs.len(),
            ray_secs: per_ray(timing.secs_median),
            ray_spread: per_ray(timing.secs_half_iqr),
            rays: timing.rays,
            rounds: timing.rounds,
        });
    }
    let rows = candidates.iter().zip(points.chunks(models.len().max(1)).zip(lanes.chunks(models.len().max(1))));
    Ok(rows.map(|(candidate, (points, lanes))| Scaling::of(candidate, points, lanes)).collect())
}

impl Scaling {
    fn of(candidate: &Candidate, points: &[Option<Point>], lanes: &[Lane]) -> Self {
        let points: Vec<Point> = points.iter().flatten().cloned().collect();
        let exponent = |secs: fn(&Point) -> f64| Exponent::of(points.iter().map(|p| (p.triangles as f64, secs(p))));
        let (build, ray) = (exponent(|p| p.build_secs), exponent(|p| p.ray_secs));
        let error = lanes.iter().find_map(|lane| lane.error.clone());
        Self { id: candidate.entry.id.to_owned(), points, build, ray, error }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::task::{Budget, Cancel, Pool};

    #[test]
    fn a_power_law_has_its_power() {
        let law = |power: f64| [1e3, 1e4, 1e5, 1e6].map(|n: f64| (n, 3e-7 * n.powf(power)));
        for power in [0.0, 0.5, 1.0, 1.07] {
            let found = Exponent::of(law(power)).expect("four sizes");
            assert!((found.value - power).abs() < 1e-12 && found.error < 1e-12, "{found:?}");
        }
        // By hand: the spread of x is 5, its product with y -0.1, and 0.018 is left of the squares of y.
        let off = [(0.0, 0.0), (1.0, 0.1), (2.0, -0.1), (3.0, 0.0)].map(|(x, y): (f64, f64)| (x.exp(), y.exp()));
        let found = Exponent::of(off).expect("four sizes");
        assert!((found.value + 0.02).abs() < 1e-12 && (found.error - (0.018f64 / 2.0 / 5.0).sqrt()).abs() < 1e-12, "{found:?}");
        assert!(Exponent::of([(1e3, 1.0)]).is_none() && Exponent::of([(1e3, 1.0), (1e4, f64::NAN)]).is_none());
    }

    #[test]
    fn a_scene_is_made_in_each_size_and_one_of_a_fixed_size_is_cut_finer() {
        let cx = LoadCx::new(Cancel::new(), Progress::new(), Budget::unlimited(), Pool::new("load", 1));
        let counts = |sizes: &Sizes, model: &str| -> Vec<usize> {
            let grown = sizes.of(model, &cx).expect("made");
            grown.geometries.iter().map(|geometry| geometry.live_count()).collect()
        };
        let made = counts(&Sizes { from: 100, to: 1600, steps: 3 }, "builtin:soup");
        assert_eq!(made, [100, 400, 1600]);
        let own = counts(&Sizes { from: 100, to: 0, steps: 3 }, "builtin:soup?triangles=50");
        assert_eq!(own, [50], "as it is");
        let cut = counts(&Sizes { from: 1, to: 900, steps: 3 }, "builtin:soup?triangles=50");
        assert_eq!(cut, [50, 200, 800]);
        assert!(Sizes { from: 1, to: 9, steps: 2 }.of("builtin:nothing", &cx).is_err());
    }

    #[test]
    fn what_is_said_of_a_model_is_said_of_the_finest_too() {
        let cx = LoadCx::new(Cancel::new(), Progress::new(), Budget::unlimited(), Pool::new("load", 1));
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("one.stl");
        // A triangle, and as much again behind it.
        let corners: Vec<u8> = [0.0f32, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0].map(f32::to_le_bytes).concat();
        std::fs::write(&path, [&[0u8; 80][..], &1u32.to_le_bytes(), &corners, &[0; 2 + 50]].concat()).expect("room on the disk");
        let model = path.to_string_lossy().into_owned();
        let warned = scene::open(&model, &cx).expect("a triangle").warnings;
        let grown = Sizes { from: 1, to: 20, steps: 3 }.of(&model, &cx).expect("a triangle");
        assert!(!warned.is_empty() && grown.geometries.len() == 3 && grown.scene.warnings == warned, "{warned:?}");
    }
}
