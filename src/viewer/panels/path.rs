//! A field for a path: for systems without a file dialog, and for built-in scenes with options.

use eframe::egui::{Key, Modal, TextEdit, Ui};

use super::Commands;
use crate::viewer::command::Command;
use crate::viewer::state::State;

/// Draws the field, if it is open. What is being typed stays here, under the field's own name.
pub fn show(ui: &Ui, state: &State, commands: &mut Commands) {
    let id = ui.scope_id().with("path");
    if state.asking.is_none() {
        ui.data_mut(|d| d.remove::<String>(id));
        return;
    }
    let modal = Modal::new(id).show(ui.ctx(), |ui| {
        ui.heading("Open a path");
        let typed: Option<String> = ui.data(|d| d.get_temp(id));
        let just_opened = typed.is_none();
        let mut text = typed.unwrap_or_default();
        let label = ui.label("A file, or a built-in scene such as builtin:terrain?triangles=1000000");
        let field = ui.add(TextEdit::singleline(&mut text).hint_text("path").desired_width(f32::INFINITY)).labelled_by(label.id);
        if just_opened {
            field.request_focus();
        }
        let entered = field.lost_focus() && ui.input(|i| i.key_pressed(Key::Enter));
        ui.horizontal(|ui| {
            let open = ui.add_enabled(!text.trim().is_empty(), eframe::egui::Button::new("Open model")).clicked();
            if (open || entered) && !text.trim().is_empty() {
                commands.push(Command::Open(text.trim().to_owned()));
            }
            if ui.button("Cancel").clicked() {
                commands.push(Command::AskForPath(false));
            }
        });
        ui.data_mut(|d| d.insert_temp(id, text));
    });
    if modal.should_close() {
        commands.push(Command::AskForPath(false));
    }
}
