//! The form of a cell: a convex polytope, as the polygons of its faces, in 64 bits. Costs and overlays
//! go by it; which triangles a cell holds does not, nor does any ray, so its rounding costs nothing
//! but a little accuracy of the heuristic.

use super::clip::half;
use super::plane::{Plane, Slack};
use crate::geometry::{Aabb, num};
use glam::DVec3;

/// Faces from which on a cell is no longer cut by general planes: what bounds the work for one cell.
pub const MANY_FACES: usize = 32;

/// The faces are polygons whose corners run counterclockwise, seen from outside.
#[derive(Clone, Debug, Default)]
pub struct Polytope {
    corners: Vec<DVec3>,
    /// Where each face's corners end.
    ends: Vec<u32>,
}

/// The areas of the two parts of a polytope.
#[derive(Clone, Copy, Debug)]
pub struct Areas {
    /// Of the part below the plane.
    pub below: f64,
    /// Of the part above it.
    pub above: f64,
}

impl Polytope {
    /// A box.
    pub fn of_box(b: &Aabb) -> Self {
        // Corner k has bit 0 for x, bit 1 for y, bit 2 for z.
        const FACES: [[usize; 4]; 6] = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
        let corners = b.corners().map(|p| p.as_dvec3());
        let mut polytope = Self::default();
        for face in FACES {
            polytope.corners.extend(face.map(|i| corners[i]));
            polytope.close();
        }
        polytope
    }

    /// How many faces it has.
    pub const fn faces(&self) -> usize {
        self.ends.len()
    }

    /// The area of its surface.
    pub fn area(&self) -> f64 {
        self.polygons().map(|face| area_vector(face).length()).sum()
    }

    /// The least box of 32-bit numbers that holds it.
    pub fn bounds(&self) -> Aabb {
        outward(self.corners.iter().copied())
    }

    /// The areas of its parts; `None` if the plane does not divide it.
    ///
    /// The surface of the part below is closed by the cut, and the area vectors of a closed surface add
    /// up to nothing: so the cut has the length of the others' sum, and need not be put together.
    pub fn areas(&self, plane: &Plane, slack: &Slack, scratch: &mut Vec<f64>) -> Option<Areas> {
        if !self.measure(plane, slack, scratch) {
            return None;
        }
        let (mut below, mut above, mut open) = (0.0, 0.0, DVec3::ZERO);
        for (face, distances) in self.polygons().zip(self.split(scratch)) {
            let whole = area_vector(face);
            let part = match extent(distances) {
                (_, high) if high <= 0.0 => whole,
                (low, _) if low >= 0.0 => DVec3::ZERO,
                _ => part_below(face, distances, plane),
            };
            open += part;
            below += part.length();
            above += (whole - part).length();
        }
        let cut = open.length();
        Some(Areas { below: below + cut, above: above + cut })
    }

    /// Its parts below and above the plane; `None` if the plane does not divide it.
    pub fn cut(&self, plane: &Plane, slack: &Slack) -> Option<(Self, Self)> {
        let mut distances = Vec::new();
        if !self.measure(plane, slack, &mut distances) {
            return None;
        }
        let (mut below, mut above, mut rim) = (Self::default(), Self::default(), Vec::new());
        for (face, distances) in self.polygons().zip(self.split(&distances)) {
            let (low, high) = extent(distances);
            if low < 0.0 {
                half(face, distances, plane, 1.0, |p| below.corners.push(p));
                below.close();
            }
            if high > 0.0 {
                half(face, distances, plane, -1.0, |p| above.corners.push(p));
                above.close();
            }
            rim.extend(face.iter().zip(distances).filter(|(_, s)| **s == 0.0).map(|(p, _)| *p));
            half_edges(face, distances, plane, &mut rim);
        }
        around(&mut rim, plane);
        if rim.len() >= 3 {
            below.corners.extend(&rim);
            below.close();
            above.corners.extend(rim.iter().rev());
            above.close();
        }
        Some((below, above))
    }

    /// The distances of all corners from the plane, those in rounding's reach made zero. False if they
    /// are not on both sides.
    fn measure(&self, plane: &Plane, slack: &Slack, distances: &mut Vec<f64>) -> bool {
        distances.clear();
        let snapped = |p: &DVec3| {
            let s = plane.distance(*p);
            if s.abs() <= slack.corner { 0.0 } else { s }
        };
        distances.extend(self.corners.iter().map(snapped));
        let (low, high) = extent(distances);
        low < 0.0 && high > 0.0
    }

    fn polygons(&self) -> impl Iterator<Item = &[DVec3]> {
        self.split(&self.corners)
    }

    /// What is known of each corner, by faces.
    fn split<'a, T>(&'a self, of_corners: &'a [T]) -> impl Iterator<Item = &'a [T]> {
        let mut start = 0;
        self.ends.iter().map(move |end| {
            let range = start..*end as usize;
            start = range.end;
            &of_corners[range]
        })
    }

    fn close(&mut self) {
        let end = num::index(self.corners.len());
        // What rounding left of a face may be no polygon.
        match end - self.ends.last().copied().unwrap_or(0) {
            0..3 => self.corners.truncate(self.ends.last().copied().unwrap_or(0) as usize),
            _ => self.ends.push(end),
        }
    }
}

/// The least box of 32-bit numbers that holds the points.
pub fn outward(points: impl Iterator<Item = DVec3>) -> Aabb {
    let (min, max) =
        points.fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(min, max): (DVec3, DVec3), p| (min.min(p), max.max(p)));
    let mut b = Aabb { min: min.as_vec3(), max: max.as_vec3() };
    for k in 0..3 {
        if f64::from(b.min[k]) > min[k] {
            b.min[k] = b.min[k].next_down();
        }
        if f64::from(b.max[k]) < max[k] {
            b.max[k] = b.max[k].next_up();
        }
    }
    b
}

/// The normal of a polygon, as long as its area.
fn area_vector(corners: &[DVec3]) -> DVec3 {
    let Some((first, rest)) = corners.split_first() else { return DVec3::ZERO };
    rest.windows(2).map(|pair| (pair[0] - first).cross(pair[1] - first)).sum::<DVec3>() * 0.5
}

/// The same of the part of a polygon below the plane, without putting the part together.
fn part_below(corners: &[DVec3], distances: &[f64], plane: &Plane) -> DVec3 {
    let (origin, mut sum) = (corners[0], DVec3::ZERO);
    let (mut first, mut before) = (None, DVec3::ZERO);
    half(corners, distances, plane, 1.0, |p| {
        let p = p - origin;
        sum += before.cross(p);
        first.get_or_insert(p);
        before = p;
    });
    (sum + before.cross(first.unwrap_or(DVec3::ZERO))) * 0.5
}

fn extent(distances: &[f64]) -> (f64, f64) {
    distances.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), s| (low.min(*s), high.max(*s)))
}

/// Where the edges of a face pass through the plane.
fn half_edges(face: &[DVec3], distances: &[f64], plane: &Plane, rim: &mut Vec<DVec3>) {
    for i in 0..face.len() {
        let k = (i + 1) % face.len();
        if distances[i] * distances[k] < 0.0 {
            rim.push(plane.crossing((face[i], distances[i]), (face[k], distances[k])));
        }
    }
}

/// Orders the corners of the cut by the angle around their middle, counterclockwise seen from above
/// the plane, each once: both faces at an edge have given its crossing, the same to the bit.
fn around(rim: &mut Vec<DVec3>, plane: &Plane) {
    let normal = match plane {
        Plane::Axis { axis, .. } => DVec3::AXES[axis.index()],
        Plane::General { normal, .. } => normal.as_dvec3().normalize_or(DVec3::X),
    };
    let (u, v) = normal.any_orthonormal_pair();
    let middle = rim.iter().sum::<DVec3>() / rim.len().max(1) as f64;
    let mut angles: Vec<(f64, DVec3)> = rim.iter().map(|p| ((*p - middle).dot(v).atan2((*p - middle).dot(u)), *p)).collect();
    angles.sort_by(|a, b| a.0.total_cmp(&b.0));
    angles.dedup_by(|a, b| a.1 == b.1);
    rim.clear();
    rim.extend(angles.into_iter().map(|(_, p)| p));
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Axis;
    use glam::Vec3;

    const UNIT: Aabb = Aabb { min: Vec3::ZERO, max: Vec3::ONE };

    fn near(a: f64, b: f64) -> bool {
        (a - b).abs() < 1e-9
    }

    #[test]
    fn a_box_is_cut_by_any_plane_into_parts_that_add_up() {
        let cube = Polytope::of_box(&UNIT);
        let slack = Slack::new(&UNIT);
        assert!(near(cube.area(), 6.0) && cube.bounds() == UNIT);
        let planes = [
            (Plane::Axis { axis: Axis::Y, pos: 0.25 }, 1.0),
            (Plane::through(DVec3::splat(0.5), DVec3::ONE).expect("a direction"), 0.75 * 3f64.sqrt()), // a hexagon
            (Plane::through(DVec3::splat(0.5), DVec3::new(1.0, -1.0, 0.0)).expect("a direction"), 2f64.sqrt()),
            (Plane::through(DVec3::X * 0.5, DVec3::ONE).expect("a direction"), 3f64.sqrt() / 8.0), // cuts off a corner
        ];
        for (plane, cut) in planes {
            let areas = cube.areas(&plane, &slack, &mut Vec::new()).expect("divides it");
            let (below, above) = cube.cut(&plane, &slack).expect("divides it");
            assert!((areas.below + areas.above - 6.0 - 2.0 * cut).abs() < 1e-6, "{plane:?} {areas:?}");
            assert!(near(below.area(), areas.below) && near(above.area(), areas.above), "{plane:?}");
            for part in [&below, &above] {
                let closed = part.polygons().map(area_vector).sum::<DVec3>();
                assert!(closed.length() < 1e-9 && UNIT.contains_box(&part.bounds()), "{plane:?}");
            }
        }
        let beside = Plane::Axis { axis: Axis::Z, pos: 1.0 };
        assert!(cube.areas(&beside, &slack, &mut Vec::new()).is_none() && cube.cut(&beside, &slack).is_none());
    }

    /// Many cuts in a row keep the parts closed and their volumes adding up.
    #[test]
    fn many_cuts_keep_a_polytope_sound() {
        let slack = Slack::new(&UNIT);
        let volume = |p: &Polytope| p.polygons().map(|face| face[0].dot(area_vector(face))).sum::<f64>() / 3.0;
        let mut parts = vec![Polytope::of_box(&UNIT)];
        let mut seed = 3u32;
        let mut next = || {
            seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            f64::from(seed >> 8) / f64::from(1 << 24)
        };
        for _ in 0..12 {
            let point = DVec3::new(next(), next(), next());
            let direction = DVec3::new(next(), next(), next()) - 0.5;
            let plane = Plane::through(point, direction).expect("a direction");
            parts = parts
                .into_iter()
                .flat_map(|part| match part.cut(&plane, &slack) {
                    Some((below, above)) => vec![below, above],
                    None => vec![part],
                })
                .collect();
        }
        assert!(parts.len() > 50);
        assert!(near(parts.iter().map(volume).sum::<f64>(), 1.0));
        for part in &parts {
            let closed = part.polygons().map(area_vector).sum::<DVec3>();
            assert!(closed.length() < 1e-9 && volume(part) > -1e-9 && part.faces() < MANY_FACES);
        }
    }

    #[test]
    fn a_flat_cell_is_cut_too() {
        let flat = Aabb { min: Vec3::ZERO, max: Vec3::new(1.0, 1.0, 0.0) };
        let (cell, slack) = (Polytope::of_box(&flat), Slack::new(&flat));
        let plane = Plane::through(DVec3::new(0.5, 0.5, 0.0), DVec3::new(1.0, 1.0, 0.5)).expect("a direction");
        let areas = cell.areas(&plane, &slack, &mut Vec::new()).expect("divides it");
        assert!((areas.below - 1.0).abs() < 1e-6 && (areas.above - 1.0).abs() < 1e-6, "{areas:?}");
        let (below, above) = cell.cut(&plane, &slack).expect("divides it");
        assert!((below.area() - 1.0).abs() < 1e-6 && (above.area() - 1.0).abs() < 1e-6);
    }
}
