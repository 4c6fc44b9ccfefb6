//! Woop, Benthin and Wald 2013, "Watertight Ray/Triangle Intersection" (JCGT 2:1).

use super::{Eight, TestKind, TriHit, TriTest};
use crate::geometry::num::narrow;
use crate::geometry::{Aabb, Ray, Slabs};
use crate::simd::Simd;
use glam::Vec3;

/// The triangle is moved and sheared so that the ray becomes the z axis; then the signs of three
/// planar edge functions decide. An edge shared by two triangles gives both the same two products,
/// with opposite signs, so no ray passes between them. No fused operations anywhere: a fused
/// `a*b - c*d` is not antisymmetric.
///
/// A nonzero `a*b - c*d` in 32 bits has the right sign, since rounding is monotone; only a zero
/// is in doubt, and then all three edges are worked out again in 64 bits, where products of
/// 32-bit numbers are exact.
#[derive(Clone, Copy, Debug)]
pub struct Watertight {
    origin: Vec3,
    /// The axis of the greatest direction component becomes z; x and y swap to keep the winding.
    axes: [usize; 3],
    /// `x -= sx * z`, `y -= sy * z`, `z *= sz`.
    shear: Vec3,
    slabs: Slabs,
}

impl TriTest for Watertight {
    const KIND: TestKind = TestKind::Watertight;

    #[inline(always)]
    fn prepare(ray: &Ray, bounds: &Aabb) -> Self {
        let d = ray.dir;
        let a = d.abs();
        let kz = if a.x > a.y && a.x > a.z {
            0
        } else if a.y > a.z {
            1
        } else {
            2
        };
        let (kx, ky) = ((kz + 1) % 3, (kz + 2) % 3);
        let (kx, ky) = if d[kz] < 0.0 { (ky, kx) } else { (kx, ky) };
        let shear = Vec3::new(d[kx] / d[kz], d[ky] / d[kz], 1.0 / d[kz]);
        Self { origin: ray.origin, axes: [kx, ky, kz], shear, slabs: Slabs::new(ray, bounds) }
    }

    #[inline(always)]
    fn slabs(&self) -> &Slabs {
        &self.slabs
    }

    #[inline(always)]
    fn meet(&self, tri: &[Vec3; 3]) -> Option<TriHit> {
        let [a, b, c] = tri.map(|p| self.sheared(p - self.origin));
        let u = c.x * b.y - c.y * b.x;
        let v = a.x * c.y - a.y * c.x;
        let w = b.x * a.y - b.y * a.x;
        if u == 0.0 || v == 0.0 || w == 0.0 {
            return self.meet_on_edge(&[a, b, c]);
        }
        if (u < 0.0 || v < 0.0 || w < 0.0) && (u > 0.0 || v > 0.0 || w > 0.0) {
            return None;
        }
        let inv = 1.0 / (u + v + w);
        let t = (u * a.z + v * b.z + w * c.z) * (self.shear.z * inv);
        t.is_finite().then_some(TriHit { t, u: v * inv, v: w * inv })
    }

    #[inline(always)]
    fn may_meet<S: Simd>(&self, s: S, triangles: &impl Eight) -> u32 {
        let a = self.sheared_corner(s, triangles, 0);
        let b = self.sheared_corner(s, triangles, 1);
        let c = self.sheared_corner(s, triangles, 2);
        let u = s.sub(s.mul(c.0, b.1), s.mul(c.1, b.0));
        let v = s.sub(s.mul(a.0, c.1), s.mul(a.1, c.0));
        let w = s.sub(s.mul(b.0, a.1), s.mul(b.1, a.0));
        // A zero is settled in 64 bits later; what is not zero has the right sign already.
        let zero = s.splat(0.0);
        let (least, greatest) = (s.min(s.min(u, v), w), s.max(s.max(u, v), w));
        s.bits(s.or(s.le(zero, least), s.le(greatest, zero)))
    }
}

impl Watertight {
    /// The first two coordinates of a corner of eight triangles, as [`Self::sheared`].
    #[inline(always)]
    fn sheared_corner<S: Simd>(&self, s: S, triangles: &impl Eight, corner: usize) -> (S::F, S::F) {
        let [kx, ky, kz] = self.axes;
        let z = s.sub(triangles.corner(s, corner, kz), s.splat(self.origin[kz]));
        let x = s.sub(triangles.corner(s, corner, kx), s.splat(self.origin[kx]));
        let y = s.sub(triangles.corner(s, corner, ky), s.splat(self.origin[ky]));
        (s.sub(x, s.mul(s.splat(self.shear.x), z)), s.sub(y, s.mul(s.splat(self.shear.y), z)))
    }

    #[inline(always)]
    fn sheared(&self, p: Vec3) -> Vec3 {
        let [kx, ky, kz] = self.axes;
        Vec3::new(p[kx] - self.shear.x * p[kz], p[ky] - self.shear.y * p[kz], p[kz])
    }

    /// The same with the edges in 64 bits, for a ray through an edge or a vertex (or one whose
    /// edge functions underflow).
    #[cold]
    fn meet_on_edge(&self, sheared: &[Vec3; 3]) -> Option<TriHit> {
        let [a, b, c] = sheared.map(|p| p.as_dvec3());
        let u = c.x * b.y - c.y * b.x;
        let v = a.x * c.y - a.y * c.x;
        let w = b.x * a.y - b.y * a.x;
        if (u < 0.0 || v < 0.0 || w < 0.0) && (u > 0.0 || v > 0.0 || w > 0.0) {
            return None;
        }
        let det = u + v + w;
        if det == 0.0 {
            return None;
        }
        let t = (u * a.z + v * b.z + w * c.z) / det * f64::from(self.shear.z);
        let hit = TriHit { t: narrow(t), u: narrow(v / det), v: narrow(w / det) };
        hit.t.is_finite().then_some(hit)
    }
}
