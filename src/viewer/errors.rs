//! What the Compare workspace knows of the picture's error: a curve for each structure that has shown the present view, the
//! reference, and the picture of a point that was clicked.

use std::sync::Arc;

use super::kept::Key;
use super::workers::{Developing, Erring, Referring};
use crate::geometry::HalfSpace;
use crate::lab::ImageErrors;
use crate::lab::converge::{REFERENCE_FACTOR, Reference};
use crate::render::sampler::SamplerKind;
use crate::render::{Picture, Shot};
use crate::scene::Camera;
use crate::scene::texture::Detail;

/// What curves are of.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View {
    /// The number of the open model.
    pub model: u64,
    /// Which of its textures were there.
    pub textured: Option<Detail>,
    /// From where it is seen.
    pub camera: Camera,
    /// What of the world is left.
    pub section: Option<HalfSpace>,
    /// The number of what says which triangles are seen.
    pub visible: Option<u64>,
    /// Columns and rows.
    pub size_px: [u32; 2],
    /// What samples are made of.
    pub sampler: SamplerKind,
}

/// Everything of it.
#[derive(Default)]
pub struct Errors {
    /// What the curves are of.
    pub view: Option<View>,
    /// One for each structure, in the order in which they were shown.
    pub curves: Vec<Live>,
    /// What errors are measured against.
    pub reference: Option<Arc<Reference>>,
    /// A reference of so many samples, on its way.
    pub making: Option<(u32, Referring)>,
    /// The point that was clicked.
    pub chosen: Option<Chosen>,
    /// Its picture, once it is developed.
    pub picture: Option<Arc<Picture>>,
    /// That, on its way.
    pub developing: Option<Developing>,
    /// Errors on their way.
    pub erring: Option<Erring>,
    /// Whether figures stand in a table instead of a plot.
    pub as_table: bool,
}

/// The curve of a structure.
pub struct Live {
    /// Which one.
    pub key: Key,
    /// Seconds that it took to build.
    pub build_secs: f64,
    /// What was kept of its pictures, the fewest samples first.
    pub shots: Vec<Arc<Shot>>,
    /// Their errors, as far as they are known.
    pub errors: Vec<Option<ImageErrors>>,
}

/// A point of a curve.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Chosen {
    /// Which curve.
    pub curve: usize,
    /// Which of its points was clicked.
    pub point: usize,
    /// Which one's picture is shown: the same, or the nearest whose light was kept.
    pub kept: usize,
    /// Whether its difference from the reference is shown.
    pub difference: bool,
}

/// What is known of a point's error.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Known {
    /// RMSE against the reference.
    Error {
        /// It.
        rmse: f64,
        /// Whether the reference is too noisy to say so.
        hollow: bool,
    },
    /// Estimated from the samples alone.
    Noise(f64),
}

impl Known {
    /// The figure.
    pub const fn value(self) -> f64 {
        match self {
            Self::Error { rmse, .. } => rmse,
            Self::Noise(noise) => noise,
        }
    }
}

impl Errors {
    /// What is known of a point: against the reference if there is one, and else an estimate.
    pub fn known(&self, curve: usize, point: usize) -> Option<Known> {
        let live = self.curves.get(curve)?;
        if let Some(reference) = &self.reference {
            let rmse = live.errors.get(point).copied().flatten()?.rmse;
            return Some(Known::Error { rmse, hollow: reference.is_hollow(rmse) });
        }
        live.shots.get(point)?.noise.map(Known::Noise)
    }

    /// The most samples that any point has.
    pub fn most_samples(&self) -> u32 {
        self.curves.iter().filter_map(|live| live.shots.last()).map(|shot| shot.samples).max().unwrap_or(0)
    }

    /// Samples that a reference for all of them has, and about how many seconds it takes.
    pub fn wanted_reference(&self) -> Option<(u32, f64)> {
        let spp = self.most_samples().checked_mul(REFERENCE_FACTOR).filter(|spp| *spp > 0)?;
        let last = self.curves.iter().filter_map(|live| live.shots.last()).max_by_key(|shot| shot.samples)?;
        Some((spp, last.secs / f64::from(last.samples) * f64::from(spp)))
    }

    /// The point of a curve whose light was kept that is nearest to one: in samples, the one of fewer where two are as near.
    pub fn nearest_kept(&self, curve: usize, point: usize) -> Option<usize> {
        let shots = &self.curves.get(curve)?.shots;
        let kept = (0..shots.len()).filter(|i| shots[*i].light.is_some());
        kept.min_by_key(|i| (i.abs_diff(point), *i))
    }

    /// Takes in what a structure has kept of the present view.
    pub fn take(&mut self, key: &Key, build_secs: f64, shots: &[Arc<Shot>]) {
        let at = self.curves.iter().position(|live| live.key == *key);
        let live = match at {
            Some(at) => &mut self.curves[at],
            None if shots.is_empty() => return,
            None => {
                self.curves.push(Live { key: key.clone(), build_secs, shots: Vec::new(), errors: Vec::new() });
                let last = self.curves.len() - 1;
                &mut self.curves[last]
            }
        };
        // One that begins anew keeps what it had until it is as far.
        if shots.len() > live.shots.len() {
            live.shots = shots.to_vec();
            live.errors.resize(shots.len(), None);
        }
    }
}
