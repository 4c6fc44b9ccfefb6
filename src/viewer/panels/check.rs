//! What is known of the cell of the matrix that was clicked, and the check of the open model.

use eframe::egui::{Label, RichText, Ui};

use super::{Commands, empty, fact, heading, memory, needs, running, saves, stability};
use crate::lab::stability::Row;
use crate::lab::stability::cases::Case;
use crate::lab::{Finding, MeshCheck, ModelCheck};
use crate::viewer::command::Command;
use crate::viewer::format;
use crate::viewer::sheets::What;
use crate::viewer::state::State;
use crate::viewer::theme::Palette;

/// Draws the panel.
pub fn show(ui: &mut Ui, state: &State, commands: &mut Commands) {
    if let Some((case, row)) = state.checks.selected.and_then(|cell| state.checks.row(cell)) {
        cell(ui, case, row);
        ui.separator();
    }
    heading(ui, "This model");
    button(ui, state, commands);
    match &state.checks.model {
        Some(check) => {
            mesh(ui, &check.mesh);
            structures(ui, state, check, commands);
            saves::show(ui, What::Check, state, commands);
        }
        None if state.checks.checking.is_none() => {
            empty(ui, "Slivers, copies, open edges; and where structures err on the rays of this view, beside exact arithmetic.");
        }
        None => {}
    }
    ui.separator();
    needs::show(ui, state, commands);
    memory::show(ui, state, commands);
}

fn cell(ui: &mut Ui, case: &Case, row: &Row) {
    heading(ui, case.id);
    paragraph(ui, case.what);
    paragraph(ui, case.bites);
    paragraph(ui, case.remedy);
    let help = "The structure and the triangle test of the cell that was clicked.";
    fact(ui, "Structure, test", format!("{}, {}", row.id, row.test.id()), help);
    fact(ui, "Verdict", stability::verdict(row), "Rays may slip through with a test that does not promise that they do not.");
    if let Some(error) = &row.error {
        paragraph(ui, error);
        return;
    }
    let count = |n: usize| format::count(n as u64);
    fact(ui, "Rays", count(row.rays), "Rays traced.");
    fact(ui, "Near", count(row.near), "Rays whose answer is a matter of the test's rounding.");
    fact(ui, "Through edges", count(row.boundary), "Rays through an edge or a corner, or in a triangle's plane, to the bit.");
    fact(ui, "Clear wrong", count(row.clear_wrong), "Wrong answers where rounding decides nothing.");
    fact(ui, "Boundary wrong", count(row.boundary_wrong), "Answers that rounding does not explain.");
    fact(ui, "Slipped through", count(row.slipped), "Rays that went through a closed surface.");
    let help = "The greatest error of t, and the one that one clear hit in a thousand exceeds, in units of the last place.";
    fact(ui, "Error of t", format!("{} ({}) ulps", format::number(row.max_ulps), format::number(row.p999_ulps)), help);
    fact(ui, "Nodes", format!("{} at most", format::count(row.max_nodes)), "The most nodes that a ray entered.");
    let help = "Nanoseconds a ray on one thread, measured beside whatever else ran.";
    fact(ui, "Time", format!("{} ns a ray", format::number(row.ns_per_ray)), help);
    fact(ui, "Build", format::duration(row.build_secs), "Wall-clock time of the build.");
}

fn paragraph(ui: &mut Ui, text: &str) {
    ui.add(Label::new(RichText::new(text).small()).wrap());
}

fn button(ui: &mut Ui, state: &State, commands: &mut Commands) {
    let Some(job) = &state.checks.checking else {
        let possible = state.shown.is_some() && state.building.is_none() && !state.is_measuring();
        let button = ui.add_enabled(possible, eframe::egui::Button::new("Check this model"));
        let help = "Look at every triangle, build every structure, and hold the rays of this view, and diffuse ones from what it sees, against exact arithmetic.";
        if button.on_hover_text(help).clicked() {
            commands.push(Command::CheckModel);
        }
        return;
    };
    if running(ui, &job.progress, job.progress.snapshot().phase, ("Cancel", "Stop the check.")) {
        commands.push(Command::CancelCheck);
    }
}

fn mesh(ui: &mut Ui, mesh: &MeshCheck) {
    fact(ui, "Surface", mesh.surface(), "Closed if each edge is in two triangles, and no triangle is there twice.");
    let help = "Triangles at least a thousand times as long as high.";
    fact(ui, "Slivers", format::count(mesh.slivers), help);
    fact(ui, "Worst aspect", format::number(mesh.worst_aspect), "The greatest length of a triangle over its height.");
    fact(ui, "No area", format::count(mesh.degenerate), "Triangles without area, which are left out.");
    fact(
        ui,
        "Not finite",
        format::count(mesh.non_finite),
        "Triangles with a corner that is NaN or infinite, which are left out.",
    );
    fact(ui, "Copies", format::count(mesh.duplicates), "Triangles with the same corners as one before.");
    fact(ui, "Open edges", format::count(mesh.boundary_edges), "Edges in one triangle alone.");
    let help = "Edges in more than two triangles.";
    fact(ui, "Branching edges", format::count(mesh.non_manifold_edges), help);
    let help = "The longest side of the model over its shortest edge.";
    fact(ui, "Extent ratio", format::number(mesh.extent_ratio), help);
    for finding in mesh.findings() {
        said(ui, &finding);
    }
}

fn said(ui: &mut Ui, finding: &Finding) {
    let palette = Palette::in_ui(ui);
    let color = if finding.grave { palette.warn } else { palette.text };
    let what = if finding.grave { format!("! {}", finding.what) } else { finding.what.clone() };
    ui.add(Label::new(RichText::new(what).small().color(color)).wrap());
    ui.add(Label::new(RichText::new(finding.remedy).small().color(palette.dim)).wrap());
}

/// A line a structure; the rays of the one that is clicked are drawn over the view.
fn structures(ui: &mut Ui, state: &State, check: &ModelCheck, commands: &mut Commands) {
    heading(ui, "Beside exact arithmetic");
    for (i, row) in check.structures.iter().enumerate() {
        let chosen = state.checks.marked == Some(i);
        let [wrong, rounded, rays] = [row.wrong, row.rounded, row.rays].map(|n| format::count(n as u64));
        let figures = format!("{}: {wrong} wrong, {rounded} rounded", row.id);
        let help =
            "rays traced. Wrong ones, and those that meet another triangle, or none, as rounding may have it: click to see them.";
        if ui.selectable_label(chosen, figures).on_hover_text(format!("{rays} {help}")).clicked() {
            commands.push(Command::MarkModel((!chosen).then_some(i)));
        }
    }
    if let Some(row) = check.structures.first() {
        let rays = format::count(check.rays.len() as u64);
        empty(ui, &format!("Of {rays} rays, or a part of them where a structure is slow; {} test.", row.test.id()));
    }
}
