//! 64 bits throughout: what is left to be gained by more bits alone. For comparison; brute force has it.

use super::plain::Plain;
use super::{Meets, Own, TestKind, TriHit, TriTest};
use crate::geometry::eight::{Points, Rays};
use crate::geometry::num::narrow;
use crate::geometry::{Aabb, EightSlabs, Ray, Slabs};
use crate::simd::Simd;
use glam::Vec3;

/// The signs of `d.(B x C)`, `d.(C x A)`, `d.(A x B)` and the quotient of [`super::bounds`], in 64 bits, t rounded once to
/// 32. Neighbours work out a shared edge alike, so that slips are as rare as its errors are small; nothing forbids them.
#[derive(Clone, Copy, Debug)]
pub struct Double(Plain);

impl TriTest for Double {
    const KIND: TestKind = TestKind::Double;

    #[inline(always)]
    fn prepare(ray: &Ray, bounds: &Aabb) -> Self {
        Self(Plain::prepare(ray, bounds))
    }

    #[inline(always)]
    fn slabs(&self) -> &Slabs {
        &self.0.slabs
    }

    #[inline(always)]
    fn meet(&self, tri: &[Vec3; 3]) -> Option<TriHit> {
        let (o, d) = (self.0.origin.as_dvec3(), self.0.dir.as_dvec3());
        let (a, b, c) = (tri[0].as_dvec3() - o, tri[1].as_dvec3() - o, tri[2].as_dvec3() - o);
        let of_bc = b.cross(c);
        let (u, v, w) = (d.dot(of_bc), d.dot(c.cross(a)), d.dot(a.cross(b)));
        if (u < 0.0 || v < 0.0 || w < 0.0) && (u > 0.0 || v > 0.0 || w > 0.0) {
            return None;
        }
        let det = u + v + w;
        if det == 0.0 {
            return None;
        }
        let t = narrow(a.dot(of_bc) / det);
        t.is_finite().then(|| TriHit { t, u: narrow(v / det), v: narrow(w / det) })
    }

    /// Each is tested by itself.
    #[inline(always)]
    fn meet_eight<S: Simd>(s: S, _: &Own<S::F>, _: &EightSlabs<S::F>, _: &[Points<S::F>; 3]) -> Meets<S> {
        Meets::doubtful(s)
    }

    #[inline(always)]
    fn own(&self) -> Own<f32> {
        self.0.own()
    }

    #[inline(always)]
    fn own_of_eight<S: Simd>(s: S, rays: &Rays<S::F>) -> Own<S::F> {
        Plain::own_of_eight(s, rays)
    }

    #[inline(always)]
    fn from_own(own: &Own<f32>, slabs: Slabs) -> Self {
        Self(Plain::from_own(own, slabs))
    }
}
