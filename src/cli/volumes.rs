//! `boxwood volumes`: bounding volumes around the nodes of one tree, tightness against cost.

use serde::Serialize;
use std::sync::Arc;
use std::time::Instant;

use super::args::{LookArgs, ModelArgs, Size, seconds};
use super::context::{Context, Model};
use super::failure::Failure;
use super::output::{print, print_json};
use super::structures::BuildArgs;
use super::table::{Table, facts};
use super::{bar, rays, stats};
use crate::accel::BuildError;
use crate::accel::params::ParamValues;
use crate::accel::registry::{self, Entry};
use crate::accel::volumes::{KINDS, build_volumes};
use crate::lab::format::{count, number, percent, ratio};
use crate::lab::{MachineFacts, MeasureOptions, RayKind, Report, SceneFacts, VolumeRow, VolumeTree, measure_volumes};
use crate::scene::CameraSpec;
use crate::task::{Cancel, Progress};

#[derive(Debug, clap::Args)]
pub struct Args {
    #[command(flatten)]
    model: ModelArgs,
    /// The rays: primary, shadow or diffuse.
    #[arg(long, value_name = "KIND", default_value = "primary")]
    rays: RayKind,
    /// The picture whose rays are traced.
    #[arg(long, value_name = "WxH", default_value = "640x400")]
    size: Size,
    /// The fewest timed rounds of each volume.
    #[arg(long, value_name = "N", default_value_t = 5, value_parser = clap::value_parser!(u32).range(1..))]
    repeat: u32,
    /// The least seconds timed of each volume.
    #[arg(long, default_value = "1", value_parser = seconds)]
    secs: f64,
    /// Seconds that a volume may take; a slower one traces a part of the rays.
    #[arg(long, value_name = "SECS", default_value = "10", value_parser = seconds)]
    cap: f64,
    #[command(flatten)]
    look: LookArgs,
    #[command(flatten)]
    build: BuildArgs,
    /// Print one JSON object.
    #[arg(long)]
    json: bool,
}

/// What is printed as JSON.
#[derive(Serialize)]
struct Volumes {
    scene: SceneFacts,
    machine: MachineFacts,
    size: [u32; 2],
    kind: RayKind,
    nodes: usize,
    volumes: Vec<VolumeRow>,
}

pub fn run(args: &Args, cancel: Cancel) -> Result<(), Failure> {
    let entry = registry::find("volumes").unwrap_or(&registry::ALL[0]);
    let params = args.build.params(&[entry])?.remove(0);
    let cx = Context::new(args.model.machine, cancel);
    let model = cx.load(&args.model.model)?;
    let camera = CameraSpec::or_first(args.look.camera.as_ref(), &model.scene, &model.geometry, args.size.aspect());
    let (set, _memory) = rays::generate(args.rays, &model, camera, rays::finder(&model, &cx)?, args.size, &cx)?;
    let trees = build_all(entry, &params, args, &model, &cx)?;
    let options =
        MeasureOptions { min_rounds: args.repeat as usize, min_secs: args.secs, cap_secs: args.cap, ..MeasureOptions::default() };
    let progress = Progress::new();
    let measured = || measure_volumes(&trees, &set, &options, &cx.pool, &cx.cancel, &progress);
    let rows = bar::watch("volumes", &progress, measured)?;
    let nodes = trees.first().map_or(0, |tree| tree.tree.node_count());
    let size = [args.size.width, args.size.height];
    let report = Volumes { scene: model.facts(), machine: cx.machine(), size, kind: args.rays, nodes, volumes: rows };
    if args.json { print_json(&report) } else { print(&text(args, report)) }
}

/// The same tree with each kind of volume.
fn build_all(entry: &Entry, params: &ParamValues, args: &Args, model: &Model, cx: &Context) -> Result<Vec<VolumeTree>, Failure> {
    let mut trees = Vec::new();
    for kind in KINDS {
        let mut params = params.clone();
        params.set("volume", kind.id).map_err(|error| Failure::Input(format!("{}: {error}", entry.id)))?;
        let build_cx = cx.build_cx();
        let start = Instant::now();
        let build = || build_volumes(&model.geometry, args.build.test, &params, &build_cx);
        let tree = bar::watch(&format!("build {}", kind.id), &build_cx.progress, build).map_err(|error| match error {
            BuildError::Cancelled(_) => Failure::Cancelled,
            other => Failure::Other(other.into()),
        })?;
        trees.push(VolumeTree { id: kind.id, tree: Arc::from(tree), build_secs: start.elapsed().as_secs_f64() });
    }
    Ok(trees)
}

fn text(args: &Args, report: Volumes) -> String {
    let Volumes { scene, machine, nodes, volumes: rows, .. } = report;
    let terms = format!("one tree of {} nodes, {} test", count(nodes as u64), args.build.test.id());
    let head = stats::head(&Report { scene, machine, structures: Vec::new() });
    let of = rows.first().map_or(0, |row| row.rays.of);
    let mut out = facts(&[head, vec![("terms", terms)]].concat());
    out += &format!("\n{} rays: {} at {}\n", args.rays.id(), count(of as u64), args.size);
    out += &table(&rows);
    out += &notes(&rows);
    out
}

fn table(rows: &[VolumeRow]) -> String {
    let mut table = Table::new(&[
        "volume",
        "bytes/node",
        "area",
        "mean",
        "ns/test",
        "±",
        "in vain",
        "volumes/ray",
        "nodes/ray",
        "tests/ray",
        "ms",
        "±",
        "time",
    ]);
    let fastest = rows.iter().map(|row| row.rays.secs_median / row.rays.rays as f64).fold(f64::INFINITY, f64::min);
    for row in rows {
        let (rays, seen) = (&row.rays, &row.traversal);
        table.row(vec![
            row.id.to_owned(),
            number(row.bytes_per_node),
            number(row.area_ratio),
            number(row.area_ratio_mean),
            number(row.test_ns.median),
            number(row.test_ns.spread),
            percent(seen.false_positives),
            number(seen.tests_per_ray),
            number(seen.nodes_per_ray),
            number(rays.prims_per_ray),
            number(rays.secs_median * 1e3),
            number(rays.secs_half_iqr * 1e3),
            ratio(rays.secs_median / rays.rays as f64 / fastest),
        ]);
    }
    table.render()
}

/// What the columns mean, and what holds of a row only.
fn notes(rows: &[VolumeRow]) -> String {
    let mut notes = String::new();
    for row in rows {
        let loose = row.loose;
        if loose.simplified + loose.failed > 0 {
            notes += &format!(
                "{}: {} with too many faces keep the largest ones, {} could not be made and are 26-DOPs\n",
                row.id,
                count(loose.simplified),
                count(loose.failed)
            );
        }
        if let Some(why) = &row.rays.capped {
            notes += &format!("{}: {why}\n", row.id);
        }
    }
    let known = rows.first().map_or(0, |row| row.area_nodes);
    let size: u64 = rows.iter().map(|row| row.test_ns.tests as u64).max().unwrap_or(0);
    notes
        + &format!(
            "\narea is the sum of the volumes' areas over that of the convex hulls', mean the mean of the ratios, over the\n\
             {} nodes whose hull is known. ns/test is a tight loop over at most {} tests of real rays, without\n\
             their set-up. in vain: entered nodes in which the ray hits no triangle. ms is one pass over the rays, ± half the\n\
             interquartile range.\n",
            count(known as u64),
            count(size),
        )
}
