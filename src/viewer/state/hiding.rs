//! Which triangles are seen: those of cells are isolated or hidden in the background.

use std::sync::Arc;
use std::time::Instant;

use super::State;
use crate::accel::Visibility;
use crate::accel::visibility::{Change, VisibilityError};
use crate::job::{Job, Outcome};
use crate::viewer::history::Kind;
use crate::viewer::pick::Picked;

/// Triangles that are sorted out.
pub type Hiding = Job<Result<Visibility, VisibilityError>>;

impl State {
    /// Which triangles are seen, if not all.
    pub fn visible(&self) -> Option<&Arc<Visibility>> {
        let model = self.model.as_ref()?;
        // One of an earlier model says nothing of this one.
        self.settings.visible.as_ref().filter(|visible| visible.is_of(&model.geometry))
    }

    /// Shows the triangles of the selected cell alone, or hides them.
    pub(super) fn hide_triangles(&mut self, change: Change) {
        let cell = self.picked.as_ref().and_then(Picked::selected).copied();
        // One after the other, or the second would not know what the first hides.
        let busy = self.is_measuring() || self.is_hiding();
        let (Some(cell), Some(shown), false) = (cell, &self.shown, busy) else { return };
        let (accel, before, budget) = (Arc::clone(&shown.accel), self.visible().cloned(), self.shared.budget.clone());
        let job = Job::spawn("hide", self.shared.waker(), move |cancel, _| {
            Visibility::change(before.as_deref(), accel.as_ref(), (&cell, change), &budget, cancel)
        });
        match job {
            Ok(job) => self.hiding = Some(job),
            Err(e) => self.fail(format!("Can't hide triangles: {e}.")),
        }
    }

    /// Shows all triangles again.
    pub(super) fn show_all(&mut self) {
        (self.settings.visible, self.hiding) = (None, None);
        self.hide_later(None);
    }

    pub(super) fn advance_hiding(&mut self) {
        let Some(job) = &self.hiding else { return };
        match job.poll() {
            Outcome::Running => return,
            Outcome::Done(Ok(visible)) => {
                self.choices.leave(self.present_choices(), Kind::Single, Instant::now());
                self.settings.visible = Some(Arc::new(visible));
            }
            Outcome::Done(Err(VisibilityError::Cancelled(_))) => {}
            Outcome::Done(Err(why)) => {
                self.fail(format!("Can't hide triangles: {}", super::finished::sentence(&why.to_string())));
            }
            Outcome::Died => self.fail("Can't hide triangles: sorting them out failed. Please report this model.".to_owned()),
        }
        self.hiding = None;
    }
}
