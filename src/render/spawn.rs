//! Rays that leave a surface.

use glam::{Vec2, Vec3};

use super::sampler::cosine_direction;
use crate::accel::Hit;
use crate::geometry::num::UNIT_ROUNDOFF;
use crate::geometry::{Aabb, Ray};
use crate::scene::{Camera, Geometry};

/// More than the roundings that a point of a surface and the next ray's test carry: each of three terms of the point is
/// rounded three times, and twelve displace a plane that is met (see [`crate::geometry::Slabs`]).
const ROUNDINGS: f32 = 16.0;

/// The sampler's dimension of a bounce; 0 is the place in the pixel, 1 ambient occlusion.
pub const BOUNCE: u32 = 2;

/// A point on a surface that rays may leave from.
#[derive(Clone, Copy, Debug)]
pub struct Point {
    /// On the triangle, in the scaled space.
    pub at: Vec3,
    /// Of unit length, towards where the first ray came from.
    pub normal: Vec3,
    /// How far from the triangle's plane a ray has to start so as not to meet it again.
    clearance: f32,
}

impl Point {
    /// Where `ray` hit the scene.
    #[inline]
    pub fn of(geometry: &Geometry, ray: &Ray, hit: &Hit) -> Self {
        let [a, b, c] = geometry.corners_of(hit.instance, hit.primitive);
        let at = a + (b - a) * hit.u + (c - a) * hit.v;
        let normal = (b - a).as_dvec3().cross((c - a).as_dvec3()).try_normalize().map_or(Vec3::Y, |n| n.as_vec3());
        let normal = normal * if normal.dot(ray.dir) > 0.0 { -1.0 } else { 1.0 };
        // `at` carries some roundings of its terms, the next ray's test some of the triangle's size.
        let reach = a.abs().max(b.abs()).max(c.abs()).max_element() + Aabb::of_triangle(&[a, b, c]).size().max_element();
        Self { at, normal, clearance: ROUNDINGS * UNIT_ROUNDOFF * reach }
    }

    /// The same for rays that leave on the other side.
    pub fn other_side(self) -> Self {
        Self { normal: -self.normal, ..self }
    }

    /// The ray from here along `dir`, in the world; `dir` points away from the surface.
    pub fn ray(&self, geometry: &Geometry, dir: Vec3) -> Ray {
        Ray::new(self.start(geometry), dir)
    }

    /// The ray from here in a random direction about the normal.
    pub fn bounce(&self, geometry: &Geometry, numbers: Vec2) -> Ray {
        self.ray(geometry, cosine_direction(self.normal, numbers))
    }

    /// The segment from here to a point in the world; it ends before that point by as much as a surface through it may
    /// be found too near.
    pub fn segment_to(&self, geometry: &Geometry, to: Vec3) -> Ray {
        let start = self.start(geometry);
        let there = geometry.space().point(to);
        let length = (there - self.at).length();
        let slack = ROUNDINGS * UNIT_ROUNDOFF * (there.abs().max_element() + length);
        let tmax = if length > slack { 1.0 - slack / length } else { 0.0 };
        Ray { origin: start, dir: to - start, tmin: 0.0, tmax }
    }

    fn start(&self, geometry: &Geometry) -> Vec3 {
        geometry.space().world_point(self.at + self.normal * self.clearance)
    }
}

/// Where the light of shadow rays stands: up and to the right of the camera by half and a quarter
/// of its distance to what it looks at, so that shadows are seen beside the things that throw them
/// and the light is inside a room if the camera is.
pub fn light_beside(camera: &Camera) -> Vec3 {
    let frame = camera.frame();
    let distance = camera.distance();
    camera.eye + (frame.up * 0.5 + frame.right * 0.25) * distance
}
