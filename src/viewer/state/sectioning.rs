//! The section plane: what of the model the camera sees.

use super::State;
use crate::geometry::{HalfSpace, Ray};
use crate::scene::Section;
use crate::viewer::gpu::View;
use crate::viewer::settings::SectionSettings;
use glam::Vec2;

impl State {
    /// Cuts the model elsewhere, or not at all.
    pub(super) fn cut(&mut self, section: SectionSettings) {
        let place = if section.at.place.is_finite() { section.at.place.clamp(0.0, 1.0) } else { 0.5 };
        let at = Section { place, ..section.at };
        self.settings.section = SectionSettings { at, ..section };
    }

    /// What of the world is left, if a part is cut away.
    pub fn section(&self) -> Option<HalfSpace> {
        let model = self.model.as_ref().filter(|_| self.settings.section.on)?;
        Some(self.settings.section.at.of(model.geometry.world_bounds()))
    }

    /// The present view in the scaled space, with what is left of that; `None` without a model.
    pub(super) fn view(&self) -> Option<View> {
        let space = self.model.as_ref()?.geometry.space();
        let view = View::new(&self.camera, space, self.aspect());
        Some(view.within(self.section().map(|section| section.scaled(space))))
    }

    /// The camera's ray through a point of the view, from (-1, -1) in the lower left corner to (1, 1) in the upper right, as
    /// far as it is not cut away.
    pub(super) fn ray_at(&self, at: Vec2) -> Ray {
        let ray = self.camera.ray(&self.camera.frame(), at, self.aspect());
        self.section().map_or(ray, |section| section.cut(&ray))
    }
}
