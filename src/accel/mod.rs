//! Acceleration structures.
//!
//! A structure is one folder and one line in [`registry`]: the plain data and its traversal in one
//! file, each builder in its own. It implements [`Structure`] (how a ray is traced) and [`Cells`]
//! (how its cells are walked); the blanket implementation below makes it an [`Accel`], which the
//! renderer, the command line, the tests and the reports use without knowing what it is.

mod best;
mod brute;
mod bsp;
mod build;
mod bvh;
pub mod cell;
pub mod epo;
mod grid;
mod hit;
mod instanced;
mod kdtree;
mod loose;
mod octree;
pub mod outline;
pub mod params;
pub mod probe;
pub mod registry;
pub mod stats;
pub mod validate;
pub mod visibility;
pub mod volumes;
mod wide;
pub mod would_fit;

pub use build::{BuildCx, BuildError, Fit, Fits};
pub use bvh::{ID as BVH, Moved, Recorded, Round, recorded as record_reinsertion};
pub use cell::{Cell, CellId, CellKind, Cells, Form, Level, MemoryPart, Shape, Split};
pub use hit::{Accepts, AnyHit, Asked, Closest, Filter, Filtered, Hit, Mode, PrimHit, Query};
pub use instanced::Instanced;
pub use probe::{Prune, Step};
pub use visibility::Visibility;

use std::sync::Arc;

use crate::geometry::Ray;
use crate::scene::Geometry;
use crate::task::{Cancel, Cancelled};
use probe::{Counts, Off, Probe, Watched};

/// How a ray is traced. Rays are in the scaled space of [`Geometry::space`] and valid.
pub trait Structure: Cells + Sized + 'static {
    /// What it was built over.
    fn geometry(&self) -> &Arc<Geometry>;

    /// Traces one ray: the closest accepted hit in the closed `[tmin, tmax]`, ties in t going to
    /// the lowest primitive; any accepted hit where that will do.
    fn trace_one<Q: Query, P: Probe>(&self, ray: &Ray, query: &Q, probe: &mut P) -> Option<PrimHit>;

    /// The same for a ray that may be given up. The default looks at `cancel` once; a structure for which one ray can
    /// take long looks more often.
    #[inline]
    fn trace_stoppable<Q: Query, P: Probe>(
        &self,
        ray: &Ray,
        query: &Q,
        probe: &mut P,
        cancel: &Cancel,
    ) -> Result<Option<PrimHit>, Cancelled> {
        cancel.check()?;
        Ok(self.trace_one(ray, query, probe))
    }

    /// The same with nobody who watches, as a function of its own: all that traces rays one by one shares it.
    #[inline(never)]
    fn trace_alone<Q: Query>(&self, ray: &Ray, query: &Q, mut off: Off, cancel: &Cancel) -> Result<Option<PrimHit>, Cancelled> {
        self.trace_stoppable(ray, query, &mut off, cancel)
    }

    /// Traces world rays into `hits` of the same length. The default traces them one by one.
    fn trace_batch<Q: Query>(
        &self,
        rays: &[Ray],
        query: &Q,
        hits: &mut [Option<Hit>],
        cancel: &Cancel,
    ) -> Result<Traced, Cancelled> {
        let off = Off::best();
        one_by_one(self.geometry(), rays, hits, |ray| self.trace_alone(ray, query, off, cancel))
    }

    /// The same one ray at a time, without instructions that not every processor has: the terms on which
    /// structures are compared like for like.
    fn trace_plain<Q: Query>(
        &self,
        rays: &[Ray],
        query: &Q,
        hits: &mut [Option<Hit>],
        cancel: &Cancel,
    ) -> Result<Traced, Cancelled> {
        one_by_one(self.geometry(), rays, hits, |ray| self.trace_alone(ray, query, Off::plain(), cancel))
    }
}

/// What a batch has to say besides its hits.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Traced {
    /// Rays that are not valid (see [`Ray::is_valid`]): they miss.
    pub invalid: u64,
    /// Rays that were traced with seven neighbours as one, since they go the same way.
    pub in_beams: u64,
}

impl std::ops::Add for Traced {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self { invalid: self.invalid + other.invalid, in_beams: self.in_beams + other.in_beams }
    }
}

/// A built structure, whatever its kind.
pub trait Accel: Cells {
    /// What it was built over.
    fn geometry(&self) -> &Arc<Geometry>;

    /// Traces world rays into `hits`, which must be as long. In [`Mode::Any`] a hit is any one in
    /// the ray's interval.
    ///
    /// # Errors
    /// [`Cancelled`], within 100 ms of the request; some hits are then not written.
    fn trace(&self, rays: &[Ray], mode: Mode, hits: &mut [Option<Hit>], cancel: &Cancel) -> Result<Traced, Cancelled>;

    /// The same where only those hits count that a filter accepts: one ray at a time.
    ///
    /// # Errors
    /// As [`Self::trace`].
    fn trace_filtered(
        &self,
        rays: &[Ray],
        mode: Mode,
        filter: &dyn Filter,
        hits: &mut [Option<Hit>],
        cancel: &Cancel,
    ) -> Result<Traced, Cancelled> {
        let geometry = self.geometry();
        let accepts = |hit: &PrimHit| {
            let (instance, primitive) = geometry.locate(hit.prim);
            filter.accepts(&Hit { t: hit.t, u: hit.u, v: hit.v, instance, primitive })
        };
        one_by_one(geometry, rays, hits, |ray| self.trace_scaled_filtered(ray, mode, &accepts, cancel))
    }

    /// The same hits as those of [`Self::trace`], found one ray at a time and without instructions that not every processor has.
    ///
    /// # Errors
    /// As [`Self::trace`].
    fn trace_like_for_like(
        &self,
        rays: &[Ray],
        mode: Mode,
        hits: &mut [Option<Hit>],
        cancel: &Cancel,
    ) -> Result<Traced, Cancelled>;

    /// Traces one world ray and counts what the traversal does; a listener hears every step. The
    /// hit is the same.
    ///
    /// # Errors
    /// [`Cancelled`], within milliseconds of the request; the counts are then those of a part of the
    /// ray.
    fn trace_heard(&self, ray: &Ray, mode: Mode, watched: &mut Watched<'_>, cancel: &Cancel) -> Result<Option<Hit>, Cancelled> {
        let local = |ray: &Ray| self.trace_scaled_heard(ray, Asked::Mode(mode), watched, cancel);
        in_scaled_space(self.geometry(), ray, &mut Traced::default(), local)
    }

    /// The same with nobody who listens.
    ///
    /// # Errors
    /// As [`Self::trace_heard`].
    fn trace_watched(&self, ray: &Ray, mode: Mode, counts: &mut Counts, cancel: &Cancel) -> Result<Option<Hit>, Cancelled> {
        self.trace_heard(ray, mode, &mut Watched { counts, listener: None }, cancel)
    }

    /// Follows one world ray to its end, no hit cutting it short, and counts what the traversal does:
    /// what [`stats::Stats::expected_nodes`] predicts of random lines.
    ///
    /// # Errors
    /// As [`Self::trace_heard`].
    fn count_uncut(&self, ray: &Ray, counts: &mut Counts, cancel: &Cancel) -> Result<(), Cancelled> {
        let mut watched = Watched { counts, listener: None };
        let local = |ray: &Ray| self.trace_scaled_heard(ray, Asked::Nothing, &mut watched, cancel);
        in_scaled_space(self.geometry(), ray, &mut Traced::default(), local).map(|_| ()) // there is no hit
    }

    /// Traces one ray that is in the scaled space already: how an upper level asks a lower one, which has no other below it.
    ///
    /// # Errors
    /// As [`Self::trace`].
    fn trace_scaled(&self, ray: &Ray, mode: Mode, off: Off, cancel: &Cancel) -> Result<Option<PrimHit>, Cancelled>;

    /// The same where only some hits count.
    ///
    /// # Errors
    /// As [`Self::trace`].
    fn trace_scaled_filtered(
        &self,
        ray: &Ray,
        mode: Mode,
        accepts: Accepts<'_>,
        cancel: &Cancel,
    ) -> Result<Option<PrimHit>, Cancelled>;

    /// The same as [`Self::trace_scaled`], watched.
    ///
    /// # Errors
    /// As [`Self::trace_heard`].
    fn trace_scaled_heard(
        &self,
        ray: &Ray,
        asked: Asked,
        watched: &mut Watched<'_>,
        cancel: &Cancel,
    ) -> Result<Option<PrimHit>, Cancelled>;

    /// What the cells of an instance are built over (see [`CellId`]): the references that they hold are its.
    fn geometry_of(&self, instance: u32) -> &Arc<Geometry> {
        let _ = instance;
        self.geometry()
    }

    /// Its two levels, if it has them.
    fn levels(&self) -> Option<&Instanced> {
        None
    }
}

impl<S: Structure> Accel for S {
    fn geometry(&self) -> &Arc<Geometry> {
        Structure::geometry(self)
    }

    fn trace(&self, rays: &[Ray], mode: Mode, hits: &mut [Option<Hit>], cancel: &Cancel) -> Result<Traced, Cancelled> {
        debug_assert_eq!(rays.len(), hits.len());
        match mode {
            Mode::Closest => self.trace_batch(rays, &Closest, hits, cancel),
            Mode::Any => self.trace_batch(rays, &AnyHit, hits, cancel),
        }
    }

    fn trace_like_for_like(
        &self,
        rays: &[Ray],
        mode: Mode,
        hits: &mut [Option<Hit>],
        cancel: &Cancel,
    ) -> Result<Traced, Cancelled> {
        match mode {
            Mode::Closest => self.trace_plain(rays, &Closest, hits, cancel),
            Mode::Any => self.trace_plain(rays, &AnyHit, hits, cancel),
        }
    }

    fn trace_scaled(&self, ray: &Ray, mode: Mode, off: Off, cancel: &Cancel) -> Result<Option<PrimHit>, Cancelled> {
        match mode {
            Mode::Closest => self.trace_alone(ray, &Closest, off, cancel),
            Mode::Any => self.trace_alone(ray, &AnyHit, off, cancel),
        }
    }

    fn trace_scaled_filtered(
        &self,
        ray: &Ray,
        mode: Mode,
        accepts: Accepts<'_>,
        cancel: &Cancel,
    ) -> Result<Option<PrimHit>, Cancelled> {
        self.trace_alone(ray, &Filtered { mode, accepts }, Off::best(), cancel)
    }

    fn trace_scaled_heard(
        &self,
        ray: &Ray,
        asked: Asked,
        watched: &mut Watched<'_>,
        cancel: &Cancel,
    ) -> Result<Option<PrimHit>, Cancelled> {
        self.trace_stoppable(ray, &asked, watched, cancel)
    }
}

/// Traces world rays one after another.
#[inline(always)]
fn one_by_one(
    geometry: &Geometry,
    rays: &[Ray],
    hits: &mut [Option<Hit>],
    mut trace: impl FnMut(&Ray) -> Result<Option<PrimHit>, Cancelled>,
) -> Result<Traced, Cancelled> {
    let mut traced = Traced::default();
    for (ray, hit) in rays.iter().zip(hits) {
        *hit = in_scaled_space(geometry, ray, &mut traced, &mut trace)?;
    }
    Ok(traced)
}

/// Brings a world ray into the scaled space, traces it there, and brings the hit back.
#[inline(always)]
fn in_scaled_space(
    geometry: &Geometry,
    ray: &Ray,
    traced: &mut Traced,
    trace: impl FnOnce(&Ray) -> Result<Option<PrimHit>, Cancelled>,
) -> Result<Option<Hit>, Cancelled> {
    if !ray.is_valid() {
        traced.invalid += 1;
        return Ok(None);
    }
    let entered = geometry.space().enter(ray);
    // A segment that ends before the scene, or rounds away, holds nothing.
    if entered.ray.tmin > entered.ray.tmax {
        return Ok(None);
    }
    Ok(trace(&entered.ray)?.map(|hit| {
        let (instance, primitive) = geometry.locate(hit.prim);
        Hit { t: entered.back.world_t(hit.t), u: hit.u, v: hit.v, instance, primitive }
    }))
}
