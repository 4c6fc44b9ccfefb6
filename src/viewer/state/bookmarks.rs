//! Views that are kept: from where, through which structure, and what was selected.

use std::sync::Arc;
use std::time::Instant;

use super::State;
use crate::accel::Visibility;
use crate::scene::Camera;
use crate::viewer::history::{Choices, Kind};

/// A view that is kept.
#[derive(Clone, Debug, serde::Serialize, serde::Deserialize)]
pub struct Bookmark {
    /// What it is called.
    pub name: String,
    /// From where.
    pub camera: Camera,
    /// The structure, and what is drawn of it.
    choices: Choices,
    /// The cells from the root to the selected one: level and number of each.
    selected: Vec<(u32, u32)>,
    /// In a workspace file, and until what is hidden was read from there: the number of its set of hidden triangles.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(super) hidden: Option<usize>,
}

impl Bookmark {
    /// Which triangles are seen from there, if not all.
    pub(super) const fn visible(&self) -> Option<&Arc<Visibility>> {
        self.choices.visible.as_ref()
    }

    /// Takes in its set of hidden triangles, if that is among those of a file that were awaited.
    pub(super) fn take_hidden(&mut self, sets: &[Option<Arc<Visibility>>]) {
        self.choices.hidden = self.hidden.take();
        self.choices.take_hidden(sets);
    }
}

impl State {
    /// Keeps the present view.
    pub(super) fn add_bookmark(&mut self) {
        if self.model.is_none() {
            return;
        }
        // Names are never given twice, also where some were forgotten.
        let used = |n: usize| self.bookmarks.iter().any(|bookmark| bookmark.name.starts_with(&format!("view {n} ")));
        let number = (1..).find(|n| !used(*n)).unwrap_or(0);
        let name = format!("view {number} ({})", self.settings.entry().name);
        let selected = self.selected_of_chosen().iter().map(|id| (id.instance, id.node)).collect();
        let (camera, choices) = (self.camera, Choices::of(&self.settings, None));
        self.bookmarks.push(Bookmark { name, camera, choices, selected, hidden: self.hidden_later() });
    }

    /// Goes back to one; that can be taken back like any move and choice.
    pub(super) fn go_to_bookmark(&mut self, at: usize) {
        let Some(Bookmark { camera, choices, selected, hidden, .. }) = self.bookmarks.get(at).cloned() else { return };
        self.choices.leave(self.present_choices(), Kind::Single, Instant::now());
        self.look(camera, Kind::Single);
        self.restore(Some(choices.beside(&self.settings)));
        self.hide_later(hidden);
        self.await_cell(&selected, None);
    }
}
