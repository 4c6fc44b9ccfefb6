//! Random lines: what the surface area heuristic assumes that rays are. A line that meets a convex
//! body meets a convex body inside it with the chance of their areas' ratio (Santaló 1976, §I.14.3),
//! if no line is likelier than another.

use crate::geometry::{Aabb, Axis, Ray};
use crate::render::sampler::{Random, cosine_direction};
use glam::{DVec3, Vec3};

/// The `i`-th of the random lines through a box of the world, the same every time. It starts outside
/// and has no end.
///
/// Lines are spread evenly over all lines that meet the box: the point where one enters is spread
/// evenly over the box's surface, and its direction about the face's inward normal by cosine.
pub fn line(bounds: &Aabb, i: u64) -> Ray {
    let sampler = Random::new((i & 0xFFFF_FFFF) as u32, (i >> 32) as u32, 0);
    let (size, [face, place, turn]) = (bounds.max.as_dvec3() - bounds.min.as_dvec3(), [0, 1, 2].map(|d| sampler.pair(d)));
    let (axis, up) = pick_face(size, f64::from(face.x));
    let (k, u, v) = (axis.index(), (axis.index() + 1) % 3, (axis.index() + 2) % 3);
    let mut entry = bounds.min.as_dvec3();
    entry[k] += if up { size[k] } else { 0.0 };
    entry[u] += size[u] * f64::from(place.x);
    entry[v] += size[v] * f64::from(place.y);
    let mut inward = Vec3::ZERO;
    inward[k] = if up { -1.0 } else { 1.0 };
    let dir = cosine_direction(inward, turn);
    let origin = entry - dir.as_dvec3() * size.length();
    Ray::new(origin.as_vec3(), dir)
}

/// A face by its area, from a number in 0..1: the axis it lies across, and whether it is the upper one.
fn pick_face(size: DVec3, x: f64) -> (Axis, bool) {
    let areas = [size.y * size.z, size.z * size.x, size.x * size.y];
    let mut left = x * 2.0 * areas.iter().sum::<f64>();
    for (axis, area) in Axis::ALL.into_iter().zip(areas) {
        for up in [false, true] {
            // Not `<=`: a face without area is never picked.
            if left < area {
                return (axis, up);
            }
            left -= area;
        }
    }
    // Rounding: the last face that has an area.
    let last = (0..3).rev().find(|k| areas[*k] > 0.0).unwrap_or(2);
    (Axis::ALL[last], true)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// By chords: the mean length of the lines' part in a convex body is 4 V / A (Cauchy), and the
    /// share that meets a body inside it is the ratio of the areas.
    #[test]
    fn lines_have_the_chords_and_chances_that_geometry_asks_for() {
        let outer = Aabb { min: Vec3::new(-1.0, 2.0, 0.5), max: Vec3::new(2.0, 3.0, 1.0) };
        let inner = Aabb { min: Vec3::new(0.0, 2.25, 0.5), max: Vec3::new(0.5, 2.75, 0.875) };
        let chord = |ray: &Ray, b: &Aabb| {
            let (o, inv) = (ray.origin.as_dvec3(), 1.0 / ray.dir.as_dvec3());
            let (a, z) = ((b.min.as_dvec3() - o) * inv, (b.max.as_dvec3() - o) * inv);
            (a.max(z).min_element() - a.min(z).max_element()).max(0.0)
        };
        let n = 200_000u32;
        let (mut length, mut met) = (0.0, 0.0);
        for i in 0..n {
            let ray = line(&outer, u64::from(i));
            assert!((ray.dir.length() - 1.0).abs() < 1e-5 && !outer.contains_box(&Aabb::of_points([ray.origin])));
            assert!(chord(&ray, &outer) > 0.0 || i % 1000 == 0, "{ray:?} misses");
            length += chord(&ray, &outer) / f64::from(n);
            met += f64::from(u8::from(chord(&ray, &inner) > 0.0)) / f64::from(n);
        }
        let expected = 4.0 * 1.5 / outer.area();
        assert!((length / expected - 1.0).abs() < 0.01, "{length} for {expected}");
        let expected = inner.area() / outer.area();
        assert!((met / expected - 1.0).abs() < 0.03, "{met} for {expected}");
    }

    #[test]
    fn a_flat_box_is_entered_through_its_two_faces() {
        let flat = Aabb { min: Vec3::ZERO, max: Vec3::new(1.0, 1.0, 0.0) };
        for i in 0..1000 {
            let ray = line(&flat, i);
            let entry = ray.at(-ray.origin.z / ray.dir.z);
            assert!(ray.is_valid() && entry.cmpge(Vec3::splat(-1e-5)).all() && entry.cmple(Vec3::splat(1.0 + 1e-5)).all());
        }
        assert!(!line(&Aabb { min: Vec3::ONE, max: Vec3::ONE }, 3).dir.is_nan());
    }
}
