//! `boxwood converge`: image error against run time.

mod text;

use std::fs;
use std::io::{BufReader, Write};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use serde::Serialize;

use super::args::{LightArgs, LookArgs, ModelArgs, SceneArgs, Size, seconds};
use super::bar;
use super::context::Context;
use super::failure::Failure;
use super::output::{OutFile, print, print_json, warn};
use super::plot::{Curve as Plotted, Dot, Panel, log_log, png_of};
use super::structures::{BuildArgs, Many, each_once};
use crate::lab::converge::{
    self, ConvergeCx, ConvergeError, ConvergeOptions, Convergence, Curve, REFERENCE_FACTOR, Reference, Rendered, Runner,
};
use crate::lab::format::count;
use crate::lab::{MachineFacts, Metric, SceneFacts};
use crate::render::sampler::SamplerKind;
use crate::render::{Job, LinearPicture, Mode, Transport};
use crate::scene::CameraSpec;
use crate::scene::texture::Detail;
use crate::task::{Cancel, Progress};

#[derive(Debug, clap::Args)]
pub struct Args {
    #[command(flatten)]
    model: ModelArgs,
    /// The structures: ids between commas, or all.
    #[arg(long, value_name = "all|ID,ID", default_value = "wide,bvh,kdtree,grid2")]
    structures: Many,
    /// The samplers, between commas: independent, sobol, blue-noise.
    #[arg(long, value_name = "SAMPLERS", value_delimiter = ',', default_value = "independent,sobol")]
    samplers: Vec<SamplerKind>,
    /// The most samples a pixel.
    #[arg(long, value_name = "N", default_value_t = 64, value_parser = clap::value_parser!(u32).range(1..=1 << 20))]
    spp: u32,
    /// The most seconds that each structure and sampler renders for, once; slow ones get to fewer samples.
    #[arg(long, value_name = "SECS", value_parser = seconds)]
    seconds: Option<f64>,
    /// How often each is timed, in turns.
    #[arg(long, value_name = "N", default_value_t = 3, value_parser = clap::value_parser!(u32).range(1..=99))]
    runs: u32,
    /// Columns and rows.
    #[arg(long, value_name = "WxH", default_value = "256x160")]
    size: Size,
    /// The folder for the reference, the plots and the data. A reference in it is used again if it is of the same.
    #[arg(short, long, value_name = "DIR")]
    output: PathBuf,
    /// No more samples for pixels that have converged to half a step of 256. It biases every picture, which is told.
    #[arg(long)]
    adaptive: bool,
    #[command(flatten)]
    light: LightArgs,
    #[command(flatten)]
    look: LookArgs,
    #[command(flatten)]
    build: BuildArgs,
    #[command(flatten)]
    scene: SceneArgs,
    /// Print one JSON object.
    #[arg(long)]
    json: bool,
}

/// What is written as JSON.
#[derive(Serialize)]
pub struct Outcome {
    /// Grows when a name changes its meaning.
    version: u32,
    scene: SceneFacts,
    machine: MachineFacts,
    size: [u32; 2],
    seed: u32,
    runs: u32,
    transport: Transport,
    /// What is around the scene.
    surroundings: String,
    /// Whether converged pixels got no more samples: errors are then those of biased pictures.
    adaptive: bool,
    metrics: Vec<[&'static str; 2]>,
    #[serde(flatten)]
    pub convergence: Convergence,
    /// Structures that are missing, and why.
    missing: Vec<[String; 2]>,
}

pub fn run(args: &Args, cancel: Cancel) -> Result<(), Failure> {
    let Many(entries) = &args.structures;
    if Reference::has_samples_of(args.light.seed.seed) {
        return Err(Failure::Input("that seed is the reference's, which has to be independent: use another".to_owned()));
    }
    let params = args.build.params(entries)?;
    let folder = Folder::at(&args.output)?;
    let cx = Context::new(args.model.machine, cancel);
    let model = cx.load_with_instances(&args.model.model, args.scene)?;
    let looks = Arc::new(cx.looks(&model, Detail::Light)?.within(args.light.around.surroundings(&cx)?));
    let (mut runners, mut missing) = (Vec::new(), Vec::new());
    for (entry, params) in entries.iter().zip(&params) {
        match cx.build(entry, &model, args.build.test, params) {
            Ok(built) => runners.push(Runner { id: entry.id.to_owned(), accel: built.accel, build_secs: built.build_secs }),
            Err(crate::accel::BuildError::Cancelled(_)) => return Err(Failure::Cancelled),
            Err(error) => {
                warn(&format!("{} is left out: {error}", entry.id));
                missing.push([entry.id.to_owned(), error.to_string()]);
            }
        }
    }
    let Some(first) = runners.first() else {
        return Err(Failure::Input("none of the structures could be built".to_owned()));
    };
    let camera = CameraSpec::or_first(args.look.camera.as_ref(), &model.scene, &model.geometry, args.size.aspect());
    let job = Job {
        transport: args.light.transport.transport(),
        ..Job::new(Arc::clone(&model.scene), Arc::clone(&first.accel), camera, Mode::Path, looks)
    };
    let outcome = measure(&job, &runners, &args.options(), (&folder, model.facts(), missing), &cx)?;
    write(&outcome, &folder, &cx.cancel)?;
    if args.json { print_json(&outcome) } else { print(&text::of(&args.output, &outcome)) }
}

/// Renders, makes the reference or takes the folder's, and measures.
pub fn measure(
    job: &Job,
    runners: &[Runner],
    options: &ConvergeOptions,
    (folder, scene, missing): (&Folder, SceneFacts, Vec<[String; 2]>),
    cx: &Context,
) -> Result<Outcome, Failure> {
    let progress = Progress::new();
    let (pool, cancel, budget) = (cx.pool.clone(), cx.cancel.clone(), cx.budget.clone());
    let with = ConvergeCx { pool, cancel, progress: progress.clone(), budget };
    let rendered = bar::watch("converge", &progress, || converge::render(job, runners, options, &with))?;
    let reference = reference(job, &rendered, options, folder, &with)?;
    Ok(Outcome {
        version: 1,
        scene,
        machine: cx.machine(),
        size: options.size,
        seed: options.seed,
        runs: options.runs,
        transport: job.transport,
        surroundings: job.looks.surroundings().describe(),
        adaptive: options.adaptive,
        metrics: Metric::ALL.map(|metric| [metric.label(), metric.formula()]).into(),
        convergence: converge::evaluate(&rendered, &reference),
        missing,
    })
}

impl Args {
    fn options(&self) -> ConvergeOptions {
        ConvergeOptions {
            size: [self.size.width, self.size.height],
            spp: self.spp,
            secs: self.seconds,
            runs: self.runs,
            samplers: each_once(self.samplers.clone()),
            seed: self.light.seed.seed,
            adaptive: self.adaptive,
        }
    }
}

impl From<ConvergeError> for Failure {
    fn from(error: ConvergeError) -> Self {
        match error {
            ConvergeError::Cancelled(_) => Self::Cancelled,
            error @ ConvergeError::Memory(_) => Self::Other(error.into()),
        }
    }
}

/// Where everything goes.
pub struct Folder(PathBuf);

impl Folder {
    /// Makes it if it is not there.
    pub fn at(path: &Path) -> Result<Self, Failure> {
        fs::create_dir_all(path).map_err(|error| Failure::of_output(path, &error))?;
        Ok(Self(path.to_owned()))
    }

    fn file(&self, name: &str) -> Result<OutFile, Failure> {
        OutFile::at(&self.0.join(name))
    }

    /// Writes a file in it.
    pub fn write(&self, name: &str, bytes: &[u8], cancel: &Cancel) -> Result<(), Failure> {
        self.file(name)?.write(cancel, |out| out.write_all(bytes))
    }
}

const REFERENCE: &str = "reference.exr";

/// The reference of the folder if it will do, or else a new one, which is kept there.
fn reference(
    job: &Job,
    rendered: &Rendered,
    options: &ConvergeOptions,
    folder: &Folder,
    cx: &ConvergeCx,
) -> Result<Reference, Failure> {
    let most = rendered.lanes.iter().filter_map(|lane| lane.shots.last()).map(|shot| shot.spp).max().unwrap_or(1);
    let spp = most.saturating_mul(REFERENCE_FACTOR);
    let kept = fs::File::open(folder.0.join(REFERENCE)).ok().and_then(|file| LinearPicture::read(BufReader::new(file)).ok());
    if let Some(kept) = kept.and_then(Reference::from_picture).filter(|kept| kept.suits(job, options.size, spp)) {
        return Ok(kept);
    }
    let with = (&cx.pool, &cx.cancel, &cx.progress);
    let made = bar::watch("reference", &cx.progress, || Reference::render(job, options.size, spp, with))?;
    let picture = made.to_picture();
    folder.file(REFERENCE)?.write(&cx.cancel, |out| picture.write(out).map_err(std::io::Error::other))?;
    Ok(made)
}

fn write(outcome: &Outcome, folder: &Folder, cancel: &Cancel) -> Result<(), Failure> {
    let json = serde_json::to_vec_pretty(outcome).map_err(|error| Failure::Other(error.into()))?;
    folder.write("convergence.json", &json, cancel)?;
    folder.write("convergence.csv", csv(&outcome.convergence.curves).as_bytes(), cancel)?;
    for (name, panel) in panels(outcome) {
        let svg = log_log(&[panel]).map_err(|error| Failure::Other(anyhow::anyhow!("{error}")))?;
        let png = png_of(&svg).map_err(|error| Failure::Other(anyhow::anyhow!("{error}")))?;
        folder.write(&format!("{name}.svg"), svg.as_bytes(), cancel)?;
        folder.write(&format!("{name}.png"), &png, cancel)?;
    }
    Ok(())
}

/// A line a point.
pub fn csv(curves: &[Curve]) -> String {
    let mut out = "structure,sampler,build_secs,spp,secs,secs_min,secs_max,rmse,relmse,mae,smape,flip,hollow\n".to_owned();
    for curve in curves {
        for p in &curve.points {
            let e = &p.errors;
            let flip = e.flip.map_or(String::new(), |flip| flip.to_string());
            out += &format!(
                "{},{},{},{},{},{},{},{},{},{},{},{flip},{}\n",
                curve.structure,
                curve.sampler.id(),
                curve.build_secs,
                p.spp,
                p.secs,
                p.secs_min,
                p.secs_max,
                e.rmse,
                e.relmse,
                e.mae,
                e.smape,
                p.hollow
            );
        }
    }
    out
}

/// Error against samples, and against seconds.
pub fn panels(outcome: &Outcome) -> [(&'static str, Panel); 2] {
    let curves = &outcome.convergence.curves;
    let several = curves.iter().any(|c| c.sampler != curves[0].sampler);
    let plotted = |curve: &Curve, of_secs: bool| {
        let dot = |p: &converge::Point| Dot {
            at: (if of_secs { p.secs } else { f64::from(p.spp) }, p.errors.rmse),
            span: of_secs.then_some((p.secs_min, p.secs_max)),
            hollow: p.hollow,
        };
        let name = if several { format!("{}, {}", curve.structure, curve.sampler.id()) } else { curve.structure.clone() };
        let mut samplers: Vec<SamplerKind> = curves.iter().map(|c| c.sampler).collect();
        samplers.dedup();
        let dash = samplers.iter().position(|sampler| *sampler == curve.sampler).unwrap_or(0);
        Plotted { id: curve.structure.clone(), name, dash, points: curve.points.iter().map(dot).collect() }
    };
    let reference = &outcome.convergence.reference;
    let panel = |title: &str, x: &'static str, of_secs: bool| Panel {
        title: format!("{}: {title}, reference of {} spp", outcome.scene.path, count(reference.spp.into())),
        axes: [x, "RMSE of linear light"],
        curves: curves.iter().map(|curve| plotted(curve, of_secs)).collect(),
        guide: Some(("slope -1/2", |x| x.powf(-0.5))),
        labelled: false,
    };
    [
        ("error-samples", panel("error against samples", "samples a pixel", false)),
        ("error-seconds", panel("error against seconds", "seconds from the end of the build", true)),
    ]
}
