//! Which structure, with what parameters, and how its build gets on.

use eframe::egui::{Button, CollapsingHeader, ComboBox, DragValue, ProgressBar, Ui};

use super::{Commands, heading};
use crate::accel::params::{Kind, Param, ParamValues, Value};
use crate::accel::registry::{self, Entry};
use crate::geometry::tri::TestKind;
use crate::viewer::command::Command;
use crate::viewer::state::State;
use crate::viewer::theme;

/// Draws the panel.
pub fn show(ui: &mut Ui, state: &State, commands: &mut Commands) {
    heading(ui, "Structure");
    ui.add_enabled_ui(!state.is_measuring(), |ui| {
        choice(ui, state, commands);
        let entry = state.settings.entry();
        commands.extend(test(ui, state.settings.test_of(entry)).map(Command::Test));
        if !entry.params.is_empty() {
            CollapsingHeader::new("Parameters").id_salt("parameters").show(ui, |ui| {
                commands.extend(parameters(ui, entry, &state.settings.params_of(entry), "Defaults").map(Command::Params));
            });
        }
    });
    if let Some(building) = &state.building {
        let now = building.job.progress.snapshot();
        let bar = now.fraction.map_or_else(|| ProgressBar::new(0.0).animate(true), ProgressBar::new);
        ui.add(bar.text(format!("Building {}: {}", building.key.entry.name, now.phase)));
        if ui.button("Cancel").on_hover_text("Stop building; the structure on the screen stays.").clicked() {
            commands.push(Command::CancelBuild);
        }
    }
}

fn choice(ui: &mut Ui, state: &State, commands: &mut Commands) {
    let chosen = state.settings.entry();
    let combo = ComboBox::from_id_salt("structure").height(theme::LONG_MENU);
    let combo = combo.selected_text(chosen.name).width(ui.available_width());
    let response = combo.show_ui(ui, |ui| {
        for entry in registry::ALL {
            if ui.selectable_label(entry.id == chosen.id, entry.name).on_hover_text(entry.help).clicked() {
                commands.push(Command::Structure(entry.id));
            }
        }
    });
    response.response.accessible_name("Structure").on_hover_text(chosen.help);
}

/// The triangle tests; the one that was chosen, if one was.
pub fn test(ui: &mut Ui, now: TestKind) -> Option<TestKind> {
    let mut chosen = None;
    ui.horizontal_wrapped(|ui| {
        // The others are shown only while one of them is chosen, by a case of the stability lab.
        let other = TestKind::OTHERS.into_iter().filter(|kind| *kind == now);
        for kind in TestKind::ALL.into_iter().chain(other) {
            if ui.radio(now == kind, kind.name()).on_hover_text(kind.help()).clicked() {
                chosen = Some(kind);
            }
        }
    });
    chosen
}

/// The parameters of a structure; others, if one was changed. `defaults` is the name of the button that brings all back.
pub fn parameters(ui: &mut Ui, entry: &Entry, before: &ParamValues, defaults: &str) -> Option<ParamValues> {
    let changed = *before != entry.defaults();
    let button = ui.add_enabled(changed, Button::new("Defaults")).accessible_name(defaults);
    let bring_back = button.on_hover_text("Bring back every parameter of this structure.").clicked();
    let mut values = before.clone();
    let mut settled = false;
    for (param, value) in values.iter_mut() {
        settled |= parameter(ui, param, value);
    }
    let values = if bring_back { entry.defaults() } else { values };
    ((bring_back || settled) && values != *before).then_some(values)
}

/// One parameter; true when its value is to be used. While a number is dragged it lives in the
/// widget's own memory, so that a build starts once, at the end.
fn parameter(ui: &mut Ui, param: &'static Param, value: &mut Value) -> bool {
    let help = if param.unit.is_empty() { param.help.to_owned() } else { format!("{} In {}.", param.help, param.unit) };
    let row = ui.horizontal(|ui| {
        let label = ui.label(param.label);
        ui.with_layout(eframe::egui::Layout::right_to_left(eframe::egui::Align::Center), |ui| {
            let id = ui.scope_id().with(("parameter", param.id));
            match (param.kind, value) {
                (Kind::Int { min, max, .. }, Value::Int(v)) => {
                    let mut shown = ui.data(|d| d.get_temp(id)).unwrap_or(*v);
                    let response = ui.add(DragValue::new(&mut shown).range(min..=max)).labelled_by(label.id);
                    settle(ui, id, &response, shown, v)
                }
                (Kind::Float { min, max, .. }, Value::Float(v)) => {
                    let mut shown = ui.data(|d| d.get_temp(id)).unwrap_or(*v);
                    let speed = (shown * 0.01).max(0.01);
                    let widget = DragValue::new(&mut shown).range(min..=max).speed(speed).max_decimals(2);
                    let response = ui.add(widget).labelled_by(label.id);
                    settle(ui, id, &response, shown, v)
                }
                (Kind::Choice { options }, Value::Choice(v)) => options_of(ui, param, label.id, options, v),
                _ => false,
            }
        })
        .inner
    });
    row.response.on_hover_text(help);
    row.inner
}

fn settle<T: Copy + PartialEq + Send + Sync + 'static>(
    ui: &Ui,
    id: eframe::egui::Id,
    response: &eframe::egui::Response,
    shown: T,
    value: &mut T,
) -> bool {
    if response.dragged() || response.has_focus() {
        ui.data_mut(|d| d.insert_temp(id, shown));
        return false;
    }
    ui.data_mut(|d| d.remove::<T>(id));
    let changed = *value != shown;
    *value = shown;
    changed
}

fn options_of(
    ui: &mut Ui,
    param: &Param,
    label: eframe::egui::Id,
    options: &'static [&'static str],
    value: &mut &'static str,
) -> bool {
    let before = *value;
    let list = ComboBox::from_id_salt(param.id).height(theme::LONG_MENU).selected_text(*value).show_ui(ui, |ui| {
        for option in options {
            ui.selectable_value(value, *option, *option);
        }
    });
    list.response.labelled_by(label);
    *value != before
}
