//! The palette: type a few letters of anything that can be done, and Enter does it.

use eframe::egui::{Align, Button, EventFilter, Key, Label, Layout, Modal, RichText, ScrollArea, TextEdit, Ui};

use super::{Commands, empty};
use crate::viewer::actions::{self, Action};
use crate::viewer::command::Command;
use crate::viewer::state::State;
use crate::viewer::theme::{self, Palette};

/// The width of the palette.
const WIDTH: f32 = 120.0 * theme::GRID;
/// Rows that are seen at a time.
const ROWS: f32 = 12.0;

/// What is typed, and which of what fits is chosen.
#[derive(Clone, Default)]
struct Typed {
    text: String,
    chosen: usize,
}

/// Draws it, if it is open.
pub fn show(ui: &Ui, state: &State, commands: &mut Commands) {
    let id = ui.scope_id().with("palette");
    if !state.palette {
        ui.data_mut(|d| d.remove::<Typed>(id));
        return;
    }
    let modal = Modal::new(id).show(ui.ctx(), |ui| {
        ui.set_width(WIDTH);
        let before: Option<Typed> = ui.data(|d| d.get_temp(id));
        let just_opened = before.is_none();
        let mut typed = before.unwrap_or_default();
        let moved = ui.input(|i| i32::from(i.key_pressed(Key::ArrowDown)) - i32::from(i.key_pressed(Key::ArrowUp)));
        let field = TextEdit::singleline(&mut typed.text).hint_text("What to do").desired_width(f32::INFINITY);
        let field = ui.add(field.event_filter(EventFilter { vertical_arrows: true, ..Default::default() }));
        field.widget_info(|| eframe::egui::WidgetInfo::labeled(eframe::egui::Role::TextInput, true, "Search commands"));
        if field.changed() {
            typed.chosen = 0;
        }
        // Of what is typed now: the last letters and Enter may come in one frame.
        let fitting = fitting(state, &typed.text);
        let last = fitting.len().saturating_sub(1);
        typed.chosen = typed.chosen.saturating_add_signed(moved as isize).min(last);
        let entered = field.lost_focus() && ui.input(|i| i.key_pressed(Key::Enter));
        if entered && let Some(action) = fitting.get(typed.chosen) {
            commands.extend([Command::Palette(false), action.command.clone()]);
        } else if just_opened || entered {
            field.request_focus();
        }
        ui.add_space(theme::GRID);
        rows(ui, &fitting, (typed.chosen, moved != 0), commands);
        ui.data_mut(|d| d.insert_temp(id, typed));
    });
    if modal.should_close() {
        commands.push(Command::Palette(false));
    }
}

/// What can be done and fits, the best first.
fn fitting(state: &State, text: &str) -> Vec<Action> {
    let possible = actions::all(state).into_iter().filter(|action| action.possible);
    let mut fitting: Vec<(u32, Action)> =
        possible.filter_map(|action| Some((actions::fit(&action.name, text)?, action))).collect();
    if !text.trim().is_empty() {
        fitting.sort_by_key(|(cost, _)| *cost);
    }
    fitting.into_iter().map(|(_, action)| action).collect()
}

fn rows(ui: &mut Ui, fitting: &[Action], (chosen, moved): (usize, bool), commands: &mut Commands) {
    if fitting.is_empty() {
        empty(ui, "Nothing that can be done now has these letters.");
    }
    let palette = Palette::in_ui(ui);
    ScrollArea::vertical().max_height(ROWS * theme::ROW).auto_shrink([false, true]).show(ui, |ui| {
        for (i, action) in fitting.iter().enumerate() {
            ui.horizontal(|ui| {
                let row = ui.add(Button::selectable(i == chosen, action.name.as_ref()));
                if i == chosen && moved {
                    row.scroll_to_me(None);
                }
                if row.clicked() {
                    commands.extend([Command::Palette(false), action.command.clone()]);
                }
                ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
                    let keys = action.keys.first().map(|key| actions::written(ui.ctx(), key));
                    ui.add(Label::new(RichText::new(keys.unwrap_or_default()).strong()));
                    ui.label(RichText::new(action.group).small().color(palette.dim));
                });
            });
        }
    });
}
