//! The look of a hit.

use glam::Vec3;

use super::sampler::{Sampler, cosine_direction};
use super::spawn::Point;
use super::{Job, Mode};
use crate::accel::Hit;
use crate::geometry::Ray;
use crate::scene::{Geometry, coverage};

/// A hit with what shading needs of its surface.
struct Surface {
    /// Shading normal towards the viewer, of unit length.
    normal: Vec3,
    /// Linear base colour.
    base: Vec3,
}

impl Surface {
    fn of(job: &Job, ray: &Ray, hit: &Hit) -> Self {
        let instance = &job.scene.instances[hit.instance as usize];
        let mesh = &job.scene.meshes[instance.mesh];
        let facing = Point::of(job.accel.geometry(), ray, hit).normal;
        let normal = if mesh.normals.is_empty() {
            facing
        } else {
            let [i, j, k] = mesh.triangles[hit.primitive as usize].map(|i| i as usize);
            let (u, v) = (hit.u, hit.v);
            // Normals go by the inverse transpose; its determinant's sign is settled by facing.
            let to_world = instance.world_from_object.matrix3.inverse().transpose();
            let smooth = to_world * (mesh.normals[i] * (1.0 - u - v) + mesh.normals[j] * u + mesh.normals[k] * v);
            let smooth = smooth.try_normalize().unwrap_or(facing);
            if smooth.dot(ray.dir) > 0.0 { -smooth } else { smooth }
        };
        let surface = coverage::Surface::new(&job.scene, instance.mesh, job.looks.textures());
        Self { normal, base: surface.color(hit.primitive, hit.u, hit.v).into() }
    }
}

/// The sample of a hit that needs no further ray; in [`Mode::Ao`], that of an open point.
pub fn shade(job: &Job, ray: &Ray, hit: &Hit) -> [f32; 4] {
    let color = match job.mode {
        Mode::Shaded => {
            let surface = Surface::of(job, ray, hit);
            let headlight = surface.normal.dot(-ray.dir.normalize_or_zero()).max(0.0);
            let sky = 0.5 + 0.5 * surface.normal.dot(job.scene.up);
            surface.base * (0.12 + 0.62 * headlight + 0.36 * sky * Vec3::new(0.92, 0.97, 1.0))
        }
        Mode::Normals => Surface::of(job, ray, hit).normal * 0.5 + 0.5,
        Mode::Depth => Vec3::splat(hit.t),
        Mode::Ao => Vec3::ONE,
        Mode::Nodes | Mode::Prims => Vec3::ZERO,
    };
    [color.x, color.y, color.z, 1.0]
}

/// The ray that asks whether a point sees the sky, as far as a fifth of the scene's extent.
pub fn occlusion_ray(geometry: &Geometry, ray: &Ray, hit: &Hit, sampler: &Sampler) -> Ray {
    let point = Point::of(geometry, ray, hit);
    let dir = cosine_direction(point.normal, sampler.pair(1));
    let reach = geometry.world_bounds().size().max_element() * 0.2;
    Ray { tmax: reach, ..point.ray(geometry, dir) }
}
