//! The table of timings: one row a structure, filled by builds and by measuring, and one for the
//! rasteriser.

use std::collections::BTreeMap;

use super::kept::{Built, Key};
use super::workers::Measured;
use crate::accel::registry::{self, Entry};
use crate::lab::{Costs, Fairness, RasterRow, Timing, is_tie};
use crate::scene::Camera;

/// The table.
#[derive(Clone, Debug, Default)]
pub struct Timings {
    rows: BTreeMap<&'static str, Row>,
    /// The same view rasterised.
    pub raster: Option<RasterRow>,
    /// The view that was measured.
    pub view: Option<(Camera, [u32; 2])>,
    /// On which terms.
    pub fairness: Fairness,
}

/// What the table is sorted by.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub enum Column {
    /// The order in which structures are listed.
    Structure,
    /// Seconds of the build.
    Build,
    /// Bytes.
    Bytes,
    /// Seconds for one ray a pixel.
    Sample,
    /// Millions of rays a second.
    Rate,
    /// Nodes a ray visits.
    Nodes,
    /// Triangles a ray is tested against.
    Tests,
}

impl Column {
    /// All, from left to right.
    pub const ALL: [Self; 7] = [Self::Structure, Self::Build, Self::Bytes, Self::Sample, Self::Rate, Self::Nodes, Self::Tests];

    /// The name over the column, with its unit.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Structure => "Structure",
            Self::Build => "Build",
            Self::Bytes => "Bytes",
            Self::Sample => "1 spp",
            Self::Rate => "Mrays/s",
            Self::Nodes => "Nodes/ray",
            Self::Tests => "Tests/ray",
        }
    }

    /// What stands below it.
    pub const fn help(self) -> &'static str {
        match self {
            Self::Structure => "The structures, in the order in which they are listed everywhere.",
            Self::Build => "Wall-clock time of the build.",
            Self::Bytes => "Memory of the structure alone.",
            Self::Sample => "Time to trace one camera ray for each pixel of this view: the median of the rounds.",
            Self::Rate => {
                "Millions of camera rays a second, all on the same rays; ± is half the interquartile range, as the line at the bar's end."
            }
            Self::Nodes => "Nodes or cells that a ray visits, on average.",
            Self::Tests => "Triangles that a ray is tested against, on average.",
        }
    }

    /// What a row is sorted by; nothing where that is not known, or where rows stay as they are listed.
    fn of(self, row: &Row) -> Option<f64> {
        let timing = row.timing.as_ref();
        let value = match self {
            Self::Structure => None,
            Self::Build => row.build_secs,
            Self::Bytes => row.bytes.map(|bytes| bytes as f64),
            Self::Sample => timing.map(secs_of_sample),
            Self::Rate => timing.map(|t| t.mrays_per_sec),
            Self::Nodes => timing.map(|t| t.nodes_per_ray),
            Self::Tests => timing.map(|t| t.prims_per_ray),
        };
        value.filter(|value| !value.is_nan())
    }

    /// Whether more is better, and so comes first.
    const fn most_first(self) -> bool {
        matches!(self, Self::Rate)
    }
}

/// The seconds of one sample for each pixel. A capped structure traced a part of the rays: scaled up to all of them.
pub fn secs_of_sample(t: &Timing) -> f64 {
    t.secs_median * t.of as f64 / t.rays.max(1) as f64
}

/// How structures are timed, and the table sorted.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(default)]
pub struct Terms {
    /// On which terms they are timed from now on.
    pub fairness: Fairness,
    /// The column that rows are sorted by.
    pub column: Column,
    /// The other way round: the worst first.
    pub reversed: bool,
}

impl Default for Terms {
    fn default() -> Self {
        Self { fairness: Fairness::default(), column: Column::Structure, reversed: false }
    }
}

impl Terms {
    /// Sorts by a column, the best first; the other way round if that is how it is.
    pub fn sort_by(&mut self, column: Column) {
        (self.reversed, self.column) = (self.column == column && !self.reversed, column);
    }

    /// Whether figures grow from the top.
    pub const fn grows(&self) -> bool {
        self.column.most_first() == self.reversed
    }
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

/// Nothing.
static NONE: Row = Row { key: None, build_secs: None, bytes: None, timing: None, costs: None, failed: None };

impl Timings {
    /// Takes in a structure that was built, or that is shown again.
    pub fn built(&mut self, built: &Built) {
        let row = self.rows.entry(built.key.entry.id).or_default();
        if row.key.as_ref() != Some(&built.key) {
            *row = Row::default(); // of another structure of that name
        }
        row.key = Some(built.key.clone());
        row.build_secs = Some(built.build_secs);
        row.bytes = Some(built.bytes());
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
        (self.view, self.fairness) = (measured.view, measured.fairness);
    }

    /// Every registered structure with what is known of it.
    pub fn rows(&self) -> impl Iterator<Item = (&'static Entry, &Row)> + '_ {
        registry::ALL.iter().map(|entry| (entry, self.rows.get(entry.id).unwrap_or(&NONE)))
    }

    /// The same in the order of a column; rows of which that is not known come last.
    pub fn sorted(&self, terms: &Terms) -> Vec<(&'static Entry, &Row)> {
        let mut rows: Vec<_> = self.rows().collect();
        if terms.column == Column::Structure && terms.reversed {
            rows.reverse();
        }
        let key = |row: &Row| terms.column.of(row);
        rows.sort_by(|(_, a), (_, b)| match (key(a), key(b)) {
            (Some(a), Some(b)) if terms.grows() => a.total_cmp(&b),
            (Some(a), Some(b)) => b.total_cmp(&a),
            (a, b) => b.is_some().cmp(&a.is_some()),
        });
        rows
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_are_sorted_best_first_and_what_is_not_known_comes_last() {
        let mut timings = Timings::default();
        let timing = |rate: f64| Timing { mrays_per_sec: rate, ..Timing::default() };
        for (id, secs, rate) in [("bvh", 2.0, 5.0), ("kdtree", 3.0, 7.0), ("grid", 1.0, 6.0)] {
            let row = Row { build_secs: Some(secs), timing: Some(timing(rate)), ..Row::default() };
            timings.rows.insert(id, row);
        }
        let mut terms = Terms::default();
        let first = |terms: &Terms| -> Vec<&str> { timings.sorted(terms).iter().take(3).map(|(entry, _)| entry.id).collect() };
        let listed: Vec<&str> = registry::ALL.iter().take(3).map(|entry| entry.id).collect();
        assert_eq!(first(&terms), listed);
        terms.sort_by(Column::Rate);
        assert_eq!((first(&terms), terms.grows()), (vec!["kdtree", "grid", "bvh"], false));
        terms.sort_by(Column::Rate);
        assert_eq!((first(&terms), terms.grows()), (vec!["bvh", "grid", "kdtree"], true));
        terms.sort_by(Column::Build);
        assert_eq!((first(&terms), terms.grows()), (vec!["grid", "bvh", "kdtree"], true));
        // Nothing of the kind is known of any: as they are listed.
        terms.sort_by(Column::Bytes);
        assert_eq!(first(&terms), listed);
        terms.sort_by(Column::Structure);
        terms.sort_by(Column::Structure);
        assert_eq!(timings.sorted(&terms)[0].0.id, registry::ALL[registry::ALL.len() - 1].id);
    }
}
