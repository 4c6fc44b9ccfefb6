//! A list of any length of which only the visible rows are laid out. Its place is kept in rows: ten million rows of 24
//! points are more than the points of a scrolled area can be told apart.

use eframe::egui::{Id, Rect, Sense, Ui, UiBuilder, pos2, vec2};

use crate::viewer::theme::{self, Palette};

/// Where a list is scrolled to, and which row it last brought into sight.
#[derive(Clone, Copy, Default)]
struct Place {
    first: f64,
    seen: u64,
}

/// A list of so many rows.
pub struct LongList {
    /// Tells it apart from others.
    pub id: Id,
    /// How many rows it has.
    pub rows: u32,
    /// The height of one, in points.
    pub height: f32,
    /// A row to bring into sight, once for each number that comes with it.
    pub reveal: Option<(u32, u64)>,
}

impl LongList {
    /// Draws the rows that are to be seen, each into a part of its own, and the bar beside them; returns how many fit.
    pub fn show(self, ui: &mut Ui, mut row: impl FnMut(&mut Ui, u32)) -> u32 {
        let (area, _) = ui.allocate_exact_size(ui.available_size(), Sense::hover());
        let fit = f64::from(area.height() / self.height);
        let most = (f64::from(self.rows) - fit).max(0.0);
        let mut place: Place = ui.data(|d| d.get_temp(self.id)).unwrap_or_default();
        if ui.rect_contains_pointer(area) {
            place.first -= f64::from(ui.input(|i| i.smooth_scroll_delta().y) / self.height);
        }
        if let Some((at, number)) = self.reveal.filter(|(_, number)| *number != place.seen) {
            place.seen = number;
            let (top, at) = (place.first, f64::from(at));
            if at < top || at + 1.0 > top + fit {
                // Some of what is around it, too.
                place.first = at - (fit / 3.0).floor();
            }
        }
        let bar = Rect::from_min_max(pos2(area.right() - theme::GUTTER, area.top()), area.right_bottom());
        place.first = scroll_bar(ui, (self.id, bar), place.first, (f64::from(self.rows), fit)).clamp(0.0, most);
        ui.data_mut(|d| d.insert_temp(self.id, place));
        let list = Rect::from_min_max(area.left_top(), pos2(bar.left() - theme::GRID, area.bottom()));
        let first = place.first.floor();
        let shown = (f64::from(self.rows) - first).min(fit.ceil() + 1.0).max(0.0) as u32;
        let above = ((place.first - first) as f32) * self.height;
        for i in 0..shown {
            let top = list.top() - above + i as f32 * self.height;
            let rect = Rect::from_min_size(pos2(list.left(), top), vec2(list.width(), self.height));
            let mut part = ui.new_child(UiBuilder::new().scope_id(self.id.with(i)).max_rect(rect));
            part.set_clip_rect(list.intersect(ui.clip_rect()));
            row(&mut part, first as u32 + i);
        }
        fit as u32
    }
}

/// The bar at the right; returns the first row that it is dragged to.
fn scroll_bar(ui: &Ui, (id, bar): (Id, Rect), first: f64, (rows, fit): (f64, f64)) -> f64 {
    if rows <= fit {
        return first;
    }
    let response = ui.interact(bar, id.with("bar"), Sense::CLICK | Sense::DRAG);
    let length = (f64::from(bar.height()) * fit / rows).max(theme::ROW.into()) as f32;
    let way = f64::from(bar.height() - length);
    let most = rows - fit;
    let first = match response.interact_pointer_pos() {
        Some(at) if response.is_pointer_button_down_on() && way > 0.0 => f64::from(at.y - bar.top() - length * 0.5) / way * most,
        _ => first,
    }
    .clamp(0.0, most);
    let top = bar.top() + (first / most * way) as f32;
    let handle = Rect::from_min_size(pos2(bar.left(), top), vec2(bar.width(), length));
    let palette = Palette::in_ui(ui);
    let color = if response.hovered() || response.dragged() { palette.dim } else { palette.line };
    ui.painter().rect_filled(handle, theme::GRID, color);
    first
}
