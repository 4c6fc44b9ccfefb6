//! Choices that are taken back, and made again.

use super::State;
use crate::viewer::history::Choices;

impl State {
    /// Choices as they are, for a step that can be taken back.
    pub(super) fn present_choices(&self) -> Choices {
        let mut choices = Choices::of(&self.settings, self.picked.as_ref());
        choices.hidden = self.hidden_later();
        choices
    }

    /// Whether the last choice can be taken back: not while triangles of a workspace file are still to be hidden, since what was
    /// hidden before is not known yet.
    pub const fn can_undo(&self) -> bool {
        self.choices.has_back() && self.rehiding.is_none()
    }

    /// Whether what was taken back can be chosen again.
    pub const fn can_redo(&self) -> bool {
        self.choices.has_forward() && self.rehiding.is_none()
    }

    /// Takes the last choice back.
    pub(super) fn undo(&mut self) {
        if self.can_undo() {
            let before = self.choices.back(self.present_choices());
            self.restore(before);
        }
    }

    /// Chooses again what was taken back.
    pub(super) fn redo(&mut self) {
        if self.can_redo() {
            let after = self.choices.forward(self.present_choices());
            self.restore(after);
        }
    }

    /// Brings choices back that were left.
    pub(super) fn restore(&mut self, choices: Option<Choices>) {
        let Some(choices) = choices else { return };
        (self.picking, self.hiding) = (None, None);
        self.select_no_more();
        self.change_panes(|state| choices.restore(&mut state.settings));
        self.chosen_depths = (self.settings.overlay.from_depth, self.settings.overlay.depth);
        self.choose();
        // A selection belongs to the structure that it was made in.
        if self.shown.as_ref().is_some_and(|b| b.key == self.wanted_key()) {
            self.select(choices.picked);
            self.clamp_depth();
        }
    }
}
