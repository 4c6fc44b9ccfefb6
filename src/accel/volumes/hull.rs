//! The convex hull: the tightest convex volume there is, and the most to store and to test.

use super::kdop::{behind, reach};
use super::points::Points;
use super::volume::{Loose, Volume};
use crate::accel::cell::{Form, Shape};
use crate::geometry::hull::{Hull as Points3, hull};
use crate::geometry::kdop::{box_planes, directions};
use crate::geometry::num::{index, round_up};
use crate::geometry::polytope::{Plane, area};
use crate::geometry::{Aabb, Line};
use crate::task::Cancelled;
use glam::{DVec3, Vec3};

/// The most faces of a hull; one with more keeps its largest and is closed by the directions of the
/// 26-DOP.
pub const MOST_FACES: usize = 64;

/// The directions of the 26-DOP besides the axes, which the box has.
const CLOSING: usize = 20;

/// Faces that differ by less than this in the scaled space, where the scene's extent is about 1, are
/// one: the line test widens each plane by more.
const TOLERANCE: f64 = 1e-6;

/// A convex hull: its faces behind the box around them. The box bounds t, as every volume must
/// (see [`Line`]), and is the cheap first look.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub struct Hull {
    bounds: Aabb,
    /// Its faces in the list that all hulls share.
    first: u32,
    count: u32,
    /// The area of the true hull; NaN where it is not known.
    area: f32,
}

/// The faces of all hulls, and how many are loose.
#[derive(Debug, Default)]
pub struct Faces {
    faces: Vec<HullFace>,
    loose: Loose,
}

/// The half-space `normal . x <= offset`, relative to the centre of the scene.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
struct HullFace {
    normal: Vec3,
    offset: f32,
}

/// A hull before it is stored.
#[derive(Debug)]
pub struct Fitted {
    bounds: Aabb,
    faces: Vec<HullFace>,
    area: f32,
    loose: Loose,
}

impl Volume for Hull {
    const ID: &'static str = "hull";
    type Shared = Faces;
    type Fit = Fitted;
    /// The corners of the hull: the hull of two nodes is that of their hulls' corners.
    type Up = Vec<DVec3>;
    type Ray = Line;

    /// Only the directions of the faces come from the hull of the points; how far each face reaches
    /// comes from all points. So whatever the quickhull did, the volume holds them all.
    fn around(points: &Points<'_>, below: Option<[Vec<DVec3>; 2]>) -> Result<(Fitted, Vec<DVec3>), Cancelled> {
        let few = points.for_choosing(below)?;
        points.cancel.check()?;
        let made = hull(&few, TOLERANCE);
        let (normals, loose) = chosen(made.as_ref());
        let faces = supporting(points, &normals)?;
        let area = made.as_ref().map_or(f32::NAN, |hull| crate::geometry::num::narrow(hull.area));
        let up = made.map_or(few, |hull| hull.corners);
        Ok((Fitted { bounds: points.bounds, faces, area, loose }, up))
    }

    fn store(fit: Fitted, shared: &mut Faces) -> Self {
        let first = index(shared.faces.len());
        let count = index(fit.faces.len());
        shared.faces.extend(fit.faces);
        shared.loose.simplified += fit.loose.simplified;
        shared.loose.failed += fit.loose.failed;
        Self { bounds: fit.bounds, first, count, area: fit.area }
    }

    fn fit_bytes(fit: &Fitted) -> u64 {
        size_of_val(&fit.faces[..]) as u64
    }

    fn ray(line: &Line) -> Line {
        *line
    }

    #[inline(always)]
    fn interval(&self, shared: &Faces, line: &Line) -> Option<(f32, f32)> {
        let in_box = line.slabs.interval(&self.bounds);
        let mut left = in_box;
        for face in self.faces(shared) {
            if left.0 > left.1 {
                return None;
            }
            left = line.clip(face.normal, face.offset, left);
        }
        (left.0 <= left.1).then_some(in_box)
    }

    fn shape(&self, shared: &Faces, centre: Vec3) -> Shape {
        let faces = self.faces(shared);
        let mut planes = self.planes(shared);
        // A side of the box that a face lies in already would count twice.
        let sides = box_planes(&self.bounds, centre.as_dvec3());
        planes.extend(sides.iter().filter(|side| faces.iter().all(|face| side.normal.dot(face.normal.as_dvec3()) < 1.0 - 1e-9)));
        Shape::Convex { bounds: self.bounds, area: area(&planes, reach(&self.bounds, centre)) }
    }

    fn form(&self, shared: &Faces, centre: Vec3) -> Form {
        behind(&self.bounds, &self.planes(shared), centre)
    }

    fn shared_bytes(shared: &Faces) -> u64 {
        size_of_val(&shared.faces[..]) as u64
    }

    fn hull_area(&self) -> Option<f64> {
        (!self.area.is_nan()).then_some(f64::from(self.area))
    }

    fn loose(shared: &Faces) -> Loose {
        shared.loose
    }
}

impl Hull {
    /// Its faces besides those of the box, relative to the centre of the scene.
    fn planes(&self, shared: &Faces) -> Vec<Plane> {
        self.faces(shared).iter().map(|face| Plane::new(face.normal.as_dvec3(), f64::from(face.offset))).collect()
    }

    #[inline(always)]
    fn faces<'a>(&self, shared: &'a Faces) -> &'a [HullFace] {
        &shared.faces[self.first as usize..(self.first + self.count) as usize]
    }
}

/// The directions of a hull's faces, or of what stands in for it.
fn chosen(made: Option<&Points3>) -> (Vec<DVec3>, Loose) {
    let Some(hull) = made else {
        return (closing().collect(), Loose { failed: 1, simplified: 0 });
    };
    if hull.normals.len() <= MOST_FACES {
        return (hull.normals.clone(), Loose::default());
    }
    let mut normals = hull.normals[..MOST_FACES - CLOSING].to_vec();
    let more: Vec<DVec3> = closing().filter(|n| normals.iter().all(|other| n.dot(*other) < 1.0 - 1e-9)).collect();
    normals.extend(more);
    (normals, Loose { failed: 0, simplified: 1 })
}

/// The directions of the 26-DOP but for the axes.
fn closing() -> impl Iterator<Item = DVec3> {
    directions().filter(|n| n.max_element() < 1.0 && n.min_element() > -1.0)
}

/// For each direction the half-space that holds all points, of the direction as it is in 32 bits.
fn supporting(points: &Points<'_>, normals: &[DVec3]) -> Result<Vec<HullFace>, Cancelled> {
    let normals: Vec<Vec3> = normals.iter().map(|n| n.as_vec3()).collect();
    let exact: Vec<DVec3> = normals.iter().map(|n| n.as_dvec3()).collect();
    let (mut reach, mut greatest) = (vec![f64::NEG_INFINITY; exact.len()], 0.0f64);
    points.each(|p| {
        greatest = greatest.max(p.abs().element_sum());
        for (reach, n) in reach.iter_mut().zip(&exact) {
            *reach = reach.max(n.dot(p));
        }
    })?;
    // 64-bit products err by less than 1e-15 of the point's magnitudes.
    let face = |(normal, reach): (Vec3, f64)| HullFace { normal, offset: round_up(reach + 1e-15 * greatest) };
    Ok(normals.into_iter().zip(reach).map(face).collect())
}

const _: () = assert!(size_of::<Hull>() == 36 && size_of::<HullFace>() == 16);
