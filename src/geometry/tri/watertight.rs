//! Woop, Benthin and Wald 2013, "Watertight Ray/Triangle Intersection" (JCGT 2:1).

use super::block::{Block, each, mask};
use super::{TestKind, TriHit, TriTest};
use crate::geometry::num::narrow;
use crate::geometry::{Aabb, Ray, Slabs};
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
    fn may_meet(&self, block: &Block) -> u32 {
        let [kx, ky, kz] = self.axes;
        let [a, b, c] = block.corners.each_ref().map(|p| {
            let z = each(|i| p[kz][i] - self.origin[kz]);
            let x = each(|i| (p[kx][i] - self.origin[kx]) - self.shear.x * z[i]);
            let y = each(|i| (p[ky][i] - self.origin[ky]) - self.shear.y * z[i]);
            (x, y)
        });
        let u = each(|i| c.0[i] * b.1[i] - c.1[i] * b.0[i]);
        let v = each(|i| a.0[i] * c.1[i] - a.1[i] * c.0[i]);
        let w = each(|i| b.0[i] * a.1[i] - b.1[i] * a.0[i]);
        // A zero is settled in 64 bits later, and may have any sign until then.
        mask(|i| {
            let outside = ((u[i] < 0.0) | (v[i] < 0.0) | (w[i] < 0.0)) & ((u[i] > 0.0) | (v[i] > 0.0) | (w[i] > 0.0));
            let zero = (u[i] == 0.0) | (v[i] == 0.0) | (w[i] == 0.0);
            !outside | zero
        })
    }
}

impl Watertight {
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
