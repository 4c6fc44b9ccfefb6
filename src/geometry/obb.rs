//! Boxes of any orientation: three slabs perpendicular to each other, within rounding.

use super::Line;
use super::line::{UNIT_SUM, common};
use super::num::{round_down, round_up};
use glam::{DMat3, DVec3, Vec3};

/// The points whose products with the three axes are between `lo` and `hi`, relative to the centre
/// of the scene. The axes are taken as they are in 32 bits, so what they hold is certain though they
/// are perpendicular only within rounding.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub struct Obb {
    /// Of unit length, within rounding.
    pub axes: [Vec3; 3],
    /// The least product with each axis, rounded down.
    pub lo: Vec3,
    /// The greatest product with each axis, rounded up.
    pub hi: Vec3,
}

/// Extents along three axes, as they are gathered.
#[derive(Clone, Copy, Debug)]
pub struct Extents {
    axes: [DVec3; 3],
    lo: DVec3,
    hi: DVec3,
    /// The greatest sum of a point's magnitudes: what 64 bits err in proportion to.
    reach: f64,
}

impl Extents {
    /// Of no points yet.
    pub fn new(axes: [Vec3; 3]) -> Self {
        Self { axes: axes.map(|a| a.as_dvec3()), lo: DVec3::INFINITY, hi: DVec3::NEG_INFINITY, reach: 0.0 }
    }

    /// Takes a point in.
    #[inline]
    pub fn add(&mut self, point: DVec3) {
        let at = DVec3::new(self.axes[0].dot(point), self.axes[1].dot(point), self.axes[2].dot(point));
        (self.lo, self.hi) = (self.lo.min(at), self.hi.max(at));
        self.reach = self.reach.max(point.abs().element_sum());
    }

    /// The area of the surface.
    pub fn area(&self) -> f64 {
        let d = (self.hi - self.lo).max(DVec3::ZERO);
        2.0 * (d.x * d.y + d.y * d.z + d.z * d.x)
    }

    /// The box, rounded outward.
    pub fn obb(&self) -> Obb {
        let slack = DVec3::splat(1e-15 * self.reach);
        let (lo, hi) = ((self.lo - slack).to_array(), (self.hi + slack).to_array());
        Obb { axes: self.axes.map(|a| a.as_vec3()), lo: lo.map(round_down).into(), hi: hi.map(round_up).into() }
    }
}

impl Obb {
    /// Where the line may hit what lies in the box; `None` if it misses. See [`Line`] for the errors.
    #[inline(always)]
    pub fn interval(&self, line: &Line) -> Option<(f32, f32)> {
        let slab = |i: usize| line.through(self.axes[i], UNIT_SUM).interval(self.lo[i], self.hi[i]);
        let (entry, exit) = common(common(slab(0), slab(1)), slab(2));
        if entry > exit {
            return None;
        }
        let (min, max) = self.rounded_box();
        let (entry, exit) = line.in_box(min, max);
        (entry <= exit).then_some((entry, exit))
    }

    /// The box with faces parallel to the axes. For axes that are perpendicular but for 3u and points
    /// within D, that errs by less than 9uD, and by 3uD of rounding.
    #[inline(always)]
    fn rounded_box(&self) -> (Vec3, Vec3) {
        let ends = |i: usize| (self.axes[i] * self.lo[i], self.axes[i] * self.hi[i]);
        let ((a, b), (c, d), (e, f)) = (ends(0), ends(1), ends(2));
        (a.min(b) + c.min(d) + e.min(f), a.max(b) + c.max(d) + e.max(f))
    }

    /// The area of the surface, taking the axes as perpendicular.
    pub fn area(&self) -> f64 {
        let d = self.hi.as_dvec3() - self.lo.as_dvec3();
        2.0 * (d.x * d.y + d.y * d.z + d.z * d.x)
    }

    /// The corners.
    pub fn corners(&self) -> [DVec3; 8] {
        let rows = DMat3::from_cols_array_2d(&self.axes.map(|a| a.as_dvec3().to_array())).transpose();
        let back = rows.inverse();
        std::array::from_fn(|i| {
            let pick = |k: usize| f64::from(if i >> k & 1 == 1 { self.hi[k] } else { self.lo[k] });
            back * DVec3::new(pick(0), pick(1), pick(2))
        })
    }
}

/// Three axes perpendicular to each other that fit some points well: the best, by the area of the
/// box around the points, of the coordinate axes and of those along the edges and normals of a few
/// large triangles among them (Larsson and Källberg 2011, "Fast Computation of Tight-Fitting
/// Oriented Bounding Boxes", DiTO: the base triangle and the two tetrahedra upon it). The points
/// are few, or the extreme ones of many.
pub fn good_axes(points: &[DVec3]) -> [Vec3; 3] {
    let mut best = (f64::INFINITY, Vec3::AXES);
    let mut consider = |axes: [DVec3; 3]| {
        let mut extents = Extents::new(axes.map(|a| a.as_vec3()));
        points.iter().for_each(|p| extents.add(*p));
        if extents.area() < best.0 {
            best = (extents.area(), axes.map(|a| a.as_vec3()));
        }
    };
    consider(DVec3::AXES);
    for [a, b, c] in large_triangles(points) {
        let Some(normal) = (b - a).cross(c - a).try_normalize() else { continue };
        for edge in [b - a, c - b, a - c] {
            if let Some(edge) = edge.try_normalize() {
                consider([edge, normal, edge.cross(normal)]);
            }
        }
    }
    best.1
}

/// A large triangle among the points, and those on its edges towards the points farthest above and
/// below it; none if the points lie on a line.
fn large_triangles(points: &[DVec3]) -> Vec<[DVec3; 3]> {
    let Some([a, b, c]) = base_triangle(points) else { return Vec::new() };
    let mut triangles = vec![[a, b, c]];
    let normal = (b - a).cross(c - a);
    for side in [normal, -normal] {
        let height = |p: &DVec3| side.dot(*p - a);
        let Some(tip) = points.iter().max_by(|p, q| height(p).total_cmp(&height(q))) else { continue };
        if height(tip) > 0.0 {
            triangles.extend([[a, b, *tip], [b, c, *tip], [c, a, *tip]]);
        }
    }
    triangles
}

/// Two points far apart and the one farthest from the line through them; `None` if all are on it.
pub fn base_triangle(points: &[DVec3]) -> Option<[DVec3; 3]> {
    let far = |from: DVec3| super::sphere::farthest(points, from).map(|(p, _)| p);
    let a = far(*points.first()?)?;
    let b = far(a)?;
    let off = |p: &DVec3| (b - a).cross(*p - a).length_squared();
    let c = *points.iter().max_by(|p, q| off(p).total_cmp(&off(q)))?;
    (off(&c) > 0.0).then_some([a, b, c])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_turned_box_is_found_again() {
        let turn = glam::DQuat::from_euler(glam::EulerRot::XYZ, 0.4, 0.7, -0.2);
        let corners: Vec<DVec3> =
            (0..8).map(|i| turn * DVec3::new(f64::from(i & 1), f64::from(i >> 1 & 1) * 0.5, f64::from(i >> 2) * 0.1)).collect();
        let mut extents = Extents::new(good_axes(&corners));
        corners.iter().for_each(|p| extents.add(*p));
        let (exact, obb) = (2.0 * (0.5 + 0.05 + 0.1), extents.obb());
        assert!((obb.area() - exact).abs() < 1e-5, "{} is not {exact}", obb.area());
        for corner in obb.corners() {
            assert!(corners.iter().any(|c| c.distance(corner) < 1e-5));
        }
    }

    #[test]
    fn points_on_a_line_keep_the_coordinate_axes() {
        assert_eq!(good_axes(&[DVec3::X, DVec3::X * 2.0]), Vec3::AXES);
        assert_eq!(good_axes(&[]), Vec3::AXES);
    }
}
