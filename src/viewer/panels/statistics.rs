//! What the shown structure is like, in figures.

use eframe::egui::{Align, Layout, RichText, Ui};

use super::{Commands, as_table, bars, empty, fact, findings, heading, memory, needs, prediction, saves};
use crate::accel::stats::{LEAF_SIZES, Stats};
use crate::viewer::format;
use crate::viewer::kept::Built;
use crate::viewer::marks;
use crate::viewer::sheets::What;
use crate::viewer::state::State;
use crate::viewer::theme::{self, Palette};

/// Draws the panel.
pub fn show(ui: &mut Ui, state: &State, commands: &mut Commands) {
    heading(ui, "Statistics");
    let Some(built) = &state.shown else {
        empty(ui, "No structure yet.");
        return;
    };
    ui.horizontal(|ui| {
        marks::dot(ui, built.key.entry.family);
        ui.label(RichText::new(built.key.entry.name).heading());
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| saves::show(ui, What::Statistics, state, commands));
    });
    build_time(ui, built);
    let Some(stats) = &built.stats else {
        ui.spinner().on_hover_text("Working out the figures.");
        return;
    };
    let triangles = state.model.as_ref().map_or(0, |m| m.geometry.stored_live());
    figures(ui, stats, triangles);
    traversal(ui, state);
    ui.separator();
    findings::show(ui, state, commands);
    ui.separator();
    prediction::show(ui, state, built, commands);
    histograms(ui, built, stats);
    memory::of_structure(ui, stats, triangles);
    needs::show(ui, state, commands);
}

fn build_time(ui: &mut Ui, built: &Built) {
    let phases: Vec<String> = built.phases.iter().map(|p| format!("{}: {}", p.name, format::duration(p.secs))).collect();
    let help = format!("Wall-clock time of the build. {}", phases.join(", "));
    fact(ui, "Build", format::duration(built.build_secs), &help);
    for remark in built.accel.remarks() {
        ui.label(RichText::new(remark).small().color(Palette::in_ui(ui).dim));
    }
}

fn figures(ui: &mut Ui, stats: &Stats, triangles: usize) {
    let help = "Expected cost of a random line that meets the root's box: the sum over inner nodes of C_trav A/A_root, and over leaves of C_isect n A/A_root (MacDonald and Booth 1990). Compare it within one family only.";
    fact(ui, "SAH cost", format::number(stats.sah), help);
    fact(ui, "Nodes", format::count(stats.nodes), "Nodes or cells, leaves among them.");
    fact(ui, "Leaves", format::count(stats.leaves), "Nodes that hold triangles rather than other nodes.");
    if stats.empty_leaves > 0 {
        fact(ui, "of them empty", format::count(stats.empty_leaves), "Cells without a triangle: a ray passes them quickly.");
    }
    fact(ui, "Depth", stats.max_depth.to_string(), "Steps from the root to the deepest leaf.");
    let per_triangle = stats.references as f64 / triangles.max(1) as f64;
    let help = "How many leaves a triangle is in, on average: 1 where every triangle is in one leaf.";
    fact(ui, "References/triangle", format::number(per_triangle), help);
}

fn traversal(ui: &mut Ui, state: &State) {
    let Some(progress) = state.picture.as_ref().map(|p| p.progress).filter(|p| p.counted > 0) else { return };
    let per_ray = |n: u64| format::number(n as f64 / progress.counted as f64);
    ui.separator();
    let help = "Nodes or cells that a camera ray of this view visits, on average over a sample of the rays.";
    fact(ui, "Nodes/ray", per_ray(progress.counts.nodes), help);
    fact(
        ui,
        "Triangle tests/ray",
        per_ray(progress.counts.prims),
        "Triangles that a camera ray of this view is tested against, on average.",
    );
}

fn histograms(ui: &mut Ui, built: &Built, stats: &Stats) {
    let color = marks::color(ui, built.key.entry.family);
    let dim = Palette::in_ui(ui).dim;
    ui.add_space(theme::GRID);
    let as_table = as_table::choice(ui, "leaves");
    if as_table {
        let counted = |name: String, n: u64| Some([name, format::count(n)]).filter(|_| n > 0);
        let named = |i: usize| if i == LEAF_SIZES - 1 { format!("{i} or more") } else { i.to_string() };
        let sizes = stats.leaf_sizes.iter().enumerate().filter_map(|(i, n)| counted(named(i), *n));
        as_table::show(ui, "leaf sizes", ["Triangles", "Leaves"], sizes);
        let depths = stats.leaf_depths.iter().enumerate().filter_map(|(i, n)| counted(i.to_string(), *n));
        as_table::show(ui, "leaf depths", ["Depth", "Leaves"], depths);
        return;
    }
    ui.label(RichText::new("Leaf size").color(dim))
        .on_hover_text("How many leaves hold 0, 1, 2 … triangles; the last bar is all larger ones.");
    let size = |i: usize| if i == LEAF_SIZES - 1 { format!("leaves with {i} or more") } else { format!("leaves with {i}") };
    bars::show(ui, "Leaf size histogram", &stats.leaf_sizes, color, size);
    if stats.max_depth > 1 {
        ui.label(RichText::new("Leaf depth").color(dim))
            .on_hover_text("How many leaves lie at each depth, the root's depth 0 at the left.");
        bars::show(ui, "Leaf depth histogram", &stats.leaf_depths, color, |i| format!("leaves at depth {i}"));
    }
}
