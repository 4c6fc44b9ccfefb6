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

use super::num::UNIT_ROUNDOFF;
use super::{Aabb, Ray};
use glam::Vec3;

/// What box tests need of a ray, worked out once.
#[derive(Clone, Copy, Debug)]
pub struct Slabs {
    /// `o + e`, subtracted from the minimum planes.
    o_lo: Vec3,
    /// `o - e`, subtracted from the maximum planes.
    o_hi: Vec3,
    /// One over the direction, always finite and never zero.
    inv: Vec3,
}

/// Directions below this (of a ray whose greatest component is about 1) count as parallel.
const PARALLEL: f32 = 1.0 / (1u128 << 100) as f32;
/// Stands for the reciprocal of a zero component: any plane not passed is far outside every t.
const PARALLEL_INV: f32 = (1u128 << 120) as f32;
/// The least widening on an axis the ray is parallel to, so that the box is closed on both sides.
const PARALLEL_PAD: f32 = 1.0 / (1u64 << 40) as f32;

impl Slabs {
    /// For a ray and a scene inside `bounds`.
    pub fn new(ray: &Ray, bounds: &Aabb) -> Self {
        let pad = Self::pad(ray.origin, bounds);
        let mut slabs = Self { o_lo: ray.origin + pad, o_hi: ray.origin - pad, inv: Vec3::ONE };
        for k in 0..3 {
            if ray.dir[k].abs() < PARALLEL {
                let (o, e) = (ray.origin[k], pad[k].max(PARALLEL_PAD));
                slabs.o_lo[k] = o.next_up().max(o + e);
                slabs.o_hi[k] = o.next_down().min(o - e);
                slabs.inv[k] = PARALLEL_INV;
            } else {
                slabs.inv[k] = 1.0 / ray.dir[k];
            }
        }
        slabs
    }

    /// The widening `e` for rays from `origin`, per axis.
    pub fn pad(origin: Vec3, bounds: &Aabb) -> Vec3 {
        let reach = (bounds.max - origin).abs().max((bounds.min - origin).abs()).max_element();
        Vec3::splat(12.0 * UNIT_ROUNDOFF * reach) + 2.0 * UNIT_ROUNDOFF * origin.abs()
    }

    /// The t at which the ray enters and leaves the box. It misses if the first exceeds the second.
    #[inline(always)]
    pub fn interval(&self, b: &Aabb) -> (f32, f32) {
        let lo = (b.min - self.o_lo) * self.inv;
        let hi = (b.max - self.o_hi) * self.inv;
        let entry = max(max(min(lo.x, hi.x), min(lo.y, hi.y)), min(lo.z, hi.z));
        let exit = min(min(max(lo.x, hi.x), max(lo.y, hi.y)), max(lo.z, hi.z));
        (entry, exit)
    }

    /// The earliest and latest t at which the ray may meet the plane `axis = pos`, by the same
    /// formula and with the same widening as the faces of a box.
    #[inline(always)]
    pub fn plane(&self, axis: usize, pos: f32) -> (f32, f32) {
        let a = (pos - self.o_lo[axis]) * self.inv[axis];
        let b = (pos - self.o_hi[axis]) * self.inv[axis];
        (min(a, b), max(a, b))
    }

    /// Whether the ray runs towards smaller values on the axis.
    #[inline(always)]
    pub fn backward(&self, axis: usize) -> bool {
        self.inv[axis] < 0.0
    }
}

#[inline(always)]
fn min(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
}

#[inline(always)]
fn max(a: f32, b: f32) -> f32 {
    if a > b { a } else { b }
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
