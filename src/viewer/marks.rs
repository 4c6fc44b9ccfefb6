//! The colour and the shape that stand for a family of structures.

use eframe::egui::{Color32, Sense, Ui, vec2};

use super::theme::{self, Mark, Palette};
use crate::accel::registry::Family;

/// The mark of a family in the look that `ui` has.
pub fn of(ui: &Ui, family: Family) -> Mark {
    let palette = Palette::in_ui(ui);
    match family {
        Family::Bvh => palette.bvh,
        Family::KdTree => palette.kd,
        Family::Grid => palette.grid,
        Family::Octree => palette.octree,
        Family::Bsp => palette.bsp,
        Family::Brute => palette.brute,
    }
}

/// Its colour.
pub fn color(ui: &Ui, family: Family) -> Color32 {
    of(ui, family).color
}

/// Draws the mark in a row of text.
pub fn dot(ui: &mut Ui, family: Family) {
    let mark = of(ui, family);
    let (rect, _) = ui.allocate_exact_size(vec2(theme::MARK, theme::ROW - theme::GRID), Sense::hover());
    mark.marker.paint(ui.painter(), rect.center(), theme::MARK, mark.color);
}
