//! The rows that tables and JSON are made of. Field names here are the schema: they stay.

use serde::Serialize;
use std::collections::BTreeMap;
use std::sync::Arc;

use super::building::{BuiltRow, build_timed};
use super::costs::Costs;
use super::facts::{MachineFacts, SceneFacts};
use super::quality::{Quality, QualityOptions};
use super::rays::RayKind;
use super::timing::Timing;
use crate::accel::params::{ParamValues, Value};
use crate::accel::registry::Entry;
use crate::accel::stats::{SahWeights, Stats};
use crate::accel::{BuildCx, BuildError, MemoryPart};
use crate::geometry::tri::TestKind;
use crate::scene::Geometry;
use crate::task::{Cancelled, Phase};

/// Everything that `stats` and `compare` say.
#[derive(Clone, Debug, Serialize)]
pub struct Report {
    /// The model.
    pub scene: SceneFacts,
    /// The machine.
    pub machine: MachineFacts,
    /// One row for each structure.
    pub structures: Vec<StructureRow>,
}

/// A structure, as it was built and as it traced.
#[derive(Clone, Debug, Serialize)]
pub struct StructureRow {
    /// The registered name.
    pub id: String,
    /// Every parameter and its value.
    pub params: BTreeMap<&'static str, Value>,
    /// The triangle test.
    pub test: TestKind,
    /// What there is to say once it is built.
    #[serde(flatten)]
    pub built: Option<BuiltFacts>,
    /// Why it is not, in words for the user.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub error: Option<String>,
    /// How good it is, without a clock; `null` if it is not built.
    pub quality: Option<Quality>,
    /// What steps and tests cost on this machine, if that was asked for and could be told.
    pub costs: Option<CostRow>,
    /// How it traced each kind of ray; empty where none was asked for.
    pub rays: BTreeMap<RayKind, Timing>,
}

impl Report {
    /// What a row is called in tables: with its triangle test where there is another row of that structure.
    pub fn label(&self, row: &StructureRow) -> String {
        let alone = self.structures.iter().filter(|other| other.id == row.id).count() < 2;
        if alone { row.id.clone() } else { format!("{} {}", row.id, row.test.id()) }
    }
}

/// The rows of what could be built, which are the contestants, in their order.
pub fn built(rows: &mut [StructureRow]) -> impl Iterator<Item = &mut StructureRow> {
    rows.iter_mut().filter(|row| row.built.is_some())
}

/// Fitted costs, and what follows from them.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct CostRow {
    /// The costs.
    #[serde(flatten)]
    pub costs: Costs,
    /// C_isect where C_trav is 1: what to set the two parameters to.
    pub ratio: Option<f64>,
    /// Nanoseconds of a random line that nothing cuts short, from the areas of the cells.
    pub expected_ns: f64,
}

impl CostRow {
    /// Of costs and the expected visits of the structure they belong to.
    pub fn of(costs: Costs, quality: &Quality) -> Self {
        let expected_ns = costs.c_trav_ns * quality.expected_nodes + costs.c_isect_ns * quality.expected_tests + costs.c0_ns;
        Self { ratio: costs.ratio(), expected_ns, costs }
    }
}

/// A built structure in figures.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct BuiltFacts {
    /// Wall-clock seconds of the build.
    pub build_secs: f64,
    /// The same by phase.
    pub phases: Vec<Phase>,
    /// Bytes of the structure, the shared geometry not counted.
    pub bytes: u64,
    /// The same by part.
    pub memory: Vec<MemoryPart>,
    /// Nodes and cells, leaves among them.
    pub nodes: u64,
    /// Leaves, empty ones among them.
    pub leaves: u64,
    /// Leaves without a reference.
    pub empty_leaves: u64,
    /// Steps from the root to the deepest leaf.
    pub max_depth: u32,
    /// References in all leaves.
    pub references: u64,
    /// The SAH cost; comparable within one family only.
    pub sah: f64,
    /// Leaves with k references at k; the last entry counts all larger ones.
    pub leaf_sizes: Vec<u64>,
    /// Leaves at each depth.
    pub leaf_depths: Vec<u64>,
    /// What the builder decided, in words.
    pub remarks: Vec<String>,
}

impl BuiltFacts {
    /// Of a build and the walk over what came of it.
    pub fn of(row: &BuiltRow, stats: Stats) -> Self {
        Self {
            build_secs: row.build_secs,
            phases: row.phases.clone(),
            bytes: stats.bytes(),
            memory: stats.memory,
            nodes: stats.nodes,
            leaves: stats.leaves,
            empty_leaves: stats.empty_leaves,
            max_depth: stats.max_depth,
            references: stats.references,
            sah: stats.sah,
            leaf_sizes: stats.leaf_sizes,
            leaf_depths: stats.leaf_depths,
            remarks: row.accel.remarks(),
        }
    }
}

impl StructureRow {
    /// A row that knows only what shall be built.
    pub fn new(id: &str, params: &ParamValues, test: TestKind) -> Self {
        let params = params.iter().map(|(param, value)| (param.id, value)).collect();
        Self { id: id.to_owned(), params, test, built: None, error: None, quality: None, costs: None, rays: BTreeMap::new() }
    }

    /// Builds a structure and looks at it. One that cannot be built is a row with the reason.
    ///
    /// # Errors
    /// [`Cancelled`] if asked to stop.
    pub fn of(
        entry: &Entry,
        test: TestKind,
        (params, options): (&ParamValues, &QualityOptions),
        geometry: &Arc<Geometry>,
        cx: &BuildCx,
    ) -> Result<(Self, Option<BuiltRow>), Cancelled> {
        let mut row = Self::new(entry.id, params, test);
        match build_timed(entry, geometry, test, params, cx) {
            Ok(built) => {
                let (accel, weights) = (built.accel.as_ref(), SahWeights::of(params));
                let stats = Stats::of_structure(accel, weights, &cx.cancel)?;
                row.quality = Some(Quality::of(accel, &stats, weights, options, (&cx.pool, &cx.budget, &cx.cancel))?);
                row.built = Some(BuiltFacts::of(&built, stats));
                Ok((row, Some(built)))
            }
            Err(BuildError::Cancelled(cancelled)) => Err(cancelled),
            Err(error) => {
                row.error = Some(error.to_string());
                Ok((row, None))
            }
        }
    }
}
