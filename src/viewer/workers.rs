//! The long work of the window, each piece a background job: loading, building, statistics,
//! overlays, measuring. At most one of each runs.

use std::sync::mpsc::Sender;
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::JoinHandle;

use super::checks::{RAYS, SEED};
use super::kept::{Built, Key};
use super::model::{self, Instances, Model};
use super::overlay::{self, Collected, Known, Wanted};
use super::panes::Pauses;
use super::pick::{self, Picked};
use super::shown;
use super::tree::Listed;
use crate::accel::outline::{Outline, OutlineError};
use crate::accel::registry;
use crate::accel::stats::{SahWeights, Stats};
use crate::accel::{Accel, BuildCx, BuildError, Cell, CellId, Visibility};
use crate::geometry::Ray;
use crate::geometry::tri::TestKind;
use crate::job::Job;
use crate::lab::converge::Reference;
use crate::lab::findings::{self, Findings};
use crate::lab::follow::{self, Followed};
use crate::lab::needs::{Kept, NeedsReport};
use crate::lab::stability::{self, CaseRow, cases};
use crate::lab::tradeoffs::{TradeoffRow, Tradeoffs, Variant};
use crate::lab::{
    self, CheckError, Checked, Contestant, Costs, Enough, Fairness, FitOptions, ImageErrors, MeasureOptions, ModelCheck, Quality,
    QualityOptions, RasterRow, RayKind, RaySet, SahCurves, Timing, fit_costs, measure, measure_with_raster, sah_curves,
};
use crate::render::{self, Looks, Picture, Shot, Tone};
use crate::scene::texture::Detail;
use crate::scene::{Camera, Finding, Geometry, Keep, LoadCx, LoadError, Scene};
use crate::task::{Budget, Cancel, Cancelled, Pool, Progress};

/// What every job needs: threads, memory, and a way to wake the window.
#[derive(Clone)]
pub struct Shared {
    /// For loading, building and measuring.
    pub pool: Pool,
    /// For everything that is large.
    pub budget: Budget,
    /// Makes the window draw a frame.
    pub wake: Arc<dyn Fn() + Send + Sync>,
    /// Threads that give memory back.
    giving_back: Arc<Mutex<Vec<JoinHandle<()>>>>,
}

impl Shared {
    /// Threads, memory, and whom to wake.
    pub fn new(pool: Pool, budget: Budget, wake: Arc<dyn Fn() + Send + Sync>) -> Self {
        Self { pool, budget, wake, giving_back: Arc::default() }
    }

    /// Gives something large back on a thread of its own: to unmap gibibytes takes the system longer than a frame.
    pub fn give_back(&self, large: impl Send + 'static) {
        // Without a thread it is done here, as the closure is dropped.
        if let Ok(thread) = std::thread::Builder::new().name("give back".into()).spawn(move || drop(large)) {
            self.giving_back.lock().unwrap_or_else(PoisonError::into_inner).push(thread);
        }
    }

    /// Waits until all of that is back, so that what follows finds the room. Not for the window's thread.
    pub fn wait_for_memory(&self) {
        let threads = std::mem::take(&mut *self.giving_back.lock().unwrap_or_else(PoisonError::into_inner));
        threads.into_iter().for_each(|thread| drop(thread.join()));
    }

    /// Wakes the window once a job is done.
    pub fn waker(&self) -> impl FnOnce() + Send + 'static + use<> {
        let wake = Arc::clone(&self.wake);
        move || wake()
    }
}

/// A model on its way.
pub type Loading = Job<Result<Model, LoadError>>;

/// Starts loading.
pub fn load(shared: &Shared, model: String, generation: u64, instances: Instances) -> std::io::Result<Loading> {
    let Shared { pool, budget, .. } = shared.clone();
    Job::spawn("load", shared.waker(), move |cancel, progress| {
        let cx = LoadCx::new(cancel.clone(), progress.clone(), budget, pool);
        model::load(&model, generation, instances, &cx)
    })
}

/// A structure on its way.
pub struct Building {
    /// Which one.
    pub key: Key,
    /// The work.
    pub job: Job<Result<Built, BuildError>>,
}

/// Starts a build.
pub fn build(shared: &Shared, key: Key, geometry: Arc<Geometry>) -> std::io::Result<Building> {
    let (shared, wanted) = (shared.clone(), key.clone());
    let job = Job::spawn("build", shared.waker(), move |cancel, progress| {
        shared.wait_for_memory();
        let cx = BuildCx::new(cancel.clone(), progress.clone(), shared.pool, shared.budget);
        build_now(wanted, &geometry, &cx)
    })?;
    Ok(Building { key, job })
}

/// Builds here and now.
pub fn build_now(key: Key, geometry: &Arc<Geometry>, cx: &BuildCx) -> Result<Built, BuildError> {
    let start = std::time::Instant::now();
    let accel: Arc<dyn Accel> = Arc::from(key.entry.build(geometry, key.test, &key.params, cx)?);
    let build_secs = start.elapsed().as_secs_f64();
    Ok(Built { key, accel, build_secs, phases: cx.progress.finish(), stats: None, quality: None })
}

/// Figures on their way, and of what.
pub type Counting = (Key, Job<Result<Stats, Cancelled>>);
/// What is predicted of rays, on its way.
pub type Predicting = (Key, Job<Result<Quality, Cancelled>>);

/// What is found out of a structure while its user waits for the figures: less exactly than on the
/// command line, in a fraction of a second.
const SOON: QualityOptions = QualityOptions {
    alpha: crate::accel::epo::ALPHA,
    epo_most: Some(20_000),
    lines: Some(Enough { three_sigma: 0.02, secs: 0.2, lines: 1 << 17 }),
};

/// Starts working out the figures of a structure.
pub fn count(shared: &Shared, built: &Built) -> std::io::Result<Counting> {
    let (accel, weights) = (Arc::clone(&built.accel), SahWeights::of(&built.key.params));
    let count = move |cancel: &Cancel, _: &Progress| Stats::of_structure(accel.as_ref(), weights, cancel);
    Ok((built.key.clone(), Job::spawn("statistics", shared.waker(), count)?))
}

/// Starts working out what is predicted of rays, from the figures of a structure.
pub fn predict(shared: &Shared, built: &Built, stats: Arc<Stats>) -> std::io::Result<Predicting> {
    let (accel, weights) = (Arc::clone(&built.accel), SahWeights::of(&built.key.params));
    let Shared { pool, budget, .. } = shared.clone();
    let job = Job::spawn("prediction", shared.waker(), move |cancel, _| {
        Quality::of(accel.as_ref(), &stats, weights, &SOON, (&pool, &budget, cancel))
    })?;
    Ok((built.key.clone(), job))
}

/// Textures on their way, and what is known of the scene's needs with them.
pub type Decoding = Job<Result<(Looks, Vec<Finding>), Cancelled>>;

/// Starts decoding the textures of a scene.
pub fn decode(shared: &Shared, scene: Arc<Scene>, detail: Detail) -> std::io::Result<Decoding> {
    let Shared { pool, budget, .. } = shared.clone();
    Job::spawn("textures", shared.waker(), move |cancel, progress| {
        let cx = LoadCx::new(cancel.clone(), progress.clone(), budget, pool);
        let looks = Looks::decode(&scene, detail, &cx)?;
        let needs = looks.needs().findings(&scene);
        Ok((looks, needs))
    })
}

/// What leaving out saves, on its way; or why that can't be told.
pub type Needing = Job<Result<NeedsReport, String>>;

/// Starts measuring what leaving out saves: the model is loaded once more, with everything that it has, and its structure
/// is built. The renderer is kept from running meanwhile.
pub fn needs(
    shared: &Shared,
    (model, shown): (&Model, &Built),
    view: (Camera, [u32; 2]),
    pause: Pauses,
) -> std::io::Result<Needing> {
    let Shared { pool, budget, .. } = shared.clone();
    let (scene, geometry, looks) = (Arc::clone(&model.scene), Arc::clone(&model.geometry), Arc::clone(&model.looks));
    let (kept, key) = (Kept { scene, geometry, accel: Arc::clone(&shown.accel), looks }, shown.key.clone());
    Job::spawn("needs", shared.waker(), move |cancel, progress| {
        pause.wait();
        let cx = LoadCx { keep: Keep::All, ..LoadCx::new(cancel.clone(), progress.clone(), budget.clone(), pool.clone()) };
        let forced = model::load(&kept.scene.name, 0, Instances::Kept, &cx).map_err(|why| why.to_string())?;
        let looks = Arc::new(Looks::decode(&forced.scene, Detail::Colors, &cx).map_err(|why| why.to_string())?);
        let build_cx = BuildCx::new(cancel.clone(), progress.clone(), pool, budget);
        let accel = build_now(key, &forced.geometry, &build_cx).map_err(|why| why.to_string())?.accel;
        let forced = Kept { scene: forced.scene, geometry: forced.geometry, accel, looks };
        lab::needs::needs(&kept, &forced, view, cancel, progress).map_err(|why| why.to_string())
    })
}

/// An overlay on its way.
pub type Collecting = Job<Result<Collected, Cancelled>>;

/// Starts collecting the boxes of a view.
pub fn collect(shared: &Shared, accel: Arc<dyn Accel>, known: Known, wanted: Wanted) -> std::io::Result<Collecting> {
    Job::spawn("overlay", shared.waker(), move |cancel, _| overlay::collect(accel.as_ref(), &known, &wanted, cancel))
}

/// What was clicked, on its way.
pub type Picking = Job<Result<Option<Picked>, Cancelled>>;

/// Starts looking what is under a click: a ray through a structure that is none can take long.
pub fn pick(
    shared: &Shared,
    scene: Arc<Scene>,
    (accel, visible): (Arc<dyn Accel>, Option<Arc<Visibility>>),
    ray: Ray,
) -> std::io::Result<Picking> {
    Job::spawn("pick", shared.waker(), move |cancel, _| pick::pick(&scene, (accel.as_ref(), visible.as_deref()), &ray, cancel))
}

/// The SAH curves of a cell, on their way.
pub type Curving = Job<Result<Option<SahCurves>, Cancelled>>;

/// Starts working out what dividing a cell would have cost.
pub fn curves(shared: &Shared, shown: &Built, cell: Cell) -> std::io::Result<Curving> {
    let (accel, params) = (Arc::clone(&shown.accel), shown.key.params.clone());
    Job::spawn("curves", shared.waker(), move |cancel, _| sah_curves(accel.as_ref(), &cell, &params, cancel))
}

/// The list of a structure's cells, on its way.
pub type Outlining = Job<Result<Listed, OutlineError>>;

/// Starts listing the cells of a structure, but where they are `listed` already.
pub fn outline(shared: &Shared, built: &Built, listed: Option<Arc<Outline>>) -> std::io::Result<Outlining> {
    let (accel, weights) = (Arc::clone(&built.accel), SahWeights::of(&built.key.params));
    let its = shared.clone();
    Job::spawn("outline", shared.waker(), move |cancel, progress| {
        if let Some(outline) = listed {
            return Ok(Listed::of(outline));
        }
        its.wait_for_memory();
        let outline = Outline::of(accel.as_ref(), weights, (&its.budget, cancel, progress))?;
        Ok(Listed::of(Arc::new(outline)))
    })
}

/// Starts making the cells along a path of them.
pub fn select_path(shared: &Shared, accel: Arc<dyn Accel>, path: Vec<CellId>) -> std::io::Result<Selecting> {
    Job::spawn("select", shared.waker(), move |cancel, _| Picked::of_path(accel.as_ref(), &path, cancel))
}

/// The cells of a row, on their way.
pub type Selecting = Job<Result<Picked, Cancelled>>;

/// Starts making the cells from the root to a row: a grid has millions of children.
pub fn select(shared: &Shared, accel: Arc<dyn Accel>, outline: Arc<Outline>, row: u32) -> std::io::Result<Selecting> {
    Job::spawn("select", shared.waker(), move |cancel, _| Picked::of_row(accel.as_ref(), &outline, row, cancel))
}

/// Why rays are slow, and the cells that say so, on their way; or why there is none: nothing to say where it was stopped.
pub type FindingCauses = Job<Result<(Findings, Listed), String>>;

/// Starts looking why rays of a view are slow, listing the structure's cells first if they are not; the renderer is kept from
/// running meanwhile.
pub fn find_causes(
    shared: &Shared,
    (shown, outline): (&Built, Option<Arc<Outline>>),
    (view, size_px): (render::Job, [u32; 2]),
    pause: Pauses,
) -> std::io::Result<FindingCauses> {
    let Shared { pool, budget, .. } = shared.clone();
    let (key, weights) = (shown.key.clone(), SahWeights::of(&shown.key.params));
    Job::spawn("causes", shared.waker(), move |cancel, progress| {
        pause.wait();
        let outline = match outline {
            Some(outline) => outline,
            None => match Outline::of(view.accel.as_ref(), weights, (&budget, cancel, progress)) {
                Ok(outline) => Arc::new(outline),
                Err(OutlineError::Cancelled(_)) => return Err(String::new()),
                Err(why) => return Err(why.to_string()),
            },
        };
        let found = findings::find(&view, size_px, (key.entry, &key.params, &outline), &pool, cancel, progress);
        found.map(|found| (found, Listed::of(outline))).map_err(|_| String::new())
    })
}

/// Bounding volumes around a cell, on their way; none if it holds nothing.
pub type FittingVolumes = Job<Result<Option<lab::Fitting>, lab::FitError>>;

/// Starts comparing bounding volumes around a cell with rays of a view; the renderer is kept from running meanwhile.
pub fn fit_volumes(
    shared: &Shared,
    view: render::Job,
    size_px: [u32; 2],
    cell: Cell,
    pause: Pauses,
) -> std::io::Result<FittingVolumes> {
    let (pool, budget) = (shared.pool.clone(), shared.budget.clone());
    Job::spawn("volumes", shared.waker(), move |cancel, progress| {
        pause.wait();
        lab::fit_volumes(&view, size_px, &cell, &pool, (&budget, cancel, progress))
    })
}

/// A ray that is to be followed.
pub struct ToFollow {
    /// Structures that are there, the shown one first.
    pub kept: Vec<Built>,
    /// Structures to build first.
    pub missing: Vec<Key>,
    /// A ray of the camera, or any other.
    pub ray: Ray,
    /// The ray itself, or one that leaves what it meets.
    pub kind: RayKind,
    /// From where the picture is seen.
    pub camera: Camera,
}

/// A ray, as structures traced it.
#[derive(Default)]
pub struct FollowedRay {
    /// The ray; `None` if the one that it was to leave meets nothing.
    pub ray: Option<Ray>,
    /// Each structure, and its steps.
    pub columns: Vec<(Built, Followed)>,
    /// Structures that could not be built, and why.
    pub failed: Vec<NotBuilt>,
}

/// A ray on its way.
pub type Following = Job<Result<FollowedRay, Cancelled>>;

/// Starts following a ray through structures, building those that are missing.
pub fn follow(shared: &Shared, wanted: ToFollow) -> std::io::Result<Following> {
    let Shared { pool, budget, .. } = shared.clone();
    Job::spawn("follow", shared.waker(), move |cancel, progress| {
        let Some(first) = wanted.kept.first().cloned() else { return Ok(FollowedRay::default()) };
        let ray = lab::leaving(wanted.kind, first.accel.as_ref(), &wanted.camera, &wanted.ray, cancel)?;
        let Some(ray) = ray else { return Ok(FollowedRay::default()) };
        let cx = BuildCx::new(cancel.clone(), progress.clone(), pool, budget);
        let (built, failed) = build_missing(wanted.kept, wanted.missing, first.accel.geometry(), &cx)?;
        let of = |built: Built| {
            let followed = follow::follow(built.accel.as_ref(), &ray, wanted.kind.mode(), cancel)?;
            Ok((built, followed))
        };
        let columns = built.into_iter().map(of).collect::<Result<Vec<_>, Cancelled>>()?;
        Ok(FollowedRay { ray: Some(ray), columns, failed })
    })
}

/// What measuring brings: every structure that could be built, its figures, and why others have
/// none.
#[derive(Debug, Default)]
pub struct Measured {
    /// Structures, the ones built for it among them.
    pub built: Vec<Built>,
    /// Their timings, in the same order.
    pub timings: Vec<Timing>,
    /// The rasteriser's, of the same view.
    pub raster: Option<RasterRow>,
    /// What steps and tests cost in each, as far as that could be told.
    pub costs: Vec<Option<Costs>>,
    /// Structures that could not be built, and why.
    pub failed: Vec<NotBuilt>,
    /// The terms of the timings.
    pub fairness: Fairness,
    /// The view, and its size in pixels.
    pub view: Option<(Camera, [u32; 2])>,
}

/// Timings on their way.
pub type Measuring = Job<Result<Measured, Cancelled>>;

/// What is measured: the structures that are there and those to be built, on the rays of a view.
pub struct Plan {
    /// Structures that are kept.
    pub kept: Vec<Built>,
    /// Structures to build first.
    pub missing: Vec<Key>,
    /// The view; its structure finds the first hits.
    pub view: render::Job,
    /// Its size in pixels.
    pub size_px: [u32; 2],
}

/// A structure that could not be built, by its id, and why.
pub type NotBuilt = (&'static str, String);

/// Builds what is missing beside what is kept: all structures, and those that could not be built.
fn build_missing(
    mut built: Vec<Built>,
    missing: Vec<Key>,
    geometry: &Arc<Geometry>,
    cx: &BuildCx,
) -> Result<(Vec<Built>, Vec<NotBuilt>), Cancelled> {
    let mut failed = Vec::new();
    for key in missing {
        let id = key.entry.id;
        match build_now(key, geometry, cx) {
            Ok(one) => built.push(one),
            Err(BuildError::Cancelled(cancelled)) => return Err(cancelled),
            Err(why) => failed.push((id, why.to_string())),
        }
    }
    Ok((built, failed))
}

/// Starts measuring; the renderer is kept from running meanwhile.
pub fn measure_all(shared: &Shared, plan: Plan, fairness: Fairness, pause: Pauses) -> std::io::Result<Measuring> {
    let Shared { pool, budget, .. } = shared.clone();
    Job::spawn("measure", shared.waker(), move |cancel, progress| {
        pause.wait();
        let (view, size_px) = (plan.view.clone(), plan.size_px);
        let cx = BuildCx::new(cancel.clone(), progress.clone(), pool.clone(), budget);
        let (built, failed) = build_missing(plan.kept, plan.missing, view.accel.geometry(), &cx)?;
        let mut measured = Measured { built, failed, fairness, view: Some((view.camera, size_px)), ..Measured::default() };
        let [width, height] = size_px;
        let rays = RaySet::generate(RayKind::Primary, &view, width, height, &pool, cancel)?;
        let contestant = |b: &Built| Contestant { id: b.key.entry.id.to_owned(), accel: Arc::clone(&b.accel) };
        let contestants: Vec<Contestant> = measured.built.iter().map(contestant).collect();
        let options = MeasureOptions { fairness, ..MeasureOptions::default() };
        if view.accel.levels().is_some() {
            // The rasteriser draws flattened triangles alone.
            measured.timings = measure(&contestants, &rays, &options, &pool, cancel, progress)?;
        } else {
            let (timings, raster) = measure_with_raster(&contestants, &rays, &view, size_px, &options, &pool, cancel, progress)?;
            (measured.timings, measured.raster) = (timings, Some(raster));
        }
        // Lines beside the view's rays: the more the rays differ, the better the costs are told apart.
        let lines = RaySet::lines(view.accel.geometry(), 1 << 16, &pool, cancel)?;
        let options = FitOptions { cap_secs: 2.0, ..FitOptions::default() };
        measured.costs = fit_costs(&contestants, &[&rays, &lines], &options, &pool, cancel, progress)?;
        Ok(measured)
    })
}

/// A reference on its way.
pub type Referring = Job<Result<Reference, Cancelled>>;

/// Starts a reference of a view, of so many samples; the renderer is kept from running meanwhile.
pub fn reference(shared: &Shared, view: render::Job, size_px: [u32; 2], spp: u32, pause: Pauses) -> std::io::Result<Referring> {
    let pool = shared.pool.clone();
    Job::spawn("reference", shared.waker(), move |cancel, progress| {
        pause.wait();
        Reference::render(&view, size_px, spp, (&pool, cancel, progress))
    })
}

/// Errors of points, by curve and point, on their way.
pub type Erring = Job<Vec<(usize, usize, ImageErrors)>>;

/// Starts measuring points against a reference.
pub fn errors(shared: &Shared, points: Vec<(usize, usize, Arc<Shot>)>, reference: Arc<Reference>) -> std::io::Result<Erring> {
    Job::spawn("errors", shared.waker(), move |cancel, _| {
        let of = |(curve, point, shot): (usize, usize, Arc<Shot>)| {
            let light = shot.light.as_ref().filter(|_| !cancel.is_cancelled())?;
            Some((curve, point, ImageErrors::of(light, &reference.pixels)))
        };
        points.into_iter().filter_map(of).collect()
    })
}

/// A picture of what was kept, on its way.
pub type Developing = Job<Result<Picture, Cancelled>>;

/// Starts developing what was kept; beside a reference, its difference from that. Its depths are those of the present picture.
pub fn develop(
    shared: &Shared,
    shot: Arc<Shot>,
    reference: Option<Arc<Reference>>,
    (present, size_px): (Arc<Picture>, [u32; 2]),
    tone: Tone,
) -> std::io::Result<Developing> {
    Job::spawn("develop", shared.waker(), move |_, _| {
        let light = shot.light.as_deref().ok_or(Cancelled)?;
        Ok(shown::picture(light, reference.as_deref().map(|r| &r.pixels[..]), (&present, size_px), tone))
    })
}

/// Quality against its cost, on its way.
pub type Trading = Job<Result<(), CheckError>>;

/// Columns and rows of the picture whose rays are traced for it, at most: many structures wait for their turn.
const TRADED: u32 = 240;

/// Starts measuring variants on the rays of a view; each is sent as soon as it is through, and the renderer is kept from
/// running meanwhile.
pub fn tradeoffs(
    shared: &Shared,
    variants: Vec<Variant>,
    view: render::Job,
    [width, height]: [u32; 2],
    (through, pause): (Sender<TradeoffRow>, Pauses),
) -> std::io::Result<Trading> {
    let Shared { pool, budget, wake, .. } = shared.clone();
    Job::spawn("tradeoffs", shared.waker(), move |cancel, progress| {
        pause.wait();
        // Builds and measurements have phases of their own, which are not told.
        let cx = BuildCx::new(cancel.clone(), Progress::new(), pool, budget);
        let shrink = width.max(height).div_ceil(TRADED).max(1);
        progress.start("exact answers", 1);
        let tradeoffs = Tradeoffs::new(&view, [width.div_ceil(shrink), height.div_ceil(shrink)], &cx)?;
        progress.start("structures", variants.len() as u64);
        for variant in variants {
            let row = tradeoffs.measure(&variant, view.accel.geometry(), &cx)?;
            // Nobody listens once the window is closed, and then this is cancelled as well.
            let _ = through.send(row);
            progress.advance(1);
            wake();
        }
        Ok(())
    })
}

/// The stability lab on its way.
pub type Stability = Job<Result<(), CheckError>>;

/// Starts the lab: all cases, structures and tests; each case is sent as soon as it is through.
pub fn stability(shared: &Shared, through: Sender<CaseRow>) -> std::io::Result<Stability> {
    let Shared { pool, budget, wake, .. } = shared.clone();
    Job::spawn("stability", shared.waker(), move |cancel, progress| {
        let tests = TestKind::ALL.into_iter().chain(TestKind::OTHERS).collect();
        let structures = registry::ALL.iter().collect();
        let options = stability::Options { seed: SEED, rays: RAYS, structures, tests, secs: 1e-3 };
        progress.start("cases", (cases::ALL.len() * options.pairs().count()) as u64);
        for case in cases::ALL {
            // Builds have phases of their own, which are not told.
            let cx = BuildCx::new(cancel.clone(), Progress::new(), pool.clone(), budget.clone());
            let row = stability::check_case(case, &options, &cx, &|| progress.advance(1))?;
            // Nobody listens once the window is closed, and then this is cancelled as well.
            let _ = through.send(row);
            wake();
        }
        Ok(())
    })
}

/// The most seconds for the rays of a structure that is checked: its user waits.
const CHECK_SECS: f64 = 1.0;

/// The check of a model on its way, and the structures that were built for it.
pub type Checking = Job<Result<(ModelCheck, Vec<Built>), CheckError>>;

/// Starts checking the open model with every structure.
pub fn check_model(shared: &Shared, plan: Plan) -> std::io::Result<Checking> {
    let Shared { pool, budget, .. } = shared.clone();
    Job::spawn("check", shared.waker(), move |cancel, progress| {
        let cx = BuildCx::new(cancel.clone(), progress.clone(), pool, budget);
        let (view, [width, height]) = (plan.view.clone(), plan.size_px);
        // What cannot be built has no row; choosing it says why.
        let (built, _) = build_missing(plan.kept, plan.missing, view.accel.geometry(), &cx)?;
        let checked = |b: &Built| Checked { id: b.key.entry.id.to_owned(), test: b.key.test, accel: Arc::clone(&b.accel) };
        let structures: Vec<Checked> = built.iter().map(checked).collect();
        // Half of the pixels on either axis.
        let size = [width.div_ceil(2), height.div_ceil(2)];
        let model = (&view.scene, view.accel.geometry());
        let check = lab::check_model(model, &structures, (view.camera, size), CHECK_SECS, &cx)?;
        Ok((check, built))
    })
}
