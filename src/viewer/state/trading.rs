//! The Compare workspace: quality against its cost, measured in the background.

use std::sync::mpsc::channel;

use super::State;
use super::finished::sentence;
use crate::accel::registry;
use crate::job::Outcome;
use crate::lab::CheckError;
use crate::lab::tradeoffs::Variant;
use crate::render::Mode;
use crate::viewer::workers;

impl State {
    /// Starts measuring every variant on the present view, with what structures are set to.
    pub(super) fn measure_tradeoffs(&mut self) {
        let Some((view, pause)) = self.begin_on_view(Mode::Shaded) else { return };
        let entries: Vec<_> = registry::ALL.iter().map(|entry| (entry, self.settings.params_of(entry))).collect();
        let (sender, receiver) = channel();
        self.building = None;
        match workers::tradeoffs(&self.shared, Variant::all_of(&entries), view, self.size_px, (sender, pause)) {
            Ok(job) => {
                self.tradeoffs.rows.clear();
                self.tradeoffs.running = Some((job, receiver));
            }
            Err(e) => self.fail(format!("Can't measure: {e}.")),
        }
    }

    /// Takes in variants that are through.
    pub(super) fn advance_tradeoffs(&mut self) {
        let Some((job, receiver)) = &self.tradeoffs.running else { return };
        // Asked first: what is sent before the end is there by then.
        let outcome = job.poll();
        self.tradeoffs.rows.extend(receiver.try_iter());
        match outcome {
            Outcome::Running => return,
            Outcome::Done(Ok(()) | Err(CheckError::Cancelled(_))) => {}
            Outcome::Done(Err(e)) => self.fail(format!("Can't measure: {}", sentence(&e.to_string()))),
            Outcome::Died => self.fail("Can't measure: a structure failed. Please report this.".to_owned()),
        }
        self.tradeoffs.running = None;
    }
}
