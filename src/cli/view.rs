//! `boxwood [MODEL]`: the window.

use std::path::PathBuf;

use super::args::{LookArgs, MachineArgs, Size};
use super::failure::Failure;
use super::structures::One;
use crate::accel::outline::Rank;
use crate::geometry::Axis;
use crate::render::{HeatRays, Mode};
use crate::scene::Section;

/// How the window begins. What is not said comes from the last time.
#[derive(Debug, clap::Args)]
#[command(next_help_heading = "Options of the window")]
#[command(group(clap::ArgGroup::new("ray").args(["follow", "rays"])))]
pub struct Args {
    /// A file (.gltf, .glb, .obj, .ply, .stl), a saved workspace (.boxwood), builtin:NAME, or builtin:NAME?triangles=N.
    #[arg(help_heading = None::<&str>)]
    pub model: Option<String>,
    /// The structure to show.
    #[arg(long, value_name = "ID")]
    pub structure: Option<One>,
    /// What is shown: shaded, path, ao, normals, depth, nodes, leaves, prims or stack.
    #[arg(long)]
    pub mode: Option<Mode>,
    /// Whose work nodes, leaves, prims and stack are: primary, shadow or bounce.
    #[arg(long, value_name = "KIND")]
    pub heat_rays: Option<HeatRays>,
    /// Samples a pixel after which to rest.
    #[arg(long, value_name = "N")]
    pub spp: Option<u32>,
    /// Cut the model open for the camera: x,0.5 leaves what is below the middle along x, -x,0.5 what is above.
    #[arg(long, value_name = "AXIS,PLACE", allow_hyphen_values = true)]
    pub section: Option<Section>,
    /// Draw boxes only from this part of the view's width on, in per cent from the left.
    #[arg(long, value_name = "PER CENT", value_parser = clap::value_parser!(u32).range(0..100))]
    pub boxes_from: Option<u32>,
    /// The depth of the boxes.
    #[arg(long, value_name = "N")]
    pub depth: Option<u32>,
    /// Show only the boxes of leaves.
    #[arg(long)]
    pub leaves_only: bool,
    /// What colours of boxes stand for: depth, triangles, share (of the SAH cost), overlap or visits.
    #[arg(long, value_name = "WHAT", value_parser = ["depth", "triangles", "share", "overlap", "visits"])]
    pub color_boxes: Option<String>,
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
    /// Show the window at work for some seconds (it turns the view, switches structures, goes down the levels), and save a
    /// picture of each step into this folder.
    #[arg(long, value_name = "DIR", conflicts_with = "screenshot")]
    pub animate: Option<PathBuf>,
    /// Measure every structure before the picture is saved.
    #[arg(long, requires = "screenshot")]
    pub measure: bool,
    /// Time the tiles of the view and show them before the picture is saved.
    #[arg(long, requires = "screenshot")]
    pub time_tiles: bool,
    /// Begin in the Check workspace; with --screenshot, run the stability lab and open the first case that rays slip through.
    #[arg(long, conflicts_with = "measure")]
    pub check: bool,
    /// Begin in the Compare workspace with that plot: image, intersection, model, prediction or scaling; with --screenshot, fill it first.
    #[arg(long, value_name = "PLOT", value_parser = plots(), conflicts_with_all = ["measure", "check"])]
    pub errors: Option<String>,
    /// Begin in the Structure workspace; with --screenshot, select that cell first: dearest, deepest, fullest, overlap or emptiest.
    #[arg(long, value_name = "CELL", conflicts_with_all = ["measure", "check", "errors"])]
    pub select: Option<Rank>,
    /// With that, show the triangles of the cell alone.
    #[arg(long, requires_all = ["select", "screenshot"])]
    pub isolate: bool,
    /// With --select and --screenshot, try a plane across an axis of the cell, at a place from 0 to 1: x,0.4.
    #[arg(long, value_name = "AXIS,PLACE", value_parser = plane, requires = "select")]
    pub try_plane: Option<(Axis, f64)>,
    /// Begin in the Structure workspace; with --screenshot, make the film of the build first, and go to that part of it, from 0 to 1.
    #[arg(long, value_name = "PART", value_parser = part,
        conflicts_with_all = ["measure", "check", "errors", "follow", "rays", "tour", "panes"])]
    pub film: Option<f32>,
    /// With --select and --screenshot, compare bounding volumes around the cell and draw one of them: aabb, sphere, obb, kdop8, kdop14, kdop18, kdop26
    /// or hull.
    #[arg(long, value_name = "KIND", value_parser = volume, requires = "select")]
    pub fit: Option<&'static str>,
    /// Begin in the Ray workspace; with --screenshot, follow the ray of that place first: -1,-1 is the lower left corner of the
    /// view, 1,1 the upper right.
    #[arg(long, value_name = "X,Y", value_parser = place, allow_hyphen_values = true, conflicts_with_all = ["select", "measure", "check", "errors"])]
    pub follow: Option<[f32; 2]>,
    /// Begin in the Ray workspace with that file of rays, six or eight numbers a line or an array of NumPy; with --screenshot,
    /// follow the dearest of them first.
    #[arg(long, value_name = "FILE", conflicts_with_all = ["follow", "select", "measure", "check", "errors"])]
    pub rays: Option<PathBuf>,
    /// With --follow or --rays, and --screenshot, structures whose steps stand beside, at most three, between commas.
    #[arg(long, value_name = "IDS", value_delimiter = ',', requires = "ray")]
    pub beside: Vec<One>,
    /// Compare the whole view with brute force before the picture is saved.
    #[arg(long, requires = "screenshot", conflicts_with_all = ["select", "measure", "check", "errors"])]
    pub check_brute: bool,
    /// Begin the tour at this step, 1 to 6.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u8).range(1..=6), conflicts_with_all = ["measure", "check", "errors", "select", "follow", "rays", "panes"])]
    pub tour: Option<u8>,
    /// Begin in the Compare workspace with these structures beside each other, two to four between commas.
    #[arg(long, value_name = "IDS", value_delimiter = ',', conflicts_with_all = ["structure", "check", "errors", "select", "follow"])]
    pub panes: Vec<One>,
    /// How they stand: divider, two or four.
    #[arg(long, value_name = "HOW", value_parser = ["divider", "two", "four"], requires = "panes")]
    pub arrange: Option<String>,
    /// The last of them shows what rays do more in the first than in it; with --mode nodes, leaves, prims or stack.
    #[arg(long, requires = "panes")]
    pub difference: bool,
    /// In a window that folds the panel at the right, open it over the view.
    #[arg(long)]
    pub unfold: bool,
    /// Turn the camera and switch structures before the picture is saved; say how soon pictures followed, and how long the window's
    /// thread worked for a frame: at most, and within what for 99 of 100.
    #[arg(long, requires = "screenshot")]
    pub pace: bool,
    /// Switch structures a thousand times and open fifty models before the picture is saved, and say what memory was held.
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
    use crate::viewer::settings::{BoxColor, ThemeChoice};
    use crate::viewer::{ViewerError, ViewerOptions, run};
    let theme = if args.light { Some(ThemeChoice::Light) } else { args.dark.then_some(ThemeChoice::Dark) };
    let options = ViewerOptions {
        model: args.model,
        structure: args.structure.map(|one| one.0.id.to_owned()),
        mode: args.mode,
        heat_rays: args.heat_rays,
        camera: args.look.camera,
        section: args.section,
        depth: args.depth,
        boxes_from: args.boxes_from,
        leaves_only: args.leaves_only,
        color_boxes: args.color_boxes.and_then(|what| BoxColor::of_id(&what)),
        no_overlay: args.no_overlay,
        samples: args.spp,
        theme,
        size: args.size.map(|size| [size.width as f32, size.height as f32]),
        measure: args.measure,
        time_tiles: args.time_tiles,
        check: args.check,
        errors: args.errors.and_then(|plot| plot.parse().ok()),
        select: args.select,
        isolate: args.isolate,
        try_plane: args.try_plane,
        film: args.film,
        fit: args.fit,
        follow: args.follow,
        rays: args.rays,
        beside: args.beside.into_iter().map(|one| one.0.id.to_owned()).collect(),
        brute: args.check_brute,
        tour: args.tour.map(|step| usize::from(step) - 1),
        panes: args.panes.into_iter().map(|one| one.0.id.to_owned()).collect(),
        arrange: args.arrange.and_then(|how| how.parse().ok()),
        difference: args.difference,
        unfold: args.unfold,
        pace: args.pace,
        endure: args.endure,
        screenshot: args.screenshot,
        animate: args.animate,
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
    Err(Failure::Other(anyhow::anyhow!("this build has no window; all commands work without one. See 'boxwood --help'")))
}

/// The plots of the Compare workspace by their names.
#[cfg(feature = "viewer")]
fn plots() -> clap::builder::PossibleValuesParser {
    crate::viewer::tradeoffs::Plot::ALL.map(crate::viewer::tradeoffs::Plot::id).into()
}

/// Any name: there is no window to show a plot in.
#[cfg(not(feature = "viewer"))]
fn plots() -> clap::builder::NonEmptyStringValueParser {
    clap::builder::NonEmptyStringValueParser::new()
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

/// `0.3`: a part of a whole.
fn part(text: &str) -> Result<f32, String> {
    let part = text.trim().parse().ok().filter(|part| (0.0..=1.0).contains(part));
    part.ok_or_else(|| "a part is a number from 0 to 1, as in 0.3".to_owned())
}

/// `0.1,-0.2`: a place in the view.
fn place(text: &str) -> Result<[f32; 2], String> {
    let parsed = text.split_once(',').and_then(|(x, y)| Some([x.trim().parse().ok()?, y.trim().parse().ok()?]));
    let inside = parsed.filter(|place: &[f32; 2]| place.iter().all(|x| (-1.0..=1.0).contains(x)));
    inside.ok_or_else(|| "a place is two numbers from -1 to 1, as in 0.1,-0.2".to_owned())
}

#[cfg(all(test, feature = "viewer"))]
mod tests {
    use clap::{Args as _, Command, FromArgMatches as _};

    use super::*;
    use crate::viewer::tradeoffs::Plot;

    #[test]
    fn every_plot_can_be_asked_for_by_its_name_and_the_help_says_all() {
        let command = || Args::augment_args(Command::new("boxwood"));
        let errors = |name: &str| {
            let matches = command().try_get_matches_from(["boxwood", "--errors", name]).map_err(|e| e.to_string())?;
            Args::from_arg_matches(&matches).map(|args| args.errors).map_err(|e| e.to_string())
        };
        let help = command().get_arguments().find(|arg| arg.get_id() == "errors").and_then(|arg| arg.get_help().cloned());
        let help = help.expect("there is help").to_string();
        for plot in Plot::ALL {
            assert_eq!(errors(plot.id()), Ok(Some(plot.id().to_owned())));
            assert_eq!(plot.id().parse(), Ok(plot));
            assert!(help.contains(plot.id()), "{help}");
        }
        let none = errors("cost").expect_err("there is no such plot");
        assert!(Plot::ALL.iter().all(|plot| none.contains(plot.id())), "{none}");
    }
}
