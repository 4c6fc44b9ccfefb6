//! The area of the part of a triangle that lies in a box: the triangle clipped at the six faces
//! (Sutherland and Hodgman 1974), in 64 bits.

use super::Aabb;
use glam::{DVec3, Vec3};

/// Three corners, and one more for each face that cuts.
const MOST: usize = 9;

/// A convex polygon in a plane.
#[derive(Clone, Copy, Debug)]
struct Polygon {
    corners: [DVec3; MOST],
    len: usize,
}

/// The area of a triangle.
pub fn area(tri: &[Vec3; 3]) -> f64 {
    let [a, b, c] = tri.map(|p| p.as_dvec3());
    0.5 * (b - a).cross(c - a).length()
}

/// The area of the triangle's part in the closed box; 0 if they do not meet. A triangle in a face of
/// the box is in the box.
pub fn area_in_box(tri: &[Vec3; 3], cell: &Aabb) -> f64 {
    let own = Aabb::of_triangle(tri);
    if cell.contains_box(&own) {
        return area(tri);
    }
    if own.intersection(*cell).is_empty() {
        return 0.0;
    }
    let mut part = Polygon { corners: [DVec3::ZERO; MOST], len: 3 };
    part.corners.iter_mut().zip(tri).for_each(|(to, from)| *to = from.as_dvec3());
    for k in 0..3 {
        // Faces that all corners are within cut nothing.
        if own.min[k] < cell.min[k] {
            part = part.cut(k, f64::from(cell.min[k]), 1.0);
        }
        if own.max[k] > cell.max[k] {
            part = part.cut(k, f64::from(cell.max[k]), -1.0);
        }
    }
    part.area()
}

impl Polygon {
    /// What lies on one side of a plane across axis `k`: above it for `side` 1, below it for -1.
    fn cut(&self, k: usize, pos: f64, side: f64) -> Self {
        let mut kept = Self { corners: [DVec3::ZERO; MOST], len: 0 };
        let corners = &self.corners[..self.len];
        let Some(mut from) = corners.last().copied() else { return kept };
        for to in corners {
            let (before, after) = ((from[k] - pos) * side, (to[k] - pos) * side);
            if (before < 0.0) != (after < 0.0) {
                let mut crossing = from + (*to - from) * (before / (before - after));
                crossing[k] = pos;
                kept.push(crossing);
            }
            if after >= 0.0 {
                kept.push(*to);
            }
            from = *to;
        }
        kept
    }

    /// Rounding can let a nearly flat polygon cross a plane more than twice; what is then too much is
    /// left out, and with it an area of the size of the rounding.
    fn push(&mut self, corner: DVec3) {
        if let Some(free) = self.corners.get_mut(self.len) {
            *free = corner;
            self.len += 1;
        }
    }

    /// Half the length of the summed cross products of a fan from the first corner.
    fn area(&self) -> f64 {
        let corners = &self.corners[..self.len];
        let Some(first) = corners.first() else { return 0.0 };
        let twice: DVec3 = corners.windows(2).map(|edge| (edge[0] - first).cross(edge[1] - first)).sum();
        0.5 * twice.length()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const UNIT: Aabb = Aabb { min: Vec3::ZERO, max: Vec3::ONE };

    fn close(a: f64, b: f64) -> bool {
        (a - b).abs() < 1e-12
    }

    #[test]
    fn known_parts_have_known_areas() {
        let flat = |a: [f32; 2], b: [f32; 2], c: [f32; 2]| [a, b, c].map(|[x, y]| Vec3::new(x, y, 0.5));
        let inside = flat([0.0, 0.0], [1.0, 0.0], [0.0, 1.0]);
        assert!(close(area_in_box(&inside, &UNIT), 0.5) && close(area(&inside), 0.5));
        // The corner beyond x = 1 is cut off: a trapezium of 2 less a triangle of 1/2.
        assert!(close(area_in_box(&flat([0.0, 0.0], [2.0, 0.0], [0.0, 1.0]), &UNIT), 0.75));
        // It covers the whole section of the box.
        assert!(close(area_in_box(&flat([-4.0, -4.0], [8.0, -4.0], [-4.0, 8.0]), &UNIT), 1.0));
        assert_eq!(area_in_box(&flat([2.0, 0.0], [3.0, 0.0], [2.0, 1.0]), &UNIT), 0.0);
        // Their boxes meet, they do not.
        assert_eq!(area_in_box(&flat([1.5, 1.0], [3.0, 1.0], [3.0, -9.0]), &UNIT), 0.0);
    }

    #[test]
    fn the_plane_across_the_diagonal_leaves_a_hexagon() {
        let far = [Vec3::new(9.0, 0.0, 0.0), Vec3::new(0.0, 9.0, 0.0), Vec3::new(0.0, 0.0, 9.0)];
        // Moved so that x + y + z = 3/2, through the middle of the box.
        let tri = far.map(|p| p - Vec3::splat(2.5));
        assert!(close(area_in_box(&tri, &UNIT), 0.75 * 3f64.sqrt()), "{}", area_in_box(&tri, &UNIT));
    }

    #[test]
    fn what_lies_in_a_face_or_ends_there_is_inside() {
        let face = [Vec3::X, Vec3::new(1.0, 1.0, 0.0), Vec3::new(1.0, 0.0, 1.0)];
        assert!(close(area_in_box(&face, &UNIT), 0.5));
        let flat = Aabb { min: Vec3::X, max: Vec3::ONE };
        assert!(close(area_in_box(&face, &flat), 0.5), "a flat box holds what lies in it");
    }

    #[test]
    fn parts_in_the_cells_of_a_box_add_up() {
        let tri = [Vec3::new(-0.3, 0.2, 0.9), Vec3::new(1.4, 0.7, -0.2), Vec3::new(0.4, 1.8, 0.5)];
        let (low, high) = UNIT.split(super::super::Axis::Y, 0.37);
        let sum = area_in_box(&tri, &low) + area_in_box(&tri, &high);
        assert!(close(sum, area_in_box(&tri, &UNIT)) && sum > 0.1);
    }
}
