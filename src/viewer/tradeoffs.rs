//! What the Compare workspace knows of quality against its cost: rows as they are measured, and what of them is drawn.

use std::sync::mpsc::Receiver;

use super::workers::Trading;
use crate::job::Job;
use crate::lab::RayKind;
use crate::lab::scaling::Scaling;
use crate::lab::tradeoffs::{Erring, TradeoffRow};

/// Everything of it.
#[derive(Default)]
pub struct Tradeoffs {
    /// One for each variant that is through.
    pub rows: Vec<TradeoffRow>,
    /// The measurement, while it runs, and where it puts rows.
    pub running: Option<(Trading, Receiver<TradeoffRow>)>,
    /// Time against the number of triangles, a row for each structure.
    pub scaling: Vec<Scaling>,
    /// That, on its way.
    pub growing: Option<Growing>,
    /// Which plot is shown.
    pub plot: Plot,
    /// What of intersections is drawn.
    pub miss: Miss,
    /// What of structures is drawn.
    pub goodness: Goodness,
}

/// Time against the number of triangles, on its way: nothing if it was stopped, or why there is none, in words for the user.
pub type Growing = Job<Result<Vec<Scaling>, String>>;

/// The plots of the workspace.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub enum Plot {
    /// The picture's error against time.
    #[default]
    Image,
    /// Errors of tests against nanoseconds.
    Intersection,
    /// How good structures are against the time of their build.
    Model,
    /// Predicted against measured times of rays.
    Prediction,
    /// Time against the number of triangles.
    Scaling,
}

impl Plot {
    /// All, in the order of tabs.
    pub const ALL: [Self; 5] = [Self::Image, Self::Intersection, Self::Model, Self::Prediction, Self::Scaling];

    /// The name on the command line.
    pub const fn id(self) -> &'static str {
        match self {
            Self::Image => "image",
            Self::Intersection => "intersection",
            Self::Model => "model",
            Self::Prediction => "prediction",
            Self::Scaling => "scaling",
        }
    }

    /// The name on the tab.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Image => "Image",
            Self::Intersection => "Intersection",
            Self::Model => "Model",
            Self::Prediction => "Prediction",
            Self::Scaling => "Scaling",
        }
    }

    /// What it shows.
    pub const fn help(self) -> &'static str {
        match self {
            Self::Image => "The error of the path traced picture against samples and seconds.",
            Self::Intersection => "How tests of triangles and boxes err on hard rays of this view, against the time of a ray.",
            Self::Model => "How good each structure is, against the time of its build; and how far predictions are off.",
            Self::Prediction => "What is predicted of a ray against what rays took: a mark for each structure and kind of ray.",
            Self::Scaling => "How the time of a build and of a ray grows with the number of triangles.",
        }
    }
}

impl std::str::FromStr for Plot {
    type Err = String;

    fn from_str(s: &str) -> Result<Self, String> {
        let known = Self::ALL.into_iter().find(|plot| plot.id() == s);
        known.ok_or_else(|| format!("there is no plot '{s}': use image, intersection, model, prediction or scaling"))
    }
}

/// How a test of triangles or boxes errs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub enum Miss {
    /// Wrong answers.
    #[default]
    Wrong,
    /// Answers that rounding decided.
    Rounded,
    /// The error of t.
    Ulps,
}

impl Miss {
    /// All, in the order of menus.
    pub const ALL: [Self; 3] = [Self::Wrong, Self::Rounded, Self::Ulps];

    /// The name along the axis.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Wrong => "wrong rays in a million",
            Self::Rounded => "rounded rays in a million",
            Self::Ulps => "ulps of t, one in a thousand",
        }
    }

    /// What it is of a test.
    pub const fn of(self, erring: &Erring) -> f64 {
        match self {
            Self::Wrong => erring.wrong_per_million,
            Self::Rounded => erring.rounded_per_million,
            Self::Ulps => erring.p999_ulps,
        }
    }
}

/// How good a structure is; less is better.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub enum Goodness {
    /// Measured nanoseconds of a diffuse ray.
    #[default]
    Diffuse,
    /// Of a primary ray.
    Primary,
    /// Of a shadow ray.
    Shadow,
    /// Predicted nanoseconds of a random line.
    Predicted,
    /// The SAH cost.
    Sah,
    /// End-point overlap.
    Epo,
    /// By how much the prediction is off, of diffuse rays.
    PredictionOfDiffuse,
    /// The same of primary rays.
    PredictionOfPrimary,
    /// The same of shadow rays.
    PredictionOfShadow,
}

impl Goodness {
    /// All, in the order of menus.
    pub const ALL: [Self; 9] = [
        Self::Diffuse,
        Self::Primary,
        Self::Shadow,
        Self::Predicted,
        Self::Sah,
        Self::Epo,
        Self::PredictionOfDiffuse,
        Self::PredictionOfPrimary,
        Self::PredictionOfShadow,
    ];

    /// The name along the axis.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Diffuse => "ns a diffuse ray",
            Self::Primary => "ns a primary ray",
            Self::Shadow => "ns a shadow ray",
            Self::Predicted => "predicted ns a line",
            Self::Sah => "SAH cost",
            Self::Epo => "end-point overlap",
            Self::PredictionOfDiffuse => "prediction off, diffuse rays",
            Self::PredictionOfPrimary => "prediction off, primary rays",
            Self::PredictionOfShadow => "prediction off, shadow rays",
        }
    }

    /// What it is of a row, if that is known.
    pub fn of(self, row: &TradeoffRow) -> Option<f64> {
        let off = |kind| row.prediction_error(kind).map(f64::abs);
        match self {
            Self::Diffuse => row.ns.get(&RayKind::Diffuse).copied(),
            Self::Primary => row.ns.get(&RayKind::Primary).copied(),
            Self::Shadow => row.ns.get(&RayKind::Shadow).copied(),
            Self::Predicted => row.predicted_ns,
            Self::Sah => Some(row.sah),
            Self::Epo => row.epo,
            Self::PredictionOfDiffuse => off(RayKind::Diffuse),
            Self::PredictionOfPrimary => off(RayKind::Primary),
            Self::PredictionOfShadow => off(RayKind::Shadow),
        }
    }
}
