//! The look of a hit.

use glam::{Mat3A, Vec2, Vec3};

use super::sampler::cosine_direction;
use super::spawn::Point;
use super::{Job, Mode};
use crate::accel::Hit;
use crate::geometry::Ray;
use crate::scene::{Feature, Geometry, Needs, coverage};

/// The normal towards the viewer, of unit length: of the triangle, or as its vertices have it (`SMOOTH`), which may have
/// to be turned with the instance (`TURNED`).
#[inline(always)]
fn normal<const SMOOTH: bool, const TURNED: bool>(job: &Job, ray: &Ray, hit: &Hit) -> Vec3 {
    bent_by_vertices::<SMOOTH, TURNED>(job, ray, hit, Point::of(job.accel.geometry(), ray, hit).normal)
}

/// The same from the triangle's normal.
#[inline(always)]
fn bent_by_vertices<const SMOOTH: bool, const TURNED: bool>(job: &Job, ray: &Ray, hit: &Hit, facing: Vec3) -> Vec3 {
    let instance = &job.scene.instances[hit.instance as usize];
    let mesh = &job.scene.meshes[instance.mesh];
    if !SMOOTH || mesh.normals.is_empty() {
        return facing;
    }
    let [i, j, k] = mesh.triangles[hit.primitive as usize].map(|i| i as usize);
    let (u, v) = (hit.u, hit.v);
    let mut smooth = mesh.normals[i] * (1.0 - u - v) + mesh.normals[j] * u + mesh.normals[k] * v;
    if TURNED {
        smooth = cofactors(&instance.world_from_object.matrix3) * smooth;
    }
    let smooth = smooth.try_normalize().unwrap_or(facing);
    // As a factor: which side it is nobody foresees.
    smooth * if smooth.dot(ray.dir) > 0.0 { -1.0 } else { 1.0 }
}

/// A normal towards the viewer.
#[derive(Clone, Copy, Debug)]
pub(super) struct Facing {
    /// Of unit length.
    pub normal: Vec3,
    /// Whether the surface itself faces the other way: it is seen from behind.
    pub turned: bool,
}

/// The normal towards the viewer at a point that was hit, in a scene of which nothing is known.
pub(super) fn normal_at(job: &Job, ray: &Ray, hit: &Hit, point: &Point) -> Vec3 {
    bent_by_vertices::<true, true>(job, ray, hit, point.normal)
}

/// Which way the surface itself faces where that normal is.
pub(super) fn facing(job: &Job, hit: &Hit, normal: Vec3) -> Facing {
    let instance = &job.scene.instances[hit.instance as usize];
    let mesh = &job.scene.meshes[instance.mesh];
    let own = if mesh.normals.is_empty() {
        let [a, b, c] = job.accel.geometry().corners_of(hit.instance, hit.primitive);
        // What mirrors a mesh turns the order of its corners.
        let mirrors = instance.world_from_object.matrix3.determinant() < 0.0;
        (b - a).cross(c - a) * if mirrors { -1.0 } else { 1.0 }
    } else {
        let [i, j, k] = mesh.triangles[hit.primitive as usize].map(|i| mesh.normals[i as usize]);
        cofactors(&instance.world_from_object.matrix3) * (i * (1.0 - hit.u - hit.v) + j * hit.u + k * hit.v)
    };
    Facing { normal, turned: own.dot(normal) < 0.0 }
}

/// What normals are turned by: the inverse transpose but for its length and sign, which are settled later, and there for
/// singular matrices too.
fn cofactors(m: &Mat3A) -> Mat3A {
    Mat3A::from_cols(m.y_axis.cross(m.z_axis), m.z_axis.cross(m.x_axis), m.x_axis.cross(m.y_axis))
}

/// The sample of a hit that needs no further ray; in [`Mode::Ao`], that of an open point.
pub type Shader = fn(&Job, &Ray, &Hit) -> [f32; 4];

/// The shading of a mode, without what a scene has none of.
pub fn shader(mode: Mode, needs: Needs) -> Shader {
    let [smooth, turned] = [Feature::Normals, Feature::Transforms].map(|feature| needs.has(feature));
    let [colors, maps] = [Feature::VertexColors, Feature::ColorMaps].map(|feature| needs.has(feature));
    match mode {
        Mode::Shaded => match (smooth, turned) {
            (false, _) => shaded::<false, false>(colors, maps),
            (true, false) => shaded::<true, false>(colors, maps),
            (true, true) => shaded::<true, true>(colors, maps),
        },
        Mode::Normals => match (smooth, turned) {
            (false, _) => |job, ray, hit| opaque(normal::<false, false>(job, ray, hit) * 0.5 + 0.5),
            (true, false) => |job, ray, hit| opaque(normal::<true, false>(job, ray, hit) * 0.5 + 0.5),
            (true, true) => |job, ray, hit| opaque(normal::<true, true>(job, ray, hit) * 0.5 + 0.5),
        },
        // Light is followed later.
        Mode::Path => |_, _, _| [0.0; 4],
        Mode::Depth => |_, _, hit| opaque(Vec3::splat(hit.t)),
        Mode::Ao => |_, _, _| opaque(Vec3::ONE),
        Mode::Nodes | Mode::Leaves | Mode::Prims | Mode::Stack => |_, _, _| opaque(Vec3::ZERO),
    }
}

fn shaded<const SMOOTH: bool, const TURNED: bool>(colors: bool, maps: bool) -> Shader {
    match (colors, maps) {
        (false, false) => lit::<SMOOTH, TURNED, false, false>,
        (false, true) => lit::<SMOOTH, TURNED, false, true>,
        (true, false) => lit::<SMOOTH, TURNED, true, false>,
        (true, true) => lit::<SMOOTH, TURNED, true, true>,
    }
}

/// A surface in the light of a lamp at the camera and of the sky.
fn lit<const SMOOTH: bool, const TURNED: bool, const COLORS: bool, const MAPS: bool>(
    job: &Job,
    ray: &Ray,
    hit: &Hit,
) -> [f32; 4] {
    let normal = normal::<SMOOTH, TURNED>(job, ray, hit);
    let mesh = job.scene.instances[hit.instance as usize].mesh;
    let surface = coverage::Surface::new(&job.scene, mesh, job.looks.textures());
    let base = Vec3::from_array(surface.color::<COLORS, MAPS>(hit.primitive, hit.u, hit.v));
    let headlight = normal.dot(-ray.dir.normalize_or_zero()).max(0.0);
    let sky = 0.5 + 0.5 * normal.dot(job.scene.up);
    opaque(base * (0.12 + 0.62 * headlight + 0.36 * sky * Vec3::new(0.92, 0.97, 1.0)))
}

fn opaque(color: Vec3) -> [f32; 4] {
    [color.x, color.y, color.z, 1.0]
}

/// The ray that asks whether a point sees the sky, as far as a fifth of the scene's extent.
pub fn occlusion_ray(geometry: &Geometry, ray: &Ray, hit: &Hit, numbers: Vec2) -> Ray {
    let point = Point::of(geometry, ray, hit);
    let dir = cosine_direction(point.normal, numbers);
    let reach = geometry.world_bounds().size().max_element() * 0.2;
    Ray { tmax: reach, ..point.ray(geometry, dir) }
}
