//! The part of a triangle inside a box (Sutherland and Hodgman 1974), in 64 bits, bounded outward.
//!
//! Bounds hold every point of the part. A corner that comes from the triangle is exact. One that
//! comes from cutting an edge is off by at most a few roundings of the greatest coordinate M on
//! each axis: 5uM beside the edge, and 6uM along it, which is as good as a plane that far off (u
//! is the unit roundoff of 64 bits). Six cuts add up to 36uM at most, so every plane keeps 64uM
//! more than it should, and every corner that was made by cutting counts as a box of 64uM around
//! itself. A coordinate that both ends of the edge share exactly stays as it is: otherwise a
//! triangle that ends at a plane would reach across it by a rounding, and fill cells beyond.

use super::num::{narrow_down, narrow_up};
use super::{Aabb, Axis};
use glam::Vec3;

/// 64u: what is kept beyond a plane and around a corner, relative to the greatest coordinate.
const SLACK: f64 = 32.0 * f64::EPSILON;

/// Six cuts leave at most nine corners; the rest is for polygons that rounding made not quite convex.
const MOST: usize = 12;

/// A corner of what is left.
#[derive(Clone, Copy, Debug, Default)]
struct Corner {
    at: [f64; 3],
    /// Whether each coordinate is free of rounding, or on a plane that the bounds end at anyway.
    exact: [bool; 3],
}

impl Corner {
    /// Where the edge from `self` to `to` meets the plane, which lies between them.
    fn cross(&self, to: &Self, k: usize, plane: f64) -> Self {
        let t = (plane - self.at[k]) / (to.at[k] - self.at[k]);
        let mut met = Self::default();
        for j in 0..3 {
            let (a, b) = (self.at[j], to.at[j]);
            met.at[j] = a + (b - a) * t;
            met.exact[j] = a == b && self.exact[j] && to.exact[j];
        }
        (met.at[k], met.exact[k]) = (plane, true);
        met
    }
}

/// The part of a triangle inside a box: a convex polygon.
#[derive(Clone, Debug)]
pub struct Clipped {
    corners: [Corner; MOST],
    count: usize,
    /// Rounding made more corners than there is room for: all that is known is the box.
    full: bool,
    /// What lies in it was asked for, and no more.
    cell: Aabb,
    slack: [f64; 3],
}

impl Clipped {
    /// The part of the triangle inside `cell`; coordinates are finite.
    pub fn new(tri: &[Vec3; 3], cell: &Aabb) -> Self {
        let around = Aabb::of_triangle(tri);
        let corner = |p: Vec3| Corner { at: p.as_dvec3().to_array(), exact: [true; 3] };
        let slack = (around.min.abs().max(around.max.abs()).as_dvec3() * SLACK).to_array();
        let mut part =
            Self { corners: [Corner::default(); MOST], count: 3, full: false, cell: around.intersection(*cell), slack };
        for (to, from) in part.corners.iter_mut().zip(tri) {
            *to = corner(*from);
        }
        for (k, slack) in slack.into_iter().enumerate() {
            if around.min[k] < cell.min[k] {
                part.cut(k, f64::from(cell.min[k]) - slack, false);
            }
            if around.max[k] > cell.max[k] {
                part.cut(k, f64::from(cell.max[k]) + slack, true);
            }
        }
        part
    }

    /// The tightest box around the part, rounded outward but within the cell; empty if there is
    /// nothing of the triangle in it.
    pub fn bounds(&self) -> Aabb {
        let mut extent = Extent::EMPTY;
        self.corners[..self.count].iter().for_each(|corner| extent.take(corner, &self.slack));
        self.outward(&extent, self.cell)
    }

    /// The same of what lies below, and of what lies above the plane `axis = pos`: one pass for both.
    pub fn halves(&self, axis: Axis, pos: f32) -> (Aabb, Aabb) {
        let k = axis.index();
        let (low_end, high_end) = (f64::from(pos) + self.slack[k], f64::from(pos) - self.slack[k]);
        let (mut low, mut high) = (Extent::EMPTY, Extent::EMPTY);
        let mut from = &self.corners[self.count.saturating_sub(1)];
        for to in &self.corners[..self.count] {
            let (a, b) = (from.at[k], to.at[k]);
            if (a <= low_end) != (b <= low_end) {
                low.take(&from.cross(to, k, low_end), &self.slack);
            }
            if (a >= high_end) != (b >= high_end) {
                high.take(&from.cross(to, k, high_end), &self.slack);
            }
            if b <= low_end {
                low.take(to, &self.slack);
            }
            if b >= high_end {
                high.take(to, &self.slack);
            }
            from = to;
        }
        let (below, above) = self.cell.split(axis, pos);
        (self.outward(&low, self.cell.intersection(below)), self.outward(&high, self.cell.intersection(above)))
    }

    /// Leaves what is at most `plane` (or at least, if not `below`).
    fn cut(&mut self, k: usize, plane: f64, below: bool) {
        let inside = |corner: &Corner| if below { corner.at[k] <= plane } else { corner.at[k] >= plane };
        if self.full || self.corners[..self.count].iter().all(inside) {
            return;
        }
        let (old, count) = (self.corners, self.count);
        self.count = 0;
        let mut from = &old[count.saturating_sub(1)];
        for to in &old[..count] {
            if inside(from) != inside(to) {
                self.push(from.cross(to, k, plane));
            }
            if inside(to) {
                self.push(*to);
            }
            from = to;
        }
    }

    fn push(&mut self, corner: Corner) {
        if self.count < MOST {
            self.corners[self.count] = corner;
            self.count += 1;
        } else {
            self.full = true;
        }
    }

    fn outward(&self, extent: &Extent, within: Aabb) -> Aabb {
        let bounds = if self.full { within } else { extent.outward().intersection(within) };
        if bounds.is_empty() { Aabb::EMPTY } else { bounds }
    }
}

/// The range of some corners.
struct Extent {
    min: [f64; 3],
    max: [f64; 3],
}

impl Extent {
    const EMPTY: Self = Self { min: [f64::INFINITY; 3], max: [f64::NEG_INFINITY; 3] };

    #[inline(always)]
    fn take(&mut self, corner: &Corner, slack: &[f64; 3]) {
        for (j, slack) in slack.iter().enumerate() {
            let around = if corner.exact[j] { 0.0 } else { *slack };
            self.min[j] = self.min[j].min(corner.at[j] - around);
            self.max[j] = self.max[j].max(corner.at[j] + around);
        }
    }

    fn outward(&self) -> Aabb {
        Aabb { min: Vec3::from(self.min.map(narrow_down)), max: Vec3::from(self.max.map(narrow_up)) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;
    use proptest::prelude::*;

    const UNIT: Aabb = Aabb { min: Vec3::ZERO, max: Vec3::ONE };

    fn bounds(tri: &[Vec3; 3], cell: &Aabb) -> Aabb {
        Clipped::new(tri, cell).bounds()
    }

    #[test]
    fn a_triangle_inside_keeps_its_box() {
        let tri = [Vec3::new(0.1, 0.2, 0.3), Vec3::new(0.9, 0.2, 0.3), Vec3::new(0.1, 0.7, 0.4)];
        assert_eq!(bounds(&tri, &UNIT), Aabb::of_triangle(&tri));
        let whole = Aabb { min: Vec3::splat(-9.0), max: Vec3::splat(9.0) };
        let (low, high) = Clipped::new(&tri, &whole).halves(Axis::X, 0.1);
        assert_eq!(high, Aabb::of_triangle(&tri));
        assert_eq!((low.min.x, low.max.x), (0.1, 0.1), "it touches the plane");
    }

    #[test]
    fn a_cut_corner_has_a_small_box() {
        // The plane x + y = 1.5 of the square: the part in the unit square has x and y above 0.5.
        let tri = [Vec3::new(1.5, 0.0, 0.5), Vec3::new(0.0, 1.5, 0.5), Vec3::new(1.5, 1.5, 0.5)];
        let part = bounds(&tri, &UNIT);
        assert!(part.min.x <= 0.5 && part.min.x > 0.499_999 && part.max.x == 1.0, "{part:?}");
        assert_eq!((part.min.z, part.max.z), (0.5, 0.5), "the plane it lies in is not widened");
    }

    #[test]
    fn what_only_touches_is_kept_and_what_is_apart_is_not() {
        let at = |d: f32| [Vec3::new(d, 0.0, 0.0), Vec3::new(2.0, 0.0, 0.0), Vec3::new(2.0, 1.0, 1.0)];
        let touching = bounds(&at(1.0), &UNIT);
        assert!(touching.contains_box(&Aabb { min: Vec3::X, max: Vec3::X }) && touching.size().max_element() < 1e-13);
        assert!(bounds(&at(1.0f32.next_up()), &UNIT).is_empty());
        let corner = |d: f32| [Vec3::X * d, Vec3::Y * d, Vec3::Z * d];
        assert!(!bounds(&corner(3.0), &UNIT).is_empty(), "touches the corner (1, 1, 1)");
        assert!(bounds(&corner(3.001), &UNIT).is_empty(), "its box overlaps, it does not");
    }

    #[test]
    fn a_shared_coordinate_stays_exact() {
        // A right triangle of a height field: cut across x, it must not grow along z.
        let z = 0.1f32 + 0.2;
        let tri = [Vec3::new(0.0, 0.3, z), Vec3::new(1.0, 0.7, z), Vec3::new(0.0, 0.1, 0.7)];
        let (low, high) = Clipped::new(&tri, &UNIT).halves(Axis::X, 0.3);
        assert_eq!((low.min.z, high.min.z), (z, z));
    }

    fn coordinate() -> impl Strategy<Value = f32> {
        // Few distinct values, so that corners, edges and planes coincide; ordinary and tiny ones.
        prop_oneof![4 => (-4i8..=4).prop_map(|i| f32::from(i) * 0.25), 4 => -1.0f32..1.0, 1 => Just(1e-20f32),
            1 => Just(-0.0f32), 1 => Just(1.0f32.next_up()), 1 => Just(0.25f32.next_down())]
    }

    fn vector() -> impl Strategy<Value = Vec3> {
        (coordinate(), coordinate(), coordinate()).prop_map(|(x, y, z)| Vec3::new(x, y, z))
    }

    /// A weight of a corner: corners and edges themselves, and what lies between.
    fn weight() -> impl Strategy<Value = f64> {
        prop_oneof![1 => Just(0.0), 3 => 0.0f64..1.0, 1 => Just(0.5)]
    }

    /// Triangles, among them slivers, needles and points, moved far out now and then.
    fn triangle() -> impl Strategy<Value = [Vec3; 3]> {
        (vector(), vector(), vector(), 0u8..6).prop_map(|(a, b, c, form)| match form {
            0 => [a, b, a.midpoint(b)],
            1 => [a, a, b],
            2 => [a, b, b + c * 1e-7],
            3 => [a * 100.0, b * 100.0, c],
            _ => [a, b, c],
        })
    }

    /// The point of the triangle by weights, in 64 bits: off by a rounding or two.
    fn point(tri: &[Vec3; 3], w: [f64; 3]) -> DVec3 {
        let sum: f64 = w.iter().sum();
        tri.iter().zip(w).map(|(p, w)| p.as_dvec3() * (w / sum)).sum()
    }

    /// Whether the box holds the point, but for the rounding of the point itself.
    fn holds(b: &Aabb, p: DVec3, off: f64) -> bool {
        (p - off).cmple(b.max.as_dvec3()).all() && (p + off).cmpge(b.min.as_dvec3()).all()
    }

    proptest! {
        #![proptest_config(ProptestConfig { cases: 2000, failure_persistence: None, ..ProptestConfig::default() })]

        #[test]
        fn bounds_hold_every_point_and_stay_within(
            tri in triangle(), a in vector(), b in vector(), axis in 0usize..3, pos in coordinate(),
            weights in proptest::collection::vec((weight(), weight(), weight()), 40),
        ) {
            let cell = Aabb { min: a.min(b), max: a.max(b) };
            let part = Clipped::new(&tri, &cell);
            let (whole, (low, high)) = (part.bounds(), part.halves(Axis::ALL[axis], pos));
            let (below, above) = cell.split(Axis::ALL[axis], pos);
            prop_assert!(cell.contains_box(&whole) && Aabb::of_triangle(&tri).contains_box(&whole));
            prop_assert!(below.contains_box(&low) && above.contains_box(&high));
            let off = 4.0 * f64::EPSILON * tri.iter().map(|p| f64::from(p.abs().max_element())).fold(0.0, f64::max);
            for (u, v, w) in weights.into_iter().filter(|(u, v, w)| u + v + w > 0.0) {
                let p = point(&tri, [u, v, w]);
                if !holds(&cell, p, 0.0) {
                    continue;
                }
                prop_assert!(holds(&whole, p, off), "{:?} is outside {:?}", p, whole);
                let side = if p[axis] <= f64::from(pos) { &low } else { &high };
                prop_assert!(holds(side, p, off), "{:?} is outside {:?}", p, side);
            }
        }

        #[test]
        fn what_overlaps_is_found_and_the_bounds_are_tight(tri in triangle(), a in vector(), b in vector()) {
            let cell = Aabb { min: a.min(b), max: a.max(b) };
            let part = bounds(&tri, &cell);
            if !part.is_empty() {
                prop_assert!(crate::geometry::triangle_overlaps_box(&tri, &part), "{:?} holds nothing", part);
            }
            // Cut twice is cut once, but for the rounding of the first box.
            let again = bounds(&tri, &part);
            prop_assert!(part.contains_box(&again));
        }
    }
}
