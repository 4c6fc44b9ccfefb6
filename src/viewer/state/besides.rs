//! The second structure of a split picture: built, traced, and brought up to date with the view.

use std::sync::Arc;

use super::{Asked, State};
use crate::accel::BuildError;
use crate::accel::registry::{self, Entry};
use crate::job::Outcome;
use crate::render::sampler::Sampling;
use crate::render::{self, Mode, Renderer, Request};
use crate::viewer::beside::Pauses;
use crate::viewer::kept::Key;
use crate::viewer::settings::Workspace;
use crate::viewer::workers;

impl State {
    /// Chooses the second structure, or none.
    pub(super) fn put_beside(&mut self, id: Option<&'static str>) {
        self.beside.chosen = id.and_then(registry::find);
        self.forget_beside();
    }

    /// Forgets its picture; the structure may be a large one.
    pub(super) fn forget_beside(&mut self) {
        self.requested_beside = None;
        self.shared.give_back(self.beside.built.take());
        self.beside.clear();
    }

    /// Whether the picture is split. Where errors are measured against seconds nothing else is traced.
    pub fn is_split(&self) -> bool {
        self.beside_entry().is_some() && self.beside.picture.is_some()
    }

    fn beside_entry(&self) -> Option<&'static Entry> {
        let offered = self.settings.workspace == Workspace::Compare && self.settings.mode != Mode::Path;
        self.beside.chosen.filter(|_| offered)
    }

    /// Keeps both renderers from running, for those who measure.
    pub(super) fn pause_rendering(&self) -> Pauses {
        let second = self.beside.renderer.as_ref().map(Renderer::pause);
        Pauses(std::iter::once(self.renderer.pause()).chain(second).collect())
    }

    /// Ends what would disturb a measurement, and keeps both renderers from running.
    pub(super) fn begin_measuring(&mut self) -> Pauses {
        (self.beside.building, self.rays.following) = (None, None);
        self.hiding = None;
        self.brute.clear();
        if self.tree.outlining.take().is_some() {
            self.tree.of = None; // listed anew afterwards
        }
        self.pause_rendering()
    }

    /// Builds what is missing, and asks for a picture if the view has changed.
    pub(super) fn advance_beside(&mut self) {
        let Some(entry) = self.beside_entry() else {
            let beside = &self.beside;
            if beside.built.is_some() || beside.building.is_some() || beside.picture.is_some() {
                self.forget_beside();
            }
            return;
        };
        let key = Key { entry, params: self.settings.params_of(entry), test: self.settings.test_of(entry) };
        self.advance_build_beside(&key);
        let (Some(model), Some(built)) = (&self.model, &self.beside.built) else { return };
        let Some(asked) = self.requested.as_ref().filter(|asked| asked.size_px == self.size_px) else { return };
        // Colours stand for the same on either side.
        let range = self.range.or_else(|| self.picture.as_ref().map(|picture| picture.range)).filter(|_| asked.mode.is_heat());
        let wanted = Asked { number: 0, key, range, keeps: false, ..asked.clone() };
        if self.requested_beside.as_ref() == Some(&wanted) || self.is_measuring() {
            return self.take_picture_beside();
        }
        if self.beside.renderer.is_none() {
            let wake = Arc::clone(&self.shared.wake);
            self.beside.renderer = Renderer::new(self.trace_pool.clone(), move || wake()).ok();
        }
        let Some(renderer) = &self.beside.renderer else { return };
        let (scene, accel) = (Arc::clone(&model.scene), Arc::clone(&built.accel));
        let sampling = Sampling { kind: wanted.sampler, seed: 0 };
        let whole = render::Job::new(scene, accel, wanted.camera, wanted.mode, Arc::clone(&model.looks));
        let job = render::Job { sampling, section: wanted.section, visible: wanted.visible.clone(), ..whole };
        let ([width, height], max_samples, tone) = (wanted.size_px, wanted.max_samples, wanted.tone);
        renderer.request(Request { job, width, height, max_samples, range, tone, keep: None });
        self.requested_beside = Some(wanted);
        self.take_picture_beside();
    }

    fn take_picture_beside(&mut self) {
        if let Some(picture) = self.beside.renderer.as_ref().and_then(Renderer::picture) {
            self.beside.picture = Some(picture);
        }
    }

    fn advance_build_beside(&mut self, key: &Key) {
        let other = |of: &Key| of != key;
        let stale = self.beside.built.as_ref().is_some_and(|built| other(&built.key))
            || self.beside.building.as_ref().is_some_and(|building| other(&building.key));
        if stale {
            self.forget_beside();
        }
        if let Some(building) = self.beside.building.take() {
            match building.job.poll() {
                Outcome::Running => self.beside.building = Some(building),
                Outcome::Done(Ok(built)) => {
                    self.kept.keep(built.clone());
                    self.beside.built = Some(built);
                }
                Outcome::Done(Err(BuildError::Cancelled(_))) => {}
                Outcome::Done(Err(e)) => {
                    let why = super::finished::sentence(&e.to_string());
                    self.fail(format!("Can't build {} beside: {why}", key.entry.name));
                    self.beside.chosen = None;
                }
                Outcome::Died => {
                    self.fail(format!("Can't build {} beside: the builder failed. Please report this model.", key.entry.name));
                    self.beside.chosen = None;
                }
            }
        }
        let free = self.beside.building.is_none() && self.building.is_none() && self.loading.is_none() && !self.is_measuring();
        if self.beside.built.is_some() || self.beside.chosen.is_none() || !free {
            return;
        }
        self.beside.built = self.kept.take_up(key);
        if let (None, Some(model)) = (&self.beside.built, &self.model) {
            self.beside.building = workers::build(&self.shared, key.clone(), Arc::clone(&model.geometry)).ok();
        }
    }
}
