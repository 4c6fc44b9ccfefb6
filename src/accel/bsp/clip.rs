//! Cutting convex polygons at planes (Sutherland and Hodgman 1974).

use super::plane::Plane;
use glam::DVec3;

/// Calls `each` for the corners of what is left of a polygon below a plane (`side` 1) or above it
/// (`side` -1), in order. `distances` are those of the corners from the plane.
#[inline(always)]
pub fn half(corners: &[DVec3], distances: &[f64], plane: &Plane, side: f64, mut each: impl FnMut(DVec3)) {
    let Some(last) = corners.len().checked_sub(1) else { return };
    let mut before = (corners[last], distances[last]);
    for corner in corners.iter().copied().zip(distances.iter().copied()) {
        if before.1 * corner.1 < 0.0 {
            each(plane.crossing(before, corner));
        }
        if corner.1 * side <= 0.0 {
            each(corner.0);
        }
        before = corner;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Axis;

    #[test]
    fn the_halves_share_the_cut() {
        let square = [DVec3::ZERO, DVec3::X, DVec3::new(1.0, 1.0, 0.0), DVec3::Y];
        let plane = Plane::Axis { axis: Axis::X, pos: 0.25 };
        let distances = square.map(|p| plane.distance(p));
        let cut = |side| {
            let mut out = Vec::new();
            half(&square, &distances, &plane, side, |p| out.push(p.to_array()));
            out
        };
        assert_eq!(cut(1.0), [[0.0, 0.0, 0.0], [0.25, 0.0, 0.0], [0.25, 1.0, 0.0], [0.0, 1.0, 0.0]]);
        assert_eq!(cut(-1.0), [[0.25, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.25, 1.0, 0.0]]);
    }
}
