//! Möller and Trumbore 1997, "Fast, Minimum Storage Ray/Triangle Intersection".

use super::block::Points;
use super::{Eight, TestKind, TriHit, TriTest};
use crate::geometry::{Aabb, Ray, Slabs};
use crate::simd::Simd;
use glam::Vec3;

/// Few operations. Rays through shared edges may slip through; boxes are widened all the same, since
/// a box taken as it is can cut the ray where it meets the triangle, and clamping t would move it far.
#[derive(Clone, Copy, Debug)]
pub struct Fast {
    origin: Vec3,
    dir: Vec3,
    slabs: Slabs,
}

impl TriTest for Fast {
    const KIND: TestKind = TestKind::Fast;

    #[inline(always)]
    fn prepare(ray: &Ray, bounds: &Aabb) -> Self {
        Self { origin: ray.origin, dir: ray.dir, slabs: Slabs::new(ray, bounds) }
    }

    #[inline(always)]
    fn slabs(&self) -> &Slabs {
        &self.slabs
    }

    #[inline(always)]
    fn meet(&self, tri: &[Vec3; 3]) -> Option<TriHit> {
        let (e1, e2) = (tri[1] - tri[0], tri[2] - tri[0]);
        let p = self.dir.cross(e2);
        let det = e1.dot(p);
        if det == 0.0 {
            return None;
        }
        let inv = 1.0 / det;
        let s = self.origin - tri[0];
        let u = s.dot(p) * inv;
        if !(0.0..=1.0).contains(&u) {
            return None;
        }
        let q = s.cross(e1);
        let v = self.dir.dot(q) * inv;
        if !(v >= 0.0 && u + v <= 1.0) {
            return None;
        }
        let t = e2.dot(q) * inv;
        t.is_finite().then_some(TriHit { t, u, v })
    }

    #[inline(always)]
    fn may_meet<S: Simd>(&self, s: S, triangles: &impl Eight) -> u32 {
        let d = Points::splat(s, self.dir);
        let a = Points::corner(s, triangles, 0);
        let e1 = Points::corner(s, triangles, 1).minus(s, a);
        let e2 = Points::corner(s, triangles, 2).minus(s, a);
        let o = Points::splat(s, self.origin).minus(s, a);
        let (p, q) = (d.cross(s, e2), o.cross(s, e1));
        let (zero, one) = (s.splat(0.0), s.splat(1.0));
        let inv = s.div(one, e1.dot(s, p));
        let u = s.mul(o.dot(s, p), inv);
        let v = s.mul(d.dot(s, q), inv);
        s.bits(s.and(s.and(s.le(zero, u), s.le(u, one)), s.and(s.le(zero, v), s.le(s.add(u, v), one))))
    }
}
