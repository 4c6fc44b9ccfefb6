//! `boxwood check`: what about a model is known to make ray tracers err, and where structures err on it.

use serde::Serialize;

use super::args::{LookArgs, ModelArgs, Size, seconds};
use super::bar;
use super::context::Context;
use super::failure::Failure;
use super::output::{print, print_json};
use super::structures::{BuildArgs, Many};
use super::table::{Table, facts};
use crate::lab::format::{count, number};
use crate::lab::{CheckError, Checked, MachineFacts, MeshCheck, ModelCheck, SceneFacts, check_model};
use crate::scene::CameraSpec;
use crate::task::Cancel;

#[derive(Debug, clap::Args)]
pub struct Args {
    #[command(flatten)]
    model: ModelArgs,
    /// The structures that are held against exact arithmetic: ids between commas, or all.
    #[arg(long, value_name = "all|ID,ID", default_value = "bvh,wide,kdtree")]
    structures: Many,
    /// The picture whose rays are traced: those of the view, and a diffuse one from each surface that they meet.
    #[arg(long, value_name = "WxH", default_value = "320x200")]
    size: Size,
    /// The most seconds for the rays of a structure; a slower one traces an evenly spread part of them.
    #[arg(long, default_value = "10", value_parser = seconds)]
    secs: f64,
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
struct Outcome {
    scene: SceneFacts,
    machine: MachineFacts,
    #[serde(flatten)]
    check: ModelCheck,
    closed: bool,
}

pub fn run(args: &Args, cancel: Cancel) -> Result<(), Failure> {
    let Many(entries) = &args.structures;
    let params = args.build.params(entries)?;
    let cx = Context::new(args.model.machine, cancel);
    let model = cx.load(&args.model.model)?;
    let mut structures = Vec::new();
    for (entry, params) in entries.iter().zip(&params) {
        let accel = cx.build(entry, &model, args.build.test, params)?.accel;
        structures.push(Checked { id: entry.id.to_owned(), test: args.build.test, accel });
    }
    let camera = CameraSpec::or_first(args.look.camera.as_ref(), &model.scene, &model.geometry, args.size.aspect());
    let scene = model.facts();
    let view = (camera, [args.size.width, args.size.height]);
    let model = (&model.scene, &model.geometry);
    let build_cx = cx.build_cx();
    let check = bar::watch("check", &build_cx.progress, || check_model(model, &structures, view, args.secs, &build_cx));
    let check = check.map_err(|error| match error {
        CheckError::Cancelled(_) => Failure::Cancelled,
        error => Failure::Other(error.into()),
    })?;
    let wrong = check.structures.iter().map(|row| row.wrong).sum::<usize>();
    let outcome = Outcome { scene, machine: cx.machine(), closed: check.mesh.is_closed(), check };
    if args.json { print_json(&outcome) } else { print(&text(&args.model.model, &outcome)) }?;
    if wrong == 0 { Ok(()) } else { Err(Failure::Other(anyhow::anyhow!("{} rays were answered wrongly", count(wrong as u64)))) }
}

fn text(model: &str, outcome: &Outcome) -> String {
    let mesh = &outcome.check.mesh;
    let mut text = facts(&figures(model, mesh));
    text += "\n";
    for finding in mesh.findings() {
        text += &format!("{} {} {}\n", if finding.grave { "!" } else { "-" }, finding.what, finding.remedy);
    }
    if mesh.findings().is_empty() {
        text += "Nothing about the triangles is known to make ray tracers err.\n";
    }
    let mut table = Table::new(&["structure", "test", "rays", "rounded", "wrong"]);
    for row in &outcome.check.structures {
        let counts = [row.rays, row.rounded, row.wrong].map(|n| count(n as u64));
        table.row([row.id.clone(), row.test.id().to_owned()].into_iter().chain(counts).collect());
    }
    format!("{text}\n{}{LEGEND}", table.render())
}

const LEGEND: &str = "\nrounded: rays that meet another triangle than they do exactly, or none, as the rounding of the test may have it. wrong: \
    answers that no rounding explains, or rays that slipped through a closed surface.\n";

fn figures(model: &str, mesh: &MeshCheck) -> [(&'static str, String); 9] {
    [
        ("model", model.to_owned()),
        ("triangles", count(mesh.triangles)),
        ("surface", mesh.surface().to_owned()),
        ("slivers", format!("{}, worst aspect {}", count(mesh.slivers), number(mesh.worst_aspect))),
        ("no area", count(mesh.degenerate)),
        ("not finite", count(mesh.non_finite)),
        ("copies", count(mesh.duplicates)),
        (
            "edges",
            format!(
                "{}, {} of one triangle, {} of more than two",
                count(mesh.edges),
                count(mesh.boundary_edges),
                count(mesh.non_manifold_edges)
            ),
        ),
        ("extent", format!("{} times the shortest edge", number(mesh.extent_ratio))),
    ]
}
