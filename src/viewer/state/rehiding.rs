//! Hidden triangles of a workspace file, those of the window and of views that were kept: put into the file, and hidden again in
//! the background once its model is open.

use std::sync::Arc;

use super::State;
use super::finished::sentence;
use crate::accel::Visibility;
use crate::accel::visibility::{VisibilityError, Written};
use crate::job::{Job, Outcome};
use crate::scene::Geometry;
use crate::task::{Cancel, Cancelled};
use crate::viewer::workspace_file::WorkspaceFile;

/// Sets of a file that are still to be hidden.
pub(super) struct Rehiding {
    sets: Arc<Vec<Written>>,
    /// Which of them is that of the window.
    now: Option<usize>,
    /// All of them, on their way.
    job: Option<Job<Result<Vec<Arc<Visibility>>, VisibilityError>>>,
}

/// Sets that are to be written down.
pub(super) struct Sets {
    /// Those of a file that are still to be hidden: they come first.
    before: Arc<Vec<Written>>,
    /// The others.
    new: Vec<Arc<Visibility>>,
    geometry: Arc<Geometry>,
}

impl Sets {
    /// Writes them down, in the order of their numbers.
    ///
    /// # Errors
    /// [`Cancelled`] if asked to stop.
    pub(super) fn written(&self, cancel: &Cancel) -> Result<Vec<Written>, Cancelled> {
        let new = self.new.iter().map(|set| set.written(&self.geometry, cancel));
        self.before.iter().cloned().map(Ok).chain(new).collect()
    }
}

impl State {
    /// Whether triangles are being sorted out: those of a cell, or those of a workspace file.
    pub const fn is_hiding(&self) -> bool {
        self.hiding.is_some() || self.rehiding.is_some()
    }

    /// Tells a file which set is hidden in the window and in each of its views, and returns the sets.
    pub(super) fn number_hidden(&self, file: &mut WorkspaceFile) -> Option<Sets> {
        let geometry = Arc::clone(&self.model.as_ref()?.geometry);
        let before = self.rehiding.as_ref().map_or_else(Arc::default, |rehiding| Arc::clone(&rehiding.sets));
        let mut new: Vec<Arc<Visibility>> = Vec::new();
        let mut number = |set: &Arc<Visibility>| {
            let at = new.iter().position(|known| known == set).unwrap_or(new.len());
            if at == new.len() {
                new.push(Arc::clone(set));
            }
            before.len() + at
        };
        file.made.hidden_now = self.hidden_later().or_else(|| self.visible().map(&mut number));
        for bookmark in file.bookmarks.iter_mut().filter(|bookmark| bookmark.hidden.is_none()) {
            bookmark.hidden = bookmark.visible().filter(|set| set.is_of(&geometry)).map(&mut number);
        }
        Some(Sets { before, new, geometry })
    }

    /// Hides what a file says, once its model is open.
    pub(super) fn rehide(&mut self, sets: Vec<Written>, now: Option<usize>) {
        if sets.is_empty() {
            return self.hide_no_more();
        }
        self.rehiding = Some(Rehiding { sets: Arc::new(sets), now, job: None });
    }

    /// The number of the set that is still to be hidden in the window.
    pub(super) fn hidden_later(&self) -> Option<usize> {
        self.rehiding.as_ref().and_then(|rehiding| rehiding.now)
    }

    /// Lets it be another one, or none.
    pub(super) const fn hide_later(&mut self, set: Option<usize>) {
        if let Some(rehiding) = &mut self.rehiding {
            rehiding.now = set;
        }
    }

    /// Gives up what is still to be hidden.
    pub(super) fn hide_no_more(&mut self) {
        (self.hiding, self.rehiding) = (None, None);
        self.bookmarks.iter_mut().for_each(|bookmark| bookmark.hidden = None);
    }

    pub(super) fn advance_rehiding(&mut self) {
        let (Some(model), Some(rehiding)) = (&self.model, &mut self.rehiding) else { return };
        let Some(job) = &rehiding.job else {
            let (sets, geometry) = (Arc::clone(&rehiding.sets), Arc::clone(&model.geometry));
            let budget = self.shared.budget.clone();
            let job = Job::spawn("hide", self.shared.waker(), move |cancel, _| {
                sets.iter().map(|set| Visibility::read(set, &geometry, &budget, cancel).map(Arc::new)).collect()
            });
            match job {
                Ok(job) => rehiding.job = Some(job),
                Err(e) => self.not_hidden_again(&e),
            }
            return;
        };
        match job.poll() {
            Outcome::Running => return,
            Outcome::Done(Ok(sets)) => {
                self.settings.visible = rehiding.now.and_then(|now| sets.get(now)).cloned().or(self.settings.visible.take());
                self.bookmarks.iter_mut().for_each(|bookmark| bookmark.take_hidden(&sets));
            }
            Outcome::Done(Err(VisibilityError::Cancelled(_))) => {}
            Outcome::Done(Err(why)) => self.not_hidden_again(&why),
            Outcome::Died => self.not_hidden_again(&"sorting them out failed. Please report this model"),
        }
        self.hide_no_more();
    }

    fn not_hidden_again(&mut self, why: &dyn std::fmt::Display) {
        self.hide_no_more();
        let why = sentence(&why.to_string());
        self.also_fail(&format!("Can't hide the triangles that were hidden: {why} The rest of the workspace is open."));
    }
}
