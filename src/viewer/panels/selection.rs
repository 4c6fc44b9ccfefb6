//! What is selected: the cells that hold the point that was clicked, and what dividing the selected one
//! would have cost.

use eframe::egui::{self, Ui};

use super::{Commands, decision, fact, heading, node};
use crate::accel::cell::{Cell, CellKind};
use crate::geometry::Axis;
use crate::viewer::command::Command;
use crate::viewer::format;
use crate::viewer::pick::Picked;
use crate::viewer::state::State;

/// Draws the panel, if anything is selected.
pub fn show(ui: &mut Ui, state: &State, commands: &mut Commands) {
    let Some(picked) = &state.picked else { return };
    ui.separator();
    heading(ui, "Selection");
    if let Some(cell) = picked.selected() {
        levels(ui, picked, cell, commands);
        match &state.curves {
            Some((id, Some(curves))) if *id == cell.id => {
                let hidden = node::hidden(state);
                decision::plot(ui, curves, hidden, (Axis::X, None));
                fact(ui, "Triangles", format::count(curves.triangles as u64), "Triangles below this cell, each counted once.");
                if !hidden {
                    decision::outcome(ui, curves);
                }
            }
            Some((id, None)) if *id == cell.id => {
                super::empty(ui, "No division to weigh: fewer than two triangles, or too many.")
            }
            _ if state.is_measuring() => super::empty(ui, "Worked out once measuring has ended."),
            _ => drop(ui.spinner().on_hover_text("Working out what each division would cost.")),
        }
    }
}

/// Which cell of the path is selected, and the way to its parent and child.
fn levels(ui: &mut Ui, picked: &Picked, cell: &Cell, commands: &mut Commands) {
    ui.horizontal(|ui| {
        let deepest = picked.path.len() - 1;
        let step = |ui: &mut Ui, possible: bool, name: &str, help: &str| {
            ui.add_enabled(possible, egui::Button::new(name)).on_hover_text(help).clicked()
        };
        if step(ui, picked.level > 0, "Parent", "Select the cell around this one.") {
            commands.push(Command::SelectLevel(picked.level - 1));
        }
        if step(ui, picked.level < deepest, "Child", "Select the next cell towards the point that was clicked.") {
            commands.push(Command::SelectLevel(picked.level + 1));
        }
    });
    let kind = match cell.kind {
        CellKind::Inner => "node".to_owned(),
        CellKind::Void => "empty space".to_owned(),
        CellKind::Leaf { prims } => format!("leaf of {}", format::count(prims.into())),
    };
    fact(
        ui,
        "Cell",
        format!("{kind} {} at depth {}", cell.id.node, cell.depth),
        "The cell that is selected, by its number and depth.",
    );
}
