//! `boxwood scaling`: how builds and rays slow down as a model gets more triangles.

use std::io::Write;
use std::path::PathBuf;
use std::sync::Arc;

use serde::Serialize;

use super::args::{ModelArgs, Size, seconds};
use super::context::{Context, Model};
use super::failure::Failure;
use super::output::{OutFile, print, print_json, warn};
use super::structures::{BuildArgs, Many};
use super::table::{Table, facts};
use super::{bar, rays};
use crate::accel::BuildError;
use crate::geometry::tri::TestKind;
use crate::lab::format::{MISSING, count, duration, number};
use crate::lab::plot::{Curve, Panel, svg_of};
use crate::lab::scaling::{BuildRounds, Candidate, Exponent, Grown, Point, Scaling, Sizes, scaling};
use crate::lab::{MachineFacts, MeasureOptions, RayKind};
use crate::scene::builtin::MAX_TRIANGLES;
use crate::scene::{CameraSpec, Geometry};
use crate::task::{Cancel, Progress};

#[derive(Debug, clap::Args)]
pub struct Args {
    /// A built-in scene named without a size is made in each size; anything else is cut finer, each
    /// triangle into four.
    #[command(flatten)]
    model: ModelArgs,
    /// The structures: ids between commas, or all.
    #[arg(long, value_name = "all|ID,ID", default_value = "all")]
    structures: Many,
    /// The fewest triangles of a scene that is made in each size.
    #[arg(long, value_name = "N", default_value_t = 1000, value_parser = clap::value_parser!(u64).range(1..=MAX_TRIANGLES as u64))]
    from: u64,
    /// The most triangles.
    #[arg(long, value_name = "N", default_value_t = 1_000_000, value_parser = clap::value_parser!(u64).range(1..=MAX_TRIANGLES as u64))]
    to: u64,
    /// Sizes of a scene that is made in each, the ratio from one to the next being the same.
    #[arg(long, value_name = "N", default_value_t = 7, value_parser = clap::value_parser!(u32).range(2..=64))]
    steps: u32,
    /// The rays that are timed: primary, shadow, diffuse or lines. One set for all sizes, made on the largest.
    #[arg(long, default_value = "lines")]
    rays: RayKind,
    /// The picture whose rays are traced.
    #[arg(long, value_name = "WxH", default_value = "320x200")]
    size: Size,
    /// The fewest timed rounds over the rays, and the most builds.
    #[arg(long, value_name = "N", default_value_t = 5, value_parser = clap::value_parser!(u32).range(1..))]
    repeat: u32,
    /// The least seconds timed of each structure and size; it is not built again after as many seconds of builds.
    #[arg(long, default_value = "0.5", value_parser = seconds)]
    secs: f64,
    /// Seconds that tracing one structure and size may take; a slower one traces a part of the rays.
    #[arg(long, value_name = "SECS", default_value = "5", value_parser = seconds)]
    cap: f64,
    #[command(flatten)]
    build: BuildArgs,
    /// Also draw the times over the triangles, on logarithmic axes.
    #[arg(long, value_name = "OUT.svg")]
    plot: Option<PathBuf>,
    /// Print one JSON object.
    #[arg(long)]
    json: bool,
}

/// What is printed as JSON.
#[derive(Serialize)]
struct Outcome {
    model: String,
    machine: MachineFacts,
    test: TestKind,
    rays: RayKind,
    triangles: Vec<u64>,
    structures: Vec<Scaling>,
}

pub fn run(args: &Args, cancel: Cancel) -> Result<(), Failure> {
    let Many(entries) = &args.structures;
    let params = args.build.params(entries)?;
    let candidates: Vec<Candidate> =
        entries.iter().copied().zip(params).map(|(entry, params)| Candidate { entry, params }).collect();
    let plot = args.plot.as_deref().map(OutFile::at).transpose()?;
    let cx = Context::new(args.model.machine, cancel);
    let (geometries, largest) = models(args, &cx)?;
    let camera = CameraSpec::or_first(None, &largest.scene, &largest.geometry, args.size.aspect());
    let (set, _memory) = rays::generate(args.rays, &largest, camera, rays::finder(&largest, &cx)?, args.size, &cx)?;
    let build_cx = cx.build_cx();
    let rounds = BuildRounds { rounds: args.repeat as usize, secs: args.secs };
    let options =
        MeasureOptions { min_rounds: args.repeat as usize, min_secs: args.secs, cap_secs: args.cap, ..MeasureOptions::default() };
    let progress = Progress::new();
    let scale = || {
        let with = (&build_cx, &progress);
        scaling(&candidates, &geometries, &set, args.build.test, (&rounds, &options), with)
    };
    let structures = bar::watch("scaling", &progress, scale).map_err(|error| match error {
        BuildError::Cancelled(_) => Failure::Cancelled,
        error => Failure::Other(error.into()),
    })?;
    let outcome = Outcome {
        model: args.model.model.clone(),
        machine: cx.machine(),
        test: args.build.test,
        rays: args.rays,
        triangles: geometries.iter().map(|g| g.live_count() as u64).collect(),
        structures,
    };
    if let Some(file) = plot {
        let svg = svg_of(&panels(&outcome)).map_err(|error| Failure::Other(anyhow::anyhow!("{error}")))?;
        file.write(&cx.cancel, |out| out.write_all(svg.as_bytes()))?;
    }
    if args.json { print_json(&outcome) } else { print(&text(&outcome)) }
}

/// The model in all sizes, the smallest first, and the largest as a whole.
fn models(args: &Args, cx: &Context) -> Result<(Vec<Arc<Geometry>>, Model), Failure> {
    let (model, load_cx) = (&args.model.model, cx.load_cx());
    let sizes = Sizes { from: args.from, to: args.to, steps: args.steps };
    let Grown { geometries, scene } = bar::watch("open", &load_cx.progress, || sizes.of(model, &load_cx))?;
    scene.warnings.iter().for_each(|warning| warn(&format!("{model}: {warning}")));
    let geometry = match &geometries[..] {
        [_, .., largest] => Arc::clone(largest),
        _ => {
            let why = "there are not two sizes in that range: give --from and --to farther apart";
            return Err(Failure::Input(format!("{model}: {why}")));
        }
    };
    Ok((geometries, Model { scene, geometry, keep: load_cx.keep, phases: Vec::new() }))
}

/// The times of builds and of rays.
fn panels(outcome: &Outcome) -> [Panel; 2] {
    let curves = |secs: fn(&Point) -> f64| {
        let points = |s: &Scaling| s.points.iter().map(|p| (p.triangles as f64, secs(p))).collect::<Vec<_>>();
        outcome.structures.iter().map(|s| Curve::of(&s.id, points(s))).collect()
    };
    let threads = outcome.machine.threads;
    [
        Panel {
            title: format!("{}: builds, {threads} threads", outcome.model),
            axes: ["triangles", "seconds of a build"],
            curves: curves(|p| p.build_secs),
            guide: Some(("N log N", |n| n * n.ln())),
            ..Panel::default()
        },
        Panel {
            title: format!("{}: {} rays, {threads} threads", outcome.model, outcome.rays.id()),
            axes: ["triangles", "nanoseconds of a ray"],
            curves: curves(|p| p.ray_secs * 1e9),
            guide: Some(("log N", f64::ln)),
            ..Panel::default()
        },
    ]
}

fn text(outcome: &Outcome) -> String {
    let machine = &outcome.machine;
    let sizes: Vec<String> = outcome.triangles.iter().map(|n| count(*n)).collect();
    let head = facts(&[
        ("model", format!("{}: {} triangles", outcome.model, sizes.join(", "))),
        ("machine", format!("{}, {} cores, {} threads", machine.cpu, machine.cores, machine.threads)),
        ("rays", format!("{}, one set for all sizes", outcome.rays.id())),
    ]);
    let mut exponents = Table::new(&["structure", "build exponent", "±", "ray exponent", "±"]);
    let mut points = Table::new(&["structure", "triangles", "build", "±", "builds", "ns/ray", "±", "rounds"]);
    let mut notes = String::new();
    for structure in &outcome.structures {
        let of = |exponent: Option<Exponent>| exponent.map_or([f64::NAN; 2], |e| [e.value, e.error]);
        let four = [of(structure.build), of(structure.ray)].concat().into_iter().map(fixed);
        exponents.row([structure.id.clone()].into_iter().chain(four).collect());
        for p in &structure.points {
            points.row(vec![
                structure.id.clone(),
                count(p.triangles),
                duration(p.build_secs),
                duration(p.build_spread),
                count(p.builds as u64),
                number(p.ray_secs * 1e9),
                number(p.ray_spread * 1e9),
                count(p.rounds as u64),
            ]);
        }
        if let Some(error) = &structure.error {
            notes += &format!("{}: {error}\n", structure.id);
        }
    }
    format!(
        "{head}\n{}\n{}{notes}\nTime grows as triangles to the power of the exponent: least squares over the logarithms, ± the standard error.\n",
        points.render(),
        exponents.render()
    )
}

/// An exponent with two decimals.
fn fixed(x: f64) -> String {
    if x.is_finite() { format!("{x:.2}") } else { MISSING.to_owned() }
}
