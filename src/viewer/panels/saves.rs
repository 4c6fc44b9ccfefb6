//! A small menu beside each table and plot, which saves it.

use eframe::egui::{Button, Ui};

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
        let mut item = |text: &str, export: Export, possible: bool| {
            let button = ui.add_enabled(possible, Button::new(text)).on_disabled_hover_text("Nothing to plot is measured yet.");
            if button.clicked() {
                commands.push(Command::Export(export));
            }
        };
        item("Table as CSV…", Export::Table(what), true);
        if what.has_plot() {
            let plotted = what.is_plotted(state);
            item("Plot as SVG…", Export::Plot(what, Form::Svg), plotted);
            item("Plot as PNG…", Export::Plot(what, Form::Png), plotted);
        }
    });
    let name = format!("Save {}", what.name());
    menu.response.accessible_name(name).on_hover_text("Save this as a file.");
}
