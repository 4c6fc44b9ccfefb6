//! `boxwood render`: a picture in a file.

use std::io::Write;
use std::path::PathBuf;
use std::sync::Arc;

use image::ImageEncoder;

use super::args::{LookArgs, ModelArgs, SceneArgs, Size};
use super::bar;
use super::context::Context;
use super::failure::Failure;
use super::output::{OutFile, print};
use super::structures::{BuildArgs, One};
use super::table::facts;
use crate::accel::Accel;
use crate::lab::format::{MISSING, bytes, duration, number, rate, ratio};
use crate::render::{self, Job, Looks, Mode, Still, auto_range};
use crate::scene::{CameraSpec, Geometry};
use crate::sys;
use crate::task::{Cancel, Phase, Progress};

#[derive(Debug, clap::Args)]
pub struct Args {
    #[command(flatten)]
    model: ModelArgs,
    /// The picture to write.
    #[arg(short, long, value_name = "FILE.png")]
    output: PathBuf,
    /// The structure to trace through.
    #[arg(long, value_name = "ID", default_value = "bvh")]
    structure: One,
    /// What is shown: shaded, path, ao, normals, depth, nodes or prims.
    #[arg(long, default_value = "shaded")]
    mode: Mode,
    /// Samples a pixel.
    #[arg(long, value_name = "N", default_value_t = 16, value_parser = clap::value_parser!(u32).range(1..))]
    spp: u32,
    /// Columns and rows.
    #[arg(long, value_name = "WxH", default_value = "1280x800")]
    size: Size,
    #[command(flatten)]
    look: LookArgs,
    #[command(flatten)]
    build: BuildArgs,
    #[command(flatten)]
    scene: SceneArgs,
}

/// A film holds a sum and a depth for each pixel, and the picture's bytes are made of it.
const BYTES_PER_PIXEL: u64 = 32;

pub fn run(args: &Args, cancel: Cancel) -> Result<(), Failure> {
    if !args.output.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("png")) {
        return Err(Failure::Input(format!("Can't write {}: pictures are .png files", args.output.display())));
    }
    let out = OutFile::at(&args.output)?;
    let One(entry) = args.structure;
    let params = args.build.params(&[entry])?.remove(0);
    let cx = Context::new(args.model.machine, cancel);
    let _memory = cx.budget.charge(args.size.pixels() * BYTES_PER_PIXEL)?;
    let model = cx.load_with_instances(&args.model.model, args.scene)?;
    let built = cx.build(entry, &model, args.build.test, &params)?;

    let camera = CameraSpec::or_first(args.look.camera.as_ref(), &model.scene, &model.geometry, args.size.aspect());
    let looks = if args.mode.shows_looks() { cx.looks(&model)? } else { Looks::default() };
    let memory = memory(&model.geometry, built.accel.as_ref());
    let times =
        [("open", phases(&model.phases)), ("build", format!("{}: {}", duration(built.build_secs), phases(&built.phases)))];
    let job = Job { scene: model.scene, accel: built.accel, camera, mode: args.mode, looks: Arc::new(looks) };
    let (width, height) = (args.size.width, args.size.height);
    let progress = Progress::new();
    let still =
        bar::watch("render", &progress, || render::render(&job, width, height, args.spp, &cx.pool, &cx.cancel, &progress))?;
    let pixels = still.develop(&job, None, None, &cx.pool);
    out.write(&cx.cancel, |file| {
        let png = image::codecs::png::PngEncoder::new(&mut *file);
        png.write_image(&pixels, width, height, image::ExtendedColorType::Rgba8).map_err(std::io::Error::other)?;
        file.flush()
    })?;
    print(&text(args, &still, times, memory))
}

/// `read 400 ms, flatten 800 ms`; phases that come several times, as for each mesh, are summed up.
fn phases(phases: &[Phase]) -> String {
    let mut sums: Vec<Phase> = Vec::new();
    for phase in phases {
        match sums.iter_mut().find(|sum| sum.name == phase.name) {
            Some(sum) => sum.secs += phase.secs,
            None => sums.push(phase.clone()),
        }
    }
    let listed = sums.iter().map(|phase| format!("{} {}", phase.name, duration(phase.secs))).collect::<Vec<_>>().join(", ");
    if listed.is_empty() { MISSING.to_owned() } else { listed }
}

/// What triangles and structure take; and the process, at most, until now.
fn memory(geometry: &Geometry, accel: &dyn Accel) -> String {
    let structure: u64 = accel.memory().iter().map(|part| part.bytes).sum();
    // Of all that are placed: those of one mesh share its bytes.
    let each = number(structure as f64 / geometry.counts().live.max(1) as f64);
    let whole = (geometry.bytes() + structure) as f64;
    let peak =
        sys::peak_memory_bytes().map(|peak| format!("; the process {} at most, {}", bytes(peak), ratio(peak as f64 / whole)));
    format!(
        "triangles {}, structure {} ({each} B a triangle){}",
        bytes(geometry.bytes()),
        bytes(structure),
        peak.unwrap_or_default()
    )
}

fn text(args: &Args, still: &Still, [open, build]: [(&'static str, String); 2], memory: String) -> String {
    let picture = format!("{}, {}, {} spp, {}", args.output.display(), args.size, args.spp, args.mode.id());
    let speed = format!("{}, {}", duration(still.secs), rate(still.rays as f64 / still.secs));
    let mut lines = vec![("picture", picture), open, build, ("trace", speed), ("memory", memory)];
    if args.mode.is_scalar() {
        let range = auto_range(&still.film, args.mode);
        let unit = match args.mode {
            Mode::Nodes => " nodes visited by a ray",
            Mode::Prims => " triangles tested by a ray",
            _ => "",
        };
        lines.push(("range", format!("{} to {}{unit}", number(range.min.into()), number(range.max.into()))));
    }
    facts(&lines)
}
