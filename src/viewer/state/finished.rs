//! What follows from a job that has finished: loading, building, statistics, picking, measuring.

use std::sync::Arc;
use std::time::Instant;

use super::{Again, Causes, Fits, State};
use crate::accel::BuildError;
use crate::job::Outcome;
use crate::scene::texture::Detail;
use crate::scene::{CameraSpec, Material};
use crate::viewer::brute::Brute;
use crate::viewer::history::{History, Kind};
use crate::viewer::kept::Built;
use crate::viewer::model::{self, Model};
use crate::viewer::pick::Picked;
use crate::viewer::rays::Rays;
use crate::viewer::settings::SectionSettings;
use crate::viewer::timings::Timings;
use crate::viewer::workers;

impl State {
    pub(super) fn advance_load(&mut self) {
        let Some((name, job)) = &self.loading else { return };
        if self.size_px == [0, 0] {
            return; // the first view is made for the viewport, and the first frame says how large it is
        }
        let name = name.clone();
        match job.poll() {
            Outcome::Running => return,
            Outcome::Done(Ok(model)) => self.opened(&name, model),
            Outcome::Done(Err(e)) if e.is_cancelled() => {}
            Outcome::Done(Err(e)) => {
                let kept = if self.model.is_some() { " Your scene is unchanged." } else { "" };
                self.fail(format!("{}{kept}", sentence(&e.to_string())));
            }
            Outcome::Died => self.fail(format!("Can't open {name}: the loader failed. Please report this file.")),
        }
        self.stay();
    }

    fn opened(&mut self, name: &str, model: Model) {
        if !model::is_case(name) {
            self.settings.opened(name);
        }
        let spec = self.first_camera.take();
        self.camera = CameraSpec::or_first(spec.as_ref(), &model.scene, &model.geometry, self.aspect());
        self.framed = spec.is_none().then_some((self.camera, self.size_px));
        let reopened = self.reopened.take();
        if let Some((camera, _)) = reopened {
            (self.camera, self.framed) = (camera, None);
        }
        (self.building, self.counting, self.collecting, self.measuring) = (None, None, None, None);
        (self.predicting, self.predicted) = (None, None);
        self.shared.give_back((self.model.take(), self.shown.take(), std::mem::take(&mut self.kept)));
        (self.picture, self.overlay, self.requested, self.collected_for) = (None, None, None, None);
        self.shared.give_back(std::mem::take(&mut self.errors));
        self.picking = None;
        (self.decoding, self.textures) = (None, None);
        self.select(None);
        (self.seen, self.counted) = (None, None);
        (self.cameras, self.choices) = (History::default(), History::default());
        (self.needs, self.needing) = (None, None);
        self.exports.opened();
        self.timings = Timings::default();
        (self.tradeoffs.running, self.tradeoffs.rows) = (None, Vec::new());
        self.tiles.clear();
        self.clicked = None;
        self.shared.give_back(std::mem::take(&mut self.visiting));
        (self.tradeoffs.growing, self.tradeoffs.scaling) = (None, Vec::new());
        self.checks.opened();
        let ray = self.rays.asked.filter(|_| reopened.is_some());
        let section = self.first_section.take();
        if reopened.is_none() {
            self.bookmarks.clear();
            self.settings.section = SectionSettings { on: section.is_some(), at: section.unwrap_or_default() };
        }
        self.shared.give_back(self.tree.outline.take());
        self.tree.clear();
        self.close_film();
        self.causes = Causes::default();
        self.fits = Fits::default();
        let (beside, kind, speed) = (std::mem::take(&mut self.rays.beside), self.rays.kind, self.rays.speed);
        let before = std::mem::replace(&mut self.rays, Rays { asked: ray, beside, kind, speed, ..Rays::default() });
        self.shared.give_back(before.columns);
        (self.brute, self.settings.visible, self.range) = (Brute::default(), None, None);
        self.hide_no_more();
        self.close_rays();
        (self.awaited, self.again) = (None, Again::default());
        self.forget_panes();
        self.bring_back();
        if self.checks.selected.is_some_and(|cell| model::case_name(cell.case) == name) {
            self.checks.mark_case(&model.rays);
        }
        self.models += 1;
        self.renderer.clear();
        self.model = Some(model);
        self.choose();
    }

    pub(super) fn advance_build(&mut self) {
        let Some(building) = &self.building else { return };
        let name = building.key.entry.name;
        match building.job.poll() {
            Outcome::Running => return,
            Outcome::Done(Ok(built)) => {
                self.kept.keep(built.clone());
                self.timings.built(&built);
                self.show(built);
            }
            Outcome::Done(Err(BuildError::Cancelled(_))) => {}
            Outcome::Done(Err(BuildError::Memory { .. })) if self.make_room(None) => {
                self.building = None;
                return self.choose(); // there is room for it now, or one more can go
            }
            Outcome::Done(Err(e)) => {
                self.fail(format!("Can't build {name}: {}", sentence(&e.to_string())));
                self.cancel_build();
            }
            Outcome::Died => {
                self.fail(format!("Can't build {name}: the builder failed. Please report this model."));
                self.cancel_build();
            }
        }
        self.building = None;
    }

    pub(super) fn advance_statistics(&mut self) {
        let Some((key, job)) = &self.counting else { return self.count() };
        match job.poll() {
            Outcome::Running => return,
            Outcome::Done(Ok(stats)) => {
                let stats = Arc::new(stats);
                self.kept.add_stats(key, &stats);
                if let Some(shown) = self.shown.as_mut().filter(|b| b.key == *key) {
                    shown.stats = Some(stats);
                }
                self.clamp_depth();
            }
            Outcome::Done(Err(_)) | Outcome::Died => {}
        }
        self.counting = None;
    }

    /// Works out the figures of the shown structure, once a picture of it is on the screen.
    fn count(&mut self) {
        let Some(shown) = &self.shown else { return };
        let wanted = shown.stats.is_none() && self.counted.as_ref() != Some(&shown.key);
        if wanted && self.seen.as_ref() == Some(&shown.key) && !self.is_measuring() {
            self.counted = Some(shown.key.clone());
            self.counting = workers::count(&self.shared, shown).ok();
        }
    }

    /// Works out what is predicted of rays in the shown structure, once its figures are there.
    pub(super) fn predict(&mut self) {
        let Some(shown) = self.shown.as_ref().filter(|shown| self.awaits_prediction(shown)) else { return };
        if let (Some(stats), false) = (&shown.stats, self.is_measuring()) {
            self.predicted = Some(shown.key.clone());
            self.predicting = workers::predict(&self.shared, shown, Arc::clone(stats)).ok();
        }
    }

    /// Whether what is predicted of rays in the shown structure is yet to be asked for.
    pub fn awaits_prediction(&self, shown: &Built) -> bool {
        shown.quality.is_none() && self.predicted.as_ref() != Some(&shown.key)
    }

    pub(super) fn advance_prediction(&mut self) {
        let Some((key, job)) = &self.predicting else { return };
        match job.poll() {
            Outcome::Running => return,
            Outcome::Done(Ok(quality)) => {
                let quality = Arc::new(quality);
                self.kept.add_quality(key, &quality);
                if let Some(shown) = self.shown.as_mut().filter(|b| b.key == *key) {
                    shown.quality = Some(quality);
                }
            }
            Outcome::Done(Err(_)) | Outcome::Died => {}
        }
        self.predicting = None;
    }

    /// Which images the present picture needs: those that light asks for only where it is followed and there are some.
    fn wanted_detail(&self) -> Detail {
        let mapped = |material: &Material| material.has_surface_maps() || material.emission_texture.is_some();
        let has_some = |model: &Model| model.scene.materials.iter().any(mapped);
        let light = self.follows_light() && self.model.as_ref().is_some_and(has_some);
        if light { Detail::Light } else { Detail::Colors }
    }

    /// Decodes the scene's images once its first picture is on the screen.
    pub(super) fn advance_textures(&mut self) {
        match self.decoding.take() {
            Some((detail, job)) => match job.poll() {
                Outcome::Running => self.decoding = Some((detail, job)),
                Outcome::Done(Ok((looks, needs))) => {
                    if let Some(model) = &mut self.model {
                        (model.looks, model.needs) = (Arc::new(looks), needs.into());
                    }
                    self.textures = Some(detail);
                }
                Outcome::Done(Err(_)) | Outcome::Died => self.textures = Some(detail),
            },
            None => {
                let wanted = self.wanted_detail();
                // Those of light hold those of colours.
                let enough = self.textures == Some(Detail::Light) || self.textures == Some(wanted);
                if let (Some(model), false, true) = (&self.model, enough, self.seen.is_some())
                    && !model.scene.images.is_empty()
                    && !self.is_measuring()
                {
                    let job = workers::decode(&self.shared, Arc::clone(&model.scene), wanted).ok();
                    self.decoding = job.map(|job| (wanted, job));
                }
            }
        }
    }

    pub(super) fn advance_picking(&mut self) {
        let Some(job) = &self.picking else { return };
        match job.poll() {
            Outcome::Running => return,
            Outcome::Done(Ok(picked)) => {
                if picked != self.picked {
                    self.choices.leave(self.present_choices(), Kind::Single, Instant::now());
                }
                self.select(picked);
            }
            Outcome::Done(Err(_)) | Outcome::Died => {}
        }
        self.picking = None;
    }

    /// The SAH curves of what is selected.
    pub(super) fn advance_curves(&mut self) {
        match self.curving.take() {
            Some((id, job)) => match job.poll() {
                Outcome::Running => self.curving = Some((id, job)),
                Outcome::Done(Ok(curves)) => self.curves = Some((id, curves)),
                Outcome::Done(Err(_)) | Outcome::Died => self.curves = Some((id, None)),
            },
            None => {
                let selected = self.picked.as_ref().and_then(Picked::selected).copied();
                if let (Some(cell), Some(shown)) = (selected, &self.shown)
                    && self.curves.as_ref().is_none_or(|c| c.0 != cell.id)
                    && !self.is_measuring()
                {
                    let job = workers::curves(&self.shared, shown, cell);
                    self.curving = job.ok().map(|job| (cell.id, job));
                }
            }
        }
    }

    pub(super) fn advance_measuring(&mut self) {
        let Some(job) = &self.measuring else { return };
        match job.poll() {
            Outcome::Running => return,
            Outcome::Done(Ok(measured)) => {
                measured.built.iter().for_each(|built| self.kept.keep(built.clone()));
                if let Some(shown) = &self.shown {
                    let _ = self.kept.take_up(&shown.key);
                }
                self.timings.measured(&measured);
            }
            Outcome::Done(Err(_)) => {}
            Outcome::Died => self.fail("Can't measure: the measurement failed.".to_owned()),
        }
        self.measuring = None;
    }
}

/// A message with its full stop.
pub(super) fn sentence(text: &str) -> String {
    if text.ends_with(['.', '!', '?']) { text.to_owned() } else { format!("{text}.") }
}
