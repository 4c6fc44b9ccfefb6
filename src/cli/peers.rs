//! `boxwood peers`: structures beside those of other libraries, in one process, on the same triangles
//! and the same rays, in turns.

mod chosen;
mod text;

use serde::Serialize;
use std::collections::BTreeSet;
use std::sync::Arc;

use super::args::{LookArgs, MachineArgs, Size, seconds};
use super::context::{Context, Model};
use super::failure::Failure;
use super::output::{print, print_json, warn};
use super::structures::Setting;
use super::{bar, rays};
use crate::accel::Accel;
use crate::geometry::tri::TestKind;
use crate::lab::peers::{PeerRace, PeerRow, Ratios, RayPairs, Recipe, race};
use crate::lab::{MachineFacts, MeasureOptions, PixelOrder, RayKind, SceneFacts};
use crate::scene::CameraSpec;
use crate::task::{Cancel, Charge, Progress};
use chosen::{Asked, Peers, Spec};

#[derive(Debug, clap::Args)]
pub struct Args {
    /// A file (.gltf, .glb, .obj, .ply, .stl), builtin:NAME, or builtin:NAME?triangles=N.
    model: String,
    /// Our structures between commas, each an id or ID:K=V:K=V [default: the bounding volume
    /// hierarchies, each in all its layouts].
    #[arg(long, value_name = "ID[:K=V],..", value_delimiter = ',')]
    structures: Vec<Spec>,
    /// Sets a parameter of every structure of ours that has it, as in --set bins=16.
    #[arg(long, value_name = "[ID.]K=V")]
    set: Vec<Setting>,
    /// Our triangle tests, between commas.
    #[arg(long, value_name = "TESTS", value_delimiter = ',', default_value = "fast,watertight")]
    test: Vec<TestKind>,
    /// The peers: all, none, or beginnings of their ids between commas, as in embree,tinybvh.
    #[arg(long, value_name = "all|none|ID,ID", default_value = "all")]
    peers: Peers,
    /// The kinds of rays between commas: primary, shadow, diffuse, shuffled, lines. A number makes the
    /// picture a square of about so many pixels.
    #[arg(long, value_name = "KINDS|N", value_delimiter = ',')]
    rays: Vec<Asked>,
    /// The picture whose rays are traced.
    #[arg(long, value_name = "WxH", default_value = "1024x1024")]
    size: Size,
    /// The order of the pixels that the rays come from: rows or morton.
    #[arg(long, default_value = "morton")]
    order: PixelOrder,
    /// Numbers of threads that build and trace, between commas; 0 for one on each core.
    #[arg(long, value_name = "N,N", value_delimiter = ',', default_value = "1", value_parser = clap::value_parser!(u16).range(..=1024))]
    threads: Vec<u16>,
    /// Memory that the model, the rays and our structures may take, in MiB [default: half of the
    /// machine's or container's]. What the peers take is not counted.
    #[arg(long, value_name = "MIB")]
    memory: Option<u64>,
    /// The fewest timed rounds of each structure.
    #[arg(long, value_name = "N", default_value_t = 5, value_parser = clap::value_parser!(u32).range(1..))]
    repeat: u32,
    /// The least seconds timed of each structure and kind of rays.
    #[arg(long, default_value = "0.5", value_parser = seconds)]
    secs: f64,
    /// Seconds that a structure may take for one kind of rays; a slower one traces a part of them.
    #[arg(long, value_name = "SECS", default_value = "10", value_parser = seconds)]
    cap: f64,
    /// Builds of each structure; one that takes longer than five seconds is built once.
    #[arg(long, value_name = "N", default_value_t = 3, value_parser = clap::value_parser!(u32).range(1..=100))]
    builds: u32,
    #[command(flatten)]
    look: LookArgs,
    /// Print one JSON object.
    #[arg(long)]
    json: bool,
}

/// What is printed as JSON. The ratios at the top are those of the first number of threads.
#[derive(Debug, Serialize)]
struct Outcome {
    scene: SceneFacts,
    machine: MachineFacts,
    size: [u32; 2],
    order: PixelOrder,
    structures: Vec<PeerRow>,
    ratios: Ratios,
    ratios_watertight: Ratios,
    runs: Vec<Run>,
    /// A word on each peer that is not here.
    missing: Vec<String>,
}

/// The ratios with one number of threads.
#[derive(Clone, Debug, Serialize)]
struct Run {
    threads: usize,
    ratios: Ratios,
    ratios_watertight: Ratios,
}

pub fn run(args: &Args, cancel: Cancel) -> Result<(), Failure> {
    let first = args.context(args.threads.first().copied().unwrap_or(1), &cancel);
    let specs = chosen::specs(&args.structures, &args.set)?;
    let (mut recipes, missing) = args.peers.chosen()?;
    if recipes.is_empty() && specs.is_empty() {
        return Err(Failure::Input("nothing takes part".to_owned()));
    }
    missing.iter().for_each(|why| warn(&format!("left out: {why}")));
    let model = first.load(&args.model)?;
    let ours = chosen::ours(&specs, &args.test, &first);
    recipes.splice(0..0, ours);

    let (sets, _memory) = sets(args, &model, &first)?;
    let (mut structures, mut runs) = (Vec::new(), Vec::new());
    for threads in &args.threads {
        let rows = rows(args, &recipes, &model, &sets, &args.context(*threads, &cancel))?;
        let (ratios, ratios_watertight) = (Ratios::of(&rows, false), Ratios::of(&rows, true));
        let threads = rows.first().map_or(0, |row| row.threads);
        runs.push(Run { threads, ratios, ratios_watertight });
        structures.extend(rows);
    }
    let Some(Run { ratios, ratios_watertight, .. }) = runs.first().cloned() else {
        return Err(Failure::Input("name a number of threads".to_owned()));
    };
    let (scene, machine, size) = (model.facts(), first.machine(), args.size());
    let size = [size.width, size.height];
    let outcome = Outcome { scene, machine, size, order: args.order, structures, ratios, ratios_watertight, runs, missing };
    if args.json { print_json(&outcome) } else { print(&text::text(&outcome)) }
}

impl Args {
    fn context(&self, threads: u16, cancel: &Cancel) -> Context {
        Context::new(MachineArgs { threads: threads.into(), memory: self.memory }, cancel.clone())
    }

    /// The kinds of rays, each once, in the order of tables.
    fn kinds(&self) -> BTreeSet<RayKind> {
        let kinds: BTreeSet<RayKind> = self.rays.iter().filter_map(|asked| asked.kind()).collect();
        let usual = [RayKind::Primary, RayKind::Diffuse, RayKind::Shuffled, RayKind::Shadow];
        if kinds.is_empty() { usual.into() } else { kinds }
    }

    fn size(&self) -> Size {
        self.rays.iter().find_map(|asked| asked.size()).unwrap_or(self.size)
    }
}

/// The rays and what they hit, by the structure that finds primary hits, a tree that equals brute force.
fn sets(args: &Args, model: &Model, cx: &Context) -> Result<(Vec<RayPairs>, Vec<Charge>), Failure> {
    let size = args.size();
    let camera = CameraSpec::or_first(args.look.camera.as_ref(), &model.scene, &model.geometry, size.aspect());
    let finder: Arc<dyn Accel> = rays::finder(model, cx)?;
    let (mut sets, mut memory) = (Vec::new(), Vec::new());
    for kind in args.kinds() {
        memory.push(cx.budget.charge(RayPairs::bytes(size.pixels()))?);
        let (set, _while_made) = rays::ordered(kind, model, camera, Arc::clone(&finder), (size, args.order), cx)?;
        sets.push(RayPairs::of(&set, finder.as_ref(), &cx.pool, &cx.cancel)?);
    }
    Ok((sets, memory))
}

/// Builds and traces on the threads of `cx`.
fn rows(
    args: &Args,
    recipes: &[Box<dyn Recipe>],
    model: &Model,
    sets: &[RayPairs],
    cx: &Context,
) -> Result<Vec<PeerRow>, Failure> {
    let (min_rounds, builds) = (args.repeat as usize, args.builds as usize);
    let options = MeasureOptions { min_rounds, min_secs: args.secs, cap_secs: args.cap, ..MeasureOptions::default() };
    let what = PeerRace { recipes, geometry: &model.geometry, sets, options: &options, builds };
    let progress = Progress::new();
    Ok(bar::watch("peers", &progress, || race(&what, &cx.pool, &cx.cancel, &progress))?)
}
