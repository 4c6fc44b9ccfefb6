//! Woop, Benthin and Wald 2013, "Watertight Ray/Triangle Intersection" (JCGT 2:1).

use super::{Meets, Own, TestKind, TriHit, TriTest};
use crate::geometry::eight::{Points, Rays};
use crate::geometry::num::{max, min, narrow};
use crate::geometry::{Aabb, EightSlabs, Ray, Slabs};
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
    /// With the axes in order.
    origin: Vec3,
    /// The order of the axes: see [`AXES`].
    axes: u32,
    /// `x -= sx * z`, `y -= sy * z`, `z *= sz`.
    shear: Vec3,
    slabs: Slabs,
}

impl TriTest for Watertight {
    const KIND: TestKind = TestKind::Watertight;

    #[inline(always)]
    fn prepare(ray: &Ray, bounds: &Aabb) -> Self {
        let (d, axes) = (ray.dir, order_of(ray.dir));
        let d = with_axes(d, AXES[axes as usize % 8]);
        let shear = Vec3::new(d.x / d.z, d.y / d.z, 1.0 / d.z);
        let origin = with_axes(ray.origin, AXES[axes as usize % 8]);
        Self { origin, axes, shear, slabs: Slabs::new(ray, bounds) }
    }

    #[inline(always)]
    fn slabs(&self) -> &Slabs {
        &self.slabs
    }

    #[inline(always)]
    fn meet(&self, tri: &[Vec3; 3]) -> Option<TriHit> {
        let (a, b, c) = (self.sheared(tri[0]), self.sheared(tri[1]), self.sheared(tri[2]));
        let u = c.x * b.y - c.y * b.x;
        let v = a.x * c.y - a.y * c.x;
        let w = b.x * a.y - b.y * a.x;
        // Two branches, of which the first goes one way nearly always: each sign by itself would be a guess.
        let (least, greatest) = (min(min(u, v), w), max(max(u, v), w));
        if least < 0.0 && greatest > 0.0 {
            return None;
        }
        if least == 0.0 || greatest == 0.0 {
            return self.meet_on_edge(&[a, b, c]);
        }
        let inv = 1.0 / (u + v + w);
        let t = (u * a.z + v * b.z + w * c.z) * (self.shear.z * inv);
        t.is_finite().then_some(TriHit { t, u: v * inv, v: w * inv })
    }

    #[inline(always)]
    fn axes(&self) -> [usize; 3] {
        AXES[self.axes as usize % 8]
    }

    #[inline(always)]
    fn meet_eight<S: Simd>(s: S, own: &Own<S::F>, _: &EightSlabs<S::F>, [a, b, c]: &[Points<S::F>; 3]) -> Meets<S> {
        let (a, b, c) = (shear(s, own, *a), shear(s, own, *b), shear(s, own, *c));
        let u = s.sub(s.mul(c.x, b.y), s.mul(c.y, b.x));
        let v = s.sub(s.mul(a.x, c.y), s.mul(a.y, c.x));
        let w = s.sub(s.mul(b.x, a.y), s.mul(b.y, a.x));
        let zero = s.splat(0.0);
        let (least, greatest) = (s.min(s.min(u, v), w), s.max(s.max(u, v), w));
        // A zero is settled in 64 bits later; what is not zero has the right sign already.
        let met = s.or(s.lt(zero, least), s.lt(greatest, zero));
        let doubt = s.or(s.eq(zero, least), s.eq(greatest, zero));
        let inv = s.div(s.splat(1.0), s.add(s.add(u, v), w));
        let t = s.add(s.add(s.mul(u, a.z), s.mul(v, b.z)), s.mul(w, c.z));
        let t = s.mul(t, s.mul(own[5], inv));
        Meets { met, doubt: Some(doubt), t, u: s.mul(v, inv), v: s.mul(w, inv) }
    }

    #[inline(always)]
    fn own(&self) -> Own<f32> {
        let (o, h) = (self.origin, self.shear);
        [o.x, o.y, o.z, h.x, h.y, h.z, f32::from_bits(self.axes)]
    }

    #[inline(always)]
    fn own_of_eight<S: Simd>(s: S, rays: &Rays<S::F>) -> Own<S::F> {
        let (o, d, axes) = in_order(s, rays);
        [o.x, o.y, o.z, s.div(d.x, d.z), s.div(d.y, d.z), s.div(s.splat(1.0), d.z), axes]
    }

    #[inline(always)]
    fn from_own(own: &Own<f32>, slabs: Slabs) -> Self {
        let &[ox, oy, oz, sx, sy, sz, axes] = own;
        Self { origin: Vec3::new(ox, oy, oz), axes: axes.to_bits(), shear: Vec3::new(sx, sy, sz), slabs }
    }
}

/// The axis of the greatest direction component becomes z; x and y swap to keep the winding. By the
/// number `2 * z + swap`.
pub const AXES: [[usize; 3]; 8] = [[1, 2, 0], [2, 1, 0], [2, 0, 1], [0, 2, 1], [0, 1, 2], [1, 0, 2], [0, 1, 2], [1, 0, 2]];

/// A point with the axes in an order; masks in place of checks, as these are known to be 0, 1 and 2.
#[inline(always)]
pub fn with_axes(p: Vec3, [x, y, z]: [usize; 3]) -> Vec3 {
    let p = [p.x, p.y, p.z, 0.0];
    Vec3::new(p[x & 3], p[y & 3], p[z & 3])
}

/// The number of the order of axes for a direction.
#[inline(always)]
pub fn order_of(dir: Vec3) -> u32 {
    let a = dir.abs();
    let z = if a.x > a.y && a.x > a.z {
        0
    } else if a.y > a.z {
        1
    } else {
        2
    };
    2 * z + u32::from(dir[z as usize] < 0.0)
}

/// Origins and directions of eight rays with the axes in the order that each asks for, and its number as bits.
#[inline(always)]
pub fn in_order<S: Simd>(s: S, rays: &Rays<S::F>) -> (Points<S::F>, Points<S::F>, S::F) {
    let (d, o, a) = (rays.dir, rays.origin, rays.dir.abs(s));
    let zero = s.splat(0.0);
    let z_is_x = s.and(s.lt(a.y, a.x), s.lt(a.z, a.x));
    let z_is_y = s.lt(a.z, a.y);
    let (d, o) = (turned(s, d, z_is_x, z_is_y), turned(s, o, z_is_x, z_is_y));
    let swap = s.lt(d.z, zero);
    let axes = s.select(z_is_x, zero, s.select(z_is_y, s.splat_bits(2), s.splat_bits(4)));
    let axes = s.add_bits(axes, s.select(swap, s.splat_bits(1), zero));
    (swapped(s, o, swap), swapped(s, d, swap), axes)
}

/// As [`Watertight::sheared`] of corners whose axes are in order.
#[inline(always)]
fn shear<S: Simd>(s: S, own: &Own<S::F>, p: Points<S::F>) -> Points<S::F> {
    let &[ox, oy, oz, sx, sy, ..] = own;
    let p = p.minus(s, Points { x: ox, y: oy, z: oz });
    Points { x: s.sub(p.x, s.mul(sx, p.z)), y: s.sub(p.y, s.mul(sy, p.z)), z: p.z }
}

/// The axes in the order that makes the greatest z.
#[inline(always)]
fn turned<S: Simd>(s: S, p: Points<S::F>, z_is_x: S::M, z_is_y: S::M) -> Points<S::F> {
    Points {
        x: s.select(z_is_x, p.y, s.select(z_is_y, p.z, p.x)),
        y: s.select(z_is_x, p.z, s.select(z_is_y, p.x, p.y)),
        z: s.select(z_is_x, p.x, s.select(z_is_y, p.y, p.z)),
    }
}

/// x and y in each other's place where it is said.
#[inline(always)]
fn swapped<S: Simd>(s: S, p: Points<S::F>, swap: S::M) -> Points<S::F> {
    Points { x: s.select(swap, p.y, p.x), y: s.select(swap, p.x, p.y), z: p.z }
}

impl Watertight {
    /// A corner as the ray sees it.
    #[inline(always)]
    fn sheared(&self, p: Vec3) -> Vec3 {
        let p = with_axes(p, self.axes()) - self.origin;
        Vec3::new(p.x - self.shear.x * p.z, p.y - self.shear.y * p.z, p.z)
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
