//! A ray: a point, a direction of any length, and the closed interval of t that counts.

use glam::Vec3;

/// `origin + t * dir` for `t` in the closed interval `[tmin, tmax]`.
///
/// The direction need not have unit length; t is in units of it.
#[derive(Clone, Copy, Debug, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct Ray {
    /// Where the ray starts.
    pub origin: Vec3,
    /// Where it goes, of any length but zero.
    pub dir: Vec3,
    /// The least t that counts, at least 0.
    pub tmin: f32,
    /// The greatest t that counts; infinite for none.
    pub tmax: f32,
}

impl Ray {
    /// A ray without an end: `[0, infinity]`.
    pub const fn new(origin: Vec3, dir: Vec3) -> Self {
        Self { origin, dir, tmin: 0.0, tmax: f32::INFINITY }
    }

    /// The segment from `a` to `b`: t = 1 is at `b`.
    pub fn segment(a: Vec3, b: Vec3) -> Self {
        Self { origin: a, dir: b - a, tmin: 0.0, tmax: 1.0 }
    }

    /// The point at `t`.
    pub fn at(&self, t: f32) -> Vec3 {
        self.origin + t * self.dir
    }

    /// Whether the ray can hit anything: finite origin and direction, a direction other than zero,
    /// and `0 <= tmin <= tmax`. A ray that is not valid misses everything and is counted.
    #[inline]
    pub fn is_valid(&self) -> bool {
        // A number times zero is zero, unless it is infinite or none.
        let zeros = self.origin * 0.0 + self.dir * 0.0;
        let finite = zeros.x + zeros.y + zeros.z == 0.0;
        finite & (self.dir != Vec3::ZERO) & (0.0 <= self.tmin) & (self.tmin <= self.tmax)
    }
}
