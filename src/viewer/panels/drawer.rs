//! The panel at the right in a narrow window: a strip with a button, which opens the panel over the view. It stays open while
//! other things are clicked, so that what is picked or selected can be read there.

use eframe::egui::{Area, Button, Frame, Id, LayerId, Panel, Rect, ScrollArea, Ui, pos2};

use super::{Commands, focus};
use crate::viewer::command::Command;
use crate::viewer::settings::Workspace;
use crate::viewer::state::State;
use crate::viewer::theme;

/// Draws the strip and, if it is open, the panel beside it; returns where what belongs to them is, and in which layer.
pub fn show(
    ui: &mut Ui,
    strip: Panel,
    state: &State,
    commands: &mut Commands,
    content: impl FnOnce(&mut Ui, &mut Commands),
) -> (LayerId, Rect) {
    let (sign, name) = sign(state.settings.workspace);
    let strip = strip.exact_size(theme::STRIP).resizable(false).show(ui, |ui| {
        let button = ui.add(Button::selectable(state.unfolded, sign)).accessible_name(name);
        if button.on_hover_text(format!("{name}, over the view (Esc closes it)")).clicked() {
            commands.push(Command::Unfold(!state.unfolded));
        }
    });
    let strip = strip.response.rect;
    if !state.unfolded {
        return (ui.layer_id(), strip);
    }
    let place = Rect::from_min_max(pos2(strip.left() - theme::RIGHT_PANEL, strip.top()), strip.left_bottom());
    let area = Area::new(Id::unique("drawer")).fixed_pos(place.min).default_size(place.size()).movable(false).fade_in(false);
    let drawn = area.show(ui.ctx(), |ui| {
        let frame = Frame::side_top_panel(ui.style()).stroke(ui.visuals().window_stroke);
        let room = place.size() - frame.total_margin().sum();
        frame.show(ui, |ui| {
            ui.set_min_size(room);
            ui.set_max_size(room);
            ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
                content(ui, commands);
                focus::keep_in_sight(ui);
            });
        });
    });
    (drawn.response.layer_id, place)
}

/// What stands on the button, and its name.
const fn sign(workspace: Workspace) -> (&'static str, &'static str) {
    match workspace {
        Workspace::View => ("Σ", "Statistics"),
        Workspace::Structure => ("#", "Selected cell"),
        Workspace::Ray => ("»", "Ray"),
        Workspace::Compare => ("±", "Errors"),
        Workspace::Check => ("?", "This model"),
    }
}
