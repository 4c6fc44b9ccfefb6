//! One page of keys and mouse.

use std::borrow::Cow;

use eframe::egui::{self, Grid, RichText, Ui};

use super::Commands;
use crate::viewer::actions;
use crate::viewer::command::Command;
use crate::viewer::settings::Navigation;
use crate::viewer::state::State;
use crate::viewer::theme;

/// Draws the page, if it is open.
pub fn show(ui: &Ui, state: &State, commands: &mut Commands) {
    if !state.help {
        return;
    }
    let mut open = true;
    let page = egui::Window::new("Keys and mouse").open(&mut open).collapsible(false).resizable(false);
    page.anchor(egui::Align2::CENTER_CENTER, egui::Vec2::ZERO).show(ui.ctx(), |ui| {
        ui.horizontal_top(|ui| {
            table(ui, "mouse", hands(state.settings.navigation).map(|(key, what)| (key.to_owned(), what.into())));
            ui.separator();
            let actions = actions::all(state);
            let keyed = actions.iter().filter_map(|action| Some((action.keys.first()?, action.name.clone())));
            let mut rows: Vec<_> = keyed.map(|(key, name)| (actions::written(ui.ctx(), key), name)).collect();
            // Beside each other, so that the page fits the least window.
            let rest = rows.split_off(rows.len().div_ceil(2));
            table(ui, "keys", rows);
            ui.separator();
            table(ui, "more keys", rest);
        });
    });
    if !open {
        commands.push(Command::Help(false));
    }
}

/// What the mouse does, and keys that do other things in other places.
const fn hands(navigation: Navigation) -> [(&'static str, &'static str); 16] {
    let (orbit, pan) = match navigation {
        Navigation::Standard => ("Left drag", "Middle drag, or Shift and left drag"),
        Navigation::Blender => ("Middle drag", "Shift and middle drag"),
    };
    [
        (orbit, "Orbit around the model"),
        (pan, "Move the picture"),
        ("Click", "Mark the leaf there; in Ray, its ray"),
        ("Wheel, pinch", "Zoom to the pointer"),
        ("Arrow keys", "Orbit, if the viewport has the focus"),
        ("+ and -", "Zoom, if the viewport has the focus"),
        ("Arrows in the tree", "Up and down; in and out"),
        ("Arrows in the SAH plot", "Move the tried plane; change its axis"),
        ("Arrows in the steps", "Step by step; left and right by leaves"),
        ("Arrows in the list of rays", "Follow the next ray, or the one before"),
        ("Drag a histogram's end, or arrows", "Move that end of the colours"),
        ("Drag a divider, or arrows", "Move it between compared pictures"),
        ("Drag a panel's edge, or arrows", "Make the panel larger or smaller"),
        ("Drag, after Mark a rectangle", "Check the pixels with brute force"),
        ("Tab", "The next control"),
        ("Esc", "Cancel what is going on"),
    ]
}

fn table(ui: &mut Ui, id: &str, rows: impl IntoIterator<Item = (String, Cow<'static, str>)>) {
    Grid::new(id).num_columns(2).spacing([2.0 * theme::GUTTER, theme::GRID]).show(ui, |ui| {
        for (key, what) in rows {
            ui.label(RichText::new(key).small().strong());
            ui.label(RichText::new(what).small());
            ui.end_row();
        }
    });
}
