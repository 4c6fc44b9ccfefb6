//! What a renderer is asked for: compared as a whole, so that it is asked anew whenever what is to be seen has changed.

use std::sync::Arc;

use super::State;
use crate::accel::{Accel, Visibility};
use crate::geometry::HalfSpace;
use crate::render::sampler::{SamplerKind, Sampling};
use crate::render::{self, HeatRays, Mode, Range, Request, Tone};
use crate::scene::Camera;
use crate::scene::texture::Detail;
use crate::task::Budget;
use crate::viewer::kept::Key;
use crate::viewer::model::Model;
use crate::viewer::panes::Pauses;

/// What the renderer was last asked for.
#[derive(Clone, PartialEq)]
pub(super) struct Asked {
    pub(super) number: u64,
    pub(super) key: Key,
    pub(super) model: u64,
    pub(super) camera: Camera,
    /// What of the world is left.
    pub(super) section: Option<HalfSpace>,
    /// Which triangles are seen.
    pub(super) visible: Option<Arc<Visibility>>,
    pub(super) mode: Mode,
    /// Whose work is shown, of heat maps.
    pub(super) heat_rays: HeatRays,
    pub(super) range: Option<Range>,
    pub(super) size_px: [u32; 2],
    pub(super) max_samples: u32,
    /// Which textures were there.
    pub(super) textured: Option<Detail>,
    /// The numbers that samples are made of.
    pub(super) sampler: SamplerKind,
    /// How light becomes colour.
    pub(super) tone: Tone,
    /// Whether light is kept on its way.
    pub(super) keeps: bool,
}

impl Asked {
    /// The same for a renderer, of a model through a structure; light is kept where there is a budget for it.
    pub(super) fn request(&self, model: &Model, accel: &Arc<dyn Accel>, keep: Option<Budget>) -> Request {
        let (scene, looks) = (Arc::clone(&model.scene), Arc::clone(&model.looks));
        let whole = render::Job::new(scene, Arc::clone(accel), self.camera, self.mode, looks);
        let (heat_rays, section, visible) = (self.heat_rays, self.section, self.visible.clone());
        let sampling = Sampling { kind: self.sampler, seed: 0 };
        let job = render::Job { sampling, heat_rays, section, visible, ..whole };
        let [width, height] = self.size_px;
        Request { job, width, height, max_samples: self.max_samples, range: self.range, tone: self.tone, keep }
    }
}

impl State {
    /// The present view as it is traced, of the whole model.
    pub(super) fn traced_view(&self, mode: Mode) -> Option<render::Job> {
        let (model, shown) = (self.model.as_ref()?, self.shown.as_ref()?);
        let (scene, accel) = (Arc::clone(&model.scene), Arc::clone(&shown.accel));
        Some(render::Job::new(scene, accel, self.camera, mode, Arc::clone(&model.looks)))
    }

    /// The same for those who measure on it, once all else rests; nothing while something else must not be disturbed.
    pub(super) fn begin_on_view(&mut self, mode: Mode) -> Option<(render::Job, Pauses)> {
        if self.is_measuring() || self.is_checking() || self.size_px.contains(&0) {
            return None;
        }
        let view = self.traced_view(mode)?;
        Some((view, self.begin_measuring()))
    }
}
