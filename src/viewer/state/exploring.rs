//! The Structure workspace: the list of cells, made in the background, and what is selected in it.

use std::sync::Arc;
use std::time::Instant;

use super::State;
use crate::accel::cell::bounds_in_scene;
use crate::accel::outline::OutlineError;
use crate::geometry::{Aabb, Axis};
use crate::job::Outcome;
use crate::viewer::gpu::{BoxInstance, Overlay};
use crate::viewer::history::Kind;
use crate::viewer::overlay::{placed, plane_in};
use crate::viewer::pick::Picked;
use crate::viewer::settings::Workspace;
use crate::viewer::{theme, workers};

impl State {
    /// Lists the cells of the shown structure where somebody looks at them.
    pub(super) fn advance_outline(&mut self) {
        self.advance_selecting();
        if let Some(job) = self.tree.outlining.take() {
            match job.poll() {
                Outcome::Running => {
                    self.tree.outlining = Some(job);
                    return;
                }
                Outcome::Done(Ok(outline)) => {
                    self.tree.listed(outline);
                    self.follow_selection();
                }
                Outcome::Done(Err(OutlineError::Cancelled(_))) => self.tree.of = None,
                Outcome::Done(Err(OutlineError::Memory(_))) if self.make_room(None) => self.tree.of = None, // it is listed again
                Outcome::Done(Err(e)) => self.tree.failed = Some(super::finished::sentence(&format!("No tree: {e}"))),
                Outcome::Died => self.tree.failed = Some("No tree: listing the cells failed. Please report this.".to_owned()),
            }
        }
        let Some(shown) = &self.shown else { return };
        if !self.needs_outline()
            || self.tree.of.as_ref() == Some(&shown.key)
            || self.seen.as_ref() != Some(&shown.key)
            || self.is_measuring()
        {
            return;
        }
        self.tree.of = Some(shown.key.clone());
        self.tree.outlining = workers::outline(&self.shared, shown, self.panes.outline_of(&shown.key)).ok();
    }

    /// Whether somebody looks at the list of cells, boxes are drawn by what it says, or a film is made of it.
    fn needs_outline(&self) -> bool {
        let overlay = &self.settings.overlay;
        let boxes = overlay.boxes && (overlay.subtree_only || overlay.color.needs_rows());
        self.settings.workspace == Workspace::Structure || boxes || self.again.needs_outline()
    }

    /// Whether something of the tree or the selected cell is on its way.
    pub(super) fn is_exploring(&self) -> bool {
        let awaited = self.needs_outline() && self.shown.as_ref().is_some_and(|shown| self.tree.of.as_ref() != Some(&shown.key));
        awaited || self.tree.outlining.is_some() || self.tree.selecting.is_some() || self.curving.is_some()
    }

    /// Selects a cell by its row; all that is walked over by keys is one step to take back.
    pub(super) fn select_row(&mut self, row: u32, walking: bool) {
        let (Some(outline), Some(shown)) = (&self.tree.outline, &self.shown) else { return };
        if row >= outline.len() {
            return;
        }
        let job = workers::select(&self.shared, Arc::clone(&shown.accel), Arc::clone(outline), row);
        // A selection of a bookmark that was on its way is overtaken.
        self.select_no_more();
        self.tree.selecting = job.ok();
        self.tree.walking = walking;
        self.picking = None;
        self.tree.select(Some(row));
    }

    /// Takes in the cell of a row.
    fn advance_selecting(&mut self) {
        let Some(job) = &self.tree.selecting else { return };
        match job.poll() {
            Outcome::Running => return,
            Outcome::Done(Ok(picked)) => {
                self.tree.selecting = None;
                // What belongs to a bookmark or a file is no step of its own.
                let restored = self.awaited.take_if(|_| self.tree.restoring);
                if restored.is_none() && self.picked.as_ref() != Some(&picked) {
                    let kind = if self.tree.walking { Kind::Walk } else { Kind::Single };
                    self.choices.leave(self.present_choices(), kind, Instant::now());
                }
                self.select(Some(picked));
                if let Some(tried) = restored.and_then(|restored| restored.tried) {
                    self.try_plane(Some(tried));
                }
            }
            Outcome::Done(Err(_)) | Outcome::Died => self.follow_selection(),
        }
        self.select_no_more();
    }

    /// Gives up the cell that is on its way, if any.
    pub(super) fn select_no_more(&mut self) {
        self.tree.selecting = None;
        if std::mem::take(&mut self.tree.restoring) {
            self.awaited = None;
        }
    }

    /// The row of what was selected otherwise.
    pub(super) fn follow_selection(&mut self) {
        let Some(outline) = &self.tree.outline else { return };
        let path = self.picked.as_ref().map(Picked::ids).unwrap_or_default();
        let row = outline.find(&path);
        self.tree.select(row);
    }

    /// Opens or closes a row, or all.
    pub(super) fn open_row(&mut self, row: u32, open: bool) {
        let Some(outline) = &self.tree.outline else { return };
        if open { self.tree.folding.open(row, outline) } else { self.tree.folding.close(row, outline) }
    }

    /// Opens everything below a row.
    pub(super) fn open_below(&mut self, row: u32) {
        let Some(outline) = &self.tree.outline else { return };
        self.tree.folding.open_all(row, outline);
    }

    /// Tries a plane in the selected node, drawn over the view.
    pub(super) fn try_plane(&mut self, plane: Option<(Axis, f64)>) {
        self.tree.tried = plane.map(|(axis, place)| (axis, place.clamp(0.0, 1.0)));
        self.light();
    }

    /// Draws what stands out among the boxes anew, and leaves the others as they are.
    pub(super) fn light(&mut self) {
        let Some(now) = &self.overlay else { return };
        let lit = self.lit(Overlay::default());
        if !lit.is_lit_as(now) {
            let Overlay { tried, compared, selected, selected_lines, .. } = lit;
            self.generation += 1;
            let generation = self.generation;
            let rest = (**now).clone();
            self.overlay = Some(Arc::new(Overlay { generation, tried, compared, selected, selected_lines, ..rest }));
        }
    }

    /// The same boxes with what stands out among them now.
    pub(super) fn lit(&self, overlay: Overlay) -> Overlay {
        let cell = self.lit_cell().unwrap_or_default();
        Overlay {
            tried: self.tried_plane(),
            compared: self.compared_volume(),
            selected: cell.boxed,
            selected_lines: cell.lines,
            ..overlay
        }
    }

    /// The plane that is tried in the selected cell.
    pub(super) fn tried_plane(&self) -> Option<BoxInstance> {
        let (axis, place) = self.tree.tried?;
        let cell = self.picked.as_ref()?.selected()?;
        let bounds = cell.shape.bounds();
        let pos = bounds.min[axis.index()] + place as f32 * bounds.size()[axis.index()];
        let plane = plane_in(bounds, axis, pos);
        Some(placed(self.shown.as_ref()?.accel.as_ref(), cell.id.instance, &plane, theme::TRIED.to_array()))
    }

    /// Brings the selected cell into view.
    pub(super) fn frame_selected(&mut self) {
        let (Some(model), Some(shown)) = (&self.model, &self.shown) else { return };
        let Some(cell) = self.picked.as_ref().and_then(Picked::selected) else { return };
        let (space, cell) = (model.geometry.space(), bounds_in_scene(shown.accel.as_ref(), cell));
        let bounds = Aabb { min: space.world_point(cell.min), max: space.world_point(cell.max) };
        let framed = self.camera.reframed(&bounds, self.aspect());
        self.look(framed, Kind::Single);
    }
}
