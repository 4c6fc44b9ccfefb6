//! A small menu beside each table and plot, which saves it.

use eframe::egui::Ui;

use super::Commands;
use crate::viewer::command::Command;
use crate::viewer::exports::{Export, Form};
use crate::viewer::sheets::What;
use crate::viewer::state::State;

/// Draws the menu, if there is anything to save.
pub fn show(ui: &mut Ui, what: What, state: &State, commands: &mut Commands) {
    if !what.is_there(state) {
        return;
    }
    let menu = ui.menu_button("Save", |ui| {
        let mut item = |text: &str, export: Export| {
            if ui.button(text).clicked() {
                commands.push(Command::Export(export));
            }
        };
        item("Table as CSV…", Export::Table(what));
        if what.has_plot() {
            item("Plot as SVG…", Export::Plot(what, Form::Svg));
            item("Plot as PNG…", Export::Plot(what, Form::Png));
        }
    });
    let name = format!("Save {}", what.name());
    menu.response.accessible_name(name).on_hover_text("Save this as a file.");
}
