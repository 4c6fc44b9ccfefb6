//! The selected cell in the Structure workspace: its figures, and how it is divided.

use eframe::egui::Ui;

use super::{Commands, decision, empty, fact, fitting, heading, hiding, tree};
use crate::accel::cell::{Cell, CellKind, Split};
use crate::viewer::command::Command;
use crate::viewer::format;
use crate::viewer::state::State;
use glam::Vec3;

/// Draws the panel.
pub fn show(ui: &mut Ui, state: &State, commands: &mut Commands) {
    heading(ui, "Selected cell");
    let Some(cell) = state.picked.as_ref().and_then(|picked| picked.selected()) else {
        empty(ui, "Nothing is selected. Click the picture, or a row of the tree.");
        hiding::show(ui, state, commands);
        return;
    };
    tree::steps(ui, state, commands);
    hiding::show(ui, state, commands);
    figures(ui, state, cell);
    ui.separator();
    heading(ui, "Decision");
    let mut hide = state.settings.hide_outcome;
    let help = "Do not show how nodes are divided, nor what would be cheapest, until asked: predict it first.";
    if ui.checkbox(&mut hide, "Hide the outcome").on_hover_text(help).changed() {
        commands.push(Command::HideOutcome(hide));
    }
    match &state.curves {
        Some((id, Some(curves))) if *id == cell.id => decision::show(ui, state, curves, commands),
        Some((id, None)) if *id == cell.id => empty(ui, "No division to weigh: fewer than two triangles, or too many."),
        _ if state.is_measuring() => empty(ui, "Worked out once measuring has ended."),
        _ => drop(ui.spinner().on_hover_text("Working out what each division would cost.")),
    }
    if state.fittable().is_some() {
        ui.separator();
        fitting::show(ui, state, commands);
    }
}

fn figures(ui: &mut Ui, state: &State, cell: &Cell) {
    let kind = match cell.kind {
        CellKind::Inner => "node",
        CellKind::Void => "empty space",
        CellKind::Leaf { .. } => "leaf",
    };
    fact(ui, "Cell", format!("{kind} {} at depth {}", cell.id.node, cell.depth), "Its kind, its number and its depth.");
    if let Some(visits) = state.visits() {
        let help = "How often a camera ray of the view enters it, from a sample of them.";
        fact(ui, "Visits a ray", format::number(visits.a_ray(cell.id)), help);
    }
    let row = state.tree.outline.as_ref().zip(state.tree.selected).map(|(outline, at)| outline.row(at));
    // The cell of a row that was just selected may be on its way.
    let row = row.filter(|row| row.id == cell.id);
    if let Some(row) = row {
        fact(ui, "Triangles", format::count(row.references.into()), "References in it and below, each time they are held.");
        fact(ui, "Cells below", format::count(row.below.into()), "Nodes and leaves below it.");
        fact(
            ui,
            "Met by",
            format!("{} of lines", format::share(row.chance)),
            "The chance that a random line through the root meets it: A(n)/A(root).",
        );
        fact(ui, "SAH share", format::share(row.share), "The part of the SAH cost that it and what is below it make up.");
        fact(ui, "By itself", format::share(row.own_share), "The part that its own step or tests make up.");
        if let Some(overlap) = row.overlap {
            let help = "The chance that a line that meets it meets the overlap of two of its children: sum A(a and b)/A(n).";
            fact(ui, "Overlap", format::share(overlap), help);
        }
    }
    let bounds = cell.shape.bounds();
    let triple = |v: Vec3, between: &str| v.to_array().map(|x| format::number(x.into())).join(between);
    let units = "in units in which the longest side of the scene is about 1.";
    fact(ui, "Size", triple(bounds.size(), " × "), &format!("The sides of its box, {units}"));
    fact(ui, "From", triple(bounds.min, ", "), &format!("The least corner of its box: x, y and z, {units}"));
    fact(ui, "To", triple(bounds.max, ", "), &format!("The greatest corner of its box: x, y and z, {units}"));
    let help = "The surface area of its box, in squares of those units; that over the root's is the chance to be met.";
    fact(ui, "Area", format::number(bounds.area()), help);
    if let Some(Split::Axis { axis, pos }) = cell.split.filter(|_| !hidden(state)) {
        fact(ui, "Divided", format!("{} = {}", axis.name(), format::number(pos.into())), "The plane that divides it.");
    }
}

/// Whether the outcome is not to be shown.
pub fn hidden(state: &State) -> bool {
    state.settings.hide_outcome && !state.tree.revealed
}
