//! The rays of a file, the dearest first: what each does in the shown structure. A click follows one.

use eframe::egui::{Align2, EventFilter, Id, Key, Rect, Response, Role, Sense, TextStyle, Ui, WidgetInfo, pos2, vec2};

use super::long_list::LongList;
use super::{Commands, empty, focus, saves};
use crate::viewer::command::Command;
use crate::viewer::format;
use crate::viewer::ray_list::Listed;
use crate::viewer::sheets::What;
use crate::viewer::state::State;
use crate::viewer::theme::{self, Palette};

/// The width of a column of figures.
const COLUMN: f32 = 14.0 * theme::GRID;
/// What the columns hold, from the left.
const HEADS: [&str; 4] = ["Ray", "Nodes", "Tests", "t"];

/// Draws the list.
pub fn show(ui: &mut Ui, state: &State, file: &Listed, commands: &mut Commands) {
    let list = &state.ray_list;
    let more = if file.more { " and more" } else { "" };
    empty(ui, &format!("{}: {} rays{more}", file.name, format::count(file.rays.len() as u64)));
    if !list.is_traced_in(state.shown.as_ref().map(|shown| &shown.key)) {
        let text = if list.tracing.is_some() { "Tracing them…" } else { "They are traced once nothing is measured or built." };
        return empty(ui, text);
    }
    saves::show(ui, What::Rays, state, commands);
    header(ui);
    let id = Id::unique("rays of a file");
    let area = ui.available_rect_before_wrap();
    let keys_go = ui.interact(area, id.with("keys"), Sense::focusable_noninteractive());
    keys_go.widget_info(|| WidgetInfo::labeled(Role::List, true, "Rays of the file"));
    let rows = u32::try_from(file.rays.len()).unwrap_or(u32::MAX);
    let reveal = list.chosen.map(|row| (row, list.moved));
    let fit = LongList { id, rows, height: theme::ROW, reveal }.show(ui, |ui, row| {
        if one(ui, state, row) {
            commands.push(Command::FollowListed(row));
            keys_go.request_focus();
        }
    });
    if keys_go.has_focus() {
        focus::ring(ui, area);
        keys(ui, &keys_go, (list.chosen, rows, fit), commands);
    }
}

/// Where the right ends of the columns are.
fn ends(rect: Rect) -> [f32; 4] {
    let right = rect.right() - theme::GRID;
    [right - 3.0 * COLUMN, right - 2.0 * COLUMN, right - COLUMN, right]
}

fn header(ui: &mut Ui) {
    let (rect, response) = ui.allocate_exact_size(vec2(ui.available_width(), theme::ROW), Sense::hover());
    let inner = Rect::from_min_max(rect.min, pos2(rect.right() - 3.0 * theme::GRID, rect.bottom()));
    let (small, color) = (TextStyle::Small.resolve(ui.style()), Palette::in_ui(ui).dim);
    for (end, head) in ends(inner).into_iter().zip(HEADS) {
        ui.painter().text(pos2(end, inner.center().y), Align2::RIGHT_CENTER, head, small.clone(), color);
    }
    response.on_hover_text("The number of the ray in the file, from 1; nodes that it enters and triangles that it is tested against in the shown structure; and where along it the closest hit is. The dearest stand first, by the weights of the structure.");
}

/// A row; true if it was clicked.
fn one(ui: &mut Ui, state: &State, row: u32) -> bool {
    let Some((number, _, work)) = state.ray_list.row(row) else { return false };
    let palette = Palette::in_ui(ui);
    let (rect, chosen) = (ui.max_rect(), state.ray_list.chosen == Some(row));
    let response = ui.interact(rect, ui.scope_id().with("ray"), Sense::CLICK);
    let t = if work.t.is_finite() { format::number(work.t.into()) } else { format::MISSING.to_owned() };
    let [number, nodes, tests] = [u64::from(number) + 1, work.nodes.into(), work.tests.into()].map(format::count);
    response.widget_info(|| {
        let name = format!("Ray {number}: {nodes} nodes, {tests} tests, t {t}");
        WidgetInfo::selected(Role::ListItem, true, chosen, name)
    });
    let fill = match () {
        () if chosen => palette.selection,
        () if response.hovered() => palette.control_hovered,
        () => palette.panel,
    };
    ui.painter().rect_filled(rect, 0.0, fill);
    let body = TextStyle::Body.resolve(ui.style());
    let colors = [palette.dim, palette.text, palette.text, palette.dim];
    for ((end, text), color) in ends(rect).into_iter().zip([number, nodes, tests, t]).zip(colors) {
        ui.painter().text(pos2(end, rect.center().y), Align2::RIGHT_CENTER, text, body.clone(), color);
    }
    response.clicked()
}

/// Up and down, a page at a time, and to either end.
fn keys(ui: &Ui, focus: &Response, (chosen, rows, fit): (Option<u32>, u32, u32), commands: &mut Commands) {
    let lock = EventFilter { horizontal_arrows: false, vertical_arrows: true, ..Default::default() };
    ui.memory_mut(|m| m.set_focus_lock_filter(focus.id, lock));
    let pressed = |key| ui.input(|i| i.modifiers.is_none() && i.key_pressed(key));
    let last = rows.saturating_sub(1);
    let down = |by: u32| chosen.map_or(0, |at| at.saturating_add(by)).min(last);
    let up = |by: u32| chosen.map_or(0, |at| at.saturating_sub(by));
    let to = match () {
        () if pressed(Key::ArrowDown) => Some(down(1)),
        () if pressed(Key::ArrowUp) => Some(up(1)),
        () if pressed(Key::PageDown) => Some(down(fit)),
        () if pressed(Key::PageUp) => Some(up(fit)),
        () if pressed(Key::End) => Some(last),
        () => None,
    };
    commands.extend(to.map(Command::FollowListed));
}
