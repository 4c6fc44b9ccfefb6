//! `boxwood rays`: the rays of a view in a file, and how other commands come by them.

use std::path::PathBuf;
use std::sync::Arc;

use super::args::{LookArgs, ModelArgs, SceneArgs, Size};
use super::context::{Context, Model};
use super::failure::Failure;
use super::output::{OutFile, print};
use super::table::facts;
use super::{bar, npy};
use crate::accel::{Accel, registry};
use crate::geometry::tri::TestKind;
use crate::lab::format::count;
use crate::lab::{PixelOrder, RayKind, RaySet};
use crate::render::{Job, Mode};
use crate::scene::{Camera, CameraSpec};
use crate::task::{Cancel, Charge, Progress};

/// The structure that finds the primary hits. Any would do; this one is quick to build and to trace.
pub const FINDER: &str = "bvh";

#[derive(Debug, clap::Args)]
pub struct Args {
    #[command(flatten)]
    model: ModelArgs,
    /// primary (through pixel centres), shadow (from the primary hits to a light), diffuse (from the
    /// primary hits in random directions), shuffled (those in a random order) or lines (random ones
    /// through the scene, as many as pixels).
    #[arg(long)]
    kind: RayKind,
    /// The file to write: float32 (N, 8), origin, direction, tmin, tmax.
    #[arg(short, long, value_name = "RAYS.npy")]
    output: PathBuf,
    /// The picture whose rays are written.
    #[arg(long, value_name = "WxH", default_value = "1280x800")]
    size: Size,
    /// The order of the pixels that the rays come from: rows or morton.
    #[arg(long, default_value = "rows")]
    order: PixelOrder,
    #[command(flatten)]
    look: LookArgs,
}

pub fn run(args: &Args, cancel: Cancel) -> Result<(), Failure> {
    let out = OutFile::at(&args.output)?;
    let cx = Context::new(args.model.machine, cancel);
    let model = cx.load_with_instances(&args.model.model, SceneArgs::default())?;
    let camera = CameraSpec::or_first(args.look.camera.as_ref(), &model.scene, &model.geometry, args.size.aspect());
    let (set, _memory) = ordered(args.kind, &model, camera, finder(&model, &cx)?, (args.size, args.order), &cx)?;
    out.write(&cx.cancel, |file| npy::write_rays(&set.rays, file))?;
    print(&facts(&[("rays", format!("{}, {} {}", args.output.display(), count(set.rays.len() as u64), set.kind.id()))]))
}

/// Builds the structure that finds the primary hits.
pub fn finder(model: &Model, cx: &Context) -> Result<Arc<dyn Accel>, Failure> {
    let entry = registry::find(FINDER).unwrap_or(&registry::ALL[0]);
    Ok(cx.build(entry, model, TestKind::Watertight, &entry.defaults())?.accel)
}

/// Makes rays, row by row, within the memory budget: what is charged is held as long as they are.
pub fn generate(
    kind: RayKind,
    model: &Model,
    camera: Camera,
    accel: Arc<dyn Accel>,
    size: Size,
    cx: &Context,
) -> Result<(RaySet, Charge), Failure> {
    ordered(kind, model, camera, accel, (size, PixelOrder::Rows), cx)
}

/// The same in an order of pixels.
pub fn ordered(
    kind: RayKind,
    model: &Model,
    camera: Camera,
    accel: Arc<dyn Accel>,
    (size, order): (Size, PixelOrder),
    cx: &Context,
) -> Result<(RaySet, Charge), Failure> {
    // Rays are made in parts, each with its pixel, and then put together.
    let memory = cx.budget.charge(size.pixels() * 2 * (size_of::<crate::geometry::Ray>() as u64 + 8))?;
    let job = Job::new(Arc::clone(&model.scene), accel, camera, Mode::Shaded, Arc::default());
    let made = || RaySet::ordered(kind, order, &job, (size.width, size.height), &cx.pool, &cx.cancel);
    let set = bar::watch(&format!("{} rays", kind.id()), &Progress::new(), made)?;
    Ok((set, memory))
}
