//! The tour: what its present step shows is done, as soon as it can be.

use super::State;
use crate::viewer::tour::{Act, Tour};

impl State {
    /// Begins the tour at a step, or leaves it.
    pub(super) fn go_on_tour(&mut self, step: Option<usize>) {
        self.tour = step.map(Tour::at);
        self.settings.toured |= step.is_some();
    }

    /// Does what is next of the present step. Where something went wrong the rest is left to the person.
    pub(super) fn advance_tour(&mut self) {
        while let Some(mut tour) = self.tour
            && self.error.is_none()
            && let Some(act) = tour.next(self)
        {
            let command = match act {
                Act::Wait => return,
                Act::Pass => None,
                Act::Do(command) => Some(command),
            };
            tour.advance();
            self.tour = Some(tour);
            if let Some(command) = command {
                self.carry_out(command);
            }
        }
    }

    /// Whether the tour is still to do something.
    pub(super) fn is_touring(&self) -> bool {
        self.error.is_none() && self.tour.is_some_and(|tour| tour.is_acting())
    }
}
