//! `boxwood compare`: structures timed on the same rays, in turns.

use serde::Serialize;
use std::collections::BTreeSet;
use std::sync::Arc;

use super::args::{LookArgs, ModelArgs, Size, seconds};
use super::context::{Context, Model};
use super::failure::Failure;
use super::output::{print, print_json};
use super::quality::QualityArgs;
use super::structures::{BuildArgs, Many};
use super::table::{Table, facts};
use super::{bar, quality, rays, stats};
use crate::accel::Accel;
use crate::lab::format::{MISSING, count, number, ratio};
use crate::lab::{Contestant, Fairness, MeasureOptions, Quality, RayKind, Report, StructureRow, Timing, is_tie, measure};
use crate::scene::CameraSpec;
use crate::task::{Cancel, Progress};

#[derive(Debug, clap::Args)]
pub struct Args {
    #[command(flatten)]
    model: ModelArgs,
    /// The structures: ids between commas, or all.
    #[arg(long, value_name = "all|ID,ID", default_value = "all")]
    structures: Many,
    /// The kinds of rays, between commas: primary, shadow, diffuse, lines (random ones).
    #[arg(long, value_name = "KINDS", value_delimiter = ',', default_value = "primary,shadow,diffuse")]
    rays: Vec<RayKind>,
    /// The picture whose rays are traced.
    #[arg(long, value_name = "WxH", default_value = "640x400")]
    size: Size,
    /// The fewest timed rounds of each structure.
    #[arg(long, value_name = "N", default_value_t = 5, value_parser = clap::value_parser!(u32).range(1..))]
    repeat: u32,
    /// The least seconds timed of each structure and kind of rays.
    #[arg(long, default_value = "1", value_parser = seconds)]
    secs: f64,
    /// Seconds that a structure may take for one kind of rays; a slower one traces a part of them.
    #[arg(long, value_name = "SECS", default_value = "10", value_parser = seconds)]
    cap: f64,
    /// Compare scalar code, single rays and the same triangle test (the default).
    #[arg(long, conflicts_with = "best")]
    like_for_like: bool,
    /// Compare each structure in its fastest form.
    #[arg(long)]
    best: bool,
    #[command(flatten)]
    look: LookArgs,
    #[command(flatten)]
    build: BuildArgs,
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
    fairness: Fairness,
    size: [u32; 2],
}

pub fn run(args: &Args, cancel: Cancel) -> Result<(), Failure> {
    let Many(entries) = &args.structures;
    let params = args.build.params(entries)?;
    let cx = Context::new(args.model.machine, cancel);
    let model = cx.load(&args.model.model)?;

    let (mut structures, mut contestants) = (Vec::new(), Vec::new());
    for (entry, params) in entries.iter().zip(&params) {
        let options = args.how.options(args.quality);
        let (row, built) = stats::row(entry, &args.build, (params, &options), &model, &cx)?;
        contestants.extend(built.map(|built| Contestant { id: row.id.clone(), accel: built.accel }));
        structures.push(row);
    }
    let mut report = Report { scene: model.facts(), machine: cx.machine(), structures };
    if !contestants.is_empty() {
        time(args, &model, &contestants, &mut report, &cx)?;
    }
    let fairness = args.options().fairness;
    let size = [args.size.width, args.size.height];
    let object = Comparison { report: &report, fairness, size };
    stats::print_report(&report, || if args.json { print_json(&object) } else { print(&text(args, &report)) })
}

impl Args {
    /// The kinds of rays asked for, each once.
    fn kinds(&self) -> BTreeSet<RayKind> {
        self.rays.iter().copied().collect()
    }

    fn options(&self) -> MeasureOptions {
        let fairness = if self.best { Fairness::Best } else { Fairness::LikeForLike };
        MeasureOptions { min_rounds: self.repeat as usize, min_secs: self.secs, cap_secs: self.cap, fairness }
    }
}

/// Measures every kind of ray and puts the outcome into the rows.
fn time(args: &Args, model: &Model, contestants: &[Contestant], report: &mut Report, cx: &Context) -> Result<(), Failure> {
    let camera = CameraSpec::or_first(args.look.camera.as_ref(), &model.scene, &model.geometry, args.size.aspect());
    let finder = finder(args, model, contestants, cx)?;
    let mut sets = Vec::new();
    for kind in &args.kinds() {
        let (set, memory) = rays::generate(*kind, model, camera, Arc::clone(&finder), args.size, cx)?;
        let progress = Progress::new();
        let title = format!("{} rays", kind.id());
        let timings =
            bar::watch(&title, &progress, || measure(contestants, &set, &args.options(), &cx.pool, &cx.cancel, &progress))?;
        for timing in timings {
            if let Some(row) = report.structures.iter_mut().find(|row| row.id == timing.id) {
                row.rays.insert(*kind, timing);
            }
        }
        if args.how.fit_costs {
            sets.push((set, memory));
        }
    }
    if args.how.fit_costs { quality::fit(contestants, &sets, &mut report.structures, cx) } else { Ok(()) }
}

/// What finds the primary hits: the `bvh`, or where that does not fit, any structure that does.
fn finder(args: &Args, model: &Model, contestants: &[Contestant], cx: &Context) -> Result<Arc<dyn Accel>, Failure> {
    // With other parameters it may be as slow as brute force.
    let usual = |c: &&Contestant| c.id == rays::FINDER && args.build.set.is_empty();
    if let Some(bvh) = contestants.iter().find(usual) {
        return Ok(Arc::clone(&bvh.accel));
    }
    rays::finder(model, cx).or_else(|failure| match (failure, contestants.last()) {
        (Failure::Other(_), Some(other)) => Ok(Arc::clone(&other.accel)),
        (failure, _) => Err(failure),
    })
}

fn text(args: &Args, report: &Report) -> String {
    let terms = format!("{}; {} test", args.options().fairness.label(), args.build.test.id());
    let head = facts(&[stats::head(report), vec![("terms", terms)]].concat());
    let mut out = format!("{head}\n{}\n{}", stats::structures(report), quality::text(report));
    for kind in &args.kinds() {
        let timing = |row: &StructureRow| Some((row.rays.get(kind)?.clone(), row.quality.clone()?));
        let rows: Vec<(Timing, Quality)> = report.structures.iter().filter_map(timing).collect();
        let Some(of) = rows.first().map(|(timing, _)| timing.of) else { continue };
        out += &format!("\n{} rays: {} at {}\n", kind.id(), count(of as u64), args.size);
        out += &timings(&rows);
    }
    out + "\nms is the median over rounds of one pass over the rays, ± half the interquartile range.\n\
           LCV is the standard deviation of the leaves that a ray enters. expected: of a random line that nothing cuts short.\n"
}

/// One line for each structure, and why some traced fewer rays.
fn timings(rows: &[(Timing, Quality)]) -> String {
    let fastest = rows.iter().map(|(timing, _)| timing).max_by(|a, b| a.mrays_per_sec.total_cmp(&b.mrays_per_sec));
    let (of_time, of_counts) = (["structure", "ms", "±", "rounds", "Mrays/s", "time", "hits"], ["nodes/ray", "expected"]);
    let mut table = Table::new(&[&of_time[..], &of_counts, &["tests/ray", "expected", "LCV"]].concat());
    let mut notes = String::new();
    for (row, quality) in rows {
        let time = match fastest {
            Some(best) if std::ptr::eq(best, row) => "fastest".to_owned(),
            Some(best) if is_tie(best, row) => "tie".to_owned(),
            Some(best) => ratio(best.mrays_per_sec / row.mrays_per_sec),
            None => MISSING.to_owned(),
        };
        table.row(vec![
            row.id.clone(),
            number(row.secs_median * 1e3),
            number(row.secs_half_iqr * 1e3),
            count(row.rounds as u64),
            number(row.mrays_per_sec),
            time,
            count(row.hits),
            number(row.nodes_per_ray),
            number(quality.expected_nodes),
            number(row.prims_per_ray),
            number(quality.expected_tests),
            number(row.lcv),
        ]);
        if let Some(why) = &row.capped {
            notes += &format!("{}: {why}\n", row.id);
        }
    }
    table.render() + &notes
}
