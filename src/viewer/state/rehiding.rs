//! Hidden triangles of a workspace file, those of the window and of views that were kept: put into the file, and hidden again in
//! the background once its model is open.

use std::sync::Arc;

use super::State;
use super::finished::sentence;
use crate::accel::Visibility;
use crate::accel::visibility::{VisibilityError, Written};
use crate::job::{Job, Outcome};
use crate::scene::Geometry;
use crate::task::{Budget, Cancel, Cancelled};
use crate::viewer::workspace_file::WorkspaceFile;

/// Sets of a file that are still to be hidden.
pub(super) struct Rehiding {
    sets: Arc<Vec<Written>>,
    /// Which of them is that of the window.
    now: Option<usize>,
    /// All of them, on their way.
    job: Option<Job<Vec<Read>>>,
}

/// One of them as it was read: what one lacks is nothing to the others.
type Read = Result<Arc<Visibility>, VisibilityError>;

/// Reads sets, one of them first: where memory runs out, it has its share.
fn read_all(sets: &[Written], first: Option<usize>, geometry: &Arc<Geometry>, budget: &Budget, cancel: &Cancel) -> Vec<Read> {
    let read = |set: &Written| Visibility::read(set, geometry, budget, cancel).map(Arc::new);
    let first = first.and_then(|at| Some((at, read(sets.get(at)?))));
    let of = |(i, set)| first.as_ref().filter(|(at, _)| *at == i).map_or_else(|| read(set), |(_, set)| set.clone());
    sets.iter().enumerate().map(of).collect()
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
        self.choices.all_mut().for_each(|choices| choices.hidden = None);
    }

    pub(super) fn advance_rehiding(&mut self) {
        let (Some(model), Some(rehiding)) = (&self.model, &mut self.rehiding) else { return };
        let Some(job) = &rehiding.job else {
            let (sets, geometry) = (Arc::clone(&rehiding.sets), Arc::clone(&model.geometry));
            let (budget, now) = (self.shared.budget.clone(), rehiding.now);
            let read = move |cancel: &Cancel| read_all(&sets, now, &geometry, &budget, cancel);
            match Job::spawn("hide", self.shared.waker(), move |cancel, _| read(cancel)) {
                Ok(job) => rehiding.job = Some(job),
                Err(e) => {
                    self.hide_no_more();
                    self.not_hidden_again("", &e);
                }
            }
            return;
        };
        match job.poll() {
            Outcome::Running => return,
            Outcome::Done(read) => self.hide_again(read),
            Outcome::Died => self.not_hidden_again("", &"sorting them out failed. Please report this model"),
        }
        self.hide_no_more();
    }

    /// Hides the sets that could be read where they belong: in the window, in views that were kept, and in choices that were left
    /// since the model is open; tells about the others.
    fn hide_again(&mut self, read: Vec<Read>) {
        let failed: Vec<VisibilityError> = read.iter().filter_map(|set| set.as_ref().err().copied()).collect();
        let (all, sets) = (read.len(), read.into_iter().map(Result::ok).collect::<Vec<_>>());
        let now = self.hidden_later().and_then(|now| sets.get(now).cloned().flatten());
        self.settings.visible = now.or(self.settings.visible.take());
        self.bookmarks.iter_mut().for_each(|bookmark| bookmark.take_hidden(&sets));
        self.choices.all_mut().for_each(|choices| choices.take_hidden(&sets));
        if let Some(why) = failed.first().filter(|why| !matches!(why, VisibilityError::Cancelled(_))) {
            let part = if failed.len() < all { format!(", {} of {all} sets", failed.len()) } else { String::new() };
            self.not_hidden_again(&part, why);
        }
    }

    /// Tells where triangles are not hidden again, and why.
    fn not_hidden_again(&mut self, part: &str, why: &dyn std::fmt::Display) {
        let why = sentence(&why.to_string());
        self.also_fail(&format!("Can't hide the triangles that were hidden{part}: {why} The rest of the workspace is open."));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{LoadCx, open};

    #[test]
    fn where_there_is_room_for_one_set_it_is_that_of_the_window() {
        let cx = LoadCx::unattended();
        let scene = open("builtin:teapot?triangles=1000", &cx).expect("built in");
        let geometry = Arc::new(Geometry::new(&scene, &cx).expect("small"));
        let of = geometry.triangle_count();
        let set = |hidden: usize| -> Written {
            serde_json::from_str(&format!(r#"{{"of": {of}, "runs": "0 {hidden} {}"}}"#, of - hidden)).expect("as it is written")
        };
        let (sets, cancel) = ([set(1), set(2), set(3)], Cancel::new());
        // A bit for each triangle, and a little.
        let budget = Budget::new(of as u64 / 8 + 40);
        let counts = |read: Vec<Read>| read.iter().map(|set| set.as_ref().ok().map(|set| set.count())).collect::<Vec<_>>();
        assert_eq!(counts(read_all(&sets, Some(1), &geometry, &budget, &cancel)), [None, Some(2), None]);
        assert_eq!(counts(read_all(&sets, None, &geometry, &budget, &cancel)), [Some(1), None, None]);
        assert_eq!(counts(read_all(&sets, Some(7), &geometry, &Budget::unlimited(), &cancel)), [Some(1), Some(2), Some(3)]);
    }
}
