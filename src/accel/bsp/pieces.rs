//! The triangles of a cell, each cut down to the part of it that lies there.
//!
//! A triangle that no plane has cut yet is only its index; of the others the polygon that is left is
//! kept. A triangle within the plane's band on one side goes to the other side alone, so a cell may
//! lack what lies that near to its planes; the traversal makes up for it (see [`super::crossing`]).
//!
//! A triangle hardly wider than rounding is dealt by its box instead. There the tests say little more
//! than that a ray meets the box: Möller and Trumbore's divides by a determinant that is all noise, and
//! finds hits well beside the triangle. With its box it is in every cell where any test may find it.

use super::clip::half;
use super::plane::{Plane, Sides, Slack};
use super::polytope::outward;
use crate::geometry::{Aabb, num};
use crate::scene::{Geometry, PrimRef};
use crate::task::{Cancel, Cancelled};
use glam::DVec3;

/// Triangles handled between two looks at the cancel flag.
const CHUNK: usize = 1 << 14;

/// A triangle in a cell.
#[derive(Clone, Copy, Debug)]
pub struct Piece {
    /// The box around the part of it that lies in the cell.
    pub bounds: Aabb,
    /// The triangle.
    pub prim: PrimRef,
    /// Where the corners of that part begin, and how many there are; none if it was never cut,
    /// [`BOXED`] if its box stands for it.
    first: u32,
    count: u32,
}

const BOXED: u32 = u32::MAX;

/// All of a cell.
#[derive(Debug, Default)]
pub struct Pieces {
    list: Vec<Piece>,
    corners: Vec<DVec3>,
}

/// The corners of one piece and their distances from a plane, filled again for each.
#[derive(Default)]
struct Scratch {
    corners: Vec<DVec3>,
    distances: Vec<f64>,
}

impl Piece {
    /// A triangle that no plane has cut.
    pub fn whole(prim: PrimRef, geometry: &Geometry, slack: &Slack) -> Self {
        let tri = geometry.corners(prim);
        let [a, b, c] = tri.map(|p| p.as_dvec3());
        let longest = (b - a).length().max((c - b).length()).max((a - c).length());
        let is_sliver = (b - a).cross(c - a).length() <= slack.sliver * longest;
        Self { bounds: Aabb::of_triangle(&tri), prim, first: 0, count: if is_sliver { BOXED } else { 0 } }
    }

    /// How many corners the list holds for it.
    const fn kept(&self) -> usize {
        if self.count == BOXED { 0 } else { self.count as usize }
    }

    /// How near to a plane it may lie and be on one side only.
    const fn band(&self, plane: &Plane, slack: &Slack) -> f64 {
        slack.of(plane, self.kept() > 0)
    }
}

impl Pieces {
    /// Triangles that no plane has cut.
    pub const fn whole(list: Vec<Piece>) -> Self {
        Self { list, corners: Vec::new() }
    }

    /// All of them.
    pub fn list(&self) -> &[Piece] {
        &self.list
    }

    /// Bytes that it holds.
    pub fn bytes(&self) -> u64 {
        (size_of_val(&self.list[..]) + size_of_val(&self.corners[..])) as u64
    }

    /// Appends the corners of what is left of a piece.
    pub fn corners(&self, piece: &Piece, geometry: &Geometry, into: &mut Vec<DVec3>) {
        match piece.count {
            0 => into.extend(geometry.corners(piece.prim).map(|p| p.as_dvec3())),
            BOXED => into.extend(piece.bounds.corners().map(|p| p.as_dvec3())),
            _ => into.extend_from_slice(self.polygon(piece)),
        }
    }

    /// What lies on each side of a plane.
    pub fn deal(&self, plane: &Plane, slack: &Slack, geometry: &Geometry, cancel: &Cancel) -> Result<(Self, Self), Cancelled> {
        let (mut below, mut above, mut scratch) = (Self::default(), Self::default(), Scratch::default());
        for chunk in self.list.chunks(CHUNK) {
            cancel.check()?;
            for piece in chunk {
                let sides = by_box(piece, plane).unwrap_or_else(|| {
                    scratch.fill(self, piece, plane, geometry);
                    scratch.sides(piece.band(plane, slack))
                });
                match sides {
                    Sides::Below => below.take(piece, self),
                    Sides::Above => above.take(piece, self),
                    Sides::Both => {
                        below.take_part(piece, plane, 1.0, &scratch);
                        above.take_part(piece, plane, -1.0, &scratch);
                    }
                }
            }
        }
        Ok((below, above))
    }

    /// Takes a piece as it is.
    fn take(&mut self, piece: &Piece, from: &Self) {
        let first = num::index(self.corners.len());
        self.corners.extend_from_slice(from.polygon(piece));
        self.list.push(Piece { first, ..*piece });
    }

    fn polygon(&self, piece: &Piece) -> &[DVec3] {
        &self.corners[piece.first as usize..][..piece.kept()]
    }

    /// Takes the part of a piece on one side.
    fn take_part(&mut self, piece: &Piece, plane: &Plane, side: f64, whole: &Scratch) {
        if piece.count == BOXED {
            self.list.push(Piece { bounds: half_box(piece.bounds, plane, side), first: 0, ..*piece });
            return;
        }
        let first = self.corners.len();
        half(&whole.corners, &whole.distances, plane, side, |p| self.corners.push(p));
        let part = &self.corners[first..];
        let bounds = outward(part.iter().copied()).intersection(piece.bounds);
        self.list.push(Piece { bounds, prim: piece.prim, first: num::index(first), count: num::index(part.len()) });
    }
}

/// The answer where the box alone gives it.
#[inline(always)]
fn by_box(piece: &Piece, plane: &Plane) -> Option<Sides> {
    let Plane::Axis { axis, pos } = plane else { return None };
    let (min, max) = (piece.bounds.min[axis.index()], piece.bounds.max[axis.index()]);
    if max <= *pos { Some(Sides::Below) } else { (min >= *pos).then_some(Sides::Above) }
}

/// What is left of a box below (`side` 1) or above a plane, or all of it where that is no box.
fn half_box(bounds: Aabb, plane: &Plane, side: f64) -> Aabb {
    let Plane::Axis { axis, pos } = *plane else { return bounds };
    let (below, above) = bounds.split(axis, pos);
    if side > 0.0 { below } else { above }
}

impl Scratch {
    fn fill(&mut self, pieces: &Pieces, piece: &Piece, plane: &Plane, geometry: &Geometry) {
        self.corners.clear();
        pieces.corners(piece, geometry, &mut self.corners);
        self.distances.clear();
        self.distances.extend(self.corners.iter().map(|p| plane.distance(*p)));
    }

    fn sides(&self, band: f64) -> Sides {
        let (low, high) =
            self.distances.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), s| (low.min(*s), high.max(*s)));
        Sides::of(low, high, band)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Axis;
    use crate::scene::{Instance, LoadCx, Mesh, Scene};
    use glam::Vec3;

    fn geometry(positions: &[[f32; 3]], triangles: &[[u32; 3]]) -> Geometry {
        let positions = positions.iter().map(|p| Vec3::from(*p)).collect();
        let mesh = Mesh { positions, triangles: triangles.to_vec(), ..Mesh::default() };
        let scene = Scene { meshes: vec![mesh], instances: vec![Instance::identity(0)], ..Scene::default() };
        Geometry::new(&scene, &LoadCx::unattended()).expect("small")
    }

    #[test]
    fn a_triangle_is_dealt_to_each_side_it_reaches() {
        let corners = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.25, 0.0, 0.0], [0.25, 1.0, 0.0], [0.25, 0.0, 1.0]];
        let geometry = geometry(&corners, &[[0, 1, 2], [3, 4, 5]]);
        let slack = Slack::new(geometry.bounds());
        let pieces = Pieces::whole(vec![Piece::whole(0, &geometry, &slack), Piece::whole(1, &geometry, &slack)]);
        let prims = |pieces: &Pieces| pieces.list.iter().map(|p| p.prim).collect::<Vec<_>>();

        let plane = Plane::Axis { axis: Axis::X, pos: 0.25 };
        let (below, above) = pieces.deal(&plane, &slack, &geometry, &Cancel::new()).expect("not cancelled");
        assert_eq!((prims(&below), prims(&above)), (vec![0, 1], vec![0]), "what lies in the plane is below");
        assert_eq!(below.list[0].bounds, Aabb { min: Vec3::ZERO, max: Vec3::new(0.25, 1.0, 0.0) });
        assert_eq!(above.list[0].bounds, Aabb { min: Vec3::new(0.25, 0.0, 0.0), max: Vec3::new(1.0, 0.75, 0.0) });
        assert_eq!((below.list[0].count, above.list[0].count), (4, 3));

        // The part that is left beyond both planes is a triangle again.
        let slanted = Plane::through(DVec3::new(0.5, 0.0, 0.0), DVec3::new(1.0, 1.0, 1.0)).expect("a direction");
        let (_, corner) = above.deal(&slanted, &slack, &geometry, &Cancel::new()).expect("not cancelled");
        assert_eq!((prims(&corner), corner.list[0].count), (vec![0], 4));
        assert!(above.list[0].bounds.contains_box(&corner.list[0].bounds));
    }

    #[test]
    fn a_sliver_is_dealt_by_its_box() {
        let corners = [[0.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.5, 0.500_000_1, 0.0]];
        let geometry = geometry(&corners, &[[0, 1, 2]]);
        let slack = Slack::new(geometry.bounds());
        let pieces = Pieces::whole(vec![Piece::whole(0, &geometry, &slack)]);
        // Beside the triangle, but not beside its box.
        let plane = Plane::through(DVec3::new(0.25, 0.75, 0.0), DVec3::new(-1.0, 1.0, 0.0)).expect("a direction");
        let (below, above) = pieces.deal(&plane, &slack, &geometry, &Cancel::new()).expect("not cancelled");
        assert_eq!((below.list[0].bounds, above.list[0].bounds), (*geometry.bounds(), *geometry.bounds()));
    }
}
