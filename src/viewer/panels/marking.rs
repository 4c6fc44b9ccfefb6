//! A rectangle dragged in the view, and the pixels that are marked there.

use eframe::egui::{CursorIcon, Pos2, Rect, Response, Stroke, StrokeKind, Ui, pos2, vec2};

use super::Commands;
use crate::lab::PixelRect;
use crate::viewer::brute::{Brute, middle};
use crate::viewer::command::Command;
use crate::viewer::theme::{self, Marker, Palette};
use glam::Vec2;

/// Under which name a drag is remembered.
const MARKED: &str = "marked rectangle";

/// Takes a drag for a rectangle to be compared, and draws it on its way.
pub fn hands(ui: &Ui, response: &Response, rect: Rect, size_px: [u32; 2], commands: &mut Commands) {
    let id = response.id.with(MARKED);
    if response.hovered() {
        ui.ctx().set_cursor_icon(CursorIcon::Crosshair);
    }
    let start = ui.input(|i| i.pointer.press_origin());
    if let Some((from, to)) = start.zip(response.interact_pointer_pos()).filter(|_| response.dragged()) {
        ui.data_mut(|d| d.insert_temp(id, (from, to)));
    }
    let Some((from, to)) = ui.data(|d| d.get_temp::<(Pos2, Pos2)>(id)) else { return };
    let marked = Rect::from_two_pos(from, to).intersect(rect);
    outline(ui, marked);
    if !response.dragged() {
        ui.data_mut(|d| d.remove_temp::<(Pos2, Pos2)>(id));
        commands.extend(pixels(marked, rect, size_px).map(|pixels| Command::CheckByBrute(Some(pixels))));
    }
}

/// Forgets a drag that was broken off.
pub fn forget(ui: &Ui, response: &Response) {
    ui.data_mut(|d| d.remove_temp::<(Pos2, Pos2)>(response.id.with(MARKED)));
}

fn outline(ui: &Ui, marked: Rect) {
    let palette = Palette::in_ui(ui);
    let painter = ui.painter();
    painter.rect_stroke(marked, 0.0, Stroke::new(theme::RAY_HALO, theme::plate(palette)), StrokeKind::Middle);
    painter.rect_stroke(marked, 0.0, Stroke::new(theme::CURVE, palette.accent_text), StrokeKind::Middle);
}

/// The rectangle that was compared, and the pixels of it that differ.
pub fn show(ui: &Ui, rect: Rect, brute: &Brute) {
    let Some((_, part)) = &brute.of else { return };
    let place = |pixel: Vec2| {
        let place = part.place(pixel, rect.aspect_ratio());
        rect.min + vec2(place.x, place.y) * rect.size()
    };
    let [from, size] = [part.rect.at, part.rect.size].map(|n| Vec2::from(n.map(|n| n as f32)));
    if part.rect != PixelRect::whole(part.size_px) {
        outline(ui, Rect::from_min_max(place(from), place(from + size)));
    }
    let (palette, painter) = (Palette::in_ui(ui), ui.painter_at(rect));
    for pixel in brute.unlike() {
        let (at, color) = (place(middle(pixel)), if pixel.rounded { palette.warn } else { palette.fail });
        Marker::Cross.paint(&painter, at, theme::MARK + theme::RAY_HALO, theme::plate(palette));
        Marker::Cross.paint(&painter, at, theme::MARK, color);
    }
}

/// The pixel that differs whose mark is there, by its number.
pub fn near(at: Pos2, rect: Rect, brute: &Brute) -> Option<usize> {
    let place = (at - rect.min) / rect.size();
    brute.near(Vec2::new(place.x, place.y), rect.aspect_ratio(), theme::MARK / rect.height())
}

/// The pixels that a rectangle of the window touches; `None` where it is hardly more than a click.
fn pixels(marked: Rect, view: Rect, size_px: [u32; 2]) -> Option<PixelRect> {
    if !marked.is_positive() || marked.size().length() < theme::CLICK_SLACK {
        return None;
    }
    let [width, height] = size_px.map(|n| n as f32);
    let place = |p: Pos2| pos2((p.x - view.min.x) / view.width() * width, (p.y - view.min.y) / view.height() * height);
    let (from, to) = (place(marked.min), place(marked.max));
    let first = |x: f32, n: u32| (x.floor().max(0.0) as u32).min(n.saturating_sub(1));
    let at = [first(from.x, size_px[0]), first(from.y, size_px[1])];
    let end = |x: f32, n: u32| (x.ceil().max(0.0) as u32).min(n);
    let size = [end(to.x, size_px[0]).saturating_sub(at[0]).max(1), end(to.y, size_px[1]).saturating_sub(at[1]).max(1)];
    Some(PixelRect { at, size })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_rectangle_takes_the_pixels_that_it_touches() {
        let view = Rect::from_min_max(pos2(100.0, 50.0), pos2(300.0, 150.0));
        let marked = |from: Pos2, to: Pos2| pixels(Rect::from_min_max(from, to), view, [400, 200]);
        assert_eq!(marked(pos2(110.0, 60.0), pos2(120.25, 70.0)), Some(PixelRect { at: [20, 20], size: [21, 20] }));
        assert_eq!(marked(view.min, view.max), Some(PixelRect::whole([400, 200])));
        assert_eq!(marked(pos2(110.0, 60.0), pos2(111.0, 61.0)), None);
        assert_eq!(marked(pos2(299.9, 60.0), pos2(300.0, 90.0)), Some(PixelRect { at: [399, 20], size: [1, 60] }));
    }
}
