//! The picture and the boxes over it: asked for anew whenever what is to be seen has changed.

use std::sync::Arc;
use std::time::Instant;

use super::{Answer, Asked, CHANGE_SHOWN, State};
use crate::job::Outcome;
use crate::render::{HeatRays, Picture};
use crate::viewer::gpu::Overlay;
use crate::viewer::overlay::{Known, Wanted};
use crate::viewer::pick::Picked;
use crate::viewer::settings::BoxColor;
use crate::viewer::{format, workers};

impl State {
    /// The first view of a model is framed anew when the viewport changes before the camera does.
    pub(super) fn follow_viewport(&mut self) {
        let (Some((camera, size_px)), Some(model)) = (self.framed, &self.model) else { return };
        if camera != self.camera {
            self.framed = None;
        } else if size_px != self.size_px {
            self.camera = model.scene.first_camera(model.geometry.world_bounds(), self.aspect());
            self.framed = Some((self.camera, self.size_px));
        }
    }

    /// Asks for a picture if what is to be seen has changed, and takes the newest.
    pub(super) fn refresh_picture(&mut self) {
        let (Some(model), Some(shown)) = (&self.model, &self.shown) else { return };
        let number = self.requested.as_ref().map_or(0, |a| a.number);
        let mode = self.settings.mode;
        let asked = Asked {
            number,
            key: shown.key.clone(),
            model: self.models,
            camera: self.camera,
            section: self.section(),
            visible: self.visible().cloned(),
            mode,
            // Of other pictures it changes nothing.
            heat_rays: if mode.is_heat() { self.settings.heat_rays } else { HeatRays::default() },
            range: self.range_of(mode),
            size_px: self.size_px,
            max_samples: self.settings.max_samples,
            textured: self.textures,
            sampler: self.settings.sampler,
            tone: self.settings.tone,
            keeps: self.has_curves(),
        };
        if self.requested.as_ref() != Some(&asked) && !self.size_px.contains(&0) {
            let keep = asked.keeps.then(|| self.shared.budget.clone());
            let number = self.renderer.request(asked.request(model, &shown.accel, keep));
            self.follow_errors(&asked);
            self.requested = Some(Asked { number, ..asked });
            self.requested_at = Instant::now();
            self.renderer.wait_for(number, self.graphics.patience());
        }
        if let Some(picture) = self.renderer.picture() {
            self.say_what_changed(&picture);
            self.answered(&picture);
            self.picture = Some(picture);
        }
    }

    /// Takes note of the first picture of the present request.
    fn answered(&mut self, picture: &Picture) {
        let Some(asked) = self.requested.as_ref().filter(|a| a.number == picture.request) else { return };
        if self.answer.is_none_or(|a| a.request != asked.number) {
            let secs = self.requested_at.elapsed().as_secs_f64();
            self.answer = Some(Answer { request: asked.number, secs, step: picture.progress.step });
            self.seen = Some(asked.key.clone());
        }
    }

    /// The structure on the screen, and what a ray visits in it, if its picture is there.
    pub(super) fn nodes_per_ray(&self) -> Option<(&'static str, f64)> {
        let (shown, asked, picture) = (self.shown.as_ref()?, self.requested.as_ref()?, self.picture.as_ref()?);
        let counted = picture.progress.counted;
        let its = asked.key == shown.key && asked.number == picture.request && counted > 0;
        its.then(|| (shown.key.entry.name, picture.progress.counts.nodes as f64 / counted as f64))
    }

    /// `k-d tree: 38.1 nodes/ray (BVH: 21.4)`, since the pictures are equal.
    fn say_what_changed(&mut self, picture: &Picture) {
        let counted = picture.progress.counted > 0 && self.requested.as_ref().is_some_and(|a| a.number == picture.request);
        if counted
            && let Some((before, nodes_before)) = self.before.take()
            && let Some(shown) = &self.shown
        {
            let nodes = picture.progress.counts.nodes as f64 / picture.progress.counted as f64;
            let number = format::number;
            let text = format!("{}: {} nodes/ray ({before}: {})", shown.key.entry.name, number(nodes), number(nodes_before));
            self.change = Some((text, Instant::now() + CHANGE_SHOWN));
        }
    }

    /// Takes finished boxes, and starts collecting if the view or the settings have changed since.
    pub(super) fn refresh_overlay(&mut self) {
        if let Some((wanted, key, job)) = self.collecting.take() {
            match job.poll() {
                Outcome::Running => self.collecting = Some((wanted, key, job)),
                Outcome::Done(Ok(mut collected)) => {
                    self.generation += 1;
                    let overlay = std::mem::take(&mut collected.overlay);
                    let overlay = self.lit(Overlay { generation: self.generation, ..overlay });
                    self.overlay = Some(Arc::new(overlay));
                    self.collected = collected;
                    self.collected_for = Some((wanted, key));
                    if self.is_comparing() {
                        (self.shared.wake)(); // colours of those beside may go over another range now
                    }
                }
                Outcome::Done(Err(_)) | Outcome::Died => self.collected_for = Some((wanted, key)),
            }
        }
        let (Some(shown), Some(view)) = (&self.shown, self.view()) else { return };
        let settings = self.settings.overlay.of_content();
        let selected = self.picked.as_ref().and_then(Picked::selected).copied();
        let (needs_rows, outline) = (settings.subtree_only || settings.color.needs_rows(), self.tree.outline.clone());
        let visits = self.visiting.newest().filter(|_| settings.color == BoxColor::Visits);
        let film = self.film_on_screen().map(|(film, at)| (Arc::clone(film), at));
        let subtree_only = settings.subtree_only && film.is_none();
        let top = selected.zip(self.tree.selected).filter(|_| subtree_only && self.tree.selecting.is_none());
        let wanted = Wanted {
            settings,
            view,
            size_px: self.size_px,
            limit: self.graphics.comfortable_boxes(),
            // A row whose cell is on its way is not that of the selected cell.
            top,
            root: top.and_then(|_| self.picked.as_ref()?.lower_root()),
            numbered: needs_rows && outline.is_some(),
            counted: visits.as_ref().map(|(number, _)| *number),
            film_at: film.as_ref().map(|film| film.1),
            range: self.range_of_boxes(None),
        };
        let current = self.collected_for.as_ref().is_some_and(|(w, k)| *w == wanted && *k == shown.key);
        self.overlay_is_current = current;
        let seen = self.seen.as_ref() == Some(&shown.key);
        if current || !seen || self.collecting.is_some() || self.is_measuring() {
            return;
        }
        let known = Known { outline, visits: visits.map(|(_, visits)| visits), film: film.map(|film| film.0) };
        if let Ok(job) = workers::collect(&self.shared, Arc::clone(&shown.accel), known, wanted.clone()) {
            self.collecting = Some((wanted, shown.key.clone(), job));
        }
    }
}
