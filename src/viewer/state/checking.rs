//! The Check workspace: the stability lab in the background, cases that are opened, and the check of the open model.

use std::sync::Arc;
use std::sync::mpsc::channel;

use super::State;
use super::finished::sentence;
use crate::job::Outcome;
use crate::lab::CheckError;
use crate::viewer::checks::Cell;
use crate::viewer::model;
use crate::viewer::workers;

impl State {
    /// Starts the lab anew.
    pub(super) fn run_lab(&mut self) {
        if self.is_measuring() {
            return;
        }
        let (sender, receiver) = channel();
        match workers::stability(&self.shared, sender) {
            Ok(job) => {
                self.checks.cases.clear();
                self.checks.selected = None;
                self.checks.running = Some((job, receiver));
            }
            Err(e) => self.fail(format!("Can't run the lab: {e}.")),
        }
    }

    /// Takes in cases that are through.
    pub(super) fn advance_lab(&mut self) {
        let Some((job, receiver)) = &self.checks.running else { return };
        // Asked first: what is sent before the end is there by then.
        let outcome = job.poll();
        self.checks.cases.extend(receiver.try_iter());
        match outcome {
            Outcome::Running => return,
            Outcome::Done(Ok(()) | Err(CheckError::Cancelled(_))) => {}
            Outcome::Done(Err(e)) => self.fail(format!("Can't finish the lab: {}", sentence(&e.to_string()))),
            Outcome::Died => self.fail("Can't finish the lab: a case failed. Please report this.".to_owned()),
        }
        self.checks.running = None;
    }

    /// Opens the case of a cell, with its structure and test, and its rays drawn over it.
    pub(super) fn open_case(&mut self, cell: Cell) {
        if self.is_measuring() {
            return;
        }
        self.checks.selected = Some(cell);
        (self.settings.structure, self.settings.test) = (cell.structure.to_owned(), cell.test);
        let entry = self.settings.entry();
        self.settings.remember(entry, &entry.defaults());
        let name = model::case_name(cell.case);
        match self.model.as_ref().filter(|model| model.scene.name == name) {
            Some(model) => {
                let rays = Arc::clone(&model.rays);
                self.checks.mark_case(&rays);
                self.choose();
            }
            None => self.open(name),
        }
    }

    /// Starts the check of the open model, on the rays of the present view.
    pub(super) fn check_model(&mut self) {
        if self.is_measuring() {
            return;
        }
        let Some(plan) = self.plan() else { return };
        match workers::check_model(&self.shared, plan) {
            Ok(job) => {
                self.checks.opened();
                self.checks.checking = Some(job);
            }
            Err(e) => self.fail(format!("Can't check the model: {e}.")),
        }
    }

    pub(super) fn advance_check(&mut self) {
        let Some(job) = &self.checks.checking else { return };
        match job.poll() {
            Outcome::Running => return,
            Outcome::Done(Ok((check, built))) => {
                built.iter().for_each(|built| self.kept.keep(built.clone()));
                if let Some(shown) = &self.shown {
                    let _ = self.kept.take_up(&shown.key);
                }
                // The first that is wrong is what one wants to see.
                let worst = check.structures.iter().position(|row| row.wrong > 0);
                self.checks.model = Some(check);
                self.checks.mark_model(worst);
            }
            Outcome::Done(Err(CheckError::Cancelled(_))) => {}
            Outcome::Done(Err(e)) => self.fail(format!("Can't check the model: {}", sentence(&e.to_string()))),
            Outcome::Died => self.fail("Can't check the model: the check failed. Please report this model.".to_owned()),
        }
        self.checks.checking = None;
    }
}
