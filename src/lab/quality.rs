//! How good a structure is, without a clock: what the areas of its cells predict, what lies where it
//! should not, and what random lines really do in it.

use serde::Serialize;

use super::uncut::{Enough, UncutLines};
use crate::accel::Accel;
use crate::accel::epo::{self, Epo, EpoCx, NoEpo};
use crate::accel::stats::{SahWeights, Stats};
use crate::task::{Budget, Cancel, Cancelled, Pool};

/// A structure's quality in figures. Field names are the schema: they stay.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Quality {
    /// [`Stats::expected_nodes`].
    pub expected_nodes: f64,
    /// [`Stats::expected_tests`].
    pub expected_tests: f64,
    /// [`Stats::overlap`].
    pub overlap: Option<f64>,
    /// [`Stats::leaf_volume`].
    pub leaf_volume: Option<f64>,
    /// [`Stats::empty_volume`].
    pub empty_volume: Option<f64>,
    /// References per live triangle.
    pub duplication: Option<f64>,
    /// End-point overlap, if it was asked for and can be worked out.
    pub epo: Option<Epo>,
    /// Why there is no end-point overlap though it was asked for.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub epo_missing: Option<String>,
    /// The weight of EPO in the blend.
    pub alpha: f64,
    /// `(1 - alpha) SAH + alpha EPO`.
    pub blend: Option<f64>,
    /// What random lines did, if that was asked for.
    pub lines: Option<UncutLines>,
}

/// What to find out.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct QualityOptions {
    /// The weight of EPO in the blend.
    pub alpha: f64,
    /// Triangles looked at for EPO, at most; `None` to leave it out.
    pub epo_most: Option<usize>,
    /// How many random lines to count; `None` to leave them out.
    pub lines: Option<Enough>,
}

impl Default for QualityOptions {
    fn default() -> Self {
        Self { alpha: epo::ALPHA, epo_most: Some(epo::MOST), lines: Some(Enough::default()) }
    }
}

impl Quality {
    /// Of a structure, its figures and the weights that they were worked out with.
    ///
    /// # Errors
    /// [`Cancelled`] if asked to stop. What does not fit the memory budget is left out with the reason.
    pub fn of(
        accel: &dyn Accel,
        stats: &Stats,
        weights: SahWeights,
        options: &QualityOptions,
        (pool, budget, cancel): (&Pool, &Budget, &Cancel),
    ) -> Result<Self, Cancelled> {
        let lines = options.lines.map(|enough| UncutLines::count(accel, &enough, pool, cancel)).transpose()?;
        let mut quality = Self {
            expected_nodes: stats.expected_nodes,
            expected_tests: stats.expected_tests,
            overlap: stats.overlap,
            leaf_volume: stats.leaf_volume,
            empty_volume: stats.empty_volume(),
            duplication: stats.duplication(accel.geometry().stored_live()),
            alpha: options.alpha,
            lines,
            ..Self::default()
        };
        if let Some(most) = options.epo_most {
            let cx = EpoCx { most, pool: pool.clone(), budget: budget.clone(), cancel: cancel.clone() };
            let epo = match accel.levels() {
                Some(_) => Err(NoEpo::TwoLevels),
                None => Epo::of(accel, accel.geometry(), weights, &cx),
            };
            match epo {
                Ok(epo) => (quality.epo, quality.blend) = (Some(epo), Some(epo.blend(stats.sah, options.alpha))),
                Err(NoEpo::Cancelled(cancelled)) => return Err(cancelled),
                Err(why) => quality.epo_missing = Some(why.to_string()),
            }
        }
        Ok(quality)
    }
}
