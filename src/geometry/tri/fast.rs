//! Möller and Trumbore 1997, "Fast, Minimum Storage Ray/Triangle Intersection".

use super::plain::Plain;
use super::{Meets, Own, TestKind, TriHit, TriTest};
use crate::geometry::eight::{Points, Rays};
use crate::geometry::{Aabb, EightSlabs, Ray, Slabs};
use crate::simd::Simd;
use glam::Vec3;

/// Few operations. Rays through shared edges may slip through; boxes are widened all the same, since
/// a box taken as it is can cut the ray where it meets the triangle, and clamping t would move it far.
#[derive(Clone, Copy, Debug)]
pub struct Fast(Plain);

impl TriTest for Fast {
    const KIND: TestKind = TestKind::Fast;

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
        let (e1, e2) = (tri[1] - tri[0], tri[2] - tri[0]);
        let p = self.0.dir.cross(e2);
        let det = e1.dot(p);
        if det == 0.0 {
            return None;
        }
        let inv = 1.0 / det;
        let s = self.0.origin - tri[0];
        let u = s.dot(p) * inv;
        if !(0.0..=1.0).contains(&u) {
            return None;
        }
        let q = s.cross(e1);
        let v = self.0.dir.dot(q) * inv;
        if !(v >= 0.0 && u + v <= 1.0) {
            return None;
        }
        let t = e2.dot(q) * inv;
        t.is_finite().then_some(TriHit { t, u, v })
    }

    #[inline(always)]
    fn meet_eight<S: Simd>(s: S, own: &Own<S::F>, _: &EightSlabs<S::F>, [a, b, c]: &[Points<S::F>; 3]) -> Meets<S> {
        let &[ox, oy, oz, dx, dy, dz, _] = own;
        let (o, d) = (Points { x: ox, y: oy, z: oz }, Points { x: dx, y: dy, z: dz });
        let (e1, e2) = (b.minus(s, *a), c.minus(s, *a));
        let o = o.minus(s, *a);
        let (p, q) = (d.cross(s, e2), o.cross(s, e1));
        let (zero, one) = (s.splat(0.0), s.splat(1.0));
        // Where the determinant is zero, u is infinite or none.
        let inv = s.div(one, e1.dot(s, p));
        let u = s.mul(o.dot(s, p), inv);
        let v = s.mul(d.dot(s, q), inv);
        let t = s.mul(e2.dot(s, q), inv);
        let inside = s.and(s.and(s.le(zero, u), s.le(u, one)), s.and(s.le(zero, v), s.le(s.add(u, v), one)));
        Meets { met: inside, doubt: None, t, u, v }
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
