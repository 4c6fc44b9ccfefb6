//! The dialog that asks for a file, from its opening to its answer.

use std::sync::Arc;
use std::sync::mpsc::{Receiver, TryRecvError};

use super::State;

impl State {
    /// Opens the dialog, unless it is open: of two, the first would ask in vain.
    pub(super) fn ask_for_file(&mut self) {
        if self.asked_for_file.is_none() {
            self.asked_for_file = Some(self.dialog.pick(Arc::clone(&self.shared.wake)));
        }
    }

    /// Opens what was picked.
    pub(super) fn advance_dialog(&mut self) {
        match self.asked_for_file.as_ref().map(Receiver::try_recv) {
            Some(Ok(path)) => {
                self.asked_for_file = None;
                if let Some(path) = path {
                    self.open(path.to_string_lossy().into_owned());
                }
            }
            Some(Err(TryRecvError::Disconnected)) => self.asked_for_file = None,
            Some(Err(TryRecvError::Empty)) | None => {}
        }
    }
}
