//! What quality costs: for every builder and structure how good it is against how long it takes to build, and for every
//! triangle test in it, and each test of boxes, how often and how far it errs against how long a ray takes. Nobody is best at
//! both: those that no other beats at both are the front (Pareto).

use std::collections::BTreeMap;
use std::sync::Arc;
use std::time::Instant;

use rayon::prelude::*;
use serde::Serialize;

use super::boxed::Boxed;
use super::building::build_timed;
use super::costs::{Costs, FitOptions, fit_costs};
use super::measure::{Contestant, MeasureOptions, measure};
use super::mesh_check::check;
use super::model_check::CheckError;
use super::quality::{Quality, QualityOptions};
use super::rays::{RayKind, RaySet};
use super::report::CostRow;
use super::stability::{Answers, BoxTest, Reference, answers_of};
use crate::accel::params::{Kind, ParamValues};
use crate::accel::registry::{Entry, Family};
use crate::accel::stats::{SahWeights, Stats};
use crate::accel::{Accel, BuildCx, BuildError, Hit, Mode};
use crate::geometry::Ray;
use crate::geometry::tri::TestKind;
use crate::render::Job;
use crate::scene::Geometry;
use crate::task::{Cancel, Cancelled, Pool, Progress};

/// A structure, built in one of its ways.
#[derive(Clone, Debug)]
pub struct Variant {
    /// Which structure.
    pub entry: &'static Entry,
    /// With what parameters.
    pub params: ParamValues,
    /// What it is called: its id, and what differs from its defaults.
    pub name: String,
}

impl Variant {
    /// Whether it is a structure as it comes.
    pub fn is_plain(&self) -> bool {
        self.name == self.entry.id
    }

    /// Structures as they come, and the BVH by each of its builders.
    pub fn all_of(entries: &[(&'static Entry, ParamValues)]) -> Vec<Self> {
        let mut variants = Vec::new();
        for (entry, params) in entries {
            variants.push(Self { entry, params: params.clone(), name: entry.id.to_owned() });
            let builders = entry.params.iter().find(|param| param.id == "builder" && entry.family == Family::Bvh);
            let Some(Kind::Choice { options }) = builders.map(|param| param.kind) else { continue };
            // The first picks one of the others.
            for builder in options.iter().skip(1).filter(|_| entry.id == "bvh") {
                let mut params = params.clone();
                if params.set("builder", builder).is_ok() {
                    variants.push(Self { entry, params, name: format!("{} {builder}", entry.id) });
                }
            }
        }
        variants
    }
}

/// How good a structure is, and what that takes.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct TradeoffRow {
    /// The variant's name.
    pub name: String,
    /// The structure's id.
    pub structure: String,
    /// Wall-clock seconds of the build.
    pub build_secs: f64,
    /// Its SAH cost; comparable within one family only.
    pub sah: f64,
    /// End-point overlap, where it can be told.
    pub epo: Option<f64>,
    /// Nanoseconds of a random line that nothing cuts short, as the areas of the cells and the fitted costs predict.
    pub predicted_ns: Option<f64>,
    /// Those costs: fitted to random lines, primary, shadow and diffuse rays of the view in this structure.
    pub costs: Option<Costs>,
    /// Seconds that the prediction took: the walk over the cells, and timing and counting rays for the fit.
    pub prediction_secs: Option<f64>,
    /// Nanoseconds of a thread for a ray, measured while all threads are at work, by kind.
    pub ns: BTreeMap<RayKind, f64>,
    /// By triangle test, on rays that are hard for them.
    pub tests: Vec<TestRow>,
    /// By test of boxes, in a plain tree of the boxes of `bvh` with the watertight test; of no other structure.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub boxes: Vec<BoxTestRow>,
    /// Why there is no more, in words for the user.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub error: Option<String>,
}

/// How a triangle test errs in a structure, and what a ray takes with it.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct TestRow {
    /// The test.
    pub test: TestKind,
    /// How it errs.
    #[serde(flatten)]
    pub erring: Erring,
}

/// The same of a test of boxes.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct BoxTestRow {
    /// The test.
    pub test: BoxTest,
    /// How it errs.
    #[serde(flatten)]
    pub erring: Erring,
}

/// How often and how far answers to hard rays are off, and what they take.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Erring {
    /// Nanoseconds of a thread for a hard ray.
    pub ns: f64,
    /// Hard rays that were judged.
    pub rays: usize,
    /// Of a million of them, those answered wrongly.
    pub wrong_per_million: f64,
    /// Of a million of them, those that meet another triangle than they do exactly, or none, as rounding may have it.
    pub rounded_per_million: f64,
    /// What the distance of t from that of the exact test exceeds in one hit of a thousand, in units in the last place.
    pub p999_ulps: f64,
}

impl TradeoffRow {
    /// By how much the prediction is above what rays of a kind take, as a share of that.
    pub fn prediction_error(&self, kind: RayKind) -> Option<f64> {
        let (predicted, measured) = (self.predicted_ns?, self.ns.get(&kind)?);
        Some(predicted / measured - 1.0)
    }
}

/// Rays of a view, and what answers them exactly.
pub struct Tradeoffs {
    reference: Reference,
    sets: Vec<RaySet>,
    hard: RaySet,
    exact: Vec<Option<Hit>>,
}

/// Hard rays, at most.
const HARD: usize = 24_000;
/// Rays traced at a time.
const CHUNK: usize = 256;
/// Seconds that a structure is judged for.
const JUDGED: f64 = 0.5;

impl Tradeoffs {
    /// Of the view of a job, whose structure finds the first hits: primary, shadow and diffuse rays and random lines; and
    /// hard ones, to corners and middles of edges of what is seen.
    ///
    /// # Errors
    /// Stopped, or what answers exactly does not fit.
    pub fn new(job: &Job, [width, height]: [u32; 2], cx: &BuildCx) -> Result<Self, CheckError> {
        let geometry = job.accel.geometry();
        cx.progress.start("exact answers", 1);
        let closed = job.accel.levels().is_none() && check(geometry, cx)?.is_closed();
        let reference = Reference::build(geometry, closed, cx)?;
        let mut sets = Vec::new();
        for kind in [RayKind::Primary, RayKind::Shadow, RayKind::Diffuse] {
            sets.push(RaySet::generate(kind, job, width, height, &cx.pool, &cx.cancel)?);
        }
        let rays = hard_rays(job, &sets[0].rays, &cx.cancel)?;
        sets.push(RaySet::lines(geometry, 1 << 14, &cx.pool, &cx.cancel)?);
        let hard = RaySet { rays, ..sets[0].clone() };
        let mut exact = vec![None; hard.rays.len()];
        reference.accel.trace(&hard.rays, Mode::Closest, &mut exact, &cx.cancel)?;
        Ok(Self { reference, sets, hard, exact })
    }

    /// Builds and measures one variant with each triangle test; what does not fit is told in its row.
    ///
    /// # Errors
    /// [`Cancelled`] if asked to stop.
    pub fn measure(&self, variant: &Variant, geometry: &Arc<Geometry>, cx: &BuildCx) -> Result<TradeoffRow, Cancelled> {
        let mut row = TradeoffRow {
            name: variant.name.clone(),
            structure: variant.entry.id.to_owned(),
            sah: f64::NAN,
            build_secs: f64::NAN,
            ..TradeoffRow::default()
        };
        let mut built: Vec<(TestKind, Arc<dyn Accel>)> = Vec::new();
        for test in TestKind::ALL {
            match build_timed(variant.entry, geometry, test, &variant.params, cx) {
                Ok(one) => {
                    if built.is_empty() {
                        row.build_secs = one.build_secs;
                    }
                    built.push((test, one.accel));
                }
                Err(BuildError::Cancelled(cancelled)) => return Err(cancelled),
                Err(error) => {
                    row.error = Some(error.to_string());
                    return Ok(row);
                }
            }
        }
        let Some((_, first)) = built.first() else { return Ok(row) };
        self.model(&mut row, first, SahWeights::of(&variant.params), cx)?;
        self.tests(&mut row, &built, cx)?;
        // Of instances there is no one tree.
        if variant.name == "bvh" && first.levels().is_none() {
            match Boxed::of(first.as_ref(), &cx.budget, &cx.cancel) {
                Ok(tree) => row.boxes = self.boxes(&tree, cx)?,
                Err(BuildError::Cancelled(cancelled)) => return Err(cancelled),
                Err(error) => row.error = Some(error.to_string()),
            }
        }
        Ok(row)
    }

    /// How good the structure is.
    fn model(&self, row: &mut TradeoffRow, accel: &Arc<dyn Accel>, weights: SahWeights, cx: &BuildCx) -> Result<(), Cancelled> {
        let (pool, cancel, quiet) = (&cx.pool, &cx.cancel, Progress::new());
        let start = Instant::now();
        let stats = Stats::of_structure(accel.as_ref(), weights, cancel)?;
        let walk = start.elapsed();
        let options = QualityOptions { epo_most: Some(20_000), lines: None, ..QualityOptions::default() };
        let quality = Quality::of(accel.as_ref(), &stats, weights, &options, (pool, &cx.budget, cancel))?;
        row.sah = stats.sah;
        row.epo = quality.epo.map(|epo| epo.value);
        let contestant = [Contestant { id: row.name.clone(), accel: Arc::clone(accel) }];
        for set in &self.sets {
            let timing = measure(&contestant, set, &TIMES, pool, cancel, &quiet)?;
            row.ns.extend(timing.first().map(|timing| (set.kind, ns_per_ray(timing, pool))));
        }
        let sets: Vec<&RaySet> = self.sets.iter().collect();
        let start = Instant::now();
        let costs = fit_costs(&contestant, &sets, &FitOptions { rounds: 3, cap_secs: 0.5 }, pool, cancel, &quiet)?;
        let took = (walk + start.elapsed()).as_secs_f64();
        row.costs = costs.into_iter().next().flatten();
        row.predicted_ns = row.costs.clone().map(|costs| CostRow::of(costs, &quality).expected_ns);
        row.prediction_secs = row.predicted_ns.map(|_| took);
        Ok(())
    }

    /// How its triangle tests err, in turns.
    fn tests(&self, row: &mut TradeoffRow, built: &[(TestKind, Arc<dyn Accel>)], cx: &BuildCx) -> Result<(), Cancelled> {
        let (pool, cancel) = (&cx.pool, &cx.cancel);
        let contestant =
            |(test, accel): &(TestKind, Arc<dyn Accel>)| Contestant { id: test.id().to_owned(), accel: Arc::clone(accel) };
        let contestants: Vec<Contestant> = built.iter().map(contestant).collect();
        let timings = measure(&contestants, &self.hard, &TIMES, pool, cancel, &Progress::new())?;
        for ((test, accel), timing) in built.iter().zip(timings) {
            let answers = answers_of(accel.as_ref(), cancel);
            let erring = self.erring(*test, &answers, ns_per_ray(&timing, pool), pool, cancel)?;
            row.tests.push(TestRow { test: *test, erring });
        }
        Ok(())
    }

    /// How tests of boxes err, in turns.
    fn boxes(&self, tree: &Boxed, cx: &BuildCx) -> Result<Vec<BoxTestRow>, Cancelled> {
        let (pool, cancel) = (&cx.pool, &cx.cancel);
        let secs = tree.times(&self.hard.rays, &TIMES, pool, cancel)?;
        let row = |(test, secs): (BoxTest, f64)| {
            let answers = |rays: &[Ray], hits: &mut [Option<Hit>]| tree.trace(test, rays, hits, cancel);
            let ns = secs * 1e9 * pool.threads() as f64 / self.hard.rays.len().max(1) as f64;
            Ok(BoxTestRow { test, erring: self.erring(TestKind::Watertight, &answers, ns, pool, cancel)? })
        };
        BoxTest::ALL.into_iter().zip(secs).map(row).collect()
    }

    /// What answers that are given with a triangle test are off by.
    fn erring(&self, test: TestKind, answers: Answers<'_>, ns: f64, pool: &Pool, cancel: &Cancel) -> Result<Erring, Cancelled> {
        let judged = self.reference.compare(("", test), answers, &self.hard.rays, JUDGED, pool, cancel)?;
        let per_million = |n: usize| 1e6 * n as f64 / judged.rays.max(1) as f64;
        Ok(Erring {
            ns,
            rays: judged.rays,
            wrong_per_million: per_million(judged.wrong),
            rounded_per_million: per_million(judged.rounded),
            p999_ulps: self.p999_ulps(answers, judged.rays, pool)?,
        })
    }

    /// Over hits on the triangle that is hit exactly, of about so many rays: a slow structure was not asked more.
    fn p999_ulps(&self, answers: Answers<'_>, rays: usize, pool: &Pool) -> Result<f64, Cancelled> {
        let every = self.hard.rays.len().div_ceil(rays.max(1)).max(1);
        let some: Vec<Ray> = self.hard.rays.iter().step_by(every).copied().collect();
        let mut hits = vec![None; some.len()];
        let trace = |(rays, hits): (&[Ray], &mut [Option<Hit>])| answers(rays, hits);
        pool.run(|| some.par_chunks(CHUNK).zip(hits.par_chunks_mut(CHUNK)).try_for_each(trace))?;
        let exact = self.exact.iter().step_by(every);
        let both = hits.iter().zip(exact).filter_map(|(a, b)| a.zip(*b));
        let same = both.filter(|(a, b)| (a.instance, a.primitive) == (b.instance, b.primitive));
        let mut errors: Vec<f64> = same.map(|(a, b)| f64::from((a.t - b.t).abs() / ulp(b.t))).collect();
        errors.sort_unstable_by(f64::total_cmp);
        Ok(errors.len().checked_sub(1 + errors.len() / 1000).map_or(f64::NAN, |at| errors[at]))
    }
}

/// Three rounds and a fifth of a second: many structures wait for their turn.
const TIMES: MeasureOptions =
    MeasureOptions { min_rounds: 3, min_secs: 0.2, cap_secs: 1.5, fairness: super::measure::Fairness::LikeForLike };

/// Of one thread: what all have taken together.
fn ns_per_ray(timing: &super::Timing, pool: &Pool) -> f64 {
    timing.secs_median * 1e9 * pool.threads() as f64 / timing.rays.max(1) as f64
}

/// The distance from a number to the next.
fn ulp(x: f32) -> f32 {
    x.abs().next_up() - x.abs()
}

/// Rays to the corners and the middles of the edges of triangles that are seen: where tests have to decide to whom a point
/// belongs.
fn hard_rays(job: &Job, primary: &[Ray], cancel: &Cancel) -> Result<Vec<Ray>, Cancelled> {
    let geometry = job.accel.geometry();
    let every = (primary.len() * 6).div_ceil(HARD).max(1);
    let some: Vec<Ray> = primary.iter().step_by(every).copied().collect();
    let mut hits = vec![None; some.len()];
    job.accel.trace(&some, Mode::Closest, &mut hits, cancel)?;
    let mut hard = Vec::new();
    for (ray, hit) in some.iter().zip(hits) {
        let Some(hit) = hit else { continue };
        let [a, b, c] = geometry.corners_of(hit.instance, hit.primitive);
        for place in [a, b, c, (a + b) * 0.5, (b + c) * 0.5, (c + a) * 0.5] {
            let dir = geometry.space().world_point(place) - ray.origin;
            if dir.is_finite() && dir.length_squared() > 0.0 {
                hard.push(Ray::new(ray.origin, dir));
            }
        }
    }
    Ok(hard)
}

/// For each point whether no other is at least as good in both coordinates, and better in one: less is better.
pub fn front(points: &[(f64, f64)]) -> Vec<bool> {
    let beaten = |p: &(f64, f64)| points.iter().any(|q| q.0 <= p.0 && q.1 <= p.1 && (q.0 < p.0 || q.1 < p.1));
    points.iter().map(|p| p.0.is_finite() && p.1.is_finite() && !beaten(p)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accel::registry;

    #[test]
    fn the_front_is_what_nobody_beats_at_both() {
        let points = [(1.0, 9.0), (2.0, 4.0), (3.0, 5.0), (4.0, 1.0), (4.0, 1.0), (9.0, f64::NAN), (5.0, 1.0)];
        assert_eq!(front(&points), [true, true, false, true, true, false, false]);
        assert!(front(&[]).is_empty());
    }

    #[test]
    fn variants_are_structures_and_builders_once_each() {
        let entries: Vec<_> = registry::ALL.iter().map(|entry| (entry, entry.defaults())).collect();
        let names: Vec<String> = Variant::all_of(&entries).into_iter().map(|v| v.name).collect();
        assert!(names.len() >= registry::ALL.len() + 6 && names.contains(&"bvh ploc".to_owned()), "{names:?}");
        let mut once = names.clone();
        once.sort();
        once.dedup();
        assert_eq!(once.len(), names.len());
    }
}
