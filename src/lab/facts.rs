//! What a report says about the model and the machine.

use serde::Serialize;

use crate::scene::{Geometry, Scene};
use crate::sys;

/// The model in figures.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SceneFacts {
    /// What the user named.
    pub path: String,
    /// Triangles of all instances, dropped and degenerate ones counted.
    pub triangles: u64,
    /// Those with a vertex that is not finite.
    pub dropped: u64,
    /// Those of zero area, which structures do not hold.
    pub degenerate: u64,
    /// The size of the bounding box of the rest, in world units.
    pub extent: [f64; 3],
}

impl SceneFacts {
    /// Of a scene and what was made of it.
    pub fn of(scene: &Scene, geometry: &Geometry) -> Self {
        let bounds = geometry.world_bounds();
        let size = if bounds.is_empty() { glam::DVec3::ZERO } else { bounds.max.as_dvec3() - bounds.min.as_dvec3() };
        let counts = geometry.counts();
        Self {
            path: scene.name.clone(),
            triangles: counts.triangles,
            dropped: counts.dropped,
            degenerate: counts.degenerate,
            extent: size.to_array(),
        }
    }
}

/// The machine, and how much of it was used.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct MachineFacts {
    /// The processor's name.
    pub cpu: String,
    /// Cores that the process may use.
    pub cores: usize,
    /// Threads that traced and built.
    pub threads: usize,
}

impl MachineFacts {
    /// Of this machine, with work done on so many threads.
    pub fn here(threads: usize) -> Self {
        Self { cpu: sys::cpu_name(), cores: sys::cores(), threads }
    }
}
