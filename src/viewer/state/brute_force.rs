//! Comparing a part of the picture with brute force: started, taken in, and its rays followed.

use std::time::Instant;

use super::State;
use crate::accel::registry;
use crate::job::Outcome;
use crate::lab::{PixelRect, RayKind};
use crate::render::{self, Mode};
use crate::viewer::brute::{self, Of, Part};
use crate::viewer::command::Command;
use crate::viewer::kept::Key;
use crate::viewer::rays::MOST;
use crate::viewer::settings::Workspace;

/// The structure that looks at everything.
const BRUTE: &str = "brute";

impl State {
    /// Whether the shown structure can be compared with brute force now and here: it is another one, and nothing is measured.
    pub fn can_compare_with_brute_force(&self) -> bool {
        let other = self.shown.as_ref().is_some_and(|shown| shown.key.entry.id != BRUTE);
        let here = matches!(self.settings.workspace, Workspace::View | Workspace::Ray);
        other && here && !self.is_measuring() && !self.is_checking() && !self.size_px.contains(&0)
    }

    /// Lets the next drag in the view mark a rectangle, or no longer.
    pub(super) fn mark_rectangle(&mut self, mark: bool) {
        self.brute.marking = mark && self.can_compare_with_brute_force();
    }

    /// The present view, as far as it says what is compared.
    fn compared(&self) -> Option<Of> {
        let key = self.shown.as_ref()?.key.clone();
        let (section, visible) = (self.section(), self.visible().cloned());
        Some(Of { key, camera: self.camera, section, visible })
    }

    /// Compares a rectangle of the view, or all of it, with brute force.
    pub(super) fn compare_with_brute_force(&mut self, rect: Option<PixelRect>) {
        self.brute.marking = false;
        if !self.can_compare_with_brute_force() {
            return;
        }
        let (Some(_model), Some(shown), Some(entry)) = (&self.model, &self.shown, registry::find(BRUTE)) else { return };
        let test = entry.tests().find(|test| *test == shown.key.test).unwrap_or_default();
        let key = Key { entry, params: self.settings.params_of(entry), test };
        let there = self.kept.take_up(&key).ok_or(key);
        let Some(whole) = self.traced_view(Mode::Shaded) else { return };
        let view = render::Job { section: self.section(), visible: self.visible().cloned(), ..whole };
        let part = Part { rect: rect.unwrap_or_else(|| PixelRect::whole(self.size_px)), size_px: self.size_px };
        let job = brute::compare(&self.shared, there, view, part);
        self.brute.clear();
        // The result is that of this view, whatever becomes of the viewport.
        self.framed = None;
        match job {
            Ok(job) => {
                self.brute.of = self.compared().map(|of| (of, part));
                self.brute.running = Some((job, Instant::now()));
            }
            Err(e) => self.fail(format!("Can't compare with brute force: {e}.")),
        }
    }

    /// Takes in what was found. What is of another view is forgotten.
    pub(super) fn advance_brute_force(&mut self) {
        if self.brute.marking && !self.can_compare_with_brute_force() {
            self.brute.marking = false;
        }
        if self.brute.of.is_some() && self.brute.of.as_ref().map(|of| &of.0) != self.compared().as_ref() {
            self.brute.clear();
        }
        let Some((job, _)) = &self.brute.running else { return };
        match job.poll() {
            Outcome::Running => return,
            Outcome::Done(Ok((found, built))) => {
                self.kept.keep(built);
                if let Some(shown) = &self.shown {
                    let _ = self.kept.take_up(&shown.key);
                }
                self.brute.found = Some(found);
            }
            Outcome::Done(Err(why)) if why.is_empty() => self.brute.of = None,
            Outcome::Done(Err(why)) => {
                self.brute.of = None;
                self.fail(format!("Can't compare with brute force: {}", super::finished::sentence(&why)));
            }
            Outcome::Died => {
                self.brute.of = None;
                self.fail("Can't compare with brute force: it failed. Please report this model.".to_owned());
            }
        }
        self.brute.running = None;
    }

    /// Follows the ray of a pixel that differs in the Ray workspace, brute force beside it.
    pub(super) fn follow_unlike(&mut self, number: usize) {
        let unlike = self.brute.unlike();
        let (count, Some(ray)) = (unlike.len(), unlike.get(number).map(|pixel| pixel.ray)) else { return };
        self.brute.next = (number + 1) % count;
        self.carry_out(Command::Workspace(Workspace::Ray));
        (self.ray_list.chosen, self.rays.awaited) = (None, None);
        (self.rays.asked, self.rays.kind, self.rays.playing) = (Some(ray), RayKind::Primary, None);
        if !self.rays.beside.contains(&BRUTE) && self.rays.beside.len() + 1 >= MOST {
            self.rays.beside.pop();
        }
        self.follow_beside(BRUTE, true);
    }
}
