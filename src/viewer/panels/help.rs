//! One page of keys and mouse.

use eframe::egui::{self, Grid, RichText, Ui};

use super::{Commands, menu};
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
    egui::Window::new("Keys and mouse").open(&mut open).collapsible(false).resizable(false).show(ui.ctx(), |ui| {
        Grid::new("keys").num_columns(2).spacing([3.0 * theme::GUTTER, theme::GRID]).show(ui, |ui| {
            let keys = |shortcut| ui.ctx().format_shortcut(shortcut);
            let (orbit, pan) = match state.settings.navigation {
                Navigation::Standard => ("Left drag", "Middle drag, or Shift and left drag"),
                Navigation::Blender => ("Middle drag", "Shift and middle drag"),
            };
            let rows = [
                (orbit.to_owned(), "Orbit around the model"),
                (pan.to_owned(), "Move the picture"),
                ("Click".to_owned(), "Say what is there, and mark its leaf"),
                ("Wheel, pinch".to_owned(), "Zoom to the pointer"),
                ("Arrow keys".to_owned(), "Orbit, when the viewport has the focus"),
                ("+ and -".to_owned(), "Zoom, when the viewport has the focus"),
                (keys(&menu::FRAME_ALL), "Frame the whole model"),
                (keys(&menu::PROJECTION), "Perspective or orthographic"),
                (format!("{}, {}", keys(&menu::CAMERA_BACK), keys(&menu::CAMERA_FORWARD)), "The view before, and forward again"),
                (format!("{}, {}", keys(&menu::UNDO), keys(&menu::REDO)), "Take back a choice, and make it again"),
                (keys(&menu::OPEN), "Open a file"),
                (keys(&menu::OPEN_PATH), "Open a path or a built-in scene"),
                (
                    format!("{}, {}, {}", keys(&menu::VIEW), keys(&menu::COMPARE), keys(&menu::CHECK)),
                    "The workspaces: View, Compare, Check",
                ),
                (keys(&menu::FULL_SCREEN), "Full screen"),
                ("Esc".to_owned(), "Cancel what is going on"),
                ("?".to_owned(), "This page"),
            ];
            for (key, what) in rows {
                ui.label(RichText::new(key).strong());
                ui.label(what);
                ui.end_row();
            }
        });
    });
    if !open {
        commands.push(Command::Help(false));
    }
}
