//! `boxwood render`: a picture in a file.

use std::io::Write;
use std::path::PathBuf;
use std::sync::Arc;

use super::args::{LightArgs, LookArgs, ModelArgs, SceneArgs, Size, ToneArgs, positive, seconds};
use super::bar;
use super::context::Context;
use super::failure::Failure;
use super::output::{OutFile, print};
use super::structures::{BuildArgs, One};
use super::table::facts;
use crate::accel::Accel;
use crate::lab::format::{MISSING, bytes, count, duration, number, percent, rate, ratio};
use crate::render::sampler::{SamplerKind, Sampling};
use crate::render::{self, HeatRays, Job, LinearPicture, Looks, Mode, Still, Until, Work, auto_range};
use crate::scene::texture::Detail;
use crate::scene::{CameraSpec, Geometry, Section};
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
    /// What is shown: shaded, path, ao, normals, depth, nodes, leaves, prims or stack.
    #[arg(long, default_value = "shaded")]
    mode: Mode,
    /// Whose work nodes, leaves, prims and stack are: of the camera's rays (primary), or of rays that leave what they meet, to a light
    /// beside the camera (shadow) or in a random direction (bounce).
    #[arg(long, value_name = "KIND", default_value = "primary")]
    heat_rays: HeatRays,
    /// Samples a pixel; at most, where --seconds or --until-error say when it is done [default: 16, or 65536 with those].
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    spp: Option<u32>,
    /// Stop after so many seconds of rendering.
    #[arg(long, value_name = "SECS", value_parser = seconds)]
    seconds: Option<f64>,
    /// Stop once the estimated noise is down to this: root mean square of the standard errors of linear red, green and blue.
    #[arg(long, value_name = "ERROR", value_parser = positive)]
    until_error: Option<f64>,
    /// No more samples for pixels that have converged to half a step of 256. It biases the picture by less than it shows.
    #[arg(long)]
    adaptive: bool,
    /// The numbers samples are made of: independent, sobol or blue-noise.
    #[arg(long, default_value = "independent")]
    sampler: SamplerKind,
    #[command(flatten)]
    light: LightArgs,
    #[command(flatten)]
    tone: ToneArgs,
    /// Columns and rows.
    #[arg(long, value_name = "WxH", default_value = "1280x800")]
    size: Size,
    #[command(flatten)]
    look: LookArgs,
    /// Cut the model open for rays of the camera: x,0.5 leaves what is below the middle along x, -x,0.5 what is above.
    #[arg(long, value_name = "AXIS,PLACE", allow_hyphen_values = true)]
    section: Option<Section>,
    #[command(flatten)]
    build: BuildArgs,
    #[command(flatten)]
    scene: SceneArgs,
}

/// A film holds a sum and a depth for each pixel, and the picture's bytes are made of it.
const BYTES_PER_PIXEL: u64 = 32;

pub fn run(args: &Args, cancel: Cancel) -> Result<(), Failure> {
    let ending = args.output.extension().map(std::ffi::OsStr::to_ascii_lowercase);
    let is_exr = ending.as_deref() == Some("exr".as_ref());
    if !is_exr && ending.as_deref() != Some("png".as_ref()) {
        return Err(Failure::Input(format!("Can't write {}: pictures are .png or .exr files", args.output.display())));
    }
    if args.heat_rays != HeatRays::Primary && !args.mode.is_heat() {
        let (rays, mode) = (args.heat_rays.id(), args.mode.id());
        let why = format!("--heat-rays {rays} is for heat maps, which {mode} is not: use --mode nodes, leaves, prims or stack");
        return Err(Failure::Input(why));
    }
    let out = OutFile::at(&args.output)?;
    let One(entry) = args.structure;
    let params = args.build.params(&[entry])?.remove(0);
    let cx = Context::new(args.model.machine, cancel);
    let _memory = cx.budget.charge(args.size.pixels() * BYTES_PER_PIXEL)?;
    let model = cx.load_with_instances(&args.model.model, args.scene)?;
    let built = cx.build(entry, &model, args.build.test, &params)?;

    let camera = CameraSpec::or_first(args.look.camera.as_ref(), &model.scene, &model.geometry, args.size.aspect());
    let looks = match args.mode {
        Mode::Path => cx.looks(&model, Detail::Light)?.within(args.light.around.surroundings(&cx)?),
        mode if mode.shows_looks() => cx.looks(&model, Detail::Colors)?,
        _ => Looks::default(),
    };
    let memory = memory(&model.geometry, built.accel.as_ref());
    let times =
        [("open", phases(&model.phases)), ("build", format!("{}: {}", duration(built.build_secs), phases(&built.phases)))];
    let job = Job {
        sampling: Sampling { kind: args.sampler, seed: args.light.seed.seed },
        transport: args.light.transport.transport(),
        section: args.section.map(|section| section.of(model.geometry.world_bounds())),
        heat_rays: args.heat_rays,
        ..Job::new(model.scene, built.accel, camera, args.mode, Arc::new(looks))
    };
    let size = (args.size.width, args.size.height);
    let (progress, until) = (Progress::new(), args.until());
    let still = bar::watch("render", &progress, || render::render(&job, size, &until, &cx.pool, &cx.cancel, &progress))?;
    if is_exr {
        let picture = LinearPicture { width: size.0, height: size.1, pixels: still.film.linear(), notes: args.notes(&still) };
        out.write(&cx.cancel, |file| picture.write(file).map_err(std::io::Error::other))?;
    } else {
        let pixels = still.develop(&job, None, args.tone.tone(&still.film), None, &cx.pool);
        let png = render::png(&pixels, size.into()).map_err(|why| Failure::Other(why.into()))?;
        out.write(&cx.cancel, |file| file.write_all(&png))?;
    }
    print(&text(args, &still, times, memory))
}

impl Args {
    fn until(&self) -> Until {
        let open = self.seconds.is_some() || self.until_error.is_some();
        let samples = self.spp.unwrap_or(if open { 1 << 16 } else { 16 });
        Until { samples, secs: self.seconds, noise: self.until_error, adaptive: self.adaptive }
    }

    /// What an EXR file says of its picture.
    fn notes(&self, still: &Still) -> Vec<(String, String)> {
        let notes = [
            ("model", self.model.model.clone()),
            ("structure", self.structure.0.id.to_owned()),
            ("mode", self.mode.id().to_owned()),
            ("spp", still.film.samples().to_string()),
            ("sampler", self.sampler.id().to_owned()),
            ("seed", self.light.seed.seed.to_string()),
            ("seconds", still.secs.to_string()),
        ];
        let heat = self.mode.is_heat().then(|| ("heat_rays", self.heat_rays.id().to_owned()));
        let section = self.section.map(|section| ("section", section.to_string()));
        notes.into_iter().chain(heat).chain(section).map(|(key, value)| (key.to_owned(), value)).collect()
    }
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

/// What the threads' time went to.
fn shares(work: &Work) -> String {
    let parts =
        [("tracing", work.tracing), ("shading", work.shading), ("the rest", work.rest)].map(|(n, d)| (n, d.as_secs_f64()));
    let all: f64 = parts.iter().map(|(_, secs)| secs).sum();
    parts.map(|(name, secs)| format!("{} {name}", percent(secs / all.max(f64::MIN_POSITIVE)))).join(", ")
}

fn text(args: &Args, still: &Still, [open, build]: [(&'static str, String); 2], memory: String) -> String {
    let samples = still.film.samples();
    let picture = format!("{}, {}, {samples} spp, {}", args.output.display(), args.size, args.mode.id());
    let speed = format!("{}, {}", duration(still.secs), rate(still.work.rays as f64 / still.secs));
    let mut lines = vec![("picture", picture), open, build, ("trace", speed), ("time", shares(&still.work)), ("memory", memory)];
    if let Some(noise) = still.film.noise() {
        let share = percent(still.film.share());
        lines
            .push(("noise", format!("{noise:.3e} estimated after {}; {share} of pixels in the last pass", duration(still.secs))));
    }
    if let Some(most) = args.light.transport.clamp {
        let Work { clamped, lost, .. } = still.work;
        let share = percent(lost / (lost + still.film.light()).max(f64::MIN_POSITIVE));
        lines.push(("clamped", format!("{} contributions above {most}: {share} of the light is missing", count(clamped))));
    }
    if args.mode.is_scalar() {
        let range = auto_range(&still.film, args.mode);
        let unit = match args.mode {
            Mode::Nodes => format!(" nodes visited by {}", args.heat_rays.each()),
            Mode::Leaves => format!(" leaves visited by {}", args.heat_rays.each()),
            Mode::Prims => format!(" triangles tested by {}", args.heat_rays.each()),
            Mode::Stack => format!(" entries on the stack at once, {}", args.heat_rays.each()),
            _ => String::new(),
        };
        lines.push(("range", format!("{} to {}{unit}", number(range.min.into()), number(range.max.into()))));
    }
    facts(&lines)
}
