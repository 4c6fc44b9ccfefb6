//! Triangles that are hidden, and the ways to hide those of the selected cell and to show all again.

use eframe::egui::{Button, RichText, Ui};

use super::Commands;
use crate::accel::visibility::Change;
use crate::viewer::actions::{self, HIDE, ISOLATE, SHOW_ALL};
use crate::viewer::command::Command;
use crate::viewer::format;
use crate::viewer::state::State;
use crate::viewer::theme::Palette;

/// What sees hidden triangles all the same.
const BUT: &str = "Heat maps, steps of a ray and measurements show what the structure does for all triangles.";

/// Draws the panel: with a cell selected, or where some triangles are hidden or will be.
pub fn show(ui: &mut Ui, state: &State, commands: &mut Commands) {
    let selected = state.picked.as_ref().is_some_and(|picked| picked.selected().is_some());
    let hidden = in_words(state);
    if !selected && hidden.is_none() && !state.is_hiding() {
        return;
    }
    let free = selected && !state.is_measuring() && !state.is_hiding();
    let written = |key| actions::written(ui.ctx(), key);
    let isolate = format!("Show only the triangles of this cell and those below it. {BUT} ({})", written(&ISOLATE));
    let hide = format!("Hide the triangles of this cell and those below it. {BUT} ({})", written(&HIDE));
    let all = format!("Show all triangles again ({})", written(&SHOW_ALL));
    let ways = [
        ("Isolate", isolate, free, Command::Hide(Change::Isolate)),
        ("Hide", hide, free, Command::Hide(Change::Hide)),
        ("Show all", all, hidden.is_some(), Command::ShowAll),
    ];
    ui.horizontal_wrapped(|ui| {
        for (name, help, possible, command) in ways {
            if ui.add_enabled(possible, Button::new(name)).on_hover_text(help).clicked() {
                commands.push(command);
            }
        }
        if state.is_hiding() {
            ui.spinner().on_hover_text("Sorting out the triangles.");
        }
    });
    if let Some(hidden) = hidden {
        ui.label(RichText::new(hidden).small().color(Palette::in_ui(ui).dim));
    }
}

/// `1 204 of 6 320 triangles are hidden`, if some are.
pub fn in_words(state: &State) -> Option<String> {
    let (visible, model) = (state.visible()?, state.model.as_ref()?);
    let [hidden, all] = [visible.count(), model.geometry.counts().live].map(format::count);
    Some(format!("{hidden} of {all} triangles are hidden"))
}
