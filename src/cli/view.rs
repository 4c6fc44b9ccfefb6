//! `boxwood [MODEL]`: the window.

use std::path::PathBuf;

use super::args::{LookArgs, MachineArgs, Size};
use super::failure::Failure;
use super::structures::One;
use crate::accel::outline::Rank;
use crate::geometry::Axis;
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
    /// What is shown: shaded, path, ao, normals, depth, nodes, leaves or prims.
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
    /// Begin in the Structure workspace; with --screenshot, select that cell first: dearest, deepest, fullest or overlap.
    #[arg(long, value_name = "CELL", conflicts_with_all = ["measure", "check", "errors"])]
    pub select: Option<Rank>,
    /// With that, try a plane across an axis of the cell, at a place from 0 to 1: x,0.4.
    #[arg(long, value_name = "AXIS,PLACE", value_parser = plane, requires = "select")]
    pub try_plane: Option<(Axis, f64)>,
    /// With that, compare bounding volumes around the cell and draw one of them: aabb, sphere, obb, kdop8, kdop14, kdop18, kdop26
    /// or hull.
    #[arg(long, value_name = "KIND", value_parser = volume, requires = "select")]
    pub fit: Option<&'static str>,
    /// Begin in the Ray workspace; with --screenshot, follow the ray of that place first: -1,-1 is the lower left corner of the
    /// view, 1,1 the upper right.
    #[arg(long, value_name = "X,Y", value_parser = place, allow_hyphen_values = true, conflicts_with_all = ["select", "measure", "check", "errors"])]
    pub follow: Option<[f32; 2]>,
    /// With that, structures whose steps stand beside, at most three, between commas.
    #[arg(long, value_name = "IDS", value_delimiter = ',', requires = "follow")]
    pub beside: Vec<One>,
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
        select: args.select,
        try_plane: args.try_plane,
        fit: args.fit,
        follow: args.follow,
        beside: args.beside.into_iter().map(|one| one.0.id.to_owned()).collect(),
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

/// A kind of bounding volume that is compared.
fn volume(text: &str) -> Result<&'static str, String> {
    let known = crate::lab::fitted_kinds().find(|kind| *kind == text);
    known.ok_or_else(|| format!("there is no such volume: use {}", crate::lab::fitted_kinds().collect::<Vec<_>>().join(", ")))
}

/// `x,0.4`: a plane across an axis, and where.
fn plane(text: &str) -> Result<(Axis, f64), String> {
    let parsed = text.split_once(',').and_then(|(axis, place)| {
        let axis = Axis::ALL.into_iter().find(|known| known.name() == axis.trim())?;
        let place = place.trim().parse::<f64>().ok().filter(|place| (0.0..=1.0).contains(place))?;
        Some((axis, place))
    });
    parsed.ok_or_else(|| "a plane is an axis and a place from 0 to 1, as in x,0.4".to_owned())
}

/// `0.1,-0.2`: a place in the view.
fn place(text: &str) -> Result<[f32; 2], String> {
    let parsed = text.split_once(',').and_then(|(x, y)| Some([x.trim().parse().ok()?, y.trim().parse().ok()?]));
    let inside = parsed.filter(|place: &[f32; 2]| place.iter().all(|x| (-1.0..=1.0).contains(x)));
    inside.ok_or_else(|| "a place is two numbers from -1 to 1, as in 0.1,-0.2".to_owned())
}
