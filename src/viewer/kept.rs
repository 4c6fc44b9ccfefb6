//! Structures that were built and are kept, so that going back to one costs nothing.

use std::sync::Arc;

use crate::accel::params::ParamValues;
use crate::accel::registry::Entry;
use crate::accel::stats::Stats;
use crate::accel::{Accel, MemoryPart};
use crate::geometry::tri::TestKind;
use crate::lab::Quality;
use crate::task::Phase;

/// What a structure was built from, besides the scene.
#[derive(Clone, Debug)]
pub struct Key {
    /// Which structure.
    pub entry: &'static Entry,
    /// With what parameters.
    pub params: ParamValues,
    /// With which triangle test.
    pub test: TestKind,
}

impl PartialEq for Key {
    fn eq(&self, other: &Self) -> bool {
        self.entry.id == other.entry.id && self.params == other.params && self.test == other.test
    }
}

/// A structure, and what is known of it.
#[derive(Clone)]
pub struct Built {
    /// What it was built from.
    pub key: Key,
    /// The structure.
    pub accel: Arc<dyn Accel>,
    /// Wall-clock seconds of the build.
    pub build_secs: f64,
    /// The same by phase.
    pub phases: Vec<Phase>,
    /// Figures, once they are worked out.
    pub stats: Option<Arc<Stats>>,
    /// What is predicted of rays, once somebody looked at it.
    pub quality: Option<Arc<Quality>>,
}

impl Built {
    /// What its memory is made of.
    pub fn memory(&self) -> Vec<MemoryPart> {
        self.stats.as_ref().map_or_else(|| self.accel.memory(), |stats| stats.memory.clone())
    }

    /// Bytes of all of it.
    pub fn bytes(&self) -> u64 {
        self.memory().iter().map(|part| part.bytes).sum()
    }
}

impl std::fmt::Debug for Built {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Built").field("id", &self.key.entry.id).finish_non_exhaustive()
    }
}

/// The kept structures, the last used at the end.
#[derive(Debug, Default)]
pub struct Kept(Vec<Built>);

impl Kept {
    /// All of them, the last used first.
    pub fn iter(&self) -> impl Iterator<Item = &Built> {
        self.0.iter().rev()
    }

    /// The structure of that key, which counts as used.
    pub fn take_up(&mut self, key: &Key) -> Option<Built> {
        let at = self.0.iter().position(|b| b.key == *key)?;
        let built = self.0.remove(at);
        self.0.push(built.clone());
        Some(built)
    }

    /// Keeps a structure, as the last used.
    pub fn keep(&mut self, mut built: Built) {
        // What is known of it stays known.
        if let Some(before) = self.0.iter().find(|b| b.key == built.key) {
            built.stats = built.stats.or_else(|| before.stats.clone());
            built.quality = built.quality.or_else(|| before.quality.clone());
        }
        self.0.retain(|b| b.key != built.key);
        self.0.push(built);
    }

    /// Adds the figures of a structure.
    pub fn add_stats(&mut self, key: &Key, stats: &Arc<Stats>) {
        self.0.iter_mut().filter(|b| b.key == *key).for_each(|b| b.stats = Some(Arc::clone(stats)));
    }

    /// Adds what is predicted of rays in a structure.
    pub fn add_quality(&mut self, key: &Key, quality: &Arc<Quality>) {
        self.0.iter_mut().filter(|b| b.key == *key).for_each(|b| b.quality = Some(Arc::clone(quality)));
    }

    /// Takes out the least recently used of those that are not in use, if there is one.
    pub fn take_oldest(&mut self, in_use: &[Key]) -> Option<Built> {
        let at = self.0.iter().position(|b| !in_use.contains(&b.key))?;
        Some(self.0.remove(at))
    }
}
