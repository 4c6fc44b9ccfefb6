//! The line of a ray as convex volumes see it: relative to the scene's centre, and with the room
//! that makes a miss certain.
//!
//! What is known of a hit. u is the unit roundoff, D the greatest distance (in any component) from
//! the origin to a point of the scene, E = 24uD + 4u|o|.
//!
//! 1. `Watertight` decides exactly over a triangle whose corners it moved by at most 6uD, so the
//!    exact line of the ray meets the triangle widened by E in each component.
//! 2. `Fast` knows no such bound: in the plane of a triangle its answer is noise. What is known of
//!    it, as of every test, is that the ray meets the triangle's own box, widened by
//!    12uD + 2u|o| plus four roundings ([`Slabs`]): less than E. So volumes that are traced with
//!    `Fast` must be made around the boxes of the triangles.
//! 3. The t of a hit is clamped into the ray's interval in the triangle's box; nothing more is
//!    known of it, since in the plane of a triangle t is noise for either test. So only boxes bound
//!    t, a volume's own or the one around it ([`Slabs`], [`Line::in_box`]); the rest of a volume
//!    decides only whether the line meets it.
//!
//! Everything is relative to the centre of the scene, so that no rounding grows with the distance
//! of the scene from the origin. For a plane `n . x = c` with `|n|` the sum of the components'
//! magnitudes, the errors in `(c - n . o) / (n . d)` are, as displacements of the plane: 4uD|n| of
//! `n . o` (1 of the relative origin, 3 of the sum), 6uD|n| of `n . d` (|t| is at most 2D, as the
//! greatest component of a direction is above 1/2; 8uD|n| where the line counts as parallel), 7uD|n|
//! of the difference, the reciprocal and the product. With E|n| that is less than
//! `(48uD + 8u|o|)|n|`, which is [`Line`]'s pad: four times that of [`Slabs`].

use super::num::{UNIT_ROUNDOFF, max, min};
use super::{Aabb, Ray, Slabs};
use glam::Vec3;

/// What volumes need of a ray, worked out once.
#[derive(Clone, Copy, Debug)]
pub struct Line {
    /// For boxes, which are in the coordinates of the scene.
    pub slabs: Slabs,
    /// Relative to the centre of the scene.
    pub origin: Vec3,
    /// The greatest component is in (1/2, 1].
    pub dir: Vec3,
    /// One over the square of the direction's length.
    pub inv_length_squared: f32,
    /// The widening of a plane whose normal's components have magnitudes that sum to 1.
    pub pad: f32,
    axes: [Through; 3],
}

/// The sum of the magnitudes of a unit vector's components is at most this (the root of 3, rounded up).
pub const UNIT_SUM: f32 = 1.732_051;

impl Line {
    /// For a ray of the scaled space and a scene inside `bounds`.
    pub fn new(ray: &Ray, bounds: &Aabb) -> Self {
        let origin = ray.origin - bounds.centre();
        let pad = 4.0 * Slabs::pad(ray.origin, bounds).max_element();
        let through = Through { lo: 0.0, hi: 0.0, inv: 0.0 };
        let mut line = Self {
            slabs: Slabs::new(ray, bounds),
            origin,
            dir: ray.dir,
            inv_length_squared: 1.0 / ray.dir.length_squared(),
            pad,
            axes: [through; 3],
        };
        line.axes = Vec3::AXES.map(|axis| line.through(axis, 1.0));
        line
    }

    /// The earliest and latest t at which anything may be hit that lies in a box, relative to the
    /// scene's centre, whose faces may err by 12uD. It misses if the first exceeds the second.
    #[inline(always)]
    pub fn in_box(&self, min: Vec3, max: Vec3) -> (f32, f32) {
        let [x, y, z] = &self.axes;
        common(common(x.interval(min.x, max.x), y.interval(min.y, max.y)), z.interval(min.z, max.z))
    }

    /// What slabs of planes perpendicular to `normal` need; `sum` is that of the magnitudes of its
    /// components, or more.
    #[inline(always)]
    pub fn through(&self, normal: Vec3, sum: f32) -> Through {
        let (at, along, pad) = (normal.dot(self.origin), normal.dot(self.dir), self.pad * sum);
        let inv = if along.abs() < PARALLEL * sum { PARALLEL_INV } else { 1.0 / along };
        Through { lo: at + pad, hi: at - pad, inv }
    }

    /// Cuts an interval of t by the half-space `normal . x <= offset` (normal of unit length,
    /// within rounding), widened.
    #[inline(always)]
    pub fn clip(&self, normal: Vec3, offset: f32, (entry, exit): (f32, f32)) -> (f32, f32) {
        let (at, along) = (normal.dot(self.origin), normal.dot(self.dir));
        let room = offset + self.pad * UNIT_SUM - at;
        if along > PARALLEL * UNIT_SUM {
            (entry, min(exit, room / along))
        } else if along < -PARALLEL * UNIT_SUM {
            (max(entry, room / along), exit)
        } else if room < 0.0 {
            (f32::INFINITY, f32::NEG_INFINITY)
        } else {
            (entry, exit)
        }
    }
}

/// A `normal . dir` below this much of the normal's sum is nothing but rounding: the line counts as
/// parallel to the plane.
const PARALLEL: f32 = 4.0 * UNIT_ROUNDOFF;
/// Stands for the reciprocal of nothing. What the pad leaves over, at least uD, times this is beyond
/// every t.
const PARALLEL_INV: f32 = (1u64 << 60) as f32;

/// What slabs of one direction need of a line: [`Slabs`] for one axis of any direction.
#[derive(Clone, Copy, Debug)]
pub struct Through {
    lo: f32,
    hi: f32,
    inv: f32,
}

impl Through {
    /// The t at which the line is between the planes at `lo` and `hi`.
    #[inline(always)]
    pub fn interval(&self, lo: f32, hi: f32) -> (f32, f32) {
        let (a, b) = ((lo - self.lo) * self.inv, (hi - self.hi) * self.inv);
        (min(a, b), max(a, b))
    }
}

/// What two intervals have in common; empty when the first exceeds the second.
#[inline(always)]
pub fn common(a: (f32, f32), b: (f32, f32)) -> (f32, f32) {
    (max(a.0, b.0), min(a.1, b.1))
}

#[cfg(test)]
mod tests {
    use super::*;

    const BOUNDS: Aabb = Aabb { min: Vec3::splat(0.5), max: Vec3::splat(1.5) };

    #[test]
    fn slabs_of_any_direction_hold_what_lies_between_their_planes() {
        let line = Line::new(&Ray::new(Vec3::new(-2.0, 1.0, 1.0), Vec3::X), &BOUNDS);
        let (entry, exit) = line.through(Vec3::new(1.0, 1.0, 0.0), 2.0).interval(-0.25, 0.25);
        assert!((2.7499..=2.75).contains(&entry) && (3.25..3.2501).contains(&exit), "{entry} {exit}");
        let (entry, exit) = line.in_box(Vec3::splat(-0.5), Vec3::splat(0.5));
        assert!(entry <= 2.5 && (3.5..3.501).contains(&exit));
    }

    #[test]
    fn a_parallel_line_is_inside_or_out() {
        let line = Line::new(&Ray::new(Vec3::new(-2.0, 1.0, 1.0), Vec3::X), &BOUNDS);
        for (lo, hi, inside) in [(0.0, 0.25, true), (-0.25, 0.0, true), (0.1, 0.2, false), (-0.2, -0.1, false)] {
            let (entry, exit) =
                common(line.through(Vec3::Y, 1.0).interval(lo, hi), line.in_box(Vec3::splat(-0.5), Vec3::splat(0.5)));
            assert_eq!(entry <= exit, inside, "{lo} {hi}");
            let (entry, exit) = line.clip(Vec3::Y, hi, (0.0, 9.0));
            assert_eq!(entry <= exit, hi >= 0.0);
        }
    }
}
