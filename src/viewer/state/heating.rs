//! Heat maps: the range of their colours, and the pixel whose amount is told.

use super::State;
use crate::accel::registry::Family;
use crate::render::{HeatRays, Mode, Range};
use crate::scene::Camera;
use glam::Vec2;

/// The least that the ends of a range are apart.
pub const LEAST_SPAN: f32 = 0.1;

impl State {
    /// Shows something else of the hits; the range fits it.
    pub(super) fn show_mode(&mut self, mode: Mode) {
        self.settings.mode = mode;
        self.show_tiles(false);
    }

    /// Shows the work of other rays.
    pub(super) fn show_heat_of(&mut self, rays: HeatRays) {
        self.settings.heat_rays = rays;
        self.fit_anew();
    }

    /// Shows tiles' times, or the renderer's picture again.
    pub(super) fn show_tiles(&mut self, shown: bool) {
        (self.tiles.shown, self.range) = (shown, None);
        if !shown {
            self.tiles.running = None;
        }
    }

    /// Maps amounts with a range from 0 on, or with one that suits.
    pub(super) fn set_heat_range(&mut self, range: Option<Range>) {
        self.range = range.filter(|range| range.min.is_finite() && range.max.is_finite()).map(|range| {
            let min = range.min.max(0.0);
            // Amounts that differ by less have one colour in any case.
            Range { min, max: range.max.max(min + LEAST_SPAN).max(min.next_up()) }
        });
    }

    /// Where the picture was last clicked, and from where it was seen.
    pub const fn clicked(&self) -> Option<(Camera, Vec2)> {
        self.clicked
    }

    /// The amount where the picture was clicked, while it is of that view.
    pub fn clicked_amount(&self) -> Option<f32> {
        let (camera, at) = self.clicked?;
        let picture = self.on_screen().filter(|picture| picture.camera == camera)?;
        picture.amount_at(at)
    }

    /// Why the shown structure has no stack, if it has none.
    pub fn why_no_stack(&self) -> Option<&'static str> {
        let shown = self.shown.as_ref().filter(|shown| shown.accel.levels().is_none())?;
        match shown.key.entry.family {
            Family::Brute => Some("No stack depth: brute force keeps no stack, it tests every triangle."),
            Family::Grid => Some("No stack depth: a grid keeps no stack, the ray goes from cell to cell."),
            Family::Bvh | Family::KdTree | Family::Octree | Family::Bsp => None,
        }
    }

    /// Whether the shown structure has what a picture shows.
    pub fn offers(&self, mode: Mode) -> bool {
        mode != Mode::Stack || self.why_no_stack().is_none()
    }

    /// Takes note of where the picture was clicked.
    pub(super) fn note_click(&mut self, at: Vec2) {
        self.clicked = Some((self.camera, at));
    }
}
