//! The table of timings: one row a structure, filled by builds and by measuring, and one for the
//! rasteriser.

use std::collections::BTreeMap;

use super::kept::{Built, Key};
use super::workers::Measured;
use crate::accel::registry::{self, Entry};
use crate::lab::{Costs, RasterRow, Timing, is_tie};
use crate::scene::Camera;

/// The table.
#[derive(Clone, Debug, Default)]
pub struct Timings {
    rows: BTreeMap<&'static str, Row>,
    /// The same view rasterised.
    pub raster: Option<RasterRow>,
    /// The view that was measured.
    pub view: Option<(Camera, [u32; 2])>,
}

/// What is known of one structure.
#[derive(Clone, Debug, Default)]
pub struct Row {
    /// What it was built from.
    pub key: Option<Key>,
    /// Seconds of its build.
    pub build_secs: Option<f64>,
    /// Bytes of its own.
    pub bytes: Option<u64>,
    /// Its timing on the measured view.
    pub timing: Option<Timing>,
    /// What steps and tests cost in it, fitted to measured rays.
    pub costs: Option<Costs>,
    /// Why there is none.
    pub failed: Option<String>,
}

impl Timings {
    /// Takes in a structure that was built, or that is shown again.
    pub fn built(&mut self, built: &Built) {
        let row = self.rows.entry(built.key.entry.id).or_default();
        if row.key.as_ref() != Some(&built.key) {
            *row = Row::default(); // of another structure of that name
        }
        row.key = Some(built.key.clone());
        row.build_secs = Some(built.build_secs);
        row.bytes = Some(built.accel.memory().iter().map(|part| part.bytes).sum());
        row.failed = None;
    }

    /// Takes in a measurement.
    pub fn measured(&mut self, measured: &Measured) {
        for ((built, timing), costs) in measured.built.iter().zip(&measured.timings).zip(&measured.costs) {
            self.built(built);
            let row = self.rows.entry(built.key.entry.id).or_default();
            (row.timing, row.costs) = (Some(timing.clone()), costs.clone());
        }
        for (id, why) in &measured.failed {
            self.rows.insert(id, Row { failed: Some(why.clone()), ..Row::default() });
        }
        self.raster.clone_from(&measured.raster);
        self.view = measured.view;
    }

    /// Every registered structure with what is known of it.
    pub fn rows(&self) -> impl Iterator<Item = (&'static Entry, Row)> + '_ {
        registry::ALL.iter().map(|entry| (entry, self.rows.get(entry.id).cloned().unwrap_or_default()))
    }

    /// The costs measured of just that structure.
    pub fn costs(&self, key: &Key) -> Option<&Costs> {
        self.rows.get(key.entry.id).filter(|row| row.key.as_ref() == Some(key))?.costs.as_ref()
    }

    /// The fastest structure that was measured.
    pub fn fastest(&self) -> Option<&Timing> {
        let timings = self.rows.values().filter_map(|row| row.timing.as_ref());
        timings.max_by(|a, b| a.mrays_per_sec.total_cmp(&b.mrays_per_sec))
    }

    /// Whether a row is the fastest, or cannot be told from it.
    pub fn is_fastest(&self, timing: &Timing) -> bool {
        self.fastest().is_some_and(|fastest| fastest.id == timing.id || is_tie(fastest, timing))
    }
}
