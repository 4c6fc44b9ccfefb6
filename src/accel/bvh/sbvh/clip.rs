//! Cutting a part of a triangle in two at an axis-parallel plane (Stich, Friedrich and Dietrich 2009,
//! §4.2): boxes around both parts, rounded outward, so that together they hold all of it.

use glam::{DVec3, Vec3, Vec4};

use crate::accel::bvh::boxes::{Bounds, PrimBox, lanes};
use crate::geometry::num::narrow;

/// The boxes below and above the plane `axis = pos` of what `part` holds of the triangle; `None`
/// where nothing is.
pub fn cut(part: &PrimBox, corners: &[Vec3; 3], axis: usize, pos: f32) -> [Option<PrimBox>; 2] {
    let (mut below, mut above) = (Bounds::EMPTY, Bounds::EMPTY);
    for i in 0..3 {
        let (a, b) = (corners[i], corners[(i + 1) % 3]);
        if a[axis] <= pos {
            below = below.with(lanes(a));
        }
        if a[axis] >= pos {
            above = above.with(lanes(a));
        }
        if (a[axis] < pos && pos < b[axis]) || (b[axis] < pos && pos < a[axis]) {
            let (low, high) = crossing(a, b, axis, pos);
            (below, above) = (below.with(low).with(high), above.with(low).with(high));
        }
    }
    let whole = part.bounds();
    [below, above].map(|side| {
        let side = side.intersection(whole);
        (!side.is_empty()).then(|| PrimBox::new(&side, part.prim()))
    })
}

/// Where an edge crosses the plane, between two corners of a box that holds it for certain.
fn crossing(a: Vec3, b: Vec3, axis: usize, pos: f32) -> (Vec4, Vec4) {
    let (from, to) = (a.as_dvec3(), b.as_dvec3());
    let t = (f64::from(pos) - from[axis]) / (to[axis] - from[axis]);
    let at: DVec3 = from + (to - from) * t;
    // A rounding to 32 bits is far more than what the sum above is off by.
    let mut low = Vec3::new(narrow(at.x).next_down(), narrow(at.y).next_down(), narrow(at.z).next_down());
    let mut high = Vec3::new(narrow(at.x).next_up(), narrow(at.y).next_up(), narrow(at.z).next_up());
    (low[axis], high[axis]) = (pos, pos);
    (lanes(low), lanes(high))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Aabb;
    use proptest::prelude::*;

    fn point() -> impl Strategy<Value = Vec3> {
        [-1.0f32..1.0, -1.0f32..1.0, -1.0f32..1.0].prop_map(Vec3::from)
    }

    proptest! {
        #[test]
        fn every_point_of_a_part_stays_in_a_side(
            corners in [point(), point(), point()], cuts in proptest::collection::vec((0usize..3, -1.0f32..1.0), 1..6),
            weights in [0.0f32..1.0, 0.0f32..1.0],
        ) {
            let (u, v) = if weights[0] + weights[1] > 1.0 { (1.0 - weights[0], 1.0 - weights[1]) } else { (weights[0], weights[1]) };
            let [a, b, c] = corners.map(|p| p.as_dvec3());
            let p = a + (b - a) * f64::from(u) + (c - a) * f64::from(v);
            let whole = Aabb::of_triangle(&corners);
            let mut part = PrimBox::new(&Bounds::from(&whole), 7);
            for (axis, pos) in cuts {
                let sides = cut(&part, &corners, axis, pos);
                let side = if p[axis] < f64::from(pos) { sides[0] } else { sides[1] };
                prop_assert!(side.is_some(), "the side that holds the point is there");
                part = side.unwrap_or(part);
                prop_assert_eq!(part.prim(), 7);
                let b = part.bounds().aabb();
                let (min, max) = (b.min.as_dvec3(), b.max.as_dvec3());
                prop_assert!(p.cmpge(min - 1e-9).all() && p.cmple(max + 1e-9).all(), "{} in {:?}", p, b);
                prop_assert!(whole.contains_box(&b));
            }
        }
    }
}
