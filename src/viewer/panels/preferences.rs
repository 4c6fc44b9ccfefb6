//! The page of settings: how the window looks, how large it is, what the mouse does, how much memory the work may take and when a
//! picture rests. They stay from day to day, and the menus have them, too.

use eframe::egui::{self, Ui};

use super::{Commands, empty, heading};
use crate::viewer::actions::{self, LARGER, SAME_SIZE, SMALLER, scaled};
use crate::viewer::command::Command;
use crate::viewer::format;
use crate::viewer::settings::{Navigation, ThemeChoice};
use crate::viewer::state::State;
use crate::viewer::theme;

/// Samples after which a picture can be told to rest.
const SAMPLES: [u32; 6] = [1, 16, 64, 256, 1024, 4096];

/// Draws the page, if it is open.
pub fn show(ui: &Ui, state: &State, commands: &mut Commands) {
    if !state.preferences {
        return;
    }
    let mut open = true;
    let page = egui::Window::new("Settings").open(&mut open).collapsible(false).resizable(false);
    page.anchor(egui::Align2::CENTER_CENTER, egui::Vec2::ZERO).show(ui.ctx(), |ui| {
        // The page is as wide as its words.
        ui.style_mut().wrap_mode = Some(egui::TextWrapMode::Extend);
        ui.horizontal_top(|ui| {
            ui.vertical(|ui| {
                heading(ui, "Look");
                look(ui, state, commands);
                ui.add_space(theme::GUTTER);
                heading(ui, "Size");
                size(ui, state, commands);
                ui.add_space(theme::GUTTER);
                heading(ui, "Mouse");
                mouse(ui, state, commands);
            });
            ui.add_space(2.0 * theme::GUTTER);
            ui.vertical(|ui| {
                heading(ui, "Memory");
                memory(ui, state, commands);
            });
            ui.add_space(2.0 * theme::GUTTER);
            ui.vertical(|ui| {
                heading(ui, "Samples a pixel");
                samples(ui, state, commands);
            });
        });
    });
    if !open {
        commands.push(Command::Preferences(false));
    }
}

/// Light or dark.
pub fn look(ui: &mut Ui, state: &State, commands: &mut Commands) {
    for (choice, text) in [(ThemeChoice::System, "As the system"), (ThemeChoice::Light, "Light"), (ThemeChoice::Dark, "Dark")] {
        if ui.radio(state.settings.theme == choice, text).clicked() {
            commands.push(Command::Theme(choice));
        }
    }
}

/// How large everything is.
fn size(ui: &mut Ui, state: &State, commands: &mut Commands) {
    let scale = state.settings.scale;
    ui.horizontal(|ui| {
        for (name, key, to) in
            [("Smaller", SMALLER, scaled(scale, false)), ("Normal", SAME_SIZE, 1.0), ("Larger", LARGER, scaled(scale, true))]
        {
            let help = actions::written(ui.ctx(), &key);
            if ui.add_enabled(to != scale, egui::Button::new(name)).on_hover_text(help).clicked() {
                commands.push(Command::Scale(to));
            }
        }
        ui.label(format::percent(scale.into()));
    });
}

/// Which button does what.
pub fn mouse(ui: &mut Ui, state: &State, commands: &mut Commands) {
    for (choice, text) in
        [(Navigation::Standard, "Left orbits, middle pans"), (Navigation::Blender, "Blender: middle orbits, Shift+middle pans")]
    {
        if ui.radio(state.settings.navigation == choice, text).clicked() {
            commands.push(Command::Navigation(choice));
        }
    }
}

/// How much the work may take. Structures that are kept go first where it is less than is held.
pub fn memory(ui: &mut Ui, state: &State, commands: &mut Commands) {
    let (used, limit) = state.memory();
    empty(ui, &format!("{} of {} in use", format::bytes(used), format::bytes(limit)));
    let chosen = state.settings.memory_mib;
    if ui.radio(chosen.is_none(), "Half of the machine").clicked() {
        commands.push(Command::Memory(None));
    }
    for gib in memory_sizes(state) {
        if ui.radio(chosen == Some(gib << 10), format::bytes(gib << 30)).clicked() {
            commands.push(Command::Memory(Some(gib << 10)));
        }
    }
}

/// Sizes of the budget that this machine has, in GiB.
pub fn memory_sizes(state: &State) -> impl Iterator<Item = u64> {
    let most = state.machine_bytes;
    [1, 2, 4, 8, 16, 32, 64, 128].into_iter().filter(move |gib| gib << 30 <= most)
}

/// After how many a picture rests.
pub fn samples(ui: &mut Ui, state: &State, commands: &mut Commands) {
    for samples in SAMPLES {
        if ui.radio(state.settings.max_samples == samples, samples.to_string()).clicked() {
            commands.push(Command::MaxSamples(samples));
        }
    }
}
