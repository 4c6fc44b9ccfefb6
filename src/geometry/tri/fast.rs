//! Möller and Trumbore 1997, "Fast, Minimum Storage Ray/Triangle Intersection".

use super::block::{Block, Lanes, each, mask};
use super::{TestKind, TriHit, TriTest};
use crate::geometry::{Aabb, Ray, Slabs};
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
    fn may_meet(&self, block: &Block) -> u32 {
        let [a, b, c] = &block.corners;
        let d = self.dir;
        let e1 = [0, 1, 2].map(|k| each(|i| b[k][i] - a[k][i]));
        let e2 = [0, 1, 2].map(|k| each(|i| c[k][i] - a[k][i]));
        let s = [0, 1, 2].map(|k| each(|i| self.origin[k] - a[k][i]));
        let p = [(1, 2), (2, 0), (0, 1)].map(|(m, n)| each(|i| d[m] * e2[n][i] - e2[m][i] * d[n]));
        let q = [(1, 2), (2, 0), (0, 1)].map(|(m, n)| each(|i| s[m][i] * e1[n][i] - e1[m][i] * s[n][i]));
        let dot = |x: &[Lanes; 3], y: &[Lanes; 3]| each(|i| x[0][i] * y[0][i] + x[1][i] * y[1][i] + x[2][i] * y[2][i]);
        let inv = dot(&e1, &p).map(|det| 1.0 / det);
        let u = dot(&s, &p);
        let v = each(|i| d.x * q[0][i] + d.y * q[1][i] + d.z * q[2][i]);
        mask(|i| {
            let (u, v) = (u[i] * inv[i], v[i] * inv[i]);
            (0.0..=1.0).contains(&u) & (v >= 0.0) & (u + v <= 1.0)
        })
    }
}
