//! The Compare workspace: curves of error that grow with the picture, the reference, and pictures of points that are clicked.

use std::sync::Arc;

use super::{Asked, State};
use crate::job::Outcome;
use crate::render::{self, Mode, Picture};
use crate::viewer::errors::{Chosen, Errors, View};
use crate::viewer::workers;

impl State {
    /// The picture that is on the screen: the present one, that of tiles' times, or in the Compare workspace that of a point of
    /// a curve.
    pub fn on_screen(&self) -> Option<&Arc<Picture>> {
        let shows = self.has_curves() && !self.tiles.shown;
        let tiles = self.tiles.picture.as_ref().filter(|_| self.shows_tiles()).map(|(_, _, picture)| picture);
        self.errors.picture.as_ref().filter(|_| shows).or(tiles).or(self.picture.as_ref())
    }

    /// Whether that is the picture of a point of a curve.
    pub fn is_held(&self) -> bool {
        self.on_screen().zip(self.errors.picture.as_ref()).is_some_and(|(shown, held)| Arc::ptr_eq(shown, held))
    }

    /// Whether there are curves of errors: light is kept on its way for them only where somebody looks at them. Seconds are those
    /// of a picture that has all threads to itself, so there are none of compared ones.
    pub fn has_curves(&self) -> bool {
        self.settings.workspace.shows_errors() && self.settings.mode == Mode::Path && !self.is_comparing()
    }

    /// Curves are those of one view: forgets them with it.
    pub(super) fn follow_errors(&mut self, now: &Asked) {
        let Asked { model, textured, camera, section, size_px, sampler, .. } = *now;
        let visible = now.visible.as_ref().map(|visible| visible.number());
        let of = View { model, textured, camera, section, visible, size_px, sampler };
        if now.mode == Mode::Path && self.errors.view != Some(of) {
            let fresh = Errors { as_table: self.errors.as_table, view: Some(of), ..Errors::default() };
            self.shared.give_back(std::mem::replace(&mut self.errors, fresh));
        }
    }

    /// Takes in what the newest picture has kept, and what jobs have finished.
    pub(super) fn advance_errors(&mut self) {
        if let (Some(asked), Some(picture), Some(shown)) = (&self.requested, &self.picture, &self.shown)
            && asked.number == picture.request
            && asked.key == shown.key
            && asked.mode == Mode::Path
        {
            self.errors.take(&asked.key, shown.build_secs, &picture.shots);
        }
        self.take_reference();
        self.take_errors();
        let Some(developing) = &self.errors.developing else { return };
        match developing.poll() {
            Outcome::Running => return,
            Outcome::Done(picture) => self.errors.picture = picture.map(Arc::new).ok(),
            Outcome::Died => self.fail("Can't show that picture: developing it failed. Please report this.".to_owned()),
        }
        self.errors.developing = None;
    }

    fn take_reference(&mut self) {
        let Some((_, making)) = &self.errors.making else { return };
        match making.poll() {
            Outcome::Running => return,
            Outcome::Done(Ok(reference)) => {
                // What is measured against the one before is of no use.
                (self.errors.reference, self.errors.erring) = (Some(Arc::new(reference)), None);
                self.errors.curves.iter_mut().for_each(|live| live.errors.fill(None));
            }
            Outcome::Done(Err(_)) => {}
            Outcome::Died => self.fail("Can't make the reference: it failed. Please report this.".to_owned()),
        }
        self.errors.making = None;
    }

    /// Measures what has not been measured yet.
    fn take_errors(&mut self) {
        if let Some(erring) = &self.errors.erring {
            match erring.poll() {
                Outcome::Running => return,
                Outcome::Done(found) => {
                    for (curve, point, errors) in found {
                        if let Some(of) = self.errors.curves.get_mut(curve).and_then(|live| live.errors.get_mut(point)) {
                            *of = Some(errors);
                        }
                    }
                }
                Outcome::Died => self.fail("Can't measure errors: it failed. Please report this.".to_owned()),
            }
            self.errors.erring = None;
        }
        let Some(reference) = &self.errors.reference else { return };
        let mut open = Vec::new();
        for (c, live) in self.errors.curves.iter().enumerate() {
            let unknown = live.shots.iter().zip(&live.errors).enumerate().filter(|(_, (_, errors))| errors.is_none());
            open.extend(unknown.filter(|(_, (shot, _))| shot.light.is_some()).map(|(p, (shot, _))| (c, p, Arc::clone(shot))));
        }
        if !open.is_empty() {
            self.errors.erring = workers::errors(&self.shared, open, Arc::clone(reference)).ok();
        }
    }

    /// Starts a reference of the present view; the picture rests meanwhile.
    pub(super) fn make_reference(&mut self) {
        let Some((spp, _)) = self.errors.wanted_reference().filter(|_| self.has_curves()) else { return };
        let Some((whole, pause)) = self.begin_on_view(Mode::Path) else { return };
        // What the picture shows, since it is what is compared.
        let view = render::Job { section: self.section(), visible: self.visible().cloned(), ..whole };
        match workers::reference(&self.shared, view, self.size_px, spp, pause) {
            Ok(job) => self.errors.making = Some((spp, job)),
            Err(e) => self.fail(format!("Can't make the reference: {e}.")),
        }
    }

    /// Shows the picture of a point, or the present one again.
    pub(super) fn choose_shot(&mut self, chosen: Option<(usize, usize)>, difference: bool) {
        (self.errors.picture, self.errors.developing) = (None, None);
        let point = chosen.and_then(|(curve, point)| Some((curve, point, self.errors.nearest_kept(curve, point)?)));
        let difference = difference && self.errors.reference.is_some();
        self.errors.chosen = point.map(|(curve, point, kept)| Chosen { curve, point, kept, difference });
        let (Some(chosen), Some(present)) = (self.errors.chosen, &self.picture) else { return };
        let shot = Arc::clone(&self.errors.curves[chosen.curve].shots[chosen.kept]);
        let reference = self.errors.reference.clone().filter(|_| difference);
        let (present, tone) = (Arc::clone(present), self.settings.tone);
        let size_px = self.errors.view.map_or(self.size_px, |view| view.size_px);
        self.errors.developing = workers::develop(&self.shared, shot, reference, (present, size_px), tone).ok();
    }
}
