//! `boxwood trace`: replays rays from a file and writes what they hit.

use rayon::prelude::*;
use serde::Serialize;
use std::path::PathBuf;
use std::time::Instant;

use super::args::{ModelArgs, SceneArgs};
use super::context::Context;
use super::failure::Failure;
use super::output::{OutFile, print, print_json};
use super::structures::{BuildArgs, One};
use super::table::facts;
use super::{bar, hits, npy};
use crate::accel::{Accel, Hit, Mode, Traced};
use crate::geometry::Ray;
use crate::lab::format::{count, duration, rate};
use crate::lab::{MachineFacts, SceneFacts};
use crate::task::{Cancel, Cancelled, Progress};

#[derive(Debug, clap::Args)]
pub struct Args {
    #[command(flatten)]
    model: ModelArgs,
    /// The structure to trace through.
    #[arg(long, value_name = "ID")]
    structure: One,
    /// The rays: float32 or float64 (N, 8), origin xyz, direction xyz, tmin, tmax. Directions need not
    /// have unit length; t is in units of the direction.
    #[arg(long, value_name = "RAYS.npy")]
    rays: PathBuf,
    /// The file to write: t, u, v (float32) and primitive (uint32) of each ray.
    #[arg(long, value_name = "HITS.npz")]
    hits: PathBuf,
    /// Ask only whether anything is hit: t is 0 if so, infinite if not.
    #[arg(long)]
    any_hit: bool,
    #[command(flatten)]
    build: BuildArgs,
    #[command(flatten)]
    scene: SceneArgs,
    /// Print one JSON object.
    #[arg(long)]
    json: bool,
}

/// What is printed as JSON.
#[derive(Serialize)]
struct Outcome {
    scene: SceneFacts,
    machine: MachineFacts,
    structure: &'static str,
    test: &'static str,
    any_hit: bool,
    build_secs: f64,
    rays: usize,
    hits: usize,
    /// Rays that hit nothing because they are no rays: not finite, no direction, a wrong interval.
    invalid: u64,
    in_beams: u64,
    secs: f64,
    mrays_per_sec: f64,
}

pub fn run(args: &Args, cancel: Cancel) -> Result<(), Failure> {
    let out = OutFile::at(&args.hits)?;
    let One(entry) = args.structure;
    let params = args.build.params(&[entry])?.remove(0);
    let cx = Context::new(args.model.machine, cancel);
    let (rays, _rays_memory) = npy::read_rays(&args.rays, &cx.budget, &cx.cancel)?;
    let _hits_memory = cx.budget.charge((rays.len() * size_of::<Option<Hit>>()) as u64)?;
    let model = cx.load_whole(&args.model.model, args.scene)?;
    let built = cx.build(entry, &model, args.build.test, &params)?;

    let mode = if args.any_hit { Mode::Any } else { Mode::Closest };
    let mut found = vec![None; rays.len()];
    let progress = Progress::new();
    let start = Instant::now();
    let Traced { invalid, in_beams } =
        bar::watch("trace", &progress, || trace(built.accel.as_ref(), &rays, mode, &mut found, &cx, &progress))?;
    let secs = start.elapsed().as_secs_f64();
    out.write(&cx.cancel, |file| hits::write(&found, mode, &model.scene, file))?;
    let outcome = Outcome {
        scene: model.facts(),
        machine: cx.machine(),
        structure: entry.id,
        test: args.build.test.id(),
        any_hit: args.any_hit,
        build_secs: built.build_secs,
        rays: rays.len(),
        hits: found.iter().filter(|hit| hit.is_some()).count(),
        invalid,
        in_beams,
        secs,
        mrays_per_sec: rays.len() as f64 / secs * 1e-6,
    };
    if args.json { print_json(&outcome) } else { print(&text(&outcome)) }
}

/// Traces all rays.
fn trace(
    accel: &dyn Accel,
    rays: &[Ray],
    mode: Mode,
    hits: &mut [Option<Hit>],
    cx: &Context,
    progress: &Progress,
) -> Result<Traced, Cancelled> {
    const CHUNK: usize = 4096;
    progress.start("trace", rays.len() as u64);
    let chunk = |(rays, hits): (&[Ray], &mut [Option<Hit>])| {
        let traced = accel.trace(rays, mode, hits, &cx.cancel)?;
        progress.advance(rays.len() as u64);
        Ok(traced)
    };
    cx.pool
        .run(|| rays.par_chunks(CHUNK).zip(hits.par_chunks_mut(CHUNK)).map(chunk).try_reduce(Traced::default, |a, b| Ok(a + b)))
}

fn text(outcome: &Outcome) -> String {
    facts(&[
        ("structure", format!("{}, {} test, built in {}", outcome.structure, outcome.test, duration(outcome.build_secs))),
        ("rays", count(outcome.rays as u64)),
        ("hits", count(outcome.hits as u64)),
        ("invalid", count(outcome.invalid)),
        ("in beams", count(outcome.in_beams)),
        ("trace", format!("{}, {}", duration(outcome.secs), rate(outcome.mrays_per_sec * 1e6))),
    ])
}
