//! `boxwood compare`: structures timed on the same rays, in turns.

use serde::Serialize;
use std::collections::BTreeSet;
use std::sync::Arc;

use super::args::{LookArgs, ModelArgs, SceneArgs, Size, seconds};
use super::context::{Context, Model};
use super::failure::Failure;
use super::output::{print, print_json};
use super::quality::QualityArgs;
use super::structures::{BuildArgs, Racers, each_once};
use super::table::facts;
use super::{bar, outcome, quality, rays, stats};
use crate::accel::Accel;
use crate::geometry::tri::TestKind;
use crate::lab::format::count;
use crate::lab::{
    Contestant, Fairness, MeasureOptions, PixelOrder, Quality, RasterRow, RayKind, RaySet, Report, StructureRow, Timing, built,
    measure, measure_with_raster,
};
use crate::render::raster::Raster;
use crate::render::{Job, Mode};
use crate::scene::{Camera, CameraSpec};
use crate::task::{Cancel, Progress};

#[derive(Debug, clap::Args)]
pub struct Args {
    #[command(flatten)]
    model: ModelArgs,
    /// The structures: ids between commas, raster (with primary rays) among them, or all.
    #[arg(long, value_name = "all|ID,ID", default_value = "all")]
    structures: Racers,
    /// The kinds of rays, between commas: primary, shadow, diffuse, lines (random ones), shuffled
    /// (diffuse ones in a random order).
    #[arg(long, value_name = "KINDS", value_delimiter = ',', default_value = "primary,shadow,diffuse")]
    rays: Vec<RayKind>,
    /// The picture whose rays are traced.
    #[arg(long, value_name = "WxH", default_value = "640x400")]
    size: Size,
    /// The order of the pixels that the rays come from: rows or morton, which raster can't draw.
    #[arg(long, default_value = "rows")]
    order: PixelOrder,
    /// The fewest timed rounds of each structure.
    #[arg(long, value_name = "N", default_value_t = 5, value_parser = clap::value_parser!(u32).range(1..))]
    repeat: u32,
    /// The least seconds timed of each structure and kind of rays.
    #[arg(long, default_value = "1", value_parser = seconds)]
    secs: f64,
    /// Seconds that a structure may take for one kind of rays; a slower one traces a part of them.
    #[arg(long, value_name = "SECS", default_value = "10", value_parser = seconds)]
    cap: f64,
    /// Compare plain code, single rays and the same triangle test (the default).
    #[arg(long, conflicts_with = "best")]
    like_for_like: bool,
    /// Compare each structure in its fastest form.
    #[arg(long)]
    best: bool,
    /// Triangle tests that race each other, between commas: each structure is built with each [default: that of --test].
    #[arg(long, value_name = "TESTS", value_delimiter = ',', conflicts_with = "test")]
    tests: Vec<TestKind>,
    #[command(flatten)]
    look: LookArgs,
    #[command(flatten)]
    build: BuildArgs,
    #[command(flatten)]
    scene: SceneArgs,
    /// Also work out end-point overlap, and count random lines that nothing cuts short, as stats does.
    #[arg(long)]
    quality: bool,
    #[command(flatten)]
    how: QualityArgs,
    /// Print one JSON object.
    #[arg(long)]
    json: bool,
}

/// What is printed as JSON.
#[derive(Serialize)]
struct Comparison<'a> {
    #[serde(flatten)]
    report: &'a Report,
    raster: Option<&'a RasterRow>,
    fairness: Fairness,
    size: [u32; 2],
    order: PixelOrder,
}

pub fn run(args: &Args, cancel: Cancel) -> Result<(), Failure> {
    let Racers { entries, raster } = &args.structures;
    let raster = *raster && args.order == PixelOrder::Rows && args.kinds().contains(&RayKind::Primary);
    if entries.is_empty() && !raster {
        return Err(Failure::Input(
            "raster draws what primary rays see, row by row: add --rays primary --order rows, or a structure".to_owned(),
        ));
    }
    let params = args.build.params(entries)?;
    let cx = Context::new(args.model.machine, cancel);
    let model = cx.load_with_instances(&args.model.model, args.scene)?;
    // It draws flattened triangles alone.
    let raster = raster && model.geometry.placed().is_none();

    let (mut structures, mut accels) = (Vec::new(), Vec::new());
    let (tests, options) = (args.tests(), args.how.options(args.quality));
    let choices = entries.iter().zip(&params).flat_map(|choice| tests.iter().map(move |test| (choice, *test)));
    for ((entry, params), test) in choices {
        let (row, built) = stats::row(entry, test, (params, &options), &model, &cx)?;
        accels.extend(built.map(|built| built.accel));
        structures.push(row);
    }
    let mut report = Report { scene: model.facts(), machine: cx.machine(), structures };
    let built = report.structures.iter().filter(|row| row.built.is_some());
    let contestants: Vec<Contestant> =
        built.zip(accels).map(|(row, accel)| Contestant { id: report.label(row), accel }).collect();
    let mut drawn = None;
    if !contestants.is_empty() || raster {
        let camera = CameraSpec::or_first(args.look.camera.as_ref(), &model.scene, &model.geometry, args.size.aspect());
        let race = Race { args, model: &model, camera, contestants: &contestants, raster, cx: &cx };
        drawn = race.run(&mut report)?;
    }
    let fairness = args.options().fairness;
    let size = [args.size.width, args.size.height];
    let object = Comparison { report: &report, raster: drawn.as_ref(), fairness, size, order: args.order };
    let say = || if args.json { print_json(&object) } else { print(&text(args, &report, drawn.as_ref())) };
    if entries.is_empty() { say() } else { stats::print_report(&report, say) }
}

impl Args {
    /// The triangle tests asked for, each once.
    fn tests(&self) -> Vec<TestKind> {
        each_once(if self.tests.is_empty() { vec![self.build.test] } else { self.tests.clone() })
    }

    /// The kinds of rays asked for, each once.
    fn kinds(&self) -> BTreeSet<RayKind> {
        self.rays.iter().copied().collect()
    }

    fn options(&self) -> MeasureOptions {
        let fairness = if self.best { Fairness::Best } else { Fairness::LikeForLike };
        MeasureOptions { min_rounds: self.repeat as usize, min_secs: self.secs, cap_secs: self.cap, fairness }
    }
}

/// Who races on what.
struct Race<'a> {
    args: &'a Args,
    model: &'a Model,
    camera: Camera,
    contestants: &'a [Contestant],
    /// The rasteriser takes part where the rays are primary.
    raster: bool,
    cx: &'a Context,
}

impl Race<'_> {
    /// Measures every kind of ray and puts the outcome into the rows.
    fn run(&self, report: &mut Report) -> Result<Option<RasterRow>, Failure> {
        let finder = self.finder()?;
        let (mut sets, mut drawn) = (Vec::new(), None);
        for kind in &self.args.kinds() {
            let shape = (self.args.size, self.args.order);
            let (set, memory) = rays::ordered(*kind, self.model, self.camera, Arc::clone(&finder), shape, self.cx)?;
            let timings = if self.raster && *kind == RayKind::Primary {
                let (timings, row) = self.with_raster(&set, &finder)?;
                drawn = Some(row);
                timings
            } else {
                self.watched(&set, |options, progress| {
                    measure(self.contestants, &set, options, &self.cx.pool, &self.cx.cancel, progress)
                })?
            };
            for (row, timing) in built(&mut report.structures).zip(timings) {
                row.rays.insert(*kind, timing);
            }
            if self.args.how.fit_costs {
                sets.push((set, memory));
            }
        }
        if self.args.how.fit_costs && !self.contestants.is_empty() {
            quality::fit(self.contestants, &sets, &mut report.structures, self.cx)?;
        }
        Ok(drawn)
    }

    /// Measures under a progress bar.
    fn watched<R>(&self, set: &RaySet, work: impl FnOnce(&MeasureOptions, &Progress) -> R) -> R {
        let progress = Progress::new();
        bar::watch(&format!("{} rays", set.kind.id()), &progress, || work(&self.args.options(), &progress))
    }

    /// Measures the structures and the rasteriser in turns.
    fn with_raster(&self, set: &RaySet, finder: &Arc<dyn Accel>) -> Result<(Vec<Timing>, RasterRow), Failure> {
        let size = [self.args.size.width, self.args.size.height];
        let _memory = self.cx.budget.charge(Raster::bytes(size[0], size[1]))?;
        let (scene, accel) = (Arc::clone(&self.model.scene), Arc::clone(finder));
        let job = Job::new(scene, accel, self.camera, Mode::Shaded, Arc::default());
        Ok(self.watched(set, |options, progress| {
            measure_with_raster(self.contestants, set, &job, size, options, &self.cx.pool, &self.cx.cancel, progress)
        })?)
    }

    /// What finds the primary hits: the `bvh`, or where that does not fit, any structure that does.
    fn finder(&self) -> Result<Arc<dyn Accel>, Failure> {
        // With other parameters it may be as slow as brute force.
        let usual = |c: &&Contestant| c.id == rays::FINDER && self.args.build.set.is_empty();
        if let Some(bvh) = self.contestants.iter().find(usual) {
            return Ok(Arc::clone(&bvh.accel));
        }
        rays::finder(self.model, self.cx).or_else(|failure| match (failure, self.contestants.last()) {
            (Failure::Other(_), Some(other)) => Ok(Arc::clone(&other.accel)),
            (failure, _) => Err(failure),
        })
    }
}

fn text(args: &Args, report: &Report, raster: Option<&RasterRow>) -> String {
    let tests = args.tests().iter().map(|test| test.id()).collect::<Vec<_>>().join(", ");
    let terms = format!("{}; {tests} test", args.options().fairness.label());
    let mut out = facts(&[stats::head(report), vec![("terms", terms)]].concat());
    if !report.structures.is_empty() {
        out += &format!("\n{}\n{}", stats::structures(report), quality::text(report));
    }
    for kind in &args.kinds() {
        let timing = |row: &StructureRow| Some((row.rays.get(kind)?.clone(), row.quality.clone()?));
        let rows: Vec<(Timing, Quality)> = report.structures.iter().filter_map(timing).collect();
        let raster = raster.filter(|_| *kind == RayKind::Primary);
        let of = rows.first().map(|(timing, _)| timing.of).or(raster.map(|row| row.count));
        let Some(of) = of else { continue };
        out += &format!("\n{} rays: {} at {}\n", kind.id(), count(of as u64), args.size);
        out += &outcome::table(&rows, raster);
    }
    out + "\nms is the median over rounds of one pass over the rays, ± half the interquartile range.\n\
           LCV is the standard deviation of the leaves that a ray enters. expected: of a random line that nothing cuts short.\n"
}
