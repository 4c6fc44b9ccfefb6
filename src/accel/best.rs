//! The best hit so far of one ray: the rule for ties in one place.

use super::hit::{PrimHit, Query};
use super::probe::Probe;
use crate::geometry::tri::{TriHit, TriTest};
use crate::scene::PrimRef;
use glam::Vec3;

/// Starts as the end of the ray's interval, which no triangle holds.
#[derive(Clone, Copy, Debug)]
pub struct Best {
    hit: PrimHit,
    tmin: f32,
}

/// The triangle of no hit.
pub const NONE: PrimRef = PrimRef::MAX;

impl Best {
    /// Nothing found yet in `[tmin, tmax]`.
    #[inline(always)]
    pub const fn new(tmin: f32, tmax: f32) -> Self {
        Self { hit: PrimHit { t: tmax, u: 0.0, v: 0.0, prim: NONE }, tmin }
    }

    /// A hit found before; its t is that of the ray's end if it is none (see [`NONE`]).
    pub const fn with(tmin: f32, hit: PrimHit) -> Self {
        Self { hit, tmin }
    }

    /// Nothing beyond this t is of interest.
    #[inline(always)]
    pub const fn t(&self) -> f32 {
        self.hit.t
    }

    /// The start of the ray's interval.
    #[inline(always)]
    pub const fn tmin(&self) -> f32 {
        self.tmin
    }

    /// What was found.
    #[inline(always)]
    pub fn found(&self) -> Option<PrimHit> {
        (self.hit.prim != NONE).then_some(self.hit)
    }

    /// The triangle found; [`NONE`] so far.
    #[inline(always)]
    pub const fn prim(&self) -> PrimRef {
        self.hit.prim
    }

    /// Tests a triangle and keeps the hit if it is closer, or as close with a lower index. True if
    /// the search is over, which happens where [`Query::any`] hit will do.
    #[inline(always)]
    pub fn test<T: TriTest, Q: Query, P: Probe>(
        &mut self,
        ray: &T,
        tri: &[Vec3; 3],
        prim: PrimRef,
        query: &Q,
        probe: &mut P,
    ) -> bool {
        self.tested(ray.hit(tri, self.tmin, self.hit.t), prim, query, probe)
    }

    /// The same of a triangle that a look at eight left in doubt.
    #[inline(always)]
    pub fn test_in_doubt<T: TriTest, Q: Query, P: Probe>(
        &mut self,
        ray: &T,
        tri: &[Vec3; 3],
        prim: PrimRef,
        query: &Q,
        probe: &mut P,
    ) -> bool {
        self.tested(ray.hit_in_doubt(tri, self.tmin, self.hit.t), prim, query, probe)
    }

    #[inline(always)]
    fn tested<Q: Query, P: Probe>(&mut self, hit: Option<TriHit>, prim: PrimRef, query: &Q, probe: &mut P) -> bool {
        probe.prim();
        probe.tested(prim, hit.map(|hit| hit.t));
        hit.is_some_and(|hit| self.offer(PrimHit { t: hit.t, u: hit.u, v: hit.v, prim }, query))
    }

    /// Keeps a hit in the ray's interval if it is closer, or as close with a lower index. True if the
    /// search is over.
    #[inline(always)]
    pub fn offer<Q: Query>(&mut self, hit: PrimHit, query: &Q) -> bool {
        let closer = hit.t < self.hit.t || (hit.t == self.hit.t && hit.prim < self.hit.prim);
        if closer && query.accept(&hit) {
            self.hit = hit;
            return query.any();
        }
        false
    }
}
