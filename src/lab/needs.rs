//! What leaving out saves: a scene as it is kept, beside the same one with everything that a scene can have
//! ([`Keep::All`](crate::scene::Keep::All)), in bytes and in nanoseconds of a ray.
//!
//! Each saving of time is measured by itself, on one thread and in turns: shading of the same hits with one thing more to
//! look for, or the same rays with the test for holes or an upper level more. Where a scene uses something there is
//! nothing to save, and its time is not taken.

use std::sync::Arc;
use std::time::Instant;

use serde::Serialize;

use super::statistics::{half_iqr, median};
use crate::accel::{self, Accel, Hit};
use crate::geometry::Ray;
use crate::render::{Job, Looks, Mode};
use crate::scene::{Camera, Feature, Finding, Geometry, Needs, Scene};
use crate::task::{Cancel, Cancelled, Progress};

/// A scene, kept in one way, with what was made of it.
#[derive(Clone)]
pub struct Kept {
    /// The model.
    pub scene: Arc<Scene>,
    /// What the structure was built over.
    pub geometry: Arc<Geometry>,
    /// The structure.
    pub accel: Arc<dyn Accel>,
    /// Textures, and what of them is needed.
    pub looks: Arc<Looks>,
}

/// What of a scene is used and what is left out. Field names are the schema: they stay.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct NeedsReport {
    /// Every feature.
    pub features: Vec<FeatureRow>,
    /// Bytes of model, triangles, structure and textures.
    pub total_bytes: u64,
    /// The same if everything were kept.
    pub forced_bytes: u64,
    /// Camera rays that times were taken with.
    pub rays: usize,
    /// Of these, the ones that hit something.
    pub hits: usize,
}

/// A feature, and what leaving it out saves.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FeatureRow {
    /// Its name in files.
    pub id: &'static str,
    /// Its name in the window.
    #[serde(skip)]
    pub name: &'static str,
    /// Whether the scene uses it.
    pub used: bool,
    /// Why, in a sentence.
    pub why: String,
    /// Bytes less than with it, for all of the scene that does not use it; below 0 where leaving it out takes more.
    pub bytes_saved: i64,
    /// Nanoseconds less for a camera ray, the median over rounds; 0 where it is used, or is no matter of time.
    pub ns_per_ray_saved: f64,
    /// Half the interquartile range of that.
    pub ns_spread: f64,
}

impl Kept {
    /// Bytes of the structure and of what it was built over.
    fn structure_bytes(&self) -> u64 {
        self.geometry.bytes() + self.accel.memory().iter().map(|part| part.bytes).sum::<u64>()
    }

    fn bytes(&self) -> u64 {
        self.scene.bytes().total() + self.looks.textures().bytes() + self.structure_bytes()
    }

    fn job(&self, camera: Camera, looks: Arc<Looks>) -> Job {
        Job::new(Arc::clone(&self.scene), Arc::clone(&self.accel), camera, Mode::Shaded, looks)
    }
}

/// What is timed of some rays.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Work {
    Trace,
    Shade,
}

struct Lane<'a> {
    job: Job,
    work: Work,
    rays: &'a [Ray],
    hits: Vec<Option<Hit>>,
    samples: Vec<[f32; 4]>,
    secs: Vec<f64>,
}

impl<'a> Lane<'a> {
    fn new(job: Job, work: Work, rays: &'a [Ray], hits: &[Option<Hit>]) -> Self {
        Self { job, work, rays, hits: hits.to_vec(), samples: vec![[0.0; 4]; rays.len()], secs: Vec::new() }
    }

    fn round(&mut self, cancel: &Cancel) -> Result<(), Cancelled> {
        let start = Instant::now();
        let chunks = self.rays.chunks(CHUNK).zip(self.hits.chunks_mut(CHUNK)).zip(self.samples.chunks_mut(CHUNK));
        for ((rays, hits), samples) in chunks {
            cancel.check()?;
            match self.work {
                Work::Trace => self.job.trace(rays, accel::Mode::Closest, hits, cancel)?,
                Work::Shade => self.job.shade(rays, hits, samples),
            }
        }
        self.secs.push(start.elapsed().as_secs_f64());
        Ok(())
    }

    /// Nanoseconds of a ray more than another lane's, in each round.
    fn over(&self, other: &Self) -> Vec<f64> {
        let per_ray = 1e9 / self.rays.len().max(1) as f64;
        self.secs.iter().zip(&other.secs).map(|(a, b)| (a - b) * per_ray).collect()
    }
}

/// Rays that are traced or shaded at a time, about as many as the renderer's.
const CHUNK: usize = 4096;
/// The fewest rounds.
const MIN_ROUNDS: usize = 15;
/// After so many seconds there are no more rounds than that.
const SECS: f64 = 2.0;
/// The most rounds.
const MAX_ROUNDS: usize = 101;

/// Looks what a scene uses. `kept` is what is in use, `forced` the same model with everything; the camera sees it in
/// `size` pixels.
///
/// # Errors
/// [`Cancelled`] within 100 ms of the request.
pub fn needs(
    kept: &Kept,
    forced: &Kept,
    (camera, [width, height]): (Camera, [u32; 2]),
    cancel: &Cancel,
    progress: &Progress,
) -> Result<NeedsReport, Cancelled> {
    let job = kept.job(camera, Arc::clone(&kept.looks));
    let rays = job.camera_rays(width, height, 0..height, 0);
    let mut hits = vec![None; rays.len()];
    for (rays, hits) in rays.chunks(CHUNK).zip(hits.chunks_mut(CHUNK)) {
        job.trace(rays, accel::Mode::Closest, hits, cancel)?;
    }
    let needs = kept.looks.needs();
    let times = times(kept, forced, camera, (&rays, &hits), cancel, progress)?;
    let (ours, theirs) = (kept.scene.bytes(), forced.scene.bytes());
    let images = |side: &Kept, rest: u64| side.looks.textures().bytes() + rest;
    let saved = |feature: Feature| match feature {
        Feature::Normals => theirs.normals.checked_signed_diff(ours.normals),
        Feature::VertexColors => theirs.colors.checked_signed_diff(ours.colors),
        Feature::Uvs => theirs.uvs.checked_signed_diff(ours.uvs),
        Feature::Corners => theirs.corners.checked_signed_diff(ours.corners),
        Feature::UnplacedMeshes => theirs.unplaced.checked_signed_diff(ours.unplaced),
        Feature::UnusedImages => images(forced, theirs.rest).checked_signed_diff(images(kept, ours.rest)),
        Feature::Instancing => forced.structure_bytes().checked_signed_diff(kept.structure_bytes()),
        _ => None,
    };
    let row = |Finding { feature, used, why }: Finding| {
        let ns = times.iter().find(|(of, _)| *of == feature).map_or(&[][..], |(_, ns)| ns);
        let [ns_per_ray_saved, ns_spread] = if ns.is_empty() { [0.0; 2] } else { [median(ns), half_iqr(ns)] };
        FeatureRow {
            id: feature.id(),
            name: feature.name(),
            used,
            why,
            bytes_saved: saved(feature).unwrap_or(0),
            ns_per_ray_saved,
            ns_spread,
        }
    };
    Ok(NeedsReport {
        features: needs.findings(&kept.scene).into_iter().map(row).collect(),
        total_bytes: kept.bytes(),
        forced_bytes: forced.bytes(),
        rays: rays.len(),
        hits: hits.iter().flatten().count(),
    })
}

/// For each feature that is left out and takes time, how many nanoseconds more a ray takes with it, in each round.
fn times(
    kept: &Kept,
    forced: &Kept,
    camera: Camera,
    (rays, hits): (&[Ray], &[Option<Hit>]),
    cancel: &Cancel,
    progress: &Progress,
) -> Result<Vec<(Feature, Vec<f64>)>, Cancelled> {
    let needs = kept.looks.needs();
    let lane = |job: Job, work| Lane::new(job, work, rays, hits);
    let shaded = |needs: Needs| {
        // The textures of everything, and the shading of the scene with one thing more.
        let looks = forced.looks.with_shading(needs);
        lane(forced.job(camera, Arc::new(looks)), Work::Shade)
    };
    let mut lanes = vec![
        lane(kept.job(camera, Arc::clone(&kept.looks)), Work::Shade),
        lane(kept.job(camera, Arc::clone(&kept.looks)), Work::Trace),
    ];
    // Which lane has it, and which has everything but it.
    let mut with: Vec<(Feature, usize, usize)> = Vec::new();
    for feature in [Feature::Normals, Feature::VertexColors, Feature::ColorMaps, Feature::Transforms] {
        if needs.has(feature) {
            continue;
        }
        let mut without = 0;
        if feature == Feature::Transforms && !needs.has(Feature::Normals) {
            // There are none to be turned: what turning would add to having them.
            without = with.iter().find(|(of, ..)| *of == Feature::Normals).map_or(0, |(_, lane, _)| *lane);
        }
        let base = if without == 0 { needs } else { needs.with(Feature::Normals) };
        with.push((feature, lanes.len(), without));
        lanes.push(shaded(base.with(feature)));
    }
    if !needs.has(Feature::AlphaTest) {
        with.push((Feature::AlphaTest, lanes.len(), 1));
        let tested = Job { scene: Arc::clone(&forced.scene), ..kept.job(camera, Arc::clone(&forced.looks)) };
        lanes.push(lane(tested, Work::Trace));
    }
    if !needs.has(Feature::Instancing) {
        with.push((Feature::Instancing, lanes.len(), 1));
        let above = Job { scene: Arc::clone(&kept.scene), ..forced.job(camera, Arc::clone(&kept.looks)) };
        lanes.push(lane(above, Work::Trace));
    }
    progress.start("measure", MAX_ROUNDS as u64);
    // The first round warms up. All do as many, since they are compared round by round, each begun by another one.
    lanes.iter_mut().try_for_each(|lane| lane.round(cancel))?;
    lanes.iter_mut().for_each(|lane| lane.secs.clear());
    let (start, n) = (Instant::now(), lanes.len());
    for round in 0..MAX_ROUNDS {
        if round >= MIN_ROUNDS && start.elapsed().as_secs_f64() > SECS {
            break;
        }
        for i in 0..n {
            lanes[(round + i) % n].round(cancel)?;
        }
        progress.advance(1);
    }
    progress.finish();
    let over = |(feature, lane, without): (Feature, usize, usize)| (feature, lanes[lane].over(&lanes[without]));
    Ok(with.into_iter().map(over).collect())
}
