//! Where compared pictures stand in the view, and the dividers between strips.

use eframe::egui::{CursorIcon, EventFilter, Key, Rect, Sense, Stroke, Ui, WidgetInfo, pos2, vec2};

use super::Commands;
use crate::viewer::command::Command;
use crate::viewer::panes::{Arrange, LETTERS, PaneSettings};
use crate::viewer::state::State;
use crate::viewer::theme::{self, Palette};

/// What an arrow key moves the divider.
const KEY_STEP: f32 = 0.02;
/// The width from which the figures of a pane stand in one line.
const ONE_LINE: f32 = 136.0 * theme::GRID;
/// The height of a line of figures.
const LINE: f32 = 4.0 * theme::GRID;

/// The place of one picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Place {
    /// What belongs to it: controls above, figures beneath.
    pub head: Rect,
    /// Its figures; of no height where there is no room.
    pub foot: Rect,
    /// Where its view lies, all of it.
    pub view: Rect,
    /// The part of that which is to be seen.
    pub seen: Rect,
}

/// Places of pictures in `rect`, the first at least; more than there are pictures where some places are empty. All views have
/// the same size in whole pixels.
pub fn places(rect: Rect, panes: Option<&PaneSettings>, pixels_per_point: f32) -> Vec<Place> {
    let Some(panes) = panes else {
        return vec![Place { head: Rect::NOTHING, foot: Rect::NOTHING, view: rect, seen: rect }];
    };
    match panes.arrange {
        Arrange::Divider => strips(rect, &panes.places()),
        Arrange::Two => grid(rect, [2, 1], pixels_per_point),
        Arrange::Four => grid(rect, [2, 2], pixels_per_point),
    }
}

/// What is left of a cell between the controls above and figures beneath.
fn parts(cell: Rect) -> [Rect; 3] {
    let lines = (ONE_LINE / cell.width().max(1.0)).ceil().clamp(1.0, 3.0);
    let head = Rect::from_min_size(cell.min, vec2(cell.width(), (theme::ROW + theme::GRID).min(cell.height())));
    let room = cell.height() - head.height() - 2.0 * theme::ROW;
    let height = if room > lines * LINE + theme::GRID { lines * LINE + theme::GRID } else { 0.0 };
    let foot = Rect::from_min_max(pos2(cell.left(), cell.bottom() - height), cell.max);
    let view = Rect::from_min_max(head.left_bottom(), foot.right_top());
    [head, view, foot]
}

fn grid(rect: Rect, [columns, rows]: [usize; 2], pixels_per_point: f32) -> Vec<Place> {
    // Whole pixels, so that no view is a pixel wider than another.
    let whole = |x: f32| (x * pixels_per_point).floor() / pixels_per_point;
    let [across, down] = [columns as f32, rows as f32];
    let size = vec2(
        whole((rect.width() - theme::GRID * (across - 1.0)) / across).max(0.0),
        whole((rect.height() - theme::GRID * (down - 1.0)) / down).max(0.0),
    );
    let origin = pos2(whole(rect.left()), whole(rect.top()));
    let step = vec2(size.x + whole(theme::GRID), size.y + whole(theme::GRID));
    let cell = |i: usize| {
        let at = vec2((i % columns) as f32 * step.x, (i / columns) as f32 * step.y);
        let [head, view, foot] = parts(Rect::from_min_size(origin + at, size));
        Place { head, foot, view, seen: view }
    };
    (0..columns * rows).map(cell).collect()
}

/// Strips of one view. Controls and figures stand above and beneath in even parts, wherever the dividers are.
fn strips(rect: Rect, dividers: &[f32]) -> Vec<Place> {
    let width = rect.width() / (dividers.len() + 1) as f32;
    let [head, view, foot] = parts(Rect::from_min_size(rect.min, vec2(width, rect.height())));
    let view = Rect::from_min_max(view.min, pos2(rect.right(), view.bottom()));
    let edge = |i: usize| match i.checked_sub(1).map(|before| dividers.get(before)) {
        None => view.left(),
        Some(at) => view.left() + at.copied().unwrap_or(1.0) * view.width(),
    };
    let strip = |i: usize| {
        let by = vec2(i as f32 * width, 0.0);
        let seen = Rect::from_min_max(pos2(edge(i), view.top()), pos2(edge(i + 1), view.bottom()));
        Place { head: head.translate(by), foot: foot.translate(by), view, seen }
    };
    (0..=dividers.len()).map(strip).collect()
}

/// Draws the dividers between strips, and moves them by hand.
pub fn dividers(ui: &Ui, places: &[Place], state: &State, commands: &mut Commands) {
    if state.settings.panes.arrange != Arrange::Divider {
        return;
    }
    let dividers = state.settings.panes.places();
    for (which, (at, place)) in dividers.iter().zip(&places[1..]).enumerate() {
        divider(ui, (which, *at), place, commands);
    }
}

/// What a divider is called.
fn name(which: usize) -> String {
    format!("Divider of {} and {}", LETTERS[which], LETTERS[which + 1])
}

fn divider(ui: &Ui, (which, at): (usize, f32), right: &Place, commands: &mut Commands) {
    let (palette, view) = (Palette::in_ui(ui), right.view);
    let line = Rect::from_center_size(right.seen.left_center(), vec2(2.0 * theme::GUTTER, view.height()));
    let response = ui.interact(line, ui.scope_id().with(("divider", which)), Sense::click_and_drag());
    response.widget_info(|| WidgetInfo::slider(true, f64::from(at), name(which)));
    let response = response.on_hover_cursor(CursorIcon::ResizeHorizontal);
    let strong = response.hovered() || response.dragged() || response.has_focus();
    let color = if strong { palette.accent_text } else { palette.text };
    ui.painter().vline(right.seen.left(), view.y_range(), Stroke::new(theme::RAY_HALO, theme::plate(palette)));
    ui.painter().vline(right.seen.left(), view.y_range(), Stroke::new(1.0, color));
    if response.clicked() || response.drag_started() {
        response.request_focus();
    }
    if let Some(pointer) = response.interact_pointer_pos().filter(|_| response.dragged()) {
        commands.push(Command::Divider(which, (pointer.x - view.left()) / view.width().max(1.0)));
    }
    if response.has_focus() {
        let lock = EventFilter { horizontal_arrows: true, ..Default::default() };
        ui.memory_mut(|m| m.set_focus_lock_filter(response.id, lock));
        let steps = ui.input(|i| i32::from(i.key_pressed(Key::ArrowRight)) - i32::from(i.key_pressed(Key::ArrowLeft)));
        if steps != 0 {
            commands.push(Command::Divider(which, at + steps as f32 * KEY_STEP));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::viewer::gpu::size_px;
    use crate::viewer::panes::PaneChoice;

    fn panes(arrange: Arrange, others: usize) -> PaneSettings {
        PaneSettings { arrange, others: vec![PaneChoice::default(); others], dividers: Vec::new() }
    }

    #[test]
    fn views_of_panes_are_as_large_as_each_other_at_any_scale() {
        for (width, height, scale) in [(601.3, 417.7, 1.0), (768.0, 300.0, 1.25), (500.0, 333.3, 1.5), (911.1, 777.7, 2.0)] {
            let rect = Rect::from_min_size(pos2(232.4, 91.7), vec2(width, height));
            for (arrange, n) in [(Arrange::Two, 2), (Arrange::Four, 4)] {
                let places = places(rect, Some(&panes(arrange, 1)), scale);
                assert_eq!(places.len(), n);
                let sizes: Vec<_> = places.iter().map(|place| size_px(place.view, scale)).collect();
                assert!(
                    sizes.iter().all(|size| *size == sizes[0] && size[0] > 100 && size[1] > 20),
                    "{arrange:?} {scale}: {sizes:?}"
                );
                for (i, place) in places.iter().enumerate() {
                    assert!(rect.expand(1.0).contains_rect(place.view), "{place:?}");
                    assert!(places[..i].iter().all(|other| !other.view.intersect(place.view).is_positive()));
                }
            }
        }
    }

    #[test]
    fn strips_cover_one_view() {
        let rect = Rect::from_min_size(pos2(10.0, 20.0), vec2(600.0, 400.0));
        let mut three = panes(Arrange::Divider, 2);
        three.dividers = vec![0.25, 0.5];
        let places = places(rect, Some(&three), 1.0);
        assert_eq!(places.len(), 3);
        assert!(places.iter().all(|place| place.view == places[0].view && place.view.width() == 600.0));
        let ends: Vec<_> = places.iter().map(|place| (place.seen.left(), place.seen.right())).collect();
        assert_eq!(ends, [(10.0, 160.0), (160.0, 310.0), (310.0, 610.0)]);
        assert_eq!(places[2].head.right(), 610.0);
        assert_eq!(super::places(rect, None, 1.0)[0].view, rect, "one picture has all of it");
    }
}
