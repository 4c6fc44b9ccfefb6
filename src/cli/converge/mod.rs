//! `boxwood converge`: image error against run time.

mod text;

use std::fs;
use std::io::{BufReader, Write};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::args::{LightArgs, LookArgs, ModelArgs, SceneArgs, Size, seconds};
use super::bar;
use super::context::Context;
use super::failure::Failure;
use super::output::{OutFile, print, print_json, warn};
use super::structures::{BuildArgs, Many, each_once};
use crate::lab::converge::{ConvergeCx, ConvergeError, ConvergeOptions, Outcome, Reference, Runner, csv, measure, panels};
use crate::lab::everything::REFERENCE;
use crate::lab::plot::{png_of, svg_of};
use crate::render::sampler::SamplerKind;
use crate::render::{Job, LinearPicture, Mode};
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
    let (pool, cancel, budget) = (cx.pool.clone(), cx.cancel.clone(), cx.budget.clone());
    let with = ConvergeCx { pool, cancel, progress: Progress::new(), budget };
    let of = (model.facts(), missing, folder.reference());
    let (outcome, made) = bar::watch("converge", &with.progress, || measure(&job, &runners, &args.options(), of, &with))?;
    if let Some(made) = made {
        folder.keep_reference(&made, &cx.cancel)?;
    }
    write(&outcome, &folder, &cx.cancel)?;
    if args.json { print_json(&outcome) } else { print(&text::of(&args.output, &outcome)) }
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

    /// The reference that is in it.
    pub fn reference(&self) -> Option<Reference> {
        let file = fs::File::open(self.0.join(REFERENCE)).ok()?;
        LinearPicture::read(BufReader::new(file)).ok().and_then(Reference::from_picture)
    }

    /// Puts a reference into it, to be used again.
    pub fn keep_reference(&self, reference: &Reference, cancel: &Cancel) -> Result<(), Failure> {
        let picture = reference.to_picture();
        self.file(REFERENCE)?.write(cancel, |out| picture.write(out).map_err(std::io::Error::other))
    }
}

fn write(outcome: &Outcome, folder: &Folder, cancel: &Cancel) -> Result<(), Failure> {
    let json = serde_json::to_vec_pretty(outcome).map_err(|error| Failure::Other(error.into()))?;
    folder.write("convergence.json", &json, cancel)?;
    folder.write("convergence.csv", csv(&outcome.convergence.curves).as_bytes(), cancel)?;
    for (name, panel) in panels(outcome) {
        let svg = svg_of(&[panel]).map_err(|error| Failure::Other(anyhow::anyhow!("{error}")))?;
        let png = png_of(&svg).map_err(|error| Failure::Other(anyhow::anyhow!("{error}")))?;
        folder.write(&format!("{name}.svg"), svg.as_bytes(), cancel)?;
        folder.write(&format!("{name}.png"), &png, cancel)?;
    }
    Ok(())
}
