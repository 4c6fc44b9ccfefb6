//! Two levels: one structure for each mesh that stands in several places, and a BVH over the places.
//!
//! A scene has two levels if [`Geometry::placed`] says so; then every structure becomes this, with the chosen kind
//! below. What stands in one place only was flattened, and is one more entry of the upper level:
//!
//! ```text
//! top ─┬─ place 0 ─┐
//!      ├─ place 1 ─┴─► the structure of mesh 0      a ray is taken into the mesh's space
//!      ├─ place 2 ───► the structure of mesh 1
//!      └─ the rest ──► the structure of what was flattened
//! ```
//!
//! With `brute` below every place is visited, whatever the ray: what the others are checked against.

mod cells;
mod statistics;
mod top;
mod trace;

use std::sync::Arc;

use super::params::ParamValues;
use super::registry::Entry;
use super::{Accel, BuildCx, BuildError};
use crate::geometry::tri::TestKind;
use crate::scene::{Geometry, Place, Placed};
use crate::task::Progress;
use rayon::prelude::*;
use top::Top;

/// A structure of two levels.
pub struct Instanced {
    /// Holds [`Placed`].
    geometry: Arc<Geometry>,
    top: Top,
    /// One for each mesh.
    parts: Vec<Box<dyn Accel>>,
    /// Over what was flattened, if anything was.
    rest: Option<Box<dyn Accel>>,
}

impl std::fmt::Debug for Instanced {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Instanced").field("parts", &self.parts.len()).finish_non_exhaustive()
    }
}

/// An entry of the upper level.
#[derive(Clone, Copy)]
enum Below<'a> {
    /// A mesh in one of its places.
    Part(&'a Place, &'a dyn Accel),
    /// What was flattened.
    Rest(&'a dyn Accel),
}

impl<'a> Below<'a> {
    const fn accel(self) -> &'a dyn Accel {
        match self {
            Self::Part(_, accel) | Self::Rest(accel) => accel,
        }
    }
}

impl Instanced {
    /// Builds the lower structures, each once, and the upper level.
    ///
    /// # Errors
    /// Those of the structure.
    pub fn build(
        entry: &Entry,
        geometry: &Arc<Geometry>,
        placed: &Placed,
        test: TestKind,
        p: &ParamValues,
        cx: &BuildCx,
    ) -> Result<Self, BuildError> {
        let rest = (geometry.live_count() > 0).then(|| entry.build_flat(geometry, test, p, cx)).transpose()?;
        let top = Top::build(geometry, placed, rest.is_some(), entry.id == BRUTE, cx)?;
        cx.progress.start("meshes", placed.parts().len() as u64);
        let part = |part: &Arc<Geometry>| {
            // How far each is nobody could follow.
            let built = entry.build_flat(part, test, p, &BuildCx { progress: Progress::new(), ..cx.clone() });
            cx.progress.advance(1);
            built
        };
        let parts: Result<Vec<_>, _> = cx.pool.run(|| placed.parts().par_iter().map(part).collect());
        Ok(Self { geometry: Arc::clone(geometry), top, parts: parts?, rest })
    }

    /// The structures of the meshes, in the order of [`Placed::parts`].
    pub fn parts(&self) -> &[Box<dyn Accel>] {
        &self.parts
    }

    /// The structure over what was flattened, if anything was.
    pub fn rest(&self) -> Option<&dyn Accel> {
        self.rest.as_deref()
    }

    /// What the cells of an instance are built over (see [`crate::accel::CellId`]).
    fn geometry_below(&self, instance: u32) -> &Arc<Geometry> {
        match instance.checked_sub(1).and_then(|entry| self.below(entry)) {
            Some(Below::Part(_, accel)) => accel.geometry(),
            _ => &self.geometry,
        }
    }

    fn places(&self) -> &[Place] {
        self.geometry.placed().map_or(&[], Placed::places)
    }

    /// The entry of that number: the places in their order, then the rest.
    fn below(&self, number: u32) -> Option<Below<'_>> {
        match self.places().get(number as usize) {
            Some(place) => Some(Below::Part(place, &*self.parts[place.part as usize])),
            None => self.rest().map(Below::Rest),
        }
    }
}

/// The structure that looks at everything.
const BRUTE: &str = "brute";
