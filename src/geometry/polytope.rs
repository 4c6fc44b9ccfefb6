//! The surface of what some half-spaces have in common.

use glam::DVec3;

/// The points with `normal . x <= offset` are inside.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plane {
    /// Of unit length.
    pub normal: DVec3,
    /// Its distance from the origin, along the normal.
    pub offset: f64,
}

impl Plane {
    /// The half-space `normal . x <= offset` for a normal of any length but zero.
    pub fn new(normal: DVec3, offset: f64) -> Self {
        let length = normal.length();
        Self { normal: normal / length, offset: offset / length }
    }
}

/// The area of the surface of a polytope that is bounded, and lies within `radius` of the origin:
/// of each plane a large square is cut by all other planes (Sutherland and Hodgman 1974). No two
/// planes may be equal. Work grows with the square of the number of planes.
pub fn area(planes: &[Plane], radius: f64) -> f64 {
    let face = |i: usize| {
        let mut polygon = square(&planes[i], radius);
        let mut rest = Vec::new();
        for (j, other) in planes.iter().enumerate() {
            if j != i {
                cut(&polygon, other, radius * 1e-12, &mut rest);
                std::mem::swap(&mut polygon, &mut rest);
            }
            if polygon.len() < 3 {
                return 0.0;
            }
        }
        polygon_area(&polygon)
    };
    (0..planes.len()).map(face).sum()
}

/// A square in the plane that holds whatever of it lies within `radius` of the origin.
fn square(plane: &Plane, radius: f64) -> Vec<DVec3> {
    let (u, v) = plane.normal.any_orthonormal_pair();
    let (at, r) = (plane.normal * plane.offset, 2.0 * radius);
    vec![at + (u + v) * r, at + (v - u) * r, at - (u + v) * r, at + (u - v) * r]
}

/// The part of a convex polygon inside a half-space, within `slack`.
fn cut(polygon: &[DVec3], plane: &Plane, slack: f64, out: &mut Vec<DVec3>) {
    out.clear();
    let over = |p: DVec3| plane.normal.dot(p) - plane.offset - slack;
    for (i, p) in polygon.iter().enumerate() {
        let next = polygon[(i + 1) % polygon.len()];
        let (a, b) = (over(*p), over(next));
        if a <= 0.0 {
            out.push(*p);
        }
        if (a < 0.0 && b > 0.0) || (a > 0.0 && b < 0.0) {
            out.push(*p + (next - *p) * (a / (a - b)));
        }
    }
}

/// The area of a polygon in space, as a fan.
pub fn polygon_area(polygon: &[DVec3]) -> f64 {
    let Some((first, rest)) = polygon.split_first() else { return 0.0 };
    let fan = rest.windows(2).map(|w| (w[0] - *first).cross(w[1] - *first)).sum::<DVec3>();
    0.5 * fan.length()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn known_solids_have_their_areas() {
        let cube: Vec<Plane> = DVec3::AXES.into_iter().flat_map(|n| [Plane::new(n, 1.0), Plane::new(-n, 1.0)]).collect();
        assert!((area(&cube, 2.0) - 24.0).abs() < 1e-9);
        let signs =
            (0..8).map(|i| DVec3::new(1.0 - f64::from(i & 1) * 2.0, 1.0 - f64::from(i & 2), 1.0 - f64::from(i & 4) / 2.0));
        let octahedron: Vec<Plane> = signs.map(|n| Plane::new(n, 1.0)).collect();
        assert!((area(&octahedron, 2.0) - 4.0 * 3.0f64.sqrt()).abs() < 1e-9);
        // Planes that touch an edge or lie outside change nothing.
        let more: Vec<Plane> =
            cube.iter().copied().chain([Plane::new(DVec3::new(1.0, 1.0, 0.0), 2.0), Plane::new(DVec3::ONE, 9.0)]).collect();
        assert!((area(&more, 2.0) - 24.0).abs() < 1e-9);
    }

    #[test]
    fn a_flat_solid_has_two_sides() {
        let flat: Vec<Plane> = DVec3::AXES
            .into_iter()
            .flat_map(|n| [Plane::new(n, if n.z > 0.0 { 0.0 } else { 1.0 }), Plane::new(-n, if n.z > 0.0 { 0.0 } else { 1.0 })])
            .collect();
        assert!((area(&flat, 2.0) - 8.0).abs() < 1e-9);
    }
}
