//! What a run of `converge` came to: its JSON, its lines for spreadsheets, its plots.

use serde::Serialize;

use super::{
    ConvergeCx, ConvergeError, ConvergeOptions, Convergence, Curve, Point, REFERENCE_FACTOR, Reference, Runner, evaluate, render,
};
use crate::lab::format::count;
use crate::lab::plot::{Curve as Plotted, Dot, Mark, Panel};
use crate::lab::{MachineFacts, Metric, SceneFacts};
use crate::render::sampler::SamplerKind;
use crate::render::{Job, Transport};

/// What is written as JSON.
#[derive(Serialize)]
pub struct Outcome {
    /// Grows when a name changes its meaning.
    pub version: u32,
    /// The model.
    pub scene: SceneFacts,
    /// The machine.
    pub machine: MachineFacts,
    /// Columns and rows.
    pub size: [u32; 2],
    /// Of the samples.
    pub seed: u32,
    /// How often each was timed.
    pub runs: u32,
    /// How far light was followed.
    pub transport: Transport,
    /// What is around the scene.
    pub surroundings: String,
    /// Whether converged pixels got no more samples: errors are then those of biased pictures.
    pub adaptive: bool,
    /// Measures of error, and their formulas.
    pub metrics: Vec<[&'static str; 2]>,
    /// What was measured.
    #[serde(flatten)]
    pub convergence: Convergence,
    /// Structures that are missing, and why.
    pub missing: Vec<[String; 2]>,
}

/// Renders, and measures against a reference that was kept, if it will do, or else a new one, which comes second.
///
/// # Errors
/// Asked to stop, or the pictures do not fit.
pub fn measure(
    job: &Job,
    runners: &[Runner],
    options: &ConvergeOptions,
    (scene, missing, kept): (SceneFacts, Vec<[String; 2]>, Option<Reference>),
    cx: &ConvergeCx,
) -> Result<(Outcome, Option<Reference>), ConvergeError> {
    let rendered = render(job, runners, options, cx)?;
    let most = rendered.lanes.iter().filter_map(|lane| lane.shots.last()).map(|shot| shot.spp).max().unwrap_or(1);
    let spp = most.saturating_mul(REFERENCE_FACTOR);
    let (convergence, made) = match kept.filter(|kept| kept.suits(job, options.size, spp)) {
        Some(kept) => (evaluate(&rendered, &kept), None),
        None => {
            let made = Reference::render(job, options.size, spp, (&cx.pool, &cx.cancel, &cx.progress))?;
            (evaluate(&rendered, &made), Some(made))
        }
    };
    let outcome = Outcome {
        version: 1,
        scene,
        machine: MachineFacts::here(cx.pool.threads()),
        size: options.size,
        seed: options.seed,
        runs: options.runs,
        transport: job.transport,
        surroundings: job.looks.surroundings().describe(),
        adaptive: options.adaptive,
        metrics: Metric::ALL.map(|metric| [metric.label(), metric.formula()]).into(),
        convergence,
        missing,
    };
    Ok((outcome, made))
}

/// A line a point.
pub fn csv(curves: &[Curve]) -> String {
    let mut out = "structure,sampler,build_secs,spp,secs,secs_min,secs_max,rmse,relmse,mae,smape,flip,hollow\n".to_owned();
    for curve in curves {
        for p in &curve.points {
            let e = &p.errors;
            let flip = e.flip.map_or(String::new(), |flip| flip.to_string());
            out += &format!(
                "{},{},{},{},{},{},{},{},{},{},{},{flip},{}\n",
                curve.structure,
                curve.sampler.id(),
                curve.build_secs,
                p.spp,
                p.secs,
                p.secs_min,
                p.secs_max,
                e.rmse,
                e.relmse,
                e.mae,
                e.smape,
                p.hollow
            );
        }
    }
    out
}

/// Error against samples, and against seconds.
pub fn panels(outcome: &Outcome) -> [(&'static str, Panel); 2] {
    let curves = &outcome.convergence.curves;
    let several = curves.iter().any(|c| c.sampler != curves[0].sampler);
    let plotted = |curve: &Curve, of_secs: bool| {
        let dot = |p: &Point| Dot {
            at: (if of_secs { p.secs } else { f64::from(p.spp) }, p.errors.rmse),
            span: of_secs.then_some((p.secs_min, p.secs_max)),
            hollow: p.hollow,
        };
        let name = if several { format!("{}, {}", curve.structure, curve.sampler.id()) } else { curve.structure.clone() };
        let mut samplers: Vec<SamplerKind> = curves.iter().map(|c| c.sampler).collect();
        samplers.dedup();
        let dash = samplers.iter().position(|sampler| *sampler == curve.sampler).unwrap_or(0);
        let points = curve.points.iter().map(dot).collect();
        Plotted { id: curve.structure.clone(), name, dash, mark: Some(Mark::Circle), points }
    };
    let reference = &outcome.convergence.reference;
    let panel = |title: &str, x: &'static str, of_secs: bool| Panel {
        title: format!("{}: {title}, reference of {} spp", outcome.scene.path, count(reference.spp.into())),
        axes: [x, "RMSE of linear light"],
        curves: curves.iter().map(|curve| plotted(curve, of_secs)).collect(),
        guide: Some(("slope -1/2", |x| x.powf(-0.5))),
        ..Panel::default()
    };
    [
        ("error-samples", panel("error against samples", "samples a pixel", false)),
        ("error-seconds", panel("error against seconds", "seconds from the end of the build", true)),
    ]
}
