//! `boxwood report`: everything that can be measured on a model, on one page.

mod html;
mod sections;

use std::path::PathBuf;
use std::sync::Arc;

use serde::Serialize;

use super::args::{AroundArgs, LookArgs, ModelArgs, Size};
use super::context::{Context, Model};
use super::converge::{self, Folder};
use super::failure::Failure;
use super::output::print;
use super::structures::{BuildArgs, Many};
use super::table::facts;
use super::{bar, quality, rays, stats};
use crate::accel::Accel;
use crate::geometry::tri::TestKind;
use crate::lab::converge::{ConvergeOptions, Runner};
use crate::lab::tradeoffs::{TradeoffRow, Tradeoffs, Variant};
use crate::lab::{
    CheckError, Checked, Contestant, Enough, MeasureOptions, MeshCheck, ModelCheck, QualityOptions, RayKind, Report, check_model,
    measure,
};
use crate::render::sampler::SamplerKind;
use crate::render::{self, Curve, Job, Mode, Tone, Until};
use crate::scene::texture::Detail;
use crate::scene::{Camera, CameraSpec, Finding};
use crate::task::{Cancel, Progress};

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

/// How much of everything.
struct Amount {
    structures: &'static str,
    picture: Size,
    spp: u32,
    rays: Size,
    times: MeasureOptions,
    lines: Enough,
    epo: usize,
    converge: Size,
    converge_spp: u32,
    runs: u32,
    tradeoffs: [u32; 2],
    builders: bool,
    check: Size,
    check_secs: f64,
}

impl Amount {
    fn of(quick: bool) -> Self {
        let times = MeasureOptions::default();
        if quick {
            Self {
                structures: "wide,bvh,kdtree,grid2",
                picture: Size { width: 480, height: 300 },
                spp: 16,
                rays: Size { width: 240, height: 150 },
                times: MeasureOptions { min_rounds: 3, min_secs: 0.15, cap_secs: 1.0, ..times },
                lines: Enough { three_sigma: 0.05, secs: 0.2, lines: 1 << 15 },
                epo: 5_000,
                converge: Size { width: 80, height: 50 },
                converge_spp: 16,
                runs: 1,
                tradeoffs: [120, 75],
                builders: false,
                check: Size { width: 80, height: 50 },
                check_secs: 0.5,
            }
        } else {
            Self {
                structures: "wide,bvh,kdtree,grid2,octree,bsp",
                picture: Size { width: 640, height: 400 },
                spp: 64,
                rays: Size { width: 480, height: 300 },
                times,
                lines: Enough::default(),
                epo: crate::accel::epo::MOST,
                converge: Size { width: 160, height: 100 },
                converge_spp: 64,
                runs: 3,
                tradeoffs: [240, 150],
                builders: true,
                check: Size { width: 320, height: 200 },
                check_secs: 10.0,
            }
        }
    }
}

/// Everything that was measured, and what is written as JSON.
#[derive(Serialize)]
struct Everything {
    /// Grows when a name changes its meaning.
    version: u32,
    quick: bool,
    #[serde(flatten)]
    report: Report,
    left_out: Vec<LeftOut>,
    convergence: converge::Outcome,
    tradeoffs: Vec<TradeoffRow>,
    check: ModelCheck,
    /// What repeats it.
    commands: Vec<String>,
}

/// A feature, and why it is used or left out.
#[derive(Serialize)]
struct LeftOut {
    feature: &'static str,
    used: bool,
    why: String,
}

/// A picture and what it shows.
struct Shown {
    png: Vec<u8>,
    caption: String,
}

pub fn run(args: &Args, cancel: Cancel) -> Result<(), Failure> {
    let amount = Amount::of(args.quick);
    let Many(entries) = args.structures.clone().map_or_else(|| amount.structures.parse().map_err(Failure::Input), Ok)?;
    let params = args.build.params(&entries)?;
    let folder = Folder::at(&args.output)?;
    let cx = Context::new(args.model.machine, cancel);
    let model = cx.load(&args.model.model)?;
    let looks = Arc::new(cx.looks(&model, Detail::Light)?.within(args.around.surroundings(&cx)?));
    let camera = CameraSpec::or_first(args.look.camera.as_ref(), &model.scene, &model.geometry, amount.rays.aspect());

    let options = QualityOptions { epo_most: Some(amount.epo), lines: Some(amount.lines), ..QualityOptions::default() };
    let (mut structures, mut built) = (Vec::new(), Vec::new());
    for (entry, params) in entries.iter().zip(&params) {
        let (row, one) = stats::row(entry, args.build.test, (params, &options), &model, &cx)?;
        built.extend(one.map(|one| Runner { id: row.id.clone(), accel: one.accel, build_secs: one.build_secs }));
        structures.push(row);
    }
    let Some(first) = built.first() else { return Err(Failure::Input("none of the structures could be built".to_owned())) };
    let mut report = Report { scene: model.facts(), machine: cx.machine(), structures };
    time(&mut report, &built, &model, camera, &amount, &cx)?;

    let view = |mode| Job::new(Arc::clone(&model.scene), Arc::clone(&first.accel), camera, mode, Arc::clone(&looks));
    let pictures = pictures(&view, &amount, &cx)?;
    let job = view(Mode::Path);
    let convergence = {
        let size = [amount.converge.width, amount.converge.height];
        let samplers = vec![SamplerKind::Independent, SamplerKind::Sobol];
        let options =
            ConvergeOptions { size, spp: amount.converge_spp, secs: None, runs: amount.runs, samplers, seed: 0, adaptive: false };
        let missing = report.structures.iter().filter_map(|row| Some([row.id.clone(), row.error.clone()?])).collect();
        converge::measure(&job, &built, &options, (&folder, model.facts(), missing), &cx)?
    };
    let tradeoffs = tradeoffs(&view(Mode::Shaded), &entries.iter().copied().zip(params).collect::<Vec<_>>(), &amount, &cx)?;
    let check = check(&model, &built, args.build.test, camera, &amount, &cx)?;
    let needs = looks.needs().findings(&model.scene);
    let left_out = needs.into_iter().map(|Finding { feature, used, why }| LeftOut { feature: feature.name(), used, why });
    let everything = Everything {
        version: 1,
        quick: args.quick,
        report,
        left_out: left_out.collect(),
        convergence,
        tradeoffs,
        check,
        commands: args.commands(&entries.iter().map(|entry| entry.id).collect::<Vec<_>>().join(","), &amount),
    };
    let page = sections::page(&everything, &pictures).map_err(|why| Failure::Other(anyhow::anyhow!("{why}")))?;
    let json = serde_json::to_vec_pretty(&everything).map_err(|error| Failure::Other(error.into()))?;
    folder.write("report.json", &json, &cx.cancel)?;
    folder.write("convergence.csv", converge::csv(&everything.convergence.convergence.curves).as_bytes(), &cx.cancel)?;
    folder.write("structures.csv", sections::csv(&everything).as_bytes(), &cx.cancel)?;
    folder.write("index.html", page.as_bytes(), &cx.cancel)?;
    let page = args.output.join("index.html").display().to_string();
    print(&facts(&[("report", page), ("data", "report.json, convergence.csv, structures.csv, reference.exr".to_owned())]))
}

impl Args {
    fn commands(&self, ids: &str, amount: &Amount) -> Vec<String> {
        let model = &self.model.model;
        let model = if model.contains(' ') { format!("\"{model}\"") } else { model.clone() };
        let (rays, size) = (amount.rays, amount.converge);
        let quick = if self.quick { " --quick" } else { "" };
        let view = passed_on(&["--camera", "--set", "--test", "--threads", "--memory"]);
        let light = passed_on(&["--environment", "--environment-turn", "--environment-strength", "--sun"]);
        let (spp, runs) = (amount.converge_spp, amount.runs);
        vec![
            format!("boxwood report {model} -o DIR{quick} --structures {ids}{view}{light}"),
            format!("boxwood compare {model} --structures {ids} --size {rays} --flatten --quality --fit-costs{view}"),
            format!(
                "boxwood converge {model} -o DIR --structures {ids} --size {size} --spp {spp} --runs {runs} --flatten{view}{light}"
            ),
            format!("boxwood check {model} --structures {ids} --size {}{view}", amount.check),
        ]
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

/// Times the structures on three kinds of rays, and fits their costs.
fn time(
    report: &mut Report,
    built: &[Runner],
    model: &Model,
    camera: Camera,
    amount: &Amount,
    cx: &Context,
) -> Result<(), Failure> {
    let contestant = |runner: &Runner| Contestant { id: runner.id.clone(), accel: Arc::clone(&runner.accel) };
    let contestants: Vec<Contestant> = built.iter().map(contestant).collect();
    let finder: Arc<dyn Accel> = Arc::clone(&built[0].accel);
    let mut sets = Vec::new();
    for kind in [RayKind::Primary, RayKind::Shadow, RayKind::Diffuse] {
        let (set, memory) = rays::generate(kind, model, camera, Arc::clone(&finder), amount.rays, cx)?;
        let progress = Progress::new();
        let measured = || measure(&contestants, &set, &amount.times, &cx.pool, &cx.cancel, &progress);
        let timings = bar::watch(&format!("{} rays", kind.id()), &progress, measured)?;
        for (row, timing) in quality::built(&mut report.structures).zip(timings) {
            row.rays.insert(kind, timing);
        }
        sets.push((set, memory));
    }
    quality::fit(&contestants, &sets, &mut report.structures, cx)
}

/// The model as it looks, in light, and as the first structure sees it.
fn pictures(view: &impl Fn(Mode) -> Job, amount: &Amount, cx: &Context) -> Result<Vec<Shown>, Failure> {
    let mut pictures = Vec::new();
    for (mode, spp) in [(Mode::Shaded, 4), (Mode::Path, amount.spp), (Mode::Nodes, 1)] {
        let (job, progress) = (view(mode), Progress::new());
        let size = (amount.picture.width, amount.picture.height);
        let until = Until::samples(spp);
        let still = bar::watch("pictures", &progress, || render::render(&job, size, &until, &cx.pool, &cx.cancel, &progress))?;
        let exposure = still.film.fitting_exposure().filter(|_| mode == Mode::Path).unwrap_or(0.0);
        let rgba = still.develop(&job, None, Tone { exposure, curve: Curve::Filmic }, None, &cx.pool);
        let mut png = Vec::new();
        let encoder = image::codecs::png::PngEncoder::new(&mut png);
        image::ImageEncoder::write_image(encoder, &rgba, size.0, size.1, image::ExtendedColorType::Rgba8)
            .map_err(|error| Failure::Other(error.into()))?;
        let exposed = if mode == Mode::Path { format!(", {exposure:+.1} stops, filmic") } else { String::new() };
        pictures.push(Shown { png, caption: format!("{}, {spp} samples a pixel{exposed}.", mode.label()) });
    }
    Ok(pictures)
}

fn tradeoffs(
    job: &Job,
    entries: &[(&'static crate::accel::registry::Entry, crate::accel::params::ParamValues)],
    amount: &Amount,
    cx: &Context,
) -> Result<Vec<TradeoffRow>, Failure> {
    let build_cx = cx.build_cx();
    let all = Variant::all_of(entries);
    let variants: Vec<Variant> = all.into_iter().filter(|variant| amount.builders || variant.is_plain()).collect();
    let quiet = cx.build_cx();
    let made = bar::watch("exact answers", &quiet.progress, || Tradeoffs::new(job, amount.tradeoffs, &quiet));
    let made = made.map_err(failed)?;
    build_cx.progress.start("quality against cost", variants.len() as u64);
    let progress = build_cx.progress.clone();
    bar::watch("tradeoffs", &progress, || {
        let mut rows = Vec::new();
        for variant in &variants {
            rows.push(made.measure(variant, job.accel.geometry(), &cx.build_cx())?);
            progress.advance(1);
        }
        Ok(rows)
    })
}

fn check(
    model: &Model,
    built: &[Runner],
    test: TestKind,
    camera: Camera,
    amount: &Amount,
    cx: &Context,
) -> Result<ModelCheck, Failure> {
    let checked = |runner: &Runner| Checked { id: runner.id.clone(), test, accel: Arc::clone(&runner.accel) };
    let structures: Vec<Checked> = built.iter().map(checked).collect();
    let (build_cx, size) = (cx.build_cx(), [amount.check.width, amount.check.height]);
    let of = (&model.scene, &model.geometry);
    bar::watch("check", &build_cx.progress, || check_model(of, &structures, (camera, size), amount.check_secs, &build_cx))
        .map_err(failed)
}

fn failed(error: CheckError) -> Failure {
    match error {
        CheckError::Cancelled(_) => Failure::Cancelled,
        error => Failure::Other(error.into()),
    }
}

/// What a reader is told of the triangles.
fn said_of(mesh: &MeshCheck) -> Vec<(bool, String)> {
    mesh.findings().into_iter().map(|finding| (finding.grave, format!("{} {}", finding.what, finding.remedy))).collect()
}
