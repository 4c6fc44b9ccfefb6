//! `boxwood stats`: what structures look like in figures.

use std::sync::Arc;

use super::args::{ModelArgs, SceneArgs};
use super::context::{Context, Model};
use super::failure::Failure;
use super::output::{print, print_json};
use super::quality::QualityArgs;
use super::structures::{BuildArgs, Many};
use super::table::{Table, facts};
use super::{bar, quality, rays};
use crate::accel::params::ParamValues;
use crate::accel::registry::Entry;
use crate::geometry::num::floor_index;
use crate::geometry::tri::TestKind;
use crate::lab::format::{MISSING, bytes, count, duration, number};
use crate::lab::{BuiltFacts, BuiltRow, Contestant, QualityOptions, RayKind, Report, StructureRow};
use crate::scene::CameraSpec;
use crate::task::Cancel;

#[derive(Debug, clap::Args)]
pub struct Args {
    #[command(flatten)]
    model: ModelArgs,
    /// The structures: ids between commas, or all.
    #[arg(long, value_name = "ID|all")]
    structure: Many,
    #[command(flatten)]
    build: BuildArgs,
    #[command(flatten)]
    scene: SceneArgs,
    #[command(flatten)]
    quality: QualityArgs,
    /// Print one JSON object.
    #[arg(long)]
    json: bool,
}

pub fn run(args: &Args, cancel: Cancel) -> Result<(), Failure> {
    let Many(entries) = &args.structure;
    let params = args.build.params(entries)?;
    let cx = Context::new(args.model.machine, cancel);
    let model = cx.load_with_instances(&args.model.model, args.scene)?;
    let options = args.quality.options(true);
    let (mut structures, mut contestants) = (Vec::new(), Vec::new());
    for (entry, params) in entries.iter().zip(&params) {
        let (row, built) = row(entry, args.build.test, (params, &options), &model, &cx)?;
        if args.quality.fit_costs {
            contestants.extend(built.map(|built| Contestant { id: row.id.clone(), accel: built.accel }));
        }
        structures.push(row);
    }
    if args.quality.fit_costs && !contestants.is_empty() {
        let camera = CameraSpec::or_first(None, &model.scene, &model.geometry, quality::SIZE.aspect());
        let finder = rays::finder(&model, &cx)?;
        let mut sets = Vec::new();
        // Shuffled rays are the diffuse ones again.
        for kind in RayKind::ALL.into_iter().filter(|kind| *kind != RayKind::Shuffled) {
            sets.push(rays::generate(kind, &model, camera, Arc::clone(&finder), quality::SIZE, &cx)?);
        }
        quality::fit(&contestants, &sets, &mut structures, &cx)?;
    }
    let report = Report { scene: model.facts(), machine: cx.machine(), structures };
    print_report(&report, || if args.json { print_json(&report) } else { print(&text(&report)) })
}

/// Prints, and fails if nothing could be built. A single reason needs no table around it.
pub fn print_report(report: &Report, print: impl FnOnce() -> Result<(), Failure>) -> Result<(), Failure> {
    let reasons: Vec<&str> = report.structures.iter().filter_map(|row| row.error.as_deref()).collect();
    match reasons[..] {
        [reason] if report.structures.len() == 1 => Err(Failure::Other(anyhow::anyhow!("{reason}"))),
        _ if reasons.len() < report.structures.len() => print(),
        _ => print().and(Err(Failure::Other(anyhow::anyhow!("none of the structures could be built")))),
    }
}

/// Builds a structure and looks at it. One that cannot be built is a row with the reason.
pub fn row(
    entry: &Entry,
    test: TestKind,
    (params, options): (&ParamValues, &QualityOptions),
    model: &Model,
    cx: &Context,
) -> Result<(StructureRow, Option<BuiltRow>), Failure> {
    let build_cx = cx.build_cx();
    let of = || StructureRow::of(entry, test, (params, options), &model.geometry, &build_cx);
    Ok(bar::watch(entry.id, &build_cx.progress, of)?)
}

fn text(report: &Report) -> String {
    let details = match &report.structures[..] {
        [StructureRow { built: Some(built), .. }] => histograms(built),
        _ => String::new(),
    };
    let (table, quality) = (structures(report), quality::text(report));
    format!("{}\n{table}\n{quality}{details}", facts(&head(report)))
}

/// The model and the machine.
pub fn head(report: &Report) -> Vec<(&'static str, String)> {
    let (scene, machine) = (&report.scene, &report.machine);
    let size = scene.extent.map(number).join(" x ");
    let left_out = [(scene.dropped, "dropped"), (scene.degenerate, "degenerate")];
    let left_out: String = left_out.iter().filter(|(n, _)| *n > 0).map(|(n, what)| format!(", {} {what}", count(*n))).collect();
    vec![
        ("model", format!("{}: {} triangles{left_out}, extent {size}", scene.path, count(scene.triangles))),
        ("machine", format!("{}, {} cores, {} threads", machine.cpu, machine.cores, machine.threads)),
    ]
}

/// One line for each structure, and why some are not there.
pub fn structures(report: &Report) -> String {
    let headers = ["structure", "test", "build ms", "MiB", "nodes", "leaves", "depth", "references", "SAH cost"];
    let mut table = Table::new(&headers);
    let mut reasons = String::new();
    for row in &report.structures {
        let mut cells = vec![row.id.clone(), row.test.id().to_owned()];
        match &row.built {
            Some(b) => cells.extend([
                number(b.build_secs * 1e3),
                number(b.bytes as f64 / f64::from(1 << 20)),
                count(b.nodes),
                count(b.leaves),
                count(b.max_depth.into()),
                count(b.references),
                number(b.sah),
            ]),
            None => cells.resize(headers.len(), MISSING.to_owned()),
        }
        table.row(cells);
        if let Some(error) = &row.error {
            reasons.push_str(&format!("{} is not there: {error}\n", report.label(row)));
        }
    }
    table.render() + &reasons
}

/// What only fits if there is one structure.
fn histograms(built: &BuiltFacts) -> String {
    let last = built.leaf_sizes.len().saturating_sub(1);
    let size = |k: usize| if k == last { format!("{k} or more") } else { k.to_string() };
    let sizes = histogram("references", &built.leaf_sizes, size);
    let depths = histogram("depth", &built.leaf_depths, |k| k.to_string());
    let phases = built.phases.iter().map(|phase| format!("{} {}", phase.name, duration(phase.secs))).collect::<Vec<_>>();
    let memory = built.memory.iter().map(|part| format!("{} {}", part.name, bytes(part.bytes))).collect::<Vec<_>>();
    let or_missing = |list: Vec<String>| if list.is_empty() { MISSING.to_owned() } else { list.join(", ") };
    let mut lines = vec![("build", or_missing(phases)), ("memory", or_missing(memory))];
    if !built.remarks.is_empty() {
        lines.push(("chosen", built.remarks.join(", ")));
    }
    format!("\n{sizes}\n{depths}\n{}", facts(&lines))
}

/// A line for each count that is not 0.
fn histogram(what: &str, counts: &[u64], name: impl Fn(usize) -> String) -> String {
    const WIDTH: usize = 30;
    let most = counts.iter().copied().max().unwrap_or(0).max(1) as f64;
    let mut table = Table::new(&[what, "leaves"]);
    for (k, n) in counts.iter().enumerate().filter(|(_, n)| **n > 0) {
        let length = floor_index(*n as f64 / most * WIDTH as f64 + 0.5, WIDTH);
        table.row(vec![name(k), count(*n), format!("{:<WIDTH$}", "█".repeat(length))]);
    }
    table.render()
}
