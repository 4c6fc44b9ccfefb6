//! The film of the build: made in the background, played, and drawn over the view while its workspace is open.

use std::sync::Arc;
use std::time::{Duration, Instant};

use super::State;
use crate::accel::registry::Family;
use crate::job::Outcome;
use crate::lab::film::{self, Film, FilmError};
use crate::viewer::command::Command;
use crate::viewer::filming;
use crate::viewer::settings::Workspace;

impl State {
    /// Whether the shown structure has a film.
    pub fn has_film(&self) -> bool {
        self.shown.as_ref().is_some_and(|b| b.key.entry.family != Family::Brute && film::is_possible(b.accel.as_ref()))
    }

    /// Whether it can be made now: all its cells are listed, and nothing is measured.
    pub fn can_make_film(&self) -> bool {
        let free = self.filming.making.is_none() && self.filming.film.is_none() && !self.is_measuring();
        free && self.has_film() && self.tree.outline.as_ref().is_some_and(|outline| !outline.is_cut())
    }

    /// Starts making it, to be seen from a position on.
    pub(super) fn begin_film(&mut self, at: u32) {
        let (Some(shown), Some(outline), true) = (&self.shown, &self.tree.outline, self.can_make_film()) else { return };
        match filming::make(&self.shared, shown, Arc::clone(outline)) {
            Ok(job) => (self.filming.making, self.filming.failed, self.filming.at) = (Some(job), None, at),
            Err(e) => self.fail(format!("Can't make the film: {e}.")),
        }
    }

    /// Makes it, where it is seen.
    pub(super) fn make_film(&mut self) {
        if !self.can_make_film() {
            return;
        }
        self.begin_film(0);
        if self.settings.workspace != Workspace::Structure {
            self.carry_out(Command::Workspace(Workspace::Structure));
        }
    }

    pub(super) fn advance_filming(&mut self) {
        let Some(job) = &self.filming.making else { return };
        match job.poll() {
            Outcome::Running => return,
            Outcome::Done(Ok(film)) => self.filming.made(film),
            Outcome::Done(Err(FilmError::Cancelled(_))) => {}
            Outcome::Done(Err(FilmError::Memory(_) | FilmError::Outline(_))) if self.make_room(None) => {
                self.filming.making = None;
                return self.begin_film(self.filming.at); // there is room for it now, or one more can go
            }
            Outcome::Done(Err(e)) => self.filming.failed = Some(super::finished::sentence(&format!("No film: {e}"))),
            Outcome::Died => self.filming.failed = Some("No film: making it failed. Please report this.".to_owned()),
        }
        self.filming.making = None;
    }

    /// Forgets it.
    pub(super) fn close_film(&mut self) {
        let film = self.filming.clear();
        self.shared.give_back(film);
    }

    /// Plays it on; says when the next event is due.
    pub fn play_film_on(&mut self) -> Option<Duration> {
        self.filming.play_on(Instant::now())
    }

    /// The film that is drawn over the view, and its position.
    pub fn film_on_screen(&self) -> Option<(&Arc<Film>, u32)> {
        let film = self.filming.film.as_ref().filter(|_| self.settings.workspace == Workspace::Structure)?;
        Some((film, self.filming.at))
    }
}
