//! What a section leaves of lines and polygons of a figure.

use glam::Vec3;

use crate::geometry::HalfSpace;

/// The part of a line that is in the half-space, both ends; all of it without one.
pub fn line(section: Option<&HalfSpace>, [a, b]: [Vec3; 2]) -> Option<[Vec3; 2]> {
    let Some(section) = section else { return Some([a, b]) };
    let [high_a, high_b] = [a, b].map(|p| height(section, p));
    match (high_a >= 0.0, high_b >= 0.0) {
        (true, true) => Some([a, b]),
        (true, false) => Some([a, crossing([a, b], [high_a, high_b])]),
        (false, true) => Some([crossing([a, b], [high_a, high_b]), b]),
        (false, false) => None,
    }
}

/// The corners of the part of a convex polygon that is in the half-space (Sutherland and Hodgman 1974); all of them without one.
pub fn polygon(section: Option<&HalfSpace>, corners: &[Vec3]) -> Vec<Vec3> {
    let Some(section) = section else { return corners.to_vec() };
    let mut left = Vec::with_capacity(corners.len() + 1);
    for (a, b) in corners.iter().zip(corners.iter().cycle().skip(1)) {
        let [high_a, high_b] = [*a, *b].map(|p| height(section, p));
        if high_a >= 0.0 {
            left.push(*a);
        }
        if (high_a >= 0.0) != (high_b >= 0.0) {
            left.push(crossing([*a, *b], [high_a, high_b]));
        }
    }
    left
}

/// How far inside a point is; negative outside.
fn height(section: &HalfSpace, p: Vec3) -> f32 {
    let (normal, offset) = section.plane();
    normal.dot(p) + offset
}

/// Where a line crosses the plane, whose ends are on either side.
fn crossing([a, b]: [Vec3; 2], [high_a, high_b]: [f32; 2]) -> Vec3 {
    a + (b - a) * (high_a / (high_a - high_b))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Axis, Side};

    const BELOW: HalfSpace = HalfSpace { axis: Axis::X, at: 0.5, side: Side::Below };

    #[test]
    fn lines_end_at_the_plane() {
        let [left, middle, right] = [0.0, 0.5, 1.0].map(|x| Vec3::new(x, 0.0, 0.0));
        assert_eq!(line(None, [left, right]), Some([left, right]));
        assert_eq!(line(Some(&BELOW), [left, right]), Some([left, middle]));
        assert_eq!(line(Some(&BELOW), [right, left]), Some([middle, left]));
        assert_eq!(line(Some(&BELOW), [middle, middle]), Some([middle, middle]), "what lies in the plane stays");
        assert_eq!(line(Some(&BELOW), [right, right]), None);
        let above = HalfSpace { side: Side::Above, ..BELOW };
        assert_eq!(line(Some(&above), [left, right]), Some([middle, right]));
    }

    #[test]
    fn polygons_lose_what_is_beyond_the_plane() {
        let square = [Vec3::ZERO, Vec3::X, Vec3::X + Vec3::Y, Vec3::Y];
        assert_eq!(polygon(None, &square), square);
        let left = polygon(Some(&BELOW), &square);
        let expected = [Vec3::ZERO, Vec3::X * 0.5, Vec3::new(0.5, 1.0, 0.0), Vec3::Y];
        assert_eq!(left, expected);
        let triangle = [Vec3::ZERO, Vec3::X, Vec3::Y];
        assert_eq!(polygon(Some(&BELOW), &triangle).len(), 4);
        assert!(polygon(Some(&HalfSpace { at: -1.0, ..BELOW }), &square).is_empty());
        assert!(polygon(Some(&BELOW), &[]).is_empty());
    }
}
