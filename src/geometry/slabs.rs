//! The interval of a ray inside a box (Kay and Kajiya 1986), made so that a box never cuts off
//! what lies in it.
//!
//! For each axis the planes of the box are met at `(min - o_lo) * inv` and `(max - o_hi) * inv`.
//! Each is a monotone function of the plane, rounding included: a larger box never has a smaller
//! interval. So if a triangle's own box is met in `[a, b]`, every box around it is met in an
//! interval that holds `[a, b]`, to the bit.
//!
//! `o_lo = o + e` and `o_hi = o - e` widen every box by `e` at no cost per box. With u the unit
//! roundoff and D the greatest distance (in any component) from the origin to a point of the
//! scene, the plane's t carries three roundings (difference, reciprocal, product), 3uD along the
//! axis; the triangle tests displace a vertex by at most 6uD (the shear of the watertight test:
//! rounded difference, three roundings of the shear, the final difference); `o + e` is itself
//! rounded by u|o|. `e = 12uD + 2u|o|` covers them all with room for the second-order terms.

use super::eight::{Points, Rays};
use super::num::{UNIT_ROUNDOFF, max, min};
use super::{Aabb, Ray};
use crate::simd::Simd;
use glam::{Vec3, Vec3A};

/// What box tests need of a ray, worked out once.
#[derive(Clone, Copy, Debug)]
pub struct Slabs {
    /// `o + e`, subtracted from the minimum planes.
    o_lo: Vec3A,
    /// `o - e`, subtracted from the maximum planes.
    o_hi: Vec3A,
    /// One over the direction, always finite and never zero.
    inv: Vec3A,
}

/// The part of one axis, taken out once by those that meet many planes of it.
#[derive(Clone, Copy, Debug)]
pub struct Along {
    o_lo: f32,
    o_hi: f32,
    inv: f32,
}

impl Along {
    /// The earliest and latest t at which the ray may meet the plane at `pos`, by the same formula and with the same
    /// widening as the faces of a box.
    #[inline(always)]
    pub fn plane(&self, pos: f32) -> (f32, f32) {
        let (a, b) = ((pos - self.o_lo) * self.inv, (pos - self.o_hi) * self.inv);
        if a < b { (a, b) } else { (b, a) }
    }

    /// Whether the ray runs towards smaller values.
    #[inline(always)]
    pub fn backward(&self) -> bool {
        self.inv < 0.0
    }
}

/// The same for eight rays side by side.
#[derive(Clone, Copy, Debug)]
pub struct EightSlabs<F> {
    /// As in [`Slabs`].
    pub o_lo: Points<F>,
    /// As in [`Slabs`].
    pub o_hi: Points<F>,
    /// As in [`Slabs`].
    pub inv: Points<F>,
}

/// Eight boxes side by side.
#[derive(Clone, Copy)]
pub struct Boxes<F> {
    /// The least corners.
    pub min: Points<F>,
    /// The greatest.
    pub max: Points<F>,
}

/// Directions below this (of a ray whose greatest component is about 1) count as parallel.
const PARALLEL: f32 = 1.0 / (1u128 << 100) as f32;
/// Stands for the reciprocal of a zero component: any plane not passed is far outside every t.
const PARALLEL_INV: f32 = (1u128 << 120) as f32;
/// The least widening, so that a box is closed on both sides for a ray along a face of it: together with
/// `2u|o|`, at least an ulp of the origin, it keeps `o_lo` above and `o_hi` below the origin.
const LEAST_PAD: f32 = 1.0 / (1u64 << 40) as f32;

impl Slabs {
    /// For a ray and a scene inside `bounds`.
    #[inline(always)]
    pub fn new(ray: &Ray, bounds: &Aabb) -> Self {
        // The three axes in one register and no branch: this is done for every ray.
        let (origin, dir) = (Vec3A::from(ray.origin), Vec3A::from(ray.dir));
        let pad = Self::pad_of(origin, bounds);
        let parallel = dir.abs().cmplt(Vec3A::splat(PARALLEL));
        let inv = Vec3A::select(parallel, Vec3A::splat(PARALLEL_INV), Vec3A::ONE / dir);
        Self { o_lo: origin + pad, o_hi: origin - pad, inv }
    }

    /// The widening `e` for rays from `origin`, per axis.
    pub fn pad(origin: Vec3, bounds: &Aabb) -> Vec3 {
        Self::pad_of(origin.into(), bounds).into()
    }

    #[inline(always)]
    fn pad_of(origin: Vec3A, bounds: &Aabb) -> Vec3A {
        let (min, max) = (Vec3A::from(bounds.min), Vec3A::from(bounds.max));
        let reach = (max - origin).abs().max((min - origin).abs()).max_element();
        let pad = Vec3A::splat(12.0 * UNIT_ROUNDOFF * reach) + 2.0 * UNIT_ROUNDOFF * origin.abs();
        pad.max(Vec3A::splat(LEAST_PAD))
    }

    /// The t at which the ray enters and leaves the box. It misses if the first exceeds the second.
    #[inline(always)]
    pub fn interval(&self, b: &Aabb) -> (f32, f32) {
        let (o_lo, o_hi, inv) = (Vec3::from(self.o_lo), Vec3::from(self.o_hi), Vec3::from(self.inv));
        let lo = (b.min - o_lo) * inv;
        let hi = (b.max - o_hi) * inv;
        let entry = max(max(min(lo.x, hi.x), min(lo.y, hi.y)), min(lo.z, hi.z));
        let exit = min(min(max(lo.x, hi.x), max(lo.y, hi.y)), max(lo.z, hi.z));
        (entry, exit)
    }

    /// What is needed of one axis.
    #[inline(always)]
    pub fn along(&self, axis: usize) -> Along {
        Along { o_lo: self.o_lo[axis], o_hi: self.o_hi[axis], inv: self.inv[axis] }
    }

    /// One bit for each axis on which the ray does not run towards smaller values.
    #[inline(always)]
    pub fn forward(&self) -> u32 {
        !self.inv.cmplt(Vec3A::ZERO).bitmask() & 7
    }

    /// `o + e`, `o - e` and one over the direction, by axis.
    pub fn parts(&self) -> [[f32; 3]; 3] {
        [self.o_lo.into(), self.o_hi.into(), self.inv.into()]
    }

    /// Of such parts.
    #[inline(always)]
    pub fn from_parts(o_lo: [f32; 3], o_hi: [f32; 3], inv: [f32; 3]) -> Self {
        Self { o_lo: o_lo.into(), o_hi: o_hi.into(), inv: inv.into() }
    }

    /// How much wider boxes are on the first axis: at least twice twelve roundoffs of the reach, see above.
    #[inline(always)]
    pub fn width_of_x(&self) -> f32 {
        self.o_lo.x - self.o_hi.x
    }

    /// With the axes in another order.
    #[inline(always)]
    pub fn in_order(&self, axes: [usize; 3]) -> Self {
        let pick = |v: &Vec3A| Vec3A::new(v[axes[0]], v[axes[1]], v[axes[2]]);
        Self { o_lo: pick(&self.o_lo), o_hi: pick(&self.o_hi), inv: pick(&self.inv) }
    }
}

impl<F: Copy> EightSlabs<F> {
    /// As [`Slabs::new`] for each ray.
    #[inline(always)]
    pub fn new<S: Simd<F = F>>(s: S, rays: &Rays<F>, bounds: &Aabb) -> Self {
        let (origin, dir) = (rays.origin, rays.dir);
        let (min, max) = (Points::splat(s, bounds.min), Points::splat(s, bounds.max));
        let reach = max.minus(s, origin).abs(s).max(s, min.minus(s, origin).abs(s)).greatest(s);
        let pad = Points::all(s.mul(s.splat(12.0 * UNIT_ROUNDOFF), reach));
        let pad = pad.plus(s, origin.abs(s).times(s, s.splat(2.0 * UNIT_ROUNDOFF)));
        let pad = pad.max(s, Points::all(s.splat(LEAST_PAD)));
        let inv = Points { x: inverse(s, dir.x), y: inverse(s, dir.y), z: inverse(s, dir.z) };
        Self { o_lo: origin.plus(s, pad), o_hi: origin.minus(s, pad), inv }
    }

    /// The slabs of one ray in all lanes.
    #[inline(always)]
    pub fn splat<S: Simd<F = F>>(s: S, slabs: &Slabs) -> Self {
        Self {
            o_lo: Points::splat(s, slabs.o_lo.into()),
            o_hi: Points::splat(s, slabs.o_hi.into()),
            inv: Points::splat(s, slabs.inv.into()),
        }
    }

    /// The t at which each ray enters and leaves the box of its lane, as in [`Slabs::interval`].
    #[inline(always)]
    pub fn intervals<S: Simd<F = F>>(&self, s: S, boxes: &Boxes<F>) -> (F, F) {
        let lo = boxes.min.minus(s, self.o_lo).scaled(s, self.inv);
        let hi = boxes.max.minus(s, self.o_hi).scaled(s, self.inv);
        (lo.min(s, hi).greatest(s), lo.max(s, hi).least(s))
    }

    /// As [`Slabs::forward`] for each ray, as the bits of floats.
    #[inline(always)]
    pub fn forward<S: Simd<F = F>>(&self, s: S) -> F {
        let zero = s.splat(0.0);
        let x = s.select(s.lt(self.inv.x, zero), zero, s.splat_bits(1));
        let y = s.select(s.lt(self.inv.y, zero), zero, s.splat_bits(2));
        let z = s.select(s.lt(self.inv.z, zero), zero, s.splat_bits(4));
        s.add_bits(s.add_bits(x, y), z)
    }
}

/// One over a component of a direction, finite and not zero.
#[inline(always)]
fn inverse<S: Simd>(s: S, dir: S::F) -> S::F {
    let parallel = s.lt(s.abs(dir), s.splat(PARALLEL));
    s.select(parallel, s.splat(PARALLEL_INV), s.div(s.splat(1.0), dir))
}

#[cfg(test)]
mod tests {
    use super::*;

    const UNIT: Aabb = Aabb { min: Vec3::ZERO, max: Vec3::ONE };

    fn hits(slabs: &Slabs, b: &Aabb) -> bool {
        let (entry, exit) = slabs.interval(b);
        entry <= exit && exit >= 0.0
    }

    #[test]
    fn a_box_is_closed_for_rays_along_its_faces_edges_and_corners() {
        for sign in [1.0, -1.0] {
            for zero in [0.0, -0.0] {
                for (y, z) in [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (1.0, 1.0), (0.5, 1.0)] {
                    let ray = Ray::new(Vec3::new(-3.0 * sign, y, z), Vec3::new(sign, zero, zero));
                    assert!(hits(&Slabs::new(&ray, &UNIT), &UNIT), "{ray:?}");
                }
            }
        }
        let outside = Ray::new(Vec3::new(-3.0, 1.1, 0.5), Vec3::X);
        assert!(!hits(&Slabs::new(&outside, &UNIT), &UNIT));
    }

    #[test]
    fn a_larger_box_never_has_a_smaller_interval() {
        let ray = Ray::new(Vec3::new(-1.3, 0.7, 2.1), Vec3::new(0.3, -1e-30, -0.9));
        let slabs = Slabs::new(&ray, &UNIT);
        let (a, b) = slabs.interval(&UNIT);
        let (c, d) = slabs.interval(&UNIT.with(Vec3::splat(1.0).map(f32::next_up)));
        assert!(c <= a && b <= d);
    }
}
