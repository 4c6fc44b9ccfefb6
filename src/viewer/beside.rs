//! A second structure that traces the same view: what its half of a split picture shows.

use std::sync::Arc;

use super::kept::Built;
use super::workers::Building;
use crate::accel::registry::Entry;
use crate::render::progressive::Pause;
use crate::render::{Picture, Renderer};

/// Everything of it.
pub struct Beside {
    /// The structure; none for one picture alone.
    pub chosen: Option<&'static Entry>,
    /// The same, once it is there.
    pub built: Option<Built>,
    /// Its build.
    pub building: Option<Building>,
    /// What traces it, from the first time on.
    pub renderer: Option<Renderer>,
    /// Its newest picture.
    pub picture: Option<Arc<Picture>>,
    /// Where the second picture begins, from 0 at the left to 1.
    pub divider: f32,
}

impl Default for Beside {
    fn default() -> Self {
        Self { chosen: None, built: None, building: None, renderer: None, picture: None, divider: 0.5 }
    }
}

impl Beside {
    /// Forgets the structure and its picture, not that one was chosen.
    pub fn clear(&mut self) {
        (self.built, self.building, self.picture) = (None, None, None);
        if let Some(renderer) = &self.renderer {
            renderer.clear();
        }
    }
}

/// Keeps all renderers from running.
pub struct Pauses(pub Vec<Pause>);

impl Pauses {
    /// Waits until all of them rest.
    pub fn wait(&self) {
        self.0.iter().for_each(Pause::wait);
    }
}
