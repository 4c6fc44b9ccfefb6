//! The dialog that asks for a file, from its opening to its answer.

use std::sync::Arc;

use super::State;
use crate::viewer::dialogs::answered;

impl State {
    /// Opens the dialog, unless it is open: of two, the first would ask in vain.
    pub(super) fn ask_for_file(&mut self) {
        if self.asked_for_file.is_none() {
            self.asked_for_file = Some(self.dialog.pick(Arc::clone(&self.shared.wake)));
        }
    }

    /// Opens what was picked.
    pub(super) fn advance_dialog(&mut self) {
        if let Some(path) = answered(&mut self.asked_for_file) {
            self.open(path.to_string_lossy().into_owned());
        }
    }
}
