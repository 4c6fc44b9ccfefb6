//! Bounding volumes of the selected node side by side: compared in the background, and drawn around it.

use super::State;
use crate::accel::{Cell, CellId};
use crate::job::Outcome;
use crate::lab::{FitError, Fitting, can_fit};
use crate::render::Mode;
use crate::scene::Camera;
use crate::viewer::gpu::BoxInstance;
use crate::viewer::pick::Picked;
use crate::viewer::workers::{self, FittingVolumes};
use crate::viewer::{theme, wires};

/// What is known of the volumes around a node.
#[derive(Default)]
pub struct Fits {
    /// The comparison, while it runs.
    pub running: Option<FittingVolumes>,
    /// The cell and the view that it is of.
    asked: Option<(CellId, Camera)>,
    /// The last one.
    made: Option<(CellId, Camera, Fitting)>,
    /// The kind that is drawn around the node.
    pub drawn: Option<&'static str>,
    /// Why there is none of the cell that was asked for, in words for the user.
    note: Option<&'static str>,
}

impl State {
    /// The selected cell, if volumes around it can be compared.
    pub fn fittable(&self) -> Option<&Cell> {
        let (picked, shown) = (self.picked.as_ref()?, self.shown.as_ref()?);
        picked.selected().filter(|cell| can_fit(shown.accel.as_ref(), cell))
    }

    /// The volumes around the selected node, if they were compared; and whether that was on another view.
    pub fn fitting(&self) -> Option<(&Fitting, bool)> {
        let selected = self.picked.as_ref().and_then(Picked::selected)?;
        let (_, camera, fitting) = self.fits.made.as_ref().filter(|made| made.0 == selected.id)?;
        Some((fitting, *camera != self.camera))
    }

    /// Why there are none around the selected node, if they were asked for.
    pub fn no_fitting(&self) -> Option<&'static str> {
        let selected = self.picked.as_ref().and_then(Picked::selected)?;
        self.fits.note.filter(|_| self.fits.asked.is_some_and(|asked| asked.0 == selected.id))
    }

    /// Starts comparing volumes around the selected node.
    pub(super) fn fit_volumes(&mut self) {
        let Some(cell) = self.fittable().copied() else { return };
        let Some((view, pause)) = self.begin_on_view(Mode::Shaded) else { return };
        (self.fits.asked, self.fits.note) = (Some((cell.id, self.camera)), None);
        match workers::fit_volumes(&self.shared, view, self.size_px, cell, pause) {
            Ok(job) => self.fits.running = Some(job),
            Err(e) => self.fail(format!("Can't compare volumes: {e}.")),
        }
    }

    /// Takes in a comparison that is through.
    pub(super) fn advance_fitting(&mut self) {
        let Some(job) = &self.fits.running else { return };
        match job.poll() {
            Outcome::Running => return,
            Outcome::Done(Ok(Some(fitting))) => {
                self.fits.made = self.fits.asked.take().map(|(id, camera)| (id, camera, fitting));
                self.light();
            }
            Outcome::Done(Ok(None)) => self.fits.note = Some("It has no triangles to bound."),
            Outcome::Done(Err(FitError::Cancelled(_))) => {}
            Outcome::Done(Err(why)) => {
                self.fail(format!("Can't compare volumes: {}", super::finished::sentence(&why.to_string())));
            }
            Outcome::Died => self.fail("Can't compare volumes: fitting them failed. Please report this.".to_owned()),
        }
        self.fits.running = None;
    }

    /// Draws a kind of volume around the node, or none.
    pub(super) fn draw_volume(&mut self, id: Option<&'static str>) {
        self.fits.drawn = id;
        self.light();
    }

    /// The lines of the volume that is drawn around the selected node.
    pub(super) fn compared_volume(&self) -> Vec<BoxInstance> {
        let lines = || {
            let (fitting, _) = self.fitting()?;
            let row = fitting.rows.iter().find(|row| Some(row.id) == self.fits.drawn)?;
            let (shown, view, color) = (self.shown.as_ref()?, self.view()?, theme::COMPARED.to_array());
            let instance = self.picked.as_ref().and_then(Picked::selected)?.id.instance;
            // Lines alone, so that a box is drawn as the others are.
            Some(wires::lines_of(shown.accel.as_ref(), instance, &row.form, (&view, wires::ROUND), color))
        };
        lines().unwrap_or_default()
    }
}
