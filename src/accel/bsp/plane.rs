//! The planes that divide cells, and which side of them a point is on.
//!
//! A plane through three corners is in general no plane of 32-bit numbers. So the plane that divides
//! is the one that the node stores, and the build asks for sides of that very plane: in 64 bits the
//! products of 32-bit numbers are exact, and a distance errs by less than `2^-49 R`, where R is the
//! greatest coordinate of the scene. The corners that gave the plane lie as near to it as its
//! rounding leaves them, at most `2 sqrt(3) uR` by the normal and `sqrt(3) uR` by the offset; what is
//! that near is called on the plane: the [`Slack::band`], `8uR`. It is so much wider than the error of
//! 64 bits that no exact predicate could change an answer that counts.

use crate::geometry::num::{UNIT_ROUNDOFF, narrow};
use crate::geometry::{Aabb, Axis};
use glam::{DVec3, Vec3};

/// A plane as a node stores it: the points p with `normal . p = offset`, or `p[axis] = pos`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Plane {
    /// Perpendicular to an axis.
    Axis {
        /// Which one.
        axis: Axis,
        /// Where it crosses the axis.
        pos: f32,
    },
    /// Of any direction.
    General {
        /// Of unit length, within rounding.
        normal: Vec3,
        /// The distance from the origin, along the normal.
        offset: f32,
    },
}

/// How near is near, in a scene.
#[derive(Clone, Copy, Debug)]
pub struct Slack {
    /// What is not farther from a general plane than this is on it.
    pub band: f64,
    /// The same for the cut corners of a triangle and a plane perpendicular to an axis: cutting rounds.
    pub cut: f64,
    /// A triangle that is not wider than this is hardly told from a line.
    pub sliver: f64,
    /// Corners of a cell that are not farther from a plane than this are on it.
    pub corner: f64,
}

impl Slack {
    /// For a scene inside `bounds`.
    pub fn new(bounds: &Aabb) -> Self {
        let reach = f64::from(bounds.min.abs().max(bounds.max.abs()).max_element());
        let u = f64::from(UNIT_ROUNDOFF);
        Self { band: 8.0 * u * reach, cut: reach * u * u.sqrt(), sliver: 64.0 * u * reach, corner: reach * 2f64.powi(-44) }
    }

    /// The part of a plane's surroundings that counts as on it, for a triangle that was cut or not.
    pub const fn of(&self, plane: &Plane, was_cut: bool) -> f64 {
        match plane {
            Plane::General { .. } => self.band,
            Plane::Axis { .. } if was_cut => self.cut,
            Plane::Axis { .. } => 0.0,
        }
    }
}

impl Plane {
    /// The plane through a point, perpendicular to a direction. `None` if the direction has no length.
    pub fn through(point: DVec3, direction: DVec3) -> Option<Self> {
        let normal = direction.try_normalize()?.as_vec3();
        for axis in Axis::ALL {
            let k = axis.index();
            if normal[(k + 1) % 3] == 0.0 && normal[(k + 2) % 3] == 0.0 {
                return Some(Self::Axis { axis, pos: narrow(point[k]) });
            }
        }
        Some(Self::General { normal, offset: narrow(normal.as_dvec3().dot(point)) })
    }

    /// The plane of a triangle.
    pub fn of_face(tri: &[DVec3; 3]) -> Option<Self> {
        Self::through(tri[0], face_normal(tri))
    }

    /// The planes through the edges of a triangle, upright on its face.
    pub fn of_edges(tri: &[DVec3; 3]) -> impl Iterator<Item = Self> {
        let normal = face_normal(tri).normalize_or_zero();
        let edges = [(tri[0], tri[1]), (tri[1], tri[2]), (tri[2], tri[0])];
        edges.into_iter().filter_map(move |(a, b)| Self::through(a, normal.cross(b - a)))
    }

    /// The distance of a point from the plane: positive above it, where the normal points.
    #[inline(always)]
    pub fn distance(&self, p: DVec3) -> f64 {
        match self {
            Self::Axis { axis, pos } => p[axis.index()] - f64::from(*pos),
            Self::General { normal, offset } => normal.as_dvec3().dot(p) - f64::from(*offset),
        }
    }

    /// Where the edge from `p` to `q` passes through the plane, from their distances of opposite sign.
    /// The same to the bit for the edge from `q` to `p`.
    pub fn crossing(&self, (p, from): (DVec3, f64), (q, to): (DVec3, f64)) -> DVec3 {
        let (p, from, q, to) = if from < to { (p, from, q, to) } else { (q, to, p, from) };
        let mut at = p + (q - p) * (from / (from - to));
        if let Self::Axis { axis, pos } = self {
            at[axis.index()] = f64::from(*pos);
        }
        at
    }
}

fn face_normal(tri: &[DVec3; 3]) -> DVec3 {
    (tri[1] - tri[0]).cross(tri[2] - tri[0])
}

/// On which sides of a plane something is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sides {
    /// Below, or on the plane.
    Below,
    /// Above.
    Above,
    /// On both.
    Both,
}

impl Sides {
    /// Of what reaches from the distance `low` to `high`. What is on the plane is below, so that a
    /// wall that gave the plane leaves the space above it empty.
    #[inline(always)]
    pub fn of(low: f64, high: f64, band: f64) -> Self {
        match (low < -band, high > band) {
            (true, true) => Self::Both,
            (false, true) => Self::Above,
            _ => Self::Below,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const UNIT: Aabb = Aabb { min: Vec3::splat(-1.0), max: Vec3::splat(1.0) };

    fn random(seed: &mut u64) -> DVec3 {
        let mut next = || {
            *seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            f64::from(narrow((*seed >> 40) as f64 / f64::from(1 << 23) - 1.0))
        };
        DVec3::new(next(), next(), next())
    }

    fn exact(tri: &[DVec3; 3], p: DVec3) -> f64 {
        let [a, b, c, d] = [tri[0], tri[1], tri[2], p].map(|p| robust::Coord3D { x: p.x, y: p.y, z: p.z });
        robust::orient3d(a, b, c, d)
    }

    /// Against Shewchuk's exact predicate: what is off the band is on the side of the plane through the
    /// corners; the corners themselves are in the band.
    #[test]
    fn sides_agree_with_the_exact_predicate() {
        let (mut seed, mut off) = (7, 0);
        let band = Slack::new(&UNIT).band;
        for _ in 0..5000 {
            let tri = [(); 3].map(|()| random(&mut seed));
            let (normal, lengths) = (face_normal(&tri), (tri[1] - tri[0]).length().max((tri[2] - tri[0]).length()));
            if normal.length() < 0.1 * lengths {
                continue; // far from a sliver the plane through three corners is another matter
            }
            let plane = Plane::of_face(&tri).expect("no sliver");
            assert!(tri.iter().all(|p| plane.distance(*p).abs() <= band));
            for p in [random(&mut seed), tri[0] + (tri[1] - tri[0]) * 0.5 + normal * 1e-6, tri[2] - normal * 1e-6] {
                let s = plane.distance(p);
                if s.abs() > band {
                    off += 1;
                    // The predicate is positive below the plane.
                    assert_eq!(s > 0.0, exact(&tri, p) < 0.0, "{tri:?} {p}");
                }
            }
        }
        assert!(off > 5000, "{off}");
    }

    #[test]
    fn a_wall_is_below_its_own_plane_and_an_upright_face_gives_an_axis_plane() {
        let wall = [DVec3::new(0.5, 0.0, 0.0), DVec3::new(0.5, 1.0, 0.0), DVec3::new(0.5, 0.0, 1.0)];
        assert_eq!(Plane::of_face(&wall), Some(Plane::Axis { axis: Axis::X, pos: 0.5 }));
        assert_eq!(Plane::of_edges(&wall).count(), 3);
        assert_eq!(Plane::of_face(&[DVec3::ONE; 3]), None);
        assert_eq!(Sides::of(-1e-9, 1e-9, 1e-8), Sides::Below);
        assert_eq!(Sides::of(-1e-9, 1.0, 1e-8), Sides::Above);
        assert_eq!(Sides::of(-1.0, 1.0, 1e-8), Sides::Both);
    }
}
