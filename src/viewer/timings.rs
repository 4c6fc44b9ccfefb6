//! The table of timings: one row a structure, filled by builds and by measuring.

use std::collections::BTreeMap;

use super::kept::{Built, Key};
use super::workers::Measured;
use crate::accel::registry::{self, Entry};
use crate::lab::{Timing, is_tie};
use crate::scene::Camera;

/// The table.
#[derive(Clone, Debug, Default)]
pub struct Timings {
    rows: BTreeMap<&'static str, Row>,
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
        for (built, timing) in measured.built.iter().zip(&measured.timings) {
            self.built(built);
            self.rows.entry(built.key.entry.id).or_default().timing = Some(timing.clone());
        }
        for (id, why) in &measured.failed {
            self.rows.insert(id, Row { failed: Some(why.clone()), ..Row::default() });
        }
        self.view = measured.view;
    }

    /// Every registered structure with what is known of it.
    pub fn rows(&self) -> impl Iterator<Item = (&'static Entry, Row)> + '_ {
        registry::ALL.iter().map(|entry| (entry, self.rows.get(entry.id).cloned().unwrap_or_default()))
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
