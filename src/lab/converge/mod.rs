//! Image error against run time: structures and samplers render the same picture, sample after sample, and what each has by
//! 1, 2, 4, … samples is measured against a reference that none of them made.

mod curve;
#[cfg(feature = "plots")]
mod outcome;
mod reference;
mod run;
mod tables;
mod witness;

pub use curve::{Curve, Point, REFERENCE_FACTOR, Slope};
#[cfg(feature = "plots")]
pub use outcome::{Outcome, csv, measure, panels};
pub use reference::{Reference, ReferenceFacts, SEED};
pub use run::{ConvergeCx, ConvergeError, ConvergeOptions, Rendered, Runner, render};
pub use tables::{BreakEven, EqualError, EqualTime, Tables};
pub use witness::{Agreement, agreement};

use serde::Serialize;

/// Everything that was measured.
#[derive(Clone, Debug, Serialize)]
pub struct Convergence {
    /// What the errors are measured against.
    pub reference: ReferenceFacts,
    /// One for each structure and sampler.
    pub curves: Vec<Curve>,
    /// Whether all structures made the same picture of the same samples, but for near ties.
    pub coincide: bool,
    /// How each structure agreed with the first, in the order of structures.
    pub agreements: Vec<StructureAgreement>,
    /// Equal times, equal errors, break-evens.
    #[serde(flatten)]
    pub tables: Tables,
}

/// How a structure's pictures agree with the first structure's.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct StructureAgreement {
    /// The structure's id.
    pub structure: String,
    /// Whether every picture was the same to the bit, at all numbers of samples and with all samplers.
    pub identical: bool,
    /// The most pixels that differed at once.
    pub pixels: u64,
    /// The greatest difference of RMSE, as a share of it.
    pub rmse_difference: f64,
    /// Ray by ray, over one sample of every pixel.
    pub rays: Agreement,
    /// Whether its curves coincide with the first structure's: the same to the bit, or all that differs are near ties, which
    /// change the error by less than [`StructureAgreement::MOST`].
    pub coincides: bool,
}

impl StructureAgreement {
    /// How much of the error near ties may change for curves to coincide: what one pixel in a thousand and more would.
    pub const MOST: f64 = 0.01;
}

/// Puts everything together: what was rendered, and the reference.
pub fn evaluate(rendered: &Rendered, reference: &Reference) -> Convergence {
    let curves: Vec<Curve> = rendered.lanes.iter().map(|lane| Curve::of(lane, reference)).collect();
    let agreements: Vec<StructureAgreement> = rendered
        .agreements
        .iter()
        .map(|(structure, rays)| {
            let mut agreement = StructureAgreement {
                structure: structure.clone(),
                identical: true,
                pixels: 0,
                rmse_difference: 0.0,
                rays: *rays,
                coincides: true,
            };
            for (lane, curve) in rendered.lanes.iter().zip(&curves).filter(|(lane, _)| lane.structure == *structure) {
                let Some(first) = rendered.lanes.iter().position(|first| first.sampler == lane.sampler) else { continue };
                // One that ran out of time has a last picture of a number of samples of its own.
                for (i, shot) in lane.shots.iter().enumerate() {
                    let same_samples = |other: &&run::Shot| other.spp == shot.spp;
                    let Some(other) = rendered.lanes[first].shots.iter().find(same_samples) else { continue };
                    let differing = shot.differing(other);
                    agreement.identical &= differing == 0;
                    agreement.pixels = agreement.pixels.max(differing);
                    let beside = curves[first].points.iter().find(|point| point.spp == shot.spp);
                    let a = curve.points[i].errors.rmse;
                    let b = beside.map_or(a, |point| point.errors.rmse);
                    let relative = if b > 0.0 { (a - b).abs() / b } else { 0.0 };
                    agreement.rmse_difference = agreement.rmse_difference.max(relative);
                }
            }
            let explained = rays.wrong == 0 && agreement.rmse_difference <= StructureAgreement::MOST;
            agreement.coincides = agreement.identical || explained;
            agreement
        })
        .collect();
    let coincide = agreements.iter().all(|agreement| agreement.coincides);
    let tables = Tables::of(&curves);
    Convergence { reference: reference.facts, curves, coincide, agreements, tables }
}
