//! The panels of the window, one per file. A panel reads [`super::state::State`] and sends
//! [`Command`]s; it changes nothing itself.

pub mod announce;
pub mod as_table;
pub mod axes;
pub mod bars;
pub mod brute;
pub mod captions;
pub mod check;
pub mod decision;
pub mod drawer;
pub mod error_side;
pub mod errors;
pub mod film;
pub mod findings;
pub mod fitting;
pub mod focus;
pub mod heat;
pub mod help;
pub mod hiding;
pub mod long_list;
pub mod lower;
pub mod marking;
pub mod memory;
pub mod menu;
pub mod needs;
pub mod node;
pub mod overlay;
pub mod palette;
pub mod panes;
pub mod path;
pub mod predicted;
pub mod prediction;
pub mod preferences;
pub mod ray;
pub mod ray_list;
pub mod saves;
pub mod scaling;
pub mod scene;
pub mod section;
pub mod selection;
pub mod split;
pub mod stability;
pub mod statistics;
pub mod status;
pub mod steps;
pub mod structure;
pub mod terms;
pub mod timings;
pub mod toolbar;
pub mod tour;
pub mod tradeoffs;
pub mod tree;
pub mod viewport;

use eframe::egui::{self, ProgressBar, RichText, Ui};

use super::command::Command;
use super::theme::{self, Palette};
use crate::task::Progress;

/// Where panels put what they ask for.
pub type Commands = Vec<Command>;

/// A panel's heading: small capitals in the dim colour.
pub fn heading(ui: &mut Ui, text: &str) {
    ui.add_space(theme::GRID);
    ui.label(RichText::new(text.to_uppercase()).small().strong().color(Palette::in_ui(ui).dim));
}

/// A name and its value, the value right-aligned; the tooltip explains the term in a sentence.
pub fn fact(ui: &mut Ui, name: &str, value: impl Into<String>, help: &str) {
    let row = ui.horizontal(|ui| {
        ui.label(RichText::new(name).color(Palette::in_ui(ui).dim));
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            ui.add(egui::Label::new(value.into()).truncate());
        });
    });
    row.response.on_hover_text(help);
}

/// How far a job is, in a row with the button that stops it, which screen readers call `name`; true if it was clicked.
pub fn running(ui: &mut Ui, progress: &Progress, text: &str, (name, help): (&str, &str)) -> bool {
    let row = ui.horizontal(|ui| {
        let share = progress.snapshot().fraction.unwrap_or(0.0);
        ui.add(ProgressBar::new(share).desired_width(theme::RUNNING).text(text));
        ui.button("Cancel").accessible_name(name).on_hover_text(help).clicked()
    });
    row.inner
}

/// What is not among the rest, and why, in one line; all of it under the pointer.
pub fn not_there(ui: &mut Ui, missing: impl IntoIterator<Item = String>) {
    let missing = missing.into_iter().collect::<Vec<_>>().join(" ");
    if !missing.is_empty() {
        let text = RichText::new(format!("Not there: {missing}")).small().color(Palette::in_ui(ui).warn);
        ui.add(egui::Label::new(text).truncate()).on_hover_text(missing);
    }
}

/// A sentence where there is nothing to show.
pub fn empty(ui: &mut Ui, text: &str) {
    ui.label(RichText::new(text).color(Palette::in_ui(ui).dim));
}
