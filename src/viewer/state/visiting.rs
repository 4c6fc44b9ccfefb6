//! How often rays of the present view enter cells: counted in the background where boxes are coloured by it.

use std::sync::Arc;

use super::State;
use crate::geometry::HalfSpace;
use crate::job::{Job, Outcome};
use crate::lab::Visits;
use crate::render::{self, Mode};
use crate::scene::Camera;
use crate::task::Cancelled;
use crate::viewer::kept::Key;
use crate::viewer::settings::BoxColor;
use crate::viewer::workers::Shared;

/// What visits are of: the structure, from where it is seen, what of it, and the size of the view in pixels.
pub(super) type Of = (Key, Camera, Option<HalfSpace>, [u32; 2]);

/// Visits of a structure.
#[derive(Default)]
pub struct Visiting {
    /// What was counted.
    found: Option<(Of, Arc<Visits>)>,
    /// That, on its way.
    running: Option<(Of, Job<Result<Visits, Cancelled>>)>,
    /// Grows with each time that they were counted.
    number: u64,
}

impl Visiting {
    /// What was counted last, maybe of an earlier view, and how often anything was.
    pub fn newest(&self) -> Option<(u64, Arc<Visits>)> {
        self.found.as_ref().map(|(_, visits)| (self.number, Arc::clone(visits)))
    }

    /// Stops counting.
    pub fn stop(&mut self) {
        self.running = None;
    }

    /// Whether they were not counted of that.
    pub(super) fn lacks(&self, of: &Of) -> bool {
        self.found.as_ref().is_none_or(|(found, _)| found != of)
    }

    /// What was counted of that.
    pub(super) fn found_of(&self, of: &Of) -> Option<Arc<Visits>> {
        self.found.as_ref().filter(|(found, _)| found == of).map(|(_, visits)| Arc::clone(visits))
    }

    /// Whether that is being counted.
    pub(super) fn counts(&self, of: &Of) -> bool {
        self.running.as_ref().is_some_and(|(running, _)| running == of)
    }

    /// Takes what was counted of that, here or for another picture of it, and counts no more.
    pub(super) fn take(&mut self, of: Of, visits: Arc<Visits>, shared: &Shared) {
        self.running = None;
        self.number += 1;
        shared.give_back(self.found.replace((of, visits)));
    }

    /// Takes in what was counted; stops what is of something else than is wanted. False if counting failed.
    pub(super) fn take_in(&mut self, wanted: Option<&Of>, shared: &Shared) -> bool {
        let Some((of, job)) = self.running.take() else { return true };
        match job.poll() {
            Outcome::Running if wanted == Some(&of) => self.running = Some((of, job)),
            Outcome::Running | Outcome::Done(Err(_)) => {}
            Outcome::Done(Ok(visits)) => self.take(of, Arc::new(visits), shared),
            Outcome::Died => return false,
        }
        true
    }

    /// Counts anew, unless something is being counted.
    pub(super) fn count(&mut self, of: Of, view: render::Job, shared: &Shared) {
        if self.running.is_some() {
            return;
        }
        let (pool, size_px) = (shared.pool.clone(), of.3);
        let job = Job::spawn("visits", shared.waker(), move |cancel, progress| {
            Visits::of_view(&view, size_px, &pool, cancel, progress)
        });
        self.running = job.ok().map(|job| (of, job));
    }
}

impl State {
    /// Whether boxes are coloured by visits.
    pub(super) fn wants_visits(&self) -> bool {
        let overlay = &self.settings.overlay;
        overlay.color == BoxColor::Visits && (overlay.boxes || overlay.planes) && self.shown.is_some()
    }

    /// What visits of a structure would be counted of now.
    pub(super) fn visited_view(&self, key: &Key) -> Of {
        (key.clone(), self.camera, self.section(), self.size_px)
    }

    /// What those of the shown structure are yet to be counted of.
    pub(super) fn awaited_visits(&self) -> Option<Of> {
        let shown = self.shown.as_ref().filter(|_| self.wants_visits())?;
        Some(self.visited_view(&shown.key)).filter(|of| self.visiting.lacks(of))
    }

    /// Whether they are wanted of the present view and not there.
    pub(super) fn awaits_visits(&self) -> bool {
        self.awaited_visits().is_some()
    }

    /// What a cell of the shown structure is visited by a ray of the view that was counted.
    pub fn visits(&self) -> Option<&Visits> {
        self.visiting.found.as_ref().filter(|_| self.wants_visits()).map(|(_, visits)| &**visits)
    }

    /// Takes in what was counted, here or for a picture beside, and counts anew once the view has changed and is on the screen.
    pub(super) fn advance_visits(&mut self) {
        let wanted = self.awaited_visits();
        if let Some((of, visits)) = wanted.as_ref().and_then(|of| Some((of.clone(), self.panes.visits_of(of)?))) {
            self.visiting.take(of, visits, &self.shared);
        }
        if !self.visiting.take_in(wanted.as_ref(), &self.shared) {
            return self.fail_visits();
        }
        let there = self.whole_picture().is_some() && !self.size_px.contains(&0);
        let (Some(of), Some(whole)) = (self.awaited_visits(), self.traced_view(Mode::Shaded)) else { return };
        if there && !self.is_measuring() {
            let view = render::Job { section: self.section(), ..whole };
            self.visiting.count(of, view, &self.shared);
        }
    }

    /// Says that visits cannot be counted, and colours boxes by depth.
    pub(super) fn fail_visits(&mut self) {
        self.settings.overlay.color = BoxColor::Depth;
        self.fail("Can't count visits: following rays failed. Please report this.".to_owned());
    }
}
