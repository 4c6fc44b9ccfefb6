//! Views that are kept: from where, through which structure, and what was selected.

use std::time::Instant;

use super::State;
use crate::scene::Camera;
use crate::viewer::history::{Choices, Kind};
use crate::viewer::pick::Picked;

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
        // A selection is of the structure that is shown, while another one may be on its way.
        let selected = self.picked.as_ref().filter(|_| self.building.is_none());
        let ids = selected.map(Picked::ids).unwrap_or_default();
        let selected = ids.iter().map(|id| (id.instance, id.node)).collect();
        self.bookmarks.push(Bookmark { name, camera: self.camera, choices: Choices::of(&self.settings, None), selected });
    }

    /// Goes back to one; that can be taken back like any move and choice.
    pub(super) fn go_to_bookmark(&mut self, at: usize) {
        let Some(Bookmark { camera, choices, selected, .. }) = self.bookmarks.get(at).cloned() else { return };
        self.choices.leave(Choices::of(&self.settings, self.picked.as_ref()), Kind::Single, Instant::now());
        self.look(camera, Kind::Single);
        self.restore(Some(choices.beside(&self.settings)));
        self.await_cell(&selected, None);
    }
}
