//! What the tests keep that take a ray as it is.

use super::Own;
use crate::geometry::eight::Rays;
use crate::geometry::{Aabb, Ray, Slabs};
use crate::simd::Simd;
use glam::Vec3;

/// The ray and its slabs.
#[derive(Clone, Copy, Debug)]
pub struct Plain {
    pub origin: Vec3,
    pub dir: Vec3,
    pub slabs: Slabs,
}

impl Plain {
    #[inline(always)]
    pub fn prepare(ray: &Ray, bounds: &Aabb) -> Self {
        Self { origin: ray.origin, dir: ray.dir, slabs: Slabs::new(ray, bounds) }
    }

    #[inline(always)]
    pub fn own(&self) -> Own<f32> {
        let (o, d) = (self.origin, self.dir);
        [o.x, o.y, o.z, d.x, d.y, d.z, 0.0]
    }

    #[inline(always)]
    pub fn own_of_eight<S: Simd>(s: S, rays: &Rays<S::F>) -> Own<S::F> {
        let (o, d) = (rays.origin, rays.dir);
        [o.x, o.y, o.z, d.x, d.y, d.z, s.splat(0.0)]
    }

    #[inline(always)]
    pub fn from_own(own: &Own<f32>, slabs: Slabs) -> Self {
        let &[ox, oy, oz, dx, dy, dz, _] = own;
        Self { origin: Vec3::new(ox, oy, oz), dir: Vec3::new(dx, dy, dz), slabs }
    }
}
