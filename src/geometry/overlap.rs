//! Whether a triangle and a box overlap (Akenine-Möller 2001: separating axes), rounded outward.

use super::Aabb;
use glam::{DVec3, Vec3};

/// False only if some plane truly separates the triangle from the box; a touching triangle
/// overlaps. Worked out in 64 bits with a margin for its own rounding, so for 32-bit input the
/// answer errs by at most a relative 1e-12, and only towards true.
pub fn triangle_overlaps_box(tri: &[Vec3; 3], cell: &Aabb) -> bool {
    let centre = (cell.min.as_dvec3() + cell.max.as_dvec3()) * 0.5;
    let half = (cell.max.as_dvec3() - cell.min.as_dvec3()) * 0.5;
    let v = tri.map(|p| p.as_dvec3() - centre);
    let slack = 1e-12 * v.iter().fold(half, |m, p| m.max(p.abs())).max_element();
    let e = [v[1] - v[0], v[2] - v[1], v[0] - v[2]];

    let apart_along = |axis: DVec3| {
        let p = v.map(|p| p.dot(axis));
        let radius = half.dot(axis.abs()) + slack * (axis.x.abs() + axis.y.abs() + axis.z.abs());
        p[0].min(p[1]).min(p[2]) > radius || p[0].max(p[1]).max(p[2]) < -radius
    };
    if DVec3::AXES.into_iter().any(apart_along) || apart_along(e[0].cross(e[1])) {
        return false;
    }
    !e.into_iter().any(|edge| DVec3::AXES.into_iter().any(|axis| apart_along(edge.cross(axis))))
}

#[cfg(test)]
mod tests {
    use super::*;

    const UNIT: Aabb = Aabb { min: Vec3::ZERO, max: Vec3::ONE };

    #[test]
    fn touching_overlaps_and_a_cut_corner_does_not() {
        let corner = |d: f32| [Vec3::X * d, Vec3::Y * d, Vec3::Z * d];
        assert!(triangle_overlaps_box(&corner(3.0), &UNIT), "touches the corner (1, 1, 1)");
        assert!(!triangle_overlaps_box(&corner(3.001), &UNIT), "its box overlaps, it does not");
        assert!(triangle_overlaps_box(&[Vec3::X, Vec3::new(2.0, 0.0, 0.0), Vec3::new(2.0, 1.0, 0.0)], &UNIT));
        assert!(!triangle_overlaps_box(&[Vec3::splat(2.0), Vec3::new(2.0, 3.0, 2.0), Vec3::new(3.0, 2.0, 2.0)], &UNIT));
    }

    #[test]
    fn a_flat_cell_works() {
        let flat = Aabb { min: Vec3::ZERO, max: Vec3::new(1.0, 1.0, 0.0) };
        assert!(triangle_overlaps_box(&[Vec3::ZERO, Vec3::X, Vec3::Y], &flat));
        assert!(!triangle_overlaps_box(&[Vec3::Z, Vec3::X + Vec3::Z, Vec3::Y + Vec3::Z], &flat));
    }
}
