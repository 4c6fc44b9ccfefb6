//! The tables of the window as they are saved: every figure as exactly as it is known, with its unit over the column.

mod compare;
mod findings;
mod holdings;
mod listed;
mod watched;
mod what;

use super::rays::Column;
use super::state::State;
use super::timings::secs_of_sample;
use crate::accel::stats::LEAF_SIZES;
use crate::accel::{Prune, Step};
use crate::geometry::Axis;
use crate::lab::{Field, SahCurves, Sheet, Timing};
pub use listed::ListedRays;
pub use watched::film;
pub use what::What;

/// The curves of the selected node, where their outcome is not hidden.
pub(super) fn curves(state: &State) -> Option<&SahCurves> {
    let hidden = state.settings.hide_outcome && !state.tree.revealed;
    state.curves.as_ref().and_then(|curves| curves.1.as_ref()).filter(|_| !hidden)
}

/// A table as it is saved; `None` where there is nothing of it, and of [`ListedRays`] and [`film`], which are put together while
/// they are saved.
pub fn sheet(state: &State, what: What) -> Option<Sheet> {
    if !what.is_there(state) {
        return None;
    }
    Some(match what {
        What::Timings => timings(state),
        What::Heat => watched::heat(state)?,
        What::Statistics => statistics(state),
        What::Findings => findings::causes(state.causes.found.as_ref()?),
        What::Needs => needs(state),
        What::Memory => holdings::memory(state),
        What::Division => division(curves(state)?),
        What::Volumes => findings::volumes(state.fitting()?.0),
        What::Steps => steps(&state.rays.columns),
        What::Film | What::Rays => return None,
        What::Errors => compare::errors(state),
        What::Tests => compare::tests(state),
        What::Quality => compare::quality(state),
        What::Prediction => compare::prediction(&state.tradeoffs.rows),
        What::Scaling => compare::scaling(state),
        What::Stability => stability(state),
        What::Check => findings::check(state.checks.model.as_ref()?),
    })
}

fn timings(state: &State) -> Sheet {
    let mut sheet = Sheet::new(&[
        "structure",
        "terms",
        "build (s)",
        "bytes",
        "1 spp (s)",
        "rays (1e6/s)",
        "spread (1e6/s)",
        "nodes/ray",
        "tests/ray",
        "rounds",
        "rays",
        "note",
    ]);
    let terms = |t: Option<&Timing>| t.map(|_| state.timings.fairness.name());
    let mut row =
        |name: &str, terms: Option<&'static str>, [build, bytes]: [Field; 2], t: Option<&Timing>, note: Option<String>| {
            sheet.row([
                name.into(),
                terms.into(),
                build,
                bytes,
                t.map(secs_of_sample).into(),
                t.map(|t| t.mrays_per_sec).into(),
                t.map(Timing::mrays_spread).into(),
                t.map(|t| t.nodes_per_ray).into(),
                t.map(|t| t.prims_per_ray).into(),
                t.map(|t| t.rounds as u64).into(),
                t.map(|t| t.rays as u64).into(),
                note.into(),
            ]);
        };
    for (entry, known) in state.timings.sorted(&state.terms_of_timings) {
        let timing = known.timing.as_ref();
        let note = known.failed.clone().or_else(|| timing.and_then(|t| t.capped.clone()));
        row(entry.id, terms(timing), [known.build_secs.into(), known.bytes.into()], timing, note);
    }
    if let Some(raster) = &state.timings.raster {
        let timing = raster.timing();
        row("raster", terms(Some(&timing)), [Field::Missing, Field::Missing], Some(&timing), None);
    }
    sheet
}

fn statistics(state: &State) -> Sheet {
    let mut sheet = Sheet::new(&["structure", "figure", "value", "unit"]);
    let Some(shown) = &state.shown else { return sheet };
    let id = shown.key.entry.id;
    let mut fact = |name: String, value: Field, unit: &str| sheet.row([id.into(), name.into(), value, unit.into()]);
    fact("build".into(), shown.build_secs.into(), "s");
    shown.phases.iter().for_each(|phase| fact(format!("build: {}", phase.name), phase.secs.into(), "s"));
    for (param, value) in shown.key.params.iter() {
        fact(format!("parameter {}", param.id), value.to_string().into(), "");
    }
    if let Some(stats) = &shown.stats {
        fact("SAH cost".into(), stats.sah.into(), "");
        let counts = [("nodes", stats.nodes), ("leaves", stats.leaves), ("empty leaves", stats.empty_leaves)];
        counts.into_iter().for_each(|(name, n)| fact(name.into(), n.into(), ""));
        fact("depth".into(), u64::from(stats.max_depth).into(), "");
        fact("references".into(), stats.references.into(), "");
        stats.memory.iter().for_each(|part| fact(format!("memory: {}", part.name), part.bytes.into(), "B"));
        let sizes = stats.leaf_sizes.iter().enumerate();
        let named = |i: usize| if i == LEAF_SIZES - 1 { format!("{i} or more") } else { i.to_string() };
        sizes.for_each(|(i, n)| fact(format!("leaves with {} triangles", named(i)), (*n).into(), ""));
        let depths = stats.leaf_depths.iter().enumerate();
        depths.for_each(|(i, n)| fact(format!("leaves at depth {i}"), (*n).into(), ""));
    }
    if let Some(quality) = &shown.quality {
        fact("nodes/line, predicted".into(), quality.expected_nodes.into(), "");
        fact("tests/line, predicted".into(), quality.expected_tests.into(), "");
        if let Some(lines) = quality.lines {
            fact("nodes/line, counted".into(), lines.nodes.into(), "");
            fact("tests/line, counted".into(), lines.tests.into(), "");
        }
        fact("sibling overlap".into(), quality.overlap.into(), "");
        fact("empty space".into(), quality.empty_volume.into(), "share");
        fact("EPO".into(), quality.epo.map(|epo| epo.value).into(), "");
        fact("SAH and EPO".into(), quality.blend.into(), "");
    }
    if let Some(costs) = state.timings.costs(&shown.key) {
        fact("C_trav, measured".into(), costs.c_trav_ns.into(), "ns");
        fact("C_isect, measured".into(), costs.c_isect_ns.into(), "ns");
        fact("C_0, measured".into(), costs.c0_ns.into(), "ns");
    }
    sheet
}

fn needs(state: &State) -> Sheet {
    let mut sheet = Sheet::new(&["feature", "used", "saved (B)", "saved (ns/ray)", "spread (ns/ray)", "why"]);
    for finding in state.model.iter().flat_map(|model| model.needs.iter()) {
        let id = finding.feature.id();
        let measured = state.needs.as_ref().and_then(|report| report.features.iter().find(|row| row.id == id));
        sheet.row([
            id.into(),
            if finding.used { "used" } else { "left out" }.into(),
            measured.map(|row| row.bytes_saved as f64).into(),
            measured.map(|row| row.ns_per_ray_saved).into(),
            measured.map(|row| row.ns_spread).into(),
            finding.why.clone().into(),
        ]);
    }
    sheet
}

fn division(curves: &SahCurves) -> Sheet {
    let mut sheet = Sheet::new(&["kind", "axis", "place (0 to 1)", "SAH cost"]);
    let mut row = |kind: &str, axis: Option<Axis>, place: Option<f64>, cost: f64| {
        sheet.row([kind.into(), axis.map(Axis::name).into(), place.into(), cost.into()]);
    };
    row("leaf", None, None, curves.leaf);
    if let Some(chosen) = &curves.chosen {
        row("chosen", chosen.plane.map(|plane| plane.0), chosen.plane.map(|plane| plane.1), chosen.cost);
    }
    for other in &curves.others {
        if let Some(division) = &other.division {
            row(other.name, Some(division.plane.0), Some(division.plane.1), division.cost);
        }
    }
    for (kind, all) in [("candidate", &curves.axes), ("bucket", &curves.buckets)] {
        for (axis, candidates) in Axis::ALL.into_iter().zip(all) {
            candidates.iter().for_each(|(place, cost)| row(kind, Some(axis), Some(*place), *cost));
        }
    }
    sheet
}

fn steps(columns: &[Column]) -> Sheet {
    let mut sheet =
        Sheet::new(&["structure", "step", "what", "node or triangle", "entry t", "exit t", "hit t", "best t", "waiting"]);
    for column in columns {
        for (i, step) in column.followed.steps.iter().enumerate() {
            let (what, number, hit) = match step.step {
                Step::Level(level) => ("level", Some(u64::from(level)), None),
                Step::Entered(node) => ("enters", Some(u64::from(node)), None),
                Step::Pruned(node, Prune::Missed) => ("left out: missed", Some(u64::from(node)), None),
                Step::Pruned(node, Prune::Outside) => ("left out: beyond", Some(u64::from(node)), None),
                Step::Pruned(node, Prune::BehindHit) => ("left out: behind the best hit", Some(u64::from(node)), None),
                Step::Tested(prim, hit) => ("tests", Some(u64::from(prim)), hit),
                Step::OutsideCell => ("hit outside the cell", None, None),
            };
            sheet.row([
                column.built.key.entry.id.into(),
                (i as u64 + 1).into(),
                what.into(),
                number.into(),
                step.interval.map(|[a, _]| f64::from(a)).into(),
                step.interval.map(|[_, b]| f64::from(b)).into(),
                hit.map(f64::from).into(),
                f64::from(step.best).into(),
                u64::from(step.waiting).into(),
            ]);
        }
    }
    sheet
}

fn stability(state: &State) -> Sheet {
    let mut sheet = Sheet::new(&[
        "case",
        "structure",
        "test",
        "verdict",
        "rays",
        "near",
        "wrong where clear",
        "wrong elsewhere",
        "slipped through",
        "t (ulps)",
        "ns/ray",
        "note",
    ]);
    for case in &state.checks.cases {
        for row in &case.structures {
            sheet.row([
                case.id.into(),
                row.id.into(),
                row.test.id().into(),
                super::panels::stability::verdict(row).into(),
                (row.rays as u64).into(),
                (row.near as u64).into(),
                (row.clear_wrong as u64).into(),
                (row.boundary_wrong as u64).into(),
                (row.slipped as u64).into(),
                row.max_ulps.into(),
                row.ns_per_ray.into(),
                row.error.clone().into(),
            ]);
        }
    }
    sheet
}
