//! Everything that can be measured on a model, on one page with its data: pictures, what is left out, structures, timings,
//! predicted against measured, the three errors and stability.

mod amount;
mod html;
mod sections;

pub use amount::{Amount, settings};

use std::io::Cursor;
use std::sync::Arc;

use serde::Serialize;

use super::converge::{self, ConvergeCx, ConvergeError, ConvergeOptions, Outcome, Reference, Runner};
use super::tradeoffs::{TradeoffRow, Tradeoffs, Variant};
use super::{
    CheckError, Checked, Contestant, CostRow, FitOptions, MachineFacts, MeshCheck, ModelCheck, QualityOptions, RayKind, RaySet,
    Report, SceneFacts, StructureRow, built, check_model, fit_costs, measure,
};
use crate::accel::BuildCx;
use crate::accel::params::ParamValues;
use crate::accel::registry::Entry;
use crate::geometry::Ray;
use crate::geometry::tri::TestKind;
use crate::render::sampler::SamplerKind;
use crate::render::{self, Curve, Job, Looks, Mode, Tone, Until};
use crate::scene::{Camera, Finding, Geometry, Scene};
use crate::task::{Cancelled, Charge, OverBudget, Progress};

/// What a report is of.
#[derive(Clone)]
pub struct Subject {
    /// The model.
    pub scene: Arc<Scene>,
    /// Its triangles.
    pub geometry: Arc<Geometry>,
    /// What surfaces look like, with the images that light asks for, and what is around.
    pub looks: Arc<Looks>,
    /// From where it is seen.
    pub camera: Camera,
    /// The structures, and what they are built with.
    pub structures: Vec<(&'static Entry, ParamValues)>,
    /// The triangle test.
    pub test: TestKind,
    /// What repeats it, a line each.
    pub commands: Vec<String>,
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
    convergence: Outcome,
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

/// The name of the page among the files.
pub const PAGE: &str = "index.html";
/// The name of the reference among them.
pub const REFERENCE: &str = "reference.exr";

/// Puts a reference where a report that is begun again finds it.
pub type Keep<'a> = dyn FnMut(&Reference) -> Result<(), ReportError> + 'a;

/// A file of a report: its name, and what is in it.
pub type File = (&'static str, Vec<u8>);

/// Why there is no report.
#[derive(Debug, thiserror::Error)]
pub enum ReportError {
    /// Asked to stop.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
    /// There is nothing to measure.
    #[error("none of the structures could be built")]
    NothingBuilt,
    /// Rays or pictures do not fit.
    #[error(transparent)]
    Memory(#[from] OverBudget),
    /// What others are compared with could not be made.
    #[error(transparent)]
    Check(CheckError),
    /// Something could not be put into its form.
    #[error("{what} can't be made: {why}")]
    Form {
        /// What it was to be.
        what: &'static str,
        /// Why not.
        why: String,
    },
}

impl From<CheckError> for ReportError {
    fn from(error: CheckError) -> Self {
        match error {
            CheckError::Cancelled(cancelled) => Self::Cancelled(cancelled),
            error => Self::Check(error),
        }
    }
}

impl From<ConvergeError> for ReportError {
    fn from(error: ConvergeError) -> Self {
        match error {
            ConvergeError::Cancelled(cancelled) => Self::Cancelled(cancelled),
            ConvergeError::Memory(over) => Self::Memory(over),
        }
    }
}

fn form(what: &'static str, why: impl std::fmt::Display) -> ReportError {
    ReportError::Form { what, why: why.to_string() }
}

/// Measures everything and makes the files of the report, the page last. `kept` is a reference of before, which is taken
/// again if it will do; a new one is given to `keep` as soon as it is made, and is among the files. The context's progress has
/// a phase for each section.
///
/// The caller sees to it that nothing else keeps the processors busy.
///
/// # Errors
/// Asked to stop, [`ReportError`], or what `keep` says.
pub fn report(
    of: &Subject,
    amount: &Amount,
    (kept, keep): (Option<Reference>, &mut Keep<'_>),
    cx: &BuildCx,
) -> Result<Vec<File>, ReportError> {
    let (rows, built) = structures(of, amount, cx)?;
    let first = built.first().ok_or(ReportError::NothingBuilt)?;
    let view = |mode| Job::new(Arc::clone(&of.scene), Arc::clone(&first.accel), of.camera, mode, Arc::clone(&of.looks));
    let scene = SceneFacts::of(&of.scene, &of.geometry);
    let machine = MachineFacts::here(cx.pool.threads());
    let mut report = Report { scene: scene.clone(), machine, structures: rows };
    time(&mut report, &built, &view(Mode::Shaded), amount, cx)?;
    let pictures = pictures(&view, amount, cx)?;
    let missing = report.structures.iter().filter_map(|row| Some([row.id.clone(), row.error.clone()?])).collect();
    let (convergence, made) = converge(&view(Mode::Path), &built, amount, (scene, missing, kept), cx)?;
    if let Some(made) = &made {
        keep(made)?;
    }
    let tradeoffs = tradeoffs(&view(Mode::Shaded), &of.structures, amount, cx)?;
    let check = check(of, &built, amount, cx)?;
    let needs = of.looks.needs().findings(&of.scene);
    let left_out = needs.into_iter().map(|Finding { feature, used, why }| LeftOut { feature: feature.name(), used, why });
    let everything = Everything {
        version: 1,
        quick: amount.quick,
        report,
        left_out: left_out.collect(),
        convergence,
        tradeoffs,
        check,
        commands: of.commands.clone(),
    };
    files(&everything, &pictures, made.as_ref())
}

/// What goes into the folder.
fn files(all: &Everything, pictures: &[Shown], made: Option<&Reference>) -> Result<Vec<File>, ReportError> {
    let page = sections::page(all, pictures).map_err(|why| form("a plot", why))?;
    let mut files = Vec::new();
    if let Some(made) = made {
        let mut bytes = Cursor::new(Vec::new());
        made.to_picture().write(&mut bytes).map_err(|why| form(REFERENCE, why))?;
        files.push((REFERENCE, bytes.into_inner()));
    }
    files.push(("report.json", serde_json::to_vec_pretty(all).map_err(|why| form("report.json", why))?));
    files.push(("convergence.csv", converge::csv(&all.convergence.convergence.curves).into_bytes()));
    files.push(("structures.csv", sections::csv(all).into_bytes()));
    files.push((PAGE, page.into_bytes()));
    Ok(files)
}

/// The same work, whose own progress nobody hears of.
fn quiet(cx: &BuildCx) -> BuildCx {
    BuildCx { progress: Progress::new(), ..cx.clone() }
}

/// Builds the structures and looks at them: a row for each, and those that could be built.
fn structures(of: &Subject, amount: &Amount, cx: &BuildCx) -> Result<(Vec<StructureRow>, Vec<Runner>), ReportError> {
    let options = QualityOptions { epo_most: Some(amount.epo), lines: Some(amount.lines), ..QualityOptions::default() };
    let (mut rows, mut built) = (Vec::new(), Vec::new());
    cx.progress.start("structures", of.structures.len() as u64);
    for (entry, params) in &of.structures {
        let (row, one) = StructureRow::of(entry, of.test, (params, &options), &of.geometry, &quiet(cx))?;
        built.extend(one.map(|one| Runner { id: row.id.clone(), accel: one.accel, build_secs: one.build_secs }));
        rows.push(row);
        cx.progress.advance(1);
    }
    Ok((rows, built))
}

/// Times the structures on three kinds of rays, and fits their costs.
fn time(report: &mut Report, runners: &[Runner], view: &Job, amount: &Amount, cx: &BuildCx) -> Result<(), ReportError> {
    let contestant = |runner: &Runner| Contestant { id: runner.id.clone(), accel: Arc::clone(&runner.accel) };
    let contestants: Vec<Contestant> = runners.iter().map(contestant).collect();
    let mut sets: Vec<(RaySet, Charge)> = Vec::new();
    let kinds = [RayKind::Primary, RayKind::Shadow, RayKind::Diffuse];
    let [width, height] = amount.rays;
    cx.progress.start("timings", kinds.len() as u64 + 1);
    for kind in kinds {
        // Rays are made in parts, each with its pixel, and then put together.
        let memory = cx.budget.charge(u64::from(width) * u64::from(height) * 2 * (size_of::<Ray>() as u64 + 8))?;
        let set = RaySet::generate(kind, view, width, height, &cx.pool, &cx.cancel)?;
        let timings = measure(&contestants, &set, &amount.times, &cx.pool, &cx.cancel, &Progress::new())?;
        for (row, timing) in built(&mut report.structures).zip(timings) {
            row.rays.insert(kind, timing);
        }
        sets.push((set, memory));
        cx.progress.advance(1);
    }
    let sets: Vec<&RaySet> = sets.iter().map(|(set, _)| set).collect();
    let fitted = fit_costs(&contestants, &sets, &FitOptions::default(), &cx.pool, &cx.cancel, &Progress::new())?;
    for (row, costs) in built(&mut report.structures).zip(fitted) {
        row.costs = costs.zip(row.quality.as_ref()).map(|(costs, quality)| CostRow::of(costs, quality));
    }
    Ok(())
}

/// The model as it looks, in light, and as the first structure sees it.
fn pictures(view: &impl Fn(Mode) -> Job, amount: &Amount, cx: &BuildCx) -> Result<Vec<Shown>, ReportError> {
    let mut pictures = Vec::new();
    let modes = [(Mode::Shaded, 4), (Mode::Path, amount.spp), (Mode::Nodes, 1)];
    cx.progress.start("pictures", modes.len() as u64);
    for (mode, spp) in modes {
        let (job, [width, height]) = (view(mode), amount.picture);
        let until = Until::samples(spp);
        let still = render::render(&job, (width, height), &until, &cx.pool, &cx.cancel, &Progress::new())?;
        let exposure = still.film.fitting_exposure().filter(|_| mode == Mode::Path).unwrap_or(0.0);
        let rgba = still.develop(&job, None, Tone { exposure, curve: Curve::Filmic }, None, &cx.pool);
        let png = render::png(&rgba, [width, height]).map_err(|why| form("a picture", why))?;
        let exposed = if mode == Mode::Path { format!(", {exposure:+.1} stops, filmic") } else { String::new() };
        pictures.push(Shown { png, caption: format!("{}, {spp} samples a pixel{exposed}.", mode.label()) });
        cx.progress.advance(1);
    }
    Ok(pictures)
}

/// Image error against run time.
fn converge(
    job: &Job,
    built: &[Runner],
    amount: &Amount,
    with: (SceneFacts, Vec<[String; 2]>, Option<Reference>),
    cx: &BuildCx,
) -> Result<(Outcome, Option<Reference>), ReportError> {
    let options = ConvergeOptions {
        size: amount.converge,
        spp: amount.converge_spp,
        secs: None,
        runs: amount.runs,
        samplers: vec![SamplerKind::Independent, SamplerKind::Sobol],
        seed: 0,
        adaptive: false,
    };
    // Its phases are long enough to be told.
    let (pool, cancel, progress, budget) = (cx.pool.clone(), cx.cancel.clone(), cx.progress.clone(), cx.budget.clone());
    Ok(converge::measure(job, built, &options, with, &ConvergeCx { pool, cancel, progress, budget })?)
}

/// Quality against its cost.
fn tradeoffs(
    job: &Job,
    structures: &[(&'static Entry, ParamValues)],
    amount: &Amount,
    cx: &BuildCx,
) -> Result<Vec<TradeoffRow>, ReportError> {
    let all = Variant::all_of(structures);
    let variants: Vec<Variant> = all.into_iter().filter(|variant| amount.builders || variant.is_plain()).collect();
    cx.progress.start("exact answers", 0);
    let made = Tradeoffs::new(job, amount.tradeoffs, &quiet(cx))?;
    cx.progress.start("quality", variants.len() as u64);
    let mut rows = Vec::new();
    for variant in &variants {
        rows.push(made.measure(variant, job.accel.geometry(), &quiet(cx))?);
        cx.progress.advance(1);
    }
    Ok(rows)
}

/// The triangles, and where structures err on them.
fn check(of: &Subject, built: &[Runner], amount: &Amount, cx: &BuildCx) -> Result<ModelCheck, ReportError> {
    let checked = |runner: &Runner| Checked { id: runner.id.clone(), test: of.test, accel: Arc::clone(&runner.accel) };
    let structures: Vec<Checked> = built.iter().map(checked).collect();
    cx.progress.start("check", 0);
    let model = (&of.scene, &of.geometry);
    Ok(check_model(model, &structures, (of.camera, amount.check), amount.check_secs, &quiet(cx))?)
}

/// What a reader is told of the triangles.
fn said_of(mesh: &MeshCheck) -> Vec<(bool, String)> {
    mesh.findings().into_iter().map(|finding| (finding.grave, format!("{} {}", finding.what, finding.remedy))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accel::registry;
    use crate::scene::texture::Textures;
    use crate::scene::{LoadCx, open};

    #[test]
    fn a_reference_is_kept_before_what_comes_after_it() {
        let load = LoadCx::unattended();
        let scene = open("builtin:cornell-box", &load).expect("built in");
        let geometry = Arc::new(Geometry::new(&scene, &load).expect("fits"));
        let entry = registry::find("bvh").expect("registered");
        let of = Subject {
            looks: Arc::new(Looks::new(&scene, Textures::none())),
            camera: scene.first_camera(geometry.world_bounds(), 1.0),
            scene: Arc::new(scene),
            geometry,
            structures: vec![(entry, entry.defaults())],
            test: TestKind::Watertight,
            commands: Vec::new(),
        };
        let small = [8, 8];
        let sizes = Amount { picture: small, rays: small, converge: small, tradeoffs: small, check: small, ..Amount::of(true) };
        let amount = Amount { spp: 1, converge_spp: 1, ..sizes };
        let (cx, mut kept) = (BuildCx::unattended(1), None);
        let mut keep = |reference: &Reference| {
            kept = Some(reference.facts.size);
            cx.cancel.cancel();
            Ok(())
        };
        let made = report(&of, &amount, (None, &mut keep), &cx);
        assert!(matches!(made, Err(ReportError::Cancelled(_))), "{:?}", made.err());
        assert_eq!(kept, Some(small));
    }
}
