//! `boxwood needs`: what a model uses, what is left out for it, and what that saves.

use std::sync::Arc;

use super::args::{LookArgs, ModelArgs, SceneArgs, Size};
use super::bar;
use super::context::Context;
use super::failure::Failure;
use super::output::{print, print_json};
use super::structures::{BuildArgs, One};
use super::table::{Table, facts};
use crate::accel::params::ParamValues;
use crate::lab::format::{MISSING, bytes, count, number, signed_bytes};
use crate::lab::needs::{FeatureRow, Kept, NeedsReport, needs};
use crate::scene::CameraSpec;
use crate::scene::texture::Detail;
use crate::task::{Cancel, Progress};

#[derive(Debug, clap::Args)]
pub struct Args {
    #[command(flatten)]
    model: ModelArgs,
    /// The structure that is built, and traced through.
    #[arg(long, value_name = "ID", default_value = "bvh")]
    structure: One,
    /// Columns and rows of the camera rays that times are taken with.
    #[arg(long, value_name = "WxH", default_value = "256x160")]
    size: Size,
    #[command(flatten)]
    look: LookArgs,
    #[command(flatten)]
    build: BuildArgs,
    /// Print one JSON object.
    #[arg(long)]
    json: bool,
}

pub fn run(args: &Args, cancel: Cancel) -> Result<(), Failure> {
    let One(entry) = args.structure;
    let params = args.build.params(&[entry])?.remove(0);
    let cx = Context::new(args.model.machine, cancel);
    let whole = SceneArgs { force_all: true, ..SceneArgs::default() };
    let ours = kept(args, &params, SceneArgs::default(), &cx)?;
    let theirs = kept(args, &params, whole, &cx)?;
    let camera = CameraSpec::or_first(args.look.camera.as_ref(), &ours.scene, &ours.geometry, args.size.aspect());
    let progress = Progress::new();
    let view = (camera, [args.size.width, args.size.height]);
    let report = bar::watch("needs", &progress, || needs(&ours, &theirs, view, &cx.cancel, &progress))?;
    if args.json { print_json(&report) } else { print(&text(args, &report)) }
}

/// The model, kept as the arguments say, with its structure.
fn kept(args: &Args, params: &ParamValues, scene: SceneArgs, cx: &Context) -> Result<Kept, Failure> {
    let One(entry) = args.structure;
    let model = cx.load_with_instances(&args.model.model, scene)?;
    let looks = Arc::new(cx.looks(&model, Detail::Colors)?);
    let built = cx.build(entry, &model, args.build.test, params)?;
    Ok(Kept { scene: model.scene, geometry: model.geometry, accel: built.accel, looks })
}

fn text(args: &Args, report: &NeedsReport) -> String {
    let saved = report.forced_bytes.saturating_sub(report.total_bytes);
    let head = facts(&[
        ("model", args.model.model.clone()),
        ("kept", format!("{}, {} less than with everything", bytes(report.total_bytes), bytes(saved))),
        ("rays", format!("{} of the camera, {} hit something", count(report.rays as u64), count(report.hits as u64))),
    ]);
    let mut table = Table::new(&["feature", "", "saved", "ns/ray saved", "±"]);
    let mut why = String::new();
    for row in &report.features {
        let [ns, spread] = times(row);
        let size = signed_bytes(row.bytes_saved);
        table.row(vec![row.id.to_owned(), if row.used { "used" } else { "left out" }.to_owned(), size, ns, spread]);
        why.push_str(&format!("{}: {}\n", row.id, row.why));
    }
    format!("{head}\n{}\n{why}", table.render())
}

/// What is no matter of time, or within the spread, is not told as a saving.
fn times(row: &FeatureRow) -> [String; 2] {
    match (row.ns_per_ray_saved, row.ns_spread) {
        (ns, spread) if ns == 0.0 && spread == 0.0 => [MISSING.to_owned(), MISSING.to_owned()],
        (ns, spread) if ns.abs() <= spread => ["tie".to_owned(), number(spread)],
        (ns, spread) => [number(ns), number(spread)],
    }
}
