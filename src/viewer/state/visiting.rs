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

/// What visits are of: the structure, from where it is seen, what of it, and the size of the view in pixels.
type Of = (Key, Camera, Option<HalfSpace>, [u32; 2]);

/// Visits of the shown structure.
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
}

impl State {
    /// Whether boxes are coloured by visits.
    fn wants_visits(&self) -> bool {
        let overlay = &self.settings.overlay;
        overlay.color == BoxColor::Visits && (overlay.boxes || overlay.planes) && self.shown.is_some()
    }

    fn visited_view(&self) -> Option<Of> {
        Some((self.shown.as_ref()?.key.clone(), self.camera, self.section(), self.size_px))
    }

    /// Whether they are wanted of the present view and not there.
    pub(super) fn awaits_visits(&self) -> bool {
        self.wants_visits() && self.visiting.found.as_ref().map(|(of, _)| of) != self.visited_view().as_ref()
    }

    /// What a cell of the shown structure is visited by a ray of the view that was counted.
    pub fn visits(&self) -> Option<&Visits> {
        self.visiting.found.as_ref().filter(|_| self.wants_visits()).map(|(_, visits)| &**visits)
    }

    /// Takes in what was counted, and counts anew once the view has changed and is on the screen.
    pub(super) fn advance_visits(&mut self) {
        if let Some((of, job)) = self.visiting.running.take() {
            match job.poll() {
                // Of another view nobody waits for it.
                Outcome::Running if self.awaits_visits() && self.visited_view().as_ref() == Some(&of) => {
                    self.visiting.running = Some((of, job));
                    return;
                }
                Outcome::Running | Outcome::Done(Err(_)) => {}
                Outcome::Done(Ok(visits)) => {
                    self.visiting.number += 1;
                    self.shared.give_back(self.visiting.found.replace((of, Arc::new(visits))));
                }
                Outcome::Died => {
                    self.settings.overlay.color = BoxColor::Depth;
                    self.fail("Can't count visits: following rays failed. Please report this.".to_owned());
                }
            }
        }
        let there = self.whole_picture().is_some() && !self.size_px.contains(&0);
        if !self.awaits_visits() || !there || self.is_measuring() {
            return;
        }
        let (Some(of), Some(whole)) = (self.visited_view(), self.traced_view(Mode::Shaded)) else { return };
        let view = render::Job { section: self.section(), ..whole };
        let (pool, size_px) = (self.shared.pool.clone(), self.size_px);
        let job = Job::spawn("visits", self.shared.waker(), move |cancel, progress| {
            Visits::of_view(&view, size_px, &pool, cancel, progress)
        });
        self.visiting.running = job.ok().map(|job| (of, job));
    }
}
