//! The Ray workspace: a ray is followed in the background, and played.

use std::time::{Duration, Instant};

use super::State;
use crate::geometry::Ray;
use crate::job::Outcome;
use crate::lab::RayKind;
use crate::lab::follow::from_text;
use crate::viewer::kept::Key;
use crate::viewer::pick::Picked;
use crate::viewer::rays::{Column, MOST};
use crate::viewer::settings::Workspace;
use crate::viewer::wires::{self, Wires};
use crate::viewer::workers::{self, ToFollow};

impl State {
    /// Follows another ray, from its first step.
    pub(super) fn follow_anew(&mut self, ray: Ray) {
        (self.rays.awaited, self.ray_list.chosen) = (None, None);
        self.follow(ray);
    }

    /// Follows a ray through the shown structure and those beside it.
    pub(super) fn follow(&mut self, ray: Ray) {
        self.rays.asked = Some(ray);
        let Some(shown) = &self.shown else { return };
        let mut kept = vec![shown.clone()];
        let mut missing = Vec::new();
        for id in &self.rays.beside {
            let Some(entry) = crate::accel::registry::find(id).filter(|entry| entry.id != shown.key.entry.id) else { continue };
            let key = Key { entry, params: self.settings.params_of(entry), test: self.settings.test_of(entry) };
            match self.kept.take_up(&key) {
                Some(built) => kept.push(built),
                None => missing.push(key),
            }
        }
        if self.is_measuring() && !missing.is_empty() {
            self.rays.note = Some("Structures that are not built yet are built once measuring has ended.".to_owned());
            missing.clear();
        }
        let wanted = ToFollow { kept, missing, ray, kind: self.rays.kind, camera: self.camera };
        match workers::follow(&self.shared, wanted) {
            Ok(job) => self.rays.following = Some(job),
            Err(e) => self.fail(format!("Can't follow the ray: {e}.")),
        }
    }

    /// The same ray anew: through other structures, or one that leaves what it meets.
    pub(super) fn follow_again(&mut self) {
        if let Some(ray) = self.rays.asked {
            self.follow(ray);
        }
    }

    /// Follows a ray that was typed.
    pub(super) fn follow_text(&mut self, text: &str) {
        match from_text(text) {
            Ok(ray) => {
                self.rays.kind = RayKind::Primary;
                self.follow_anew(ray);
            }
            Err(why) => self.rays.note = Some(super::finished::sentence(&format!("Not followed: {why}"))),
        }
    }

    /// Shows, or hides, a structure's steps beside the shown one's.
    pub(super) fn follow_beside(&mut self, id: &'static str, beside: bool) {
        let shown = self.settings.entry().id;
        self.rays.beside.retain(|known| *known != id && *known != shown);
        if beside && self.rays.beside.len() + 1 < MOST {
            self.rays.beside.push(id);
        }
        self.follow_again();
    }

    pub(super) fn advance_following(&mut self) {
        let Some(job) = &self.rays.following else { return };
        match job.poll() {
            Outcome::Running => return,
            Outcome::Done(Ok(found)) => {
                // The same step of the same ray stays, and so does who leads, as far as there is one.
                let (lead, at) = if self.rays.ray == found.ray { (self.rays.lead, self.rays.at) } else { (0, 0) };
                self.rays.ray = found.ray;
                found.columns.iter().for_each(|(built, _)| self.kept.keep(built.clone()));
                self.rays.columns = found.columns.into_iter().map(|(built, followed)| Column { built, followed }).collect();
                self.rays.go(lead, at);
                self.rays.go_to_awaited();
                let failed = found.failed.iter().map(|(id, why)| super::finished::sentence(&format!("{id}: {why}")));
                let failed = failed.collect::<Vec<_>>().join(" ");
                self.rays.note = match found.ray {
                    None => Some("The ray meets nothing that another could leave.".to_owned()),
                    // That some are built later was said when it began.
                    Some(_) if failed.is_empty() && self.is_measuring() => self.rays.note.take(),
                    Some(_) => Some(failed).filter(|text| !text.is_empty()),
                };
                self.light();
            }
            Outcome::Done(Err(_)) => {}
            Outcome::Died => self.rays.note = Some("Following the ray failed. Please report this.".to_owned()),
        }
        self.rays.following = None;
    }

    /// Goes to a step.
    pub(super) fn go_to_step(&mut self, column: usize, step: usize) {
        self.rays.go(column, step);
        self.light();
    }

    /// Starts or stops playing; from the start where it has come to the end.
    pub(super) fn play(&mut self, play: bool) {
        if play && self.rays.at >= self.rays.last() {
            self.rays.at = 0;
        }
        self.rays.playing = play.then(Instant::now);
        self.light();
    }

    /// Plays on; says when the next step is due.
    pub fn play_on(&mut self) -> Option<Duration> {
        let (due, changed) = self.rays.play(Instant::now());
        if changed {
            self.light();
        }
        due
    }

    /// The cell that stands out: of the step that is played, or what is selected.
    pub(super) fn lit_cell(&self) -> Option<Wires> {
        let (view, white) = (self.view()?, [u8::MAX; 4]);
        if self.settings.workspace == Workspace::Ray
            && let Some(column) = self.rays.columns.get(self.rays.lead)
        {
            let cell = column.followed.cell_at(self.rays.at)?;
            return Some(wires::of_cell(column.built.accel.as_ref(), cell, &view, white));
        }
        let cell = self.picked.as_ref().and_then(Picked::selected)?;
        Some(wires::of_cell(self.shown.as_ref()?.accel.as_ref(), cell, &view, white))
    }
}
