//! The convex hull of some points, by parry3d's quickhull where the points fill space, and in the
//! plane where they are flat.
//!
//! parry3d works in 32 bits and loses its way in sets that are thin: of random slabs with a
//! thickness of 1e-4 of their extent every second hull left points outside. Hulls keep their faces
//! under affine maps, so the points are first brought to equal extents along three axes of their
//! own; then failures are rare. What comes back is checked, and refused if it is no closed
//! surface or leaves a point outside.

use std::panic::{AssertUnwindSafe, catch_unwind};

use super::num::narrow;
use super::obb::base_triangle;
use super::polytope::polygon_area;
use glam::{DMat3, DVec3};

/// The most points that a hull is made of: quickhull calls itself once for each face that a point
/// sees, and the stack of a thread is small.
pub const MOST_POINTS: usize = 4096;

/// Points outside a face by this much of their extent, brought to 1, are put down to rounding.
const OUTSIDE: f64 = 1e-4;

/// A convex hull.
#[derive(Clone, Debug, PartialEq)]
pub struct Hull {
    /// Its corners, taken back from 32 bits.
    pub corners: Vec<DVec3>,
    /// Outward normals of its faces, of unit length, the largest faces first; faces that lie in one
    /// plane, within the tolerance, count as one.
    pub normals: Vec<DVec3>,
    /// The area of its surface, both sides of a flat one.
    pub area: f64,
}

/// The hull of some points; `None` if they are more than [`MOST_POINTS`], lie on a line, or could
/// not be dealt with. Sets no thicker than `tolerance` are taken as flat.
pub fn hull(points: &[DVec3], tolerance: f64) -> Option<Hull> {
    if points.len() > MOST_POINTS {
        return None;
    }
    let frame = Frame::of(points)?;
    if frame.size.z <= tolerance { flat(points, &frame) } else { solid(points, &frame, tolerance) }
}

/// Axes of a point set, and its extent along each.
struct Frame {
    from: DVec3,
    /// The longest extent, across it, and the normal.
    axes: DMat3,
    size: DVec3,
}

impl Frame {
    fn of(points: &[DVec3]) -> Option<Self> {
        let [a, b, c] = base_triangle(points)?;
        let long = (b - a).try_normalize()?;
        let normal = (b - a).cross(c - a).try_normalize()?;
        let axes = DMat3::from_cols(long, normal.cross(long), normal);
        let (mut min, mut max) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        for p in points {
            let at = axes.transpose() * (*p - a);
            (min, max) = (min.min(at), max.max(at));
        }
        let size = max - min;
        // On a line, as far as 64 bits can tell.
        (size.y > 1e-12 * size.x).then(|| Self { from: a + axes * min, axes, size })
    }

    /// A point with its extents brought to 1; a flat extent is left as it is.
    fn enter(&self, p: DVec3) -> DVec3 {
        let at = self.axes.transpose() * (p - self.from);
        DVec3::from_array(std::array::from_fn(|k| if self.size[k] > 0.0 { at[k] / self.size[k] } else { at[k] }))
    }

    fn leave(&self, p: DVec3) -> DVec3 {
        self.from + self.axes * (p * self.size)
    }
}

/// A polygon in the plane of the frame's first two axes (Andrew 1979, monotone chain), as a prism
/// of next to no height.
fn flat(points: &[DVec3], frame: &Frame) -> Option<Hull> {
    let mut sorted: Vec<(DVec3, DVec3)> = points.iter().map(|p| (frame.enter(*p), *p)).collect();
    sorted.sort_by(|(a, _), (b, _)| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)));
    sorted.dedup_by(|(a, _), (b, _)| a.x == b.x && a.y == b.y);
    let turns_left = |[a, b, c]: [DVec3; 3]| (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x) > 0.0;
    let chain = |list: &mut dyn Iterator<Item = &(DVec3, DVec3)>| {
        let mut chain: Vec<(DVec3, DVec3)> = Vec::new();
        for next in list {
            while let [.., a, b] = chain[..] {
                if turns_left([a.0, b.0, next.0]) {
                    break;
                }
                chain.pop();
            }
            chain.push(*next);
        }
        chain.pop();
        chain
    };
    let mut around = chain(&mut sorted.iter());
    around.extend(chain(&mut sorted.iter().rev()));
    if around.len() < 3 {
        return None;
    }
    let corners: Vec<DVec3> = around.into_iter().map(|(_, p)| p).collect();
    let normal = frame.axes.z_axis;
    let mut edges: Vec<DVec3> = (0..corners.len()).map(|i| corners[(i + 1) % corners.len()] - corners[i]).collect();
    let perimeter: f64 = edges.iter().map(|e| e.length()).sum();
    edges.sort_by(|a, b| b.length_squared().total_cmp(&a.length_squared()));
    let sides = edges.iter().filter_map(|edge| edge.cross(normal).try_normalize());
    let area = 2.0 * polygon_area(&corners) + perimeter * frame.size.z;
    Some(Hull { normals: [normal, -normal].into_iter().chain(sides).collect(), corners, area })
}

/// A face of a hull.
struct Face {
    normal: DVec3,
    corners: [DVec3; 3],
    area: f64,
}

fn solid(points: &[DVec3], frame: &Frame, tolerance: f64) -> Option<Hull> {
    let even: Vec<DVec3> = points.iter().map(|p| frame.enter(*p)).collect();
    let (corners, triangles) = quickhull(&even)?;
    let faces = |corners: &[DVec3]| triangles.iter().filter_map(|t| face(t.map(|i| corners[i as usize]))).collect::<Vec<_>>();
    if !is_around(&faces(&corners), &even) {
        return None;
    }
    let corners: Vec<DVec3> = corners.into_iter().map(|p| frame.leave(p)).collect();
    let mut faces = faces(&corners);
    faces.sort_by(|a, b| b.area.total_cmp(&a.area));
    let area = faces.iter().map(|face| face.area).sum();
    Some(Hull { normals: merged(&faces, tolerance), corners, area })
}

/// parry3d's hull of points in the unit cube; `None` if it gives up. It may also panic, on
/// assertions about the rounding of its input.
fn quickhull(points: &[DVec3]) -> Option<(Vec<DVec3>, Vec<[u32; 3]>)> {
    use parry3d::math::Vector;
    let points: Vec<Vector> = points.iter().map(|p| Vector::from(p.to_array().map(narrow))).collect();
    let made = catch_unwind(AssertUnwindSafe(|| parry3d::transformation::try_convex_hull(&points)));
    let (corners, triangles) = made.ok()?.ok()?;
    let there = |t: &[u32; 3]| t.iter().all(|i| (*i as usize) < corners.len());
    let corners: Vec<DVec3> = corners.iter().map(|p| DVec3::from_array(p.to_array().map(f64::from))).collect();
    triangles.iter().all(there).then_some((corners, triangles))
}

/// `None` for a face of no area.
fn face(corners: [DVec3; 3]) -> Option<Face> {
    let cross = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
    Some(Face { normal: cross.try_normalize()?, corners, area: 0.5 * cross.length() })
}

/// Whether the faces close (their areas, as vectors, sum to nothing) and no point is outside one.
/// The normals of slivers are noise and not asked.
fn is_around(faces: &[Face], points: &[DVec3]) -> bool {
    let total: f64 = faces.iter().map(|face| face.area).sum();
    let sum: DVec3 = faces.iter().map(|face| face.normal * face.area).sum();
    let outside = |face: &Face| {
        let longest = (0..3).map(|k| face.corners[k].distance(face.corners[(k + 1) % 3])).fold(0.0, f64::max);
        // How thin a face is says how far rounding of 1e-7 turns it.
        let sliver = face.area <= 1e-3 * longest;
        !sliver && points.iter().any(|p| face.normal.dot(*p - face.corners[0]) > OUTSIDE)
    };
    total > 0.0 && sum.length() <= 1e-5 * total && !faces.iter().any(outside)
}

/// The normals of the faces, largest first, those left out that lie in the plane of a larger one.
fn merged(faces: &[Face], tolerance: f64) -> Vec<DVec3> {
    let mut kept: Vec<&Face> = Vec::new();
    for face in faces {
        let in_plane = |other: &&Face| {
            let below = |p: &DVec3| other.normal.dot(other.corners[0] - *p) <= tolerance;
            other.normal.dot(face.normal) > 0.5 && face.corners.iter().all(below)
        };
        // Beyond what anybody keeps there is nothing left to compare with.
        if kept.len() <= MOST_MERGED && !kept.iter().any(in_plane) {
            kept.push(face);
        }
    }
    kept.into_iter().map(|face| face.normal).collect()
}

/// The most planes that [`Hull::normals`] tells apart; there is one more where there are more.
pub const MOST_MERGED: usize = 64;

#[cfg(test)]
mod tests {
    use super::*;

    const TOLERANCE: f64 = 1e-6;

    fn cube(size: DVec3) -> Vec<DVec3> {
        (0..8).map(|i| DVec3::new(f64::from(i & 1), f64::from(i >> 1 & 1), f64::from(i >> 2)) * size).collect()
    }

    #[test]
    fn a_box_has_six_faces_however_thin() {
        for thin in [1.0, 1e-2, 1e-4, 2e-6] {
            let size = DVec3::new(1.0, 0.5, thin);
            let mut points = cube(size);
            points.extend((1..9).map(|i| size * f64::from(i) * 0.1));
            let hull = hull(&points, TOLERANCE).expect("a hull");
            let exact = 2.0 * (size.x * size.y + size.y * size.z + size.z * size.x);
            assert_eq!((hull.normals.len(), hull.corners.len()), (6, 8), "{thin}");
            assert!((hull.area / exact - 1.0).abs() < 1e-5, "{thin}: {} is not {exact}", hull.area);
        }
    }

    #[test]
    fn a_flat_set_is_a_polygon_with_two_sides() {
        let turn = glam::DQuat::from_euler(glam::EulerRot::XYZ, 0.3, 0.8, 0.1);
        let square: Vec<DVec3> = cube(DVec3::new(1.0, 1.0, 0.0))
            .into_iter()
            .chain([DVec3::new(0.5, 0.5, 0.0), DVec3::X * 0.5])
            .map(|p| turn * p)
            .collect();
        let hull = hull(&square, TOLERANCE).expect("a hull");
        assert_eq!((hull.normals.len(), hull.corners.len()), (6, 4));
        assert!((hull.area - 2.0).abs() < 1e-9);
    }

    #[test]
    fn no_hull_of_a_line_or_of_too_many() {
        assert_eq!(hull(&[], TOLERANCE), None);
        assert_eq!(hull(&[DVec3::ONE; 5], TOLERANCE), None);
        assert_eq!(hull(&[DVec3::ZERO, DVec3::X, DVec3::X * 3.0], TOLERANCE), None);
        assert_eq!(hull(&vec![DVec3::ZERO; MOST_POINTS + 1], TOLERANCE), None);
    }

    #[test]
    fn a_ball_is_found_whole() {
        let points: Vec<DVec3> = (0..2000)
            .map(|i| (f64::from(i) * 2.399_963, 1.0 - (f64::from(i) + 0.5) / 1000.0))
            .map(|(a, z)| DVec3::new(a.cos() * (1.0 - z * z).sqrt(), a.sin() * (1.0 - z * z).sqrt(), z))
            .collect();
        let hull = hull(&points, TOLERANCE).expect("a hull");
        assert_eq!(hull.corners.len(), 2000);
        assert!(hull.normals.len() > MOST_MERGED && (hull.area / (4.0 * std::f64::consts::PI) - 1.0).abs() < 5e-3);
    }
}
