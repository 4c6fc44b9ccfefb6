//! Where a ray meets a plane of any direction, as an interval of t that surely holds it.
//!
//! The ray is above the plane where `s(t) = (n . o - offset) + t (n . d)` is positive. With u the unit
//! roundoff, D the greatest distance (in any component) from the origin to a point of the scene and O
//! the greatest component of the origin, a point of the scene on the ray has t |d| <= D in every
//! component, the sum of a unit vector's components is at most sqrt(3), and, in lengths along the normal:
//!
//! - `n . o - offset` errs by 3u sqrt(3) O and, rounded to its own size, u sqrt(3) D;
//! - `n . d` by 3u of its terms, which at t is 3u sqrt(3) D;
//! - t, a difference, a reciprocal and a product, by 3u, which is 3u sqrt(3) D;
//! - a triangle may reach over the plane by the band and not be there: 8uR, at most 8u(O + D);
//! - the triangle tests displace a vertex by at most 6uD on every axis (see `geometry/slabs.rs`):
//!   6 sqrt(3) uD.
//!
//! Together 30.6 uD + 13.2 uO. So where `|s| > e = 40uD + 16uO` the ray has met, or will find, all that
//! counts on the side that the sign says; while `|s| <= e` it is taken to be on both sides. A ray along
//! the plane is so for all t. The second-order terms are in what e is rounded up by.

use crate::geometry::num::UNIT_ROUNDOFF;
use crate::geometry::{Aabb, Ray};
use glam::Vec3;

/// A general plane as the tree keeps it.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub struct Row {
    /// Of unit length, within rounding.
    pub normal: Vec3,
    /// The distance from the origin, along the normal.
    pub offset: f32,
}

/// What meeting planes needs of a ray, worked out once.
#[derive(Clone, Copy, Debug)]
pub struct Crossings {
    origin: Vec3,
    dir: Vec3,
    /// e, above.
    error: f32,
}

/// Where a ray meets a plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Crossing {
    /// Before this t the ray is on the near side only.
    pub early: f32,
    /// After this t it is on the far side only.
    pub late: f32,
    /// The near side is the one above.
    pub from_above: bool,
}

/// A ray that comes no nearer to a plane than this, for each unit of t, runs along it.
const PARALLEL: f32 = 1.0 / (1u128 << 100) as f32;

impl Crossings {
    /// For a ray and a scene inside `bounds`.
    pub fn new(ray: &Ray, bounds: &Aabb) -> Self {
        let reach = (bounds.max - ray.origin).abs().max((bounds.min - ray.origin).abs()).max_element();
        let error = UNIT_ROUNDOFF * (40.0 * reach + 16.0 * ray.origin.abs().max_element());
        Self { origin: ray.origin, dir: ray.dir, error }
    }

    /// The interval of t in which the ray may be on either side.
    #[inline(always)]
    pub fn of(&self, plane: &Row) -> Crossing {
        let height = plane.normal.dot(self.origin) - plane.offset;
        let climb = plane.normal.dot(self.dir);
        // Beside the plane for ever: both ends are then far before, or far behind, every t.
        let climb = if climb.abs() < PARALLEL { PARALLEL } else { climb };
        let inv = 1.0 / climb;
        let (low, high) = ((-self.error - height) * inv, (self.error - height) * inv);
        if climb > 0.0 {
            Crossing { early: low, late: high, from_above: false }
        } else {
            Crossing { early: high, late: low, from_above: true }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SCENE: Aabb = Aabb { min: Vec3::splat(-1.0), max: Vec3::splat(1.0) };
    const SLANTED: Row = Row { normal: Vec3::new(0.6, 0.0, 0.8), offset: 0.5 };

    fn cross(origin: Vec3, dir: Vec3) -> Crossing {
        Crossings::new(&Ray::new(origin, dir), &SCENE).of(&SLANTED)
    }

    #[test]
    fn a_plane_is_met_where_it_is_from_either_side() {
        // Twice e at most, for D = 1.8 and O = 0.8.
        let width = 2.02 * UNIT_ROUNDOFF * (40.0 * 1.8 + 16.0 * 0.8);
        let up = cross(Vec3::ZERO, SLANTED.normal);
        assert!(!up.from_above && up.early < 0.5 && 0.5 < up.late && up.late - up.early < width, "{up:?}");
        let down = cross(SLANTED.normal, -SLANTED.normal);
        assert!(down.from_above && down.early < 0.5 && 0.5 < down.late && down.late - down.early < width, "{down:?}");
    }

    #[test]
    fn a_ray_along_the_plane_is_on_both_sides_and_one_beside_it_on_one() {
        let along = Vec3::new(0.8, 0.0, -0.6);
        let within = cross(SLANTED.normal * 0.5, along);
        assert!(within.early < -1e6 && within.late > 1e6, "{within:?}");
        for dir in [Vec3::Y, Vec3::NEG_Y] {
            // Exactly parallel: the near side is the one below.
            let below = cross(Vec3::ZERO, dir);
            assert!(!below.from_above && below.early > 1e9, "{below:?}");
            let above = cross(SLANTED.normal, dir);
            assert!(!above.from_above && above.late < -1e9, "{above:?}");
        }
    }

    /// Wherever 64 bits put the ray surely above or below, the interval agrees.
    #[test]
    fn the_interval_holds_every_doubtful_t() {
        let mut seed = 5u32;
        let mut next = || {
            seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (seed >> 8) as f32 / (1 << 23) as f32 - 1.0
        };
        let mut sure = 0;
        for i in 0..20_000 {
            let mut vector = || Vec3::new(next(), next(), next());
            let (normal, through, origin, mut dir) = (vector().normalize_or(Vec3::X), vector(), vector() * 3.0, vector());
            if i % 2 == 0 {
                dir = dir.reject_from(normal) + normal * 1e-7 * next();
            }
            let plane = Row { normal, offset: normal.dot(through) };
            let c = Crossings::new(&Ray::new(origin, dir), &SCENE).of(&plane);
            assert!(c.early <= c.late);
            for step in 0..20u8 {
                let t = f32::from(step) * 0.3;
                let s = normal.as_dvec3().dot(origin.as_dvec3() + dir.as_dvec3() * f64::from(t)) - f64::from(plane.offset);
                let before = t < c.early;
                if before || t > c.late {
                    assert_eq!(s > 0.0, before == c.from_above, "{plane:?} {origin} {dir} {t}: {s}");
                    sure += 1;
                }
            }
        }
        assert!(sure > 300_000, "{sure}");
    }
}
