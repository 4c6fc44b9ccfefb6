//! The divider of a split picture, and what stands on either side of it.

use eframe::egui::{Align2, CursorIcon, EventFilter, Key, Rect, Sense, Stroke, Ui, WidgetInfo, pos2, vec2};

use super::{Commands, captions};
use crate::render::Picture;
use crate::viewer::command::Command;
use crate::viewer::format;
use crate::viewer::state::State;
use crate::viewer::theme::{self, Palette};

/// What an arrow key moves the divider.
const KEY_STEP: f32 = 0.02;

/// The parts of the view that belong to the first structure and to the second.
pub fn halves(rect: Rect, divider: f32) -> [Rect; 2] {
    let x = rect.left() + divider * rect.width();
    [Rect::from_min_max(rect.min, pos2(x, rect.bottom())), Rect::from_min_max(pos2(x, rect.top()), rect.max)]
}

/// Draws the divider and the names, and moves it by hand.
pub fn show(ui: &Ui, rect: Rect, state: &State, commands: &mut Commands) {
    if !state.is_split() {
        return;
    }
    let palette = Palette::in_ui(ui);
    let divider = state.beside.divider;
    let [left, right] = halves(rect, divider);
    let line = Rect::from_center_size(right.left_center(), vec2(2.0 * theme::GUTTER, rect.height()));
    let response = ui.interact(line, ui.scope_id().with("divider"), Sense::click_and_drag());
    response.widget_info(|| WidgetInfo::slider(true, f64::from(divider), "Divider of the pictures"));
    let response = response.on_hover_cursor(CursorIcon::ResizeHorizontal);
    let strong = response.hovered() || response.dragged() || response.has_focus();
    let color = if strong { palette.accent_text } else { palette.text };
    ui.painter().vline(right.left(), rect.y_range(), Stroke::new(theme::RAY_HALO, theme::plate(palette)));
    ui.painter().vline(right.left(), rect.y_range(), Stroke::new(1.0, color));
    if response.clicked() || response.drag_started() {
        response.request_focus();
    }
    if let Some(at) = response.interact_pointer_pos().filter(|_| response.dragged()) {
        commands.push(Command::Divider((at.x - rect.left()) / rect.width()));
    }
    if response.has_focus() {
        let lock = EventFilter { horizontal_arrows: true, ..Default::default() };
        ui.memory_mut(|m| m.set_focus_lock_filter(response.id, lock));
        let steps = ui.input(|i| i32::from(i.key_pressed(Key::ArrowRight)) - i32::from(i.key_pressed(Key::ArrowLeft)));
        if steps != 0 {
            commands.push(Command::Divider(divider + steps as f32 * KEY_STEP));
        }
    }
    for (half, align, text) in [(left, Align2::LEFT_TOP, first(state)), (right, Align2::RIGHT_TOP, second(state))] {
        let inner = half.shrink(theme::GUTTER);
        if let Some(text) = text.filter(|_| inner.is_positive()) {
            captions::plate(ui, align.pos_in_rect(&inner), align, text);
        }
    }
}

fn first(state: &State) -> Option<String> {
    let shown = state.shown.as_ref()?;
    Some(sentence(shown.key.entry.name, state.picture.as_deref()?))
}

fn second(state: &State) -> Option<String> {
    let built = state.beside.built.as_ref()?;
    Some(sentence(built.key.entry.name, state.beside.picture.as_deref()?))
}

/// A name, and what rays did in the structure.
fn sentence(name: &str, picture: &Picture) -> String {
    let progress = &picture.progress;
    if progress.counted == 0 {
        return name.to_owned();
    }
    let over = |n: u64| format::number(n as f64 / progress.counted as f64);
    format!("{name}: {} nodes, {} tests a ray", over(progress.counts.nodes), over(progress.counts.prims))
}

/// What stands on either side, for those who cannot see it.
pub fn describe(state: &State) -> Option<String> {
    state.is_split().then(|| [first(state), second(state)].into_iter().flatten().collect::<Vec<_>>().join("; at the right "))
}
