//! `boxwood report`: everything that can be measured on a model, on one page.

use std::path::PathBuf;
use std::sync::Arc;

use super::args::{AroundArgs, LookArgs, ModelArgs};
use super::bar;
use super::context::Context;
use super::converge::Folder;
use super::failure::Failure;
use super::output::print;
use super::structures::{BuildArgs, Many};
use super::table::facts;
use crate::lab::converge::Reference;
use crate::lab::everything::{self, Amount, ReportError, Subject};
use crate::scene::CameraSpec;
use crate::scene::texture::Detail;
use crate::task::{Cancel, Cancelled};

#[derive(Debug, clap::Args)]
pub struct Args {
    #[command(flatten)]
    model: ModelArgs,
    /// The folder for the page and the data.
    #[arg(short, long, value_name = "DIR")]
    output: PathBuf,
    /// Fewer rays, samples and structures: under a minute for 300,000 triangles.
    #[arg(long)]
    quick: bool,
    /// The structures: ids between commas, or all [default: wide,bvh,kdtree,grid2, and without --quick octree and bsp].
    #[arg(long, value_name = "all|ID,ID")]
    structures: Option<Many>,
    #[command(flatten)]
    look: LookArgs,
    #[command(flatten)]
    around: AroundArgs,
    #[command(flatten)]
    build: BuildArgs,
}

pub fn run(args: &Args, cancel: Cancel) -> Result<(), Failure> {
    let amount = Amount::of(args.quick);
    let entries = args.structures.clone().map_or_else(|| amount.entries(), |Many(entries)| entries);
    let params = args.build.params(&entries)?;
    let folder = Folder::at(&args.output)?;
    let cx = Context::new(args.model.machine, cancel);
    let model = cx.load(&args.model.model)?;
    let looks = Arc::new(cx.looks(&model, Detail::Light)?.within(args.around.surroundings(&cx)?));
    let aspect = amount.rays[0] as f32 / amount.rays[1] as f32;
    let camera = CameraSpec::or_first(args.look.camera.as_ref(), &model.scene, &model.geometry, aspect);
    let ids = entries.iter().map(|entry| entry.id).collect::<Vec<_>>().join(",");
    let view = passed_on(&["--camera", "--set", "--test", "--threads", "--memory"]);
    let light = passed_on(&["--environment", "--environment-turn", "--environment-strength", "--sun"]);
    let subject = Subject {
        scene: model.scene,
        geometry: model.geometry,
        looks,
        camera,
        structures: entries.into_iter().zip(params).collect(),
        test: args.build.test,
        commands: amount.commands(&args.model.model, &ids, [&view, &light], true),
    };
    let build_cx = cx.build_cx();
    // What takes longest is there even if all else is stopped.
    let mut keep = |reference: &Reference| folder.keep_reference(reference, &cx.cancel).map_err(unkept);
    let make = || everything::report(&subject, &amount, (folder.reference(), &mut keep), &build_cx);
    for (name, bytes) in bar::watch("report", &build_cx.progress, make)? {
        folder.write(name, &bytes, &cx.cancel)?;
    }
    let page = args.output.join(everything::PAGE).display().to_string();
    print(&facts(&[("report", page), ("data", "report.json, convergence.csv, structures.csv, reference.exr".to_owned())]))
}

/// Why a reference could not be put into the folder.
fn unkept(failure: Failure) -> ReportError {
    let why = match failure {
        Failure::Cancelled | Failure::Closed => return ReportError::Cancelled(Cancelled),
        Failure::Input(why) => why,
        Failure::Other(error) => format!("{error:#}"),
    };
    ReportError::Form { what: everything::REFERENCE, why }
}

impl From<ReportError> for Failure {
    fn from(error: ReportError) -> Self {
        match error {
            ReportError::Cancelled(_) => Self::Cancelled,
            error @ ReportError::NothingBuilt => Self::Input(error.to_string()),
            ReportError::Memory(over) => over.into(),
            error => Self::Other(error.into()),
        }
    }
}

/// Those of the arguments that this program was given, as they were typed.
fn passed_on(names: &[&str]) -> String {
    let mut said = String::new();
    let mut arguments = std::env::args().skip(1);
    while let Some(argument) = arguments.next() {
        let (name, value) = match argument.split_once('=') {
            Some((name, value)) => (name.to_owned(), Some(value.to_owned())),
            None => (argument, None),
        };
        if names.contains(&name.as_str()) {
            let value = value.or_else(|| arguments.next()).unwrap_or_default();
            said += &if value.contains(' ') { format!(" {name} \"{value}\"") } else { format!(" {name} {value}") };
        }
    }
    said
}
