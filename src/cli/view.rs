//! `boxwood [MODEL]`: the window.

use std::path::PathBuf;

use super::args::{MachineArgs, Size};
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
    /// What is shown: shaded, normals, depth, ao, nodes or prims.
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
    #[command(flatten)]
    pub machine: MachineArgs,
}

pub fn run(args: Args) -> Result<(), Failure> {
    open_viewer(args)
}

/// ==== WIRING POINT: hand `args` to `viewer::run` here, under `cfg(feature = "viewer")`. ====
fn open_viewer(args: Args) -> Result<(), Failure> {
    let _ = args;
    Err(Failure::Other(anyhow::anyhow!(
        "this build has no viewer; the commands scenes, stats, compare, render, rays and trace work. See 'boxwood --help'"
    )))
}
