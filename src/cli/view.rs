//! `boxwood [MODEL]`: the window.

use std::path::PathBuf;

use super::args::{LookArgs, MachineArgs, Size};
use super::failure::Failure;
use super::structures::One;
use crate::render::Mode;

/// How the window begins. What is not said comes from the last time.
#[derive(Debug, clap::Args)]
#[command(next_help_heading = "Options of the window")]
pub struct Args {
    /// A file (.gltf, .glb, .obj, .ply, .stl), builtin:NAME, or builtin:NAME?triangles=N.
    #[arg(help_heading = None::<&str>)]
    pub model: Option<String>,
    /// The structure to show.
    #[arg(long, value_name = "ID")]
    pub structure: Option<One>,
    /// What is shown: shaded, path, ao, normals, depth, nodes or prims.
    #[arg(long)]
    pub mode: Option<Mode>,
    /// Samples a pixel after which to rest.
    #[arg(long, value_name = "N")]
    pub spp: Option<u32>,
    /// The depth of the boxes.
    #[arg(long, value_name = "N")]
    pub depth: Option<u32>,
    /// Show only the boxes of leaves.
    #[arg(long)]
    pub leaves_only: bool,
    /// Show no boxes and planes.
    #[arg(long)]
    pub no_overlay: bool,
    /// Use the light theme.
    #[arg(long, conflicts_with = "dark")]
    pub light: bool,
    /// Use the dark theme.
    #[arg(long)]
    pub dark: bool,
    /// The size of the window in points.
    #[arg(long, value_name = "WxH")]
    pub size: Option<Size>,
    /// Save a picture of the window once everything is there, and close it.
    #[arg(long, value_name = "FILE.png")]
    pub screenshot: Option<PathBuf>,
    /// Measure every structure before the picture is saved.
    #[arg(long, requires = "screenshot")]
    pub measure: bool,
    /// Begin in the Check workspace; with --screenshot, run the stability lab and open the first case that rays slip through.
    #[arg(long, conflicts_with = "measure")]
    pub check: bool,
    /// Begin in the Compare workspace with that plot: image, intersection or model; with --screenshot, fill it first.
    #[arg(long, value_name = "PLOT", value_parser = ["image", "intersection", "model"], conflicts_with_all = ["measure", "check"])]
    pub errors: Option<String>,
    /// Turn the camera and switch structures before that, and say how soon pictures followed.
    #[arg(long, requires = "screenshot")]
    pub pace: bool,
    /// Switch structures a thousand times and open fifty models before that, and say what memory was held.
    #[arg(long, requires = "screenshot")]
    pub endure: bool,
    #[command(flatten)]
    pub look: LookArgs,
    #[command(flatten)]
    pub machine: MachineArgs,
}

/// Opens the window and returns when it is closed.
#[cfg(feature = "viewer")]
pub fn run(args: Args) -> Result<(), Failure> {
    use crate::viewer::{ViewerError, ViewerOptions, run, settings::ThemeChoice};
    let theme = if args.light { Some(ThemeChoice::Light) } else { args.dark.then_some(ThemeChoice::Dark) };
    let options = ViewerOptions {
        model: args.model,
        structure: args.structure.map(|one| one.0.id.to_owned()),
        mode: args.mode,
        camera: args.look.camera,
        depth: args.depth,
        leaves_only: args.leaves_only,
        no_overlay: args.no_overlay,
        samples: args.spp,
        theme,
        size: args.size.map(|size| [size.width as f32, size.height as f32]),
        measure: args.measure,
        check: args.check,
        errors: args.errors.and_then(|plot| plot.parse().ok()),
        pace: args.pace,
        endure: args.endure,
        screenshot: args.screenshot,
        threads: args.machine.threads,
        memory_mib: args.machine.memory,
    };
    run(options).map_err(|error| match error {
        ViewerError::NoStructure(..) => Failure::Input(error.to_string()),
        ViewerError::NoWindow(_) => Failure::Other(error.into()),
    })
}

/// Says that there is no window in this build.
#[cfg(not(feature = "viewer"))]
pub fn run(_: Args) -> Result<(), Failure> {
    Err(Failure::Other(anyhow::anyhow!(
        "this build has no window; the commands scenes, stats, compare, render, rays and trace work. See 'boxwood --help'"
    )))
}
