//! Convex polyhedra as their corners and faces: a box, cut by one half-space after another.
//!
//! A corner is shared by the faces that meet there, so edges are found without comparing coordinates. Cutting is
//! Sutherland and Hodgman's (1974), face by face; the new face is put together from the edges that it left on the plane.

use std::collections::HashMap;

use super::Aabb;
use super::num::index;
use super::polytope::{Plane, polygon_area};
use glam::DVec3;

/// A convex polyhedron, or a flat one with two sides.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Polyhedron {
    corners: Vec<DVec3>,
    /// The corners of each, in order, all seen from outside or all from within.
    faces: Vec<Vec<u32>>,
}

impl Polyhedron {
    /// A box.
    pub fn of_box(b: &Aabb) -> Self {
        Self::of_corners(b.corners().map(|p| p.as_dvec3()))
    }

    /// A box of any orientation, or a parallelepiped: corner k has bit 0 for its first axis, bit 1 for its second, bit 2
    /// for its third.
    pub fn of_corners(corners: [DVec3; 8]) -> Self {
        const FACES: [[u32; 4]; 6] = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
        Self { corners: corners.to_vec(), faces: FACES.iter().map(|face| face.to_vec()).collect() }
    }

    /// Its corners.
    pub fn corners(&self) -> &[DVec3] {
        &self.corners
    }

    /// How many faces it has.
    pub const fn face_count(&self) -> usize {
        self.faces.len()
    }

    /// The corners of each face, in order.
    pub fn faces(&self) -> impl Iterator<Item = Vec<DVec3>> {
        self.faces.iter().map(|face| face.iter().map(|at| self.corner(*at)).collect())
    }

    /// The two ends of each edge.
    pub fn edges(&self) -> impl Iterator<Item = [DVec3; 2]> {
        // The two faces at an edge run along it in opposite directions.
        let ends = self.faces.iter().flat_map(|face| around(face)).filter(|[a, b]| a < b);
        ends.map(|ends| ends.map(|at| self.corner(at)))
    }

    /// The area of its surface; of a flat one that of both sides.
    pub fn area(&self) -> f64 {
        self.faces().map(|face| polygon_area(&face)).sum()
    }

    /// Leaves what lies in a half-space; everything, if nothing else of it would be left. Corners within `slack` of the
    /// plane are on it.
    pub fn cut(&mut self, plane: &Plane, slack: f64) {
        if let Some(inside) = self.inside(plane, slack) {
            *self = inside;
        }
    }

    /// The polygon that a plane has in common with it; no corners if that does not divide it.
    pub fn section(&self, plane: &Plane, slack: f64) -> Vec<DVec3> {
        let inside = self.inside(plane, slack);
        inside.and_then(|inside| inside.faces().last()).unwrap_or_default()
    }

    /// The part in a half-space, with the new face as its last; `None` if the plane does not divide it.
    ///
    /// Where corners that were called on the plane leave no closed rim, which takes faces about as thin as the slack, the
    /// same is tried without slack.
    fn inside(&self, plane: &Plane, slack: f64) -> Option<Self> {
        [slack, 0.0].into_iter().find_map(|slack| {
            let over = self.corners.iter().map(|p| plane.normal.dot(*p) - plane.offset);
            let over: Vec<f64> = over.map(|over| if over.abs() <= slack { 0.0 } else { over }).collect();
            let divided = over.iter().any(|over| *over > 0.0) && over.iter().any(|over| *over < 0.0);
            if divided { Cutting::new(self, over).cut(&self.faces) } else { None }
        })
    }

    fn corner(&self, at: u32) -> DVec3 {
        self.corners[at as usize]
    }

    /// The same without the corners that no face has.
    fn compact(self) -> Self {
        let mut now = HashMap::new();
        let mut corners = Vec::new();
        let mut keep = |at: &u32| {
            *now.entry(*at).or_insert_with(|| {
                corners.push(self.corners[*at as usize]);
                index(corners.len() - 1)
            })
        };
        let faces = self.faces.iter().map(|face| face.iter().map(&mut keep).collect()).collect();
        Self { corners, faces }
    }
}

/// The two ends of each side of a face.
fn around(face: &[u32]) -> impl Iterator<Item = [u32; 2]> {
    (0..face.len()).map(|i| [face[i], face[(i + 1) % face.len()]])
}

/// A polyhedron that is being cut.
struct Cutting {
    /// Those that there were, then where edges pass through the plane.
    corners: Vec<DVec3>,
    /// How far corners lie outside; 0 for those on the plane, the new ones among them.
    over: Vec<f64>,
    /// The corner where an edge passes through.
    crossings: HashMap<[u32; 2], u32>,
    /// Edges that lie on the plane, as the new face runs along them.
    rim: Vec<[u32; 2]>,
}

impl Cutting {
    fn new(of: &Polyhedron, over: Vec<f64>) -> Self {
        Self { corners: of.corners.clone(), over, crossings: HashMap::new(), rim: Vec::new() }
    }

    /// What is left, and the new face; `None` if the rim is not one closed polygon.
    fn cut(mut self, faces: &[Vec<u32>]) -> Option<Polyhedron> {
        let mut left: Vec<Vec<u32>> = faces.iter().filter_map(|face| self.part(face)).collect();
        left.push(closed(&self.rim)?);
        Some(Polyhedron { corners: self.corners, faces: left }.compact())
    }

    /// What is left of a face; `None` if nothing is that has an area.
    fn part(&mut self, face: &[u32]) -> Option<Vec<u32>> {
        let mut kept = Vec::with_capacity(face.len() + 1);
        for [a, b] in around(face) {
            let (from, to) = (self.over[a as usize], self.over[b as usize]);
            if from <= 0.0 {
                kept.push(a);
            }
            if from * to < 0.0 {
                kept.push(self.crossing(a, b));
            }
        }
        if kept.iter().all(|at| self.is_on(*at)) {
            return None;
        }
        let on_plane = around(&kept).filter(|[a, b]| self.is_on(*a) && self.is_on(*b));
        let rim: Vec<[u32; 2]> = on_plane.map(|[a, b]| [b, a]).collect();
        self.rim.extend(rim);
        Some(kept)
    }

    fn is_on(&self, at: u32) -> bool {
        self.over[at as usize] == 0.0
    }

    /// Where an edge passes through the plane: the same corner for both faces at the edge.
    fn crossing(&mut self, a: u32, b: u32) -> u32 {
        let [a, b] = if a < b { [a, b] } else { [b, a] };
        if let Some(known) = self.crossings.get(&[a, b]) {
            return *known;
        }
        let (from, to) = (self.over[a as usize], self.over[b as usize]);
        let (p, q) = (self.corners[a as usize], self.corners[b as usize]);
        self.corners.push(p + (q - p) * (from / (from - to)));
        self.over.push(0.0);
        let new = index(self.corners.len() - 1);
        self.crossings.insert([a, b], new);
        new
    }
}

/// The one polygon that some edges make up, if they do.
fn closed(edges: &[[u32; 2]]) -> Option<Vec<u32>> {
    let first = edges.first()?[0];
    let mut ring = vec![first];
    let mut at = first;
    loop {
        at = edges.iter().find(|edge| edge[0] == at)?[1];
        if at == first {
            return (ring.len() == edges.len() && ring.len() >= 3).then_some(ring);
        }
        if ring.len() == edges.len() {
            return None;
        }
        ring.push(at);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::polytope;
    use glam::Vec3;

    const UNIT: Aabb = Aabb { min: Vec3::ZERO, max: Vec3::ONE };
    const SLACK: f64 = 1e-12;

    fn euler(p: &Polyhedron) -> usize {
        p.corners().len() + p.face_count() - p.edges().count()
    }

    #[test]
    fn a_box_is_cut_into_what_is_expected() {
        let cube = Polyhedron::of_box(&UNIT);
        assert_eq!((cube.corners().len(), cube.edges().count(), cube.face_count(), cube.area()), (8, 12, 6, 6.0));
        let through = |normal: DVec3, offset: f64| {
            let mut part = cube.clone();
            part.cut(&Plane::new(normal, offset), SLACK);
            (part.corners().len(), part.edges().count(), part.face_count())
        };
        assert_eq!(through(DVec3::X, 0.25), (8, 12, 6));
        assert_eq!(through(DVec3::ONE, 2.5), (10, 15, 7), "a corner is cut off");
        assert_eq!(through(DVec3::new(1.0, 1.0, 0.0), 1.0), (6, 9, 5), "through two edges: a prism is left");
        assert_eq!(through(DVec3::ONE, 1.0), (4, 6, 4), "through three corners: one tetrahedron is left");
        for beside in [Plane::new(DVec3::X, 1.0), Plane::new(DVec3::X, 2.0), Plane::new(DVec3::X, -1.0)] {
            let mut same = cube.clone();
            same.cut(&beside, SLACK);
            assert_eq!(same, cube);
            assert!(cube.section(&beside, SLACK).is_empty());
        }
        let hexagon = cube.section(&Plane::new(DVec3::ONE, 1.5), SLACK);
        assert!(hexagon.len() == 6 && (polygon_area(&hexagon) - 0.75 * 3f64.sqrt()).abs() < 1e-12);
    }

    #[test]
    fn many_cuts_keep_corners_on_planes_and_the_formula_of_euler() {
        let mut seed = 3u32;
        let mut next = || {
            seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            f64::from(seed >> 8) / f64::from(1 << 24) - 0.5
        };
        for _ in 0..20 {
            let bounds = Aabb { min: Vec3::NEG_ONE, max: Vec3::ONE };
            let mut planes: Vec<Plane> =
                DVec3::AXES.into_iter().flat_map(|n| [Plane::new(n, 1.0), Plane::new(-n, 1.0)]).collect();
            let mut part = Polyhedron::of_box(&bounds);
            for _ in 0..40 {
                let normal = DVec3::new(next(), next(), next());
                let plane = Plane::new(normal, normal.length() * (0.9 + 0.4 * next()));
                part.cut(&plane, SLACK);
                planes.push(plane);
            }
            assert_eq!(euler(&part), 2);
            assert!((part.area() / polytope::area(&planes, 2.0) - 1.0).abs() < 1e-9);
            for [a, b] in part.edges() {
                let over = |p: DVec3| planes.iter().map(move |plane| plane.normal.dot(p) - plane.offset);
                let tight = |p: DVec3| over(p).filter(|over| over.abs() < 1e-9).count();
                assert!(over(a).chain(over(b)).all(|over| over < 1e-9));
                assert!(tight(a) >= 3 && tight(b) >= 3 && tight((a + b) * 0.5) >= 2);
            }
        }
    }

    #[test]
    fn a_flat_box_keeps_two_sides() {
        let mut flat = Polyhedron::of_box(&Aabb { min: Vec3::ZERO, max: Vec3::new(1.0, 1.0, 0.0) });
        flat.cut(&Plane::new(DVec3::new(1.0, 1.0, 0.5), 1.0), SLACK);
        assert!((flat.area() - 1.0).abs() < 1e-12 && euler(&flat) == 2, "two triangles of one half");
        let before = flat.clone();
        flat.cut(&Plane::new(DVec3::Z, 0.0), SLACK);
        assert_eq!(flat, before);
    }
}
