//! Rays that leave a surface.

use glam::Vec3;

use crate::accel::Hit;
use crate::geometry::num::UNIT_ROUNDOFF;
use crate::geometry::{Aabb, Ray};
use crate::scene::Geometry;

/// A point on a surface that rays may leave from.
#[derive(Clone, Copy, Debug)]
pub struct Point {
    /// On the triangle, in the scaled space.
    at: Vec3,
    /// Of unit length, towards where the first ray came from.
    pub normal: Vec3,
    /// How far from the triangle's plane a ray has to start so as not to meet it again.
    clearance: f32,
}

impl Point {
    /// Where `ray` hit the scene.
    pub fn of(geometry: &Geometry, ray: &Ray, hit: &Hit) -> Self {
        let [a, b, c] = geometry.corners(geometry.flat(hit.instance, hit.primitive));
        let at = a + (b - a) * hit.u + (c - a) * hit.v;
        let normal = (b - a).as_dvec3().cross((c - a).as_dvec3()).try_normalize().map_or(Vec3::Y, |n| n.as_vec3());
        let normal = if normal.dot(ray.dir) > 0.0 { -normal } else { normal };
        // `at` carries some roundings of its terms, the next ray's test some of the triangle's size.
        let reach = a.abs().max(b.abs()).max(c.abs()).max_element() + Aabb::of_triangle(&[a, b, c]).size().max_element();
        Self { at, normal, clearance: 16.0 * UNIT_ROUNDOFF * reach }
    }

    /// The ray from here along `dir`, in the world; `dir` points away from the surface.
    pub fn ray(&self, geometry: &Geometry, dir: Vec3) -> Ray {
        Ray::new(self.start(geometry), dir)
    }

    /// The segment from here to a point in the world; it ends just before that point.
    pub fn segment_to(&self, geometry: &Geometry, to: Vec3) -> Ray {
        let start = self.start(geometry);
        Ray { origin: start, dir: to - start, tmin: 0.0, tmax: 1.0 - 1e-4 }
    }

    fn start(&self, geometry: &Geometry) -> Vec3 {
        geometry.space().world_point(self.at + self.normal * self.clearance)
    }
}
