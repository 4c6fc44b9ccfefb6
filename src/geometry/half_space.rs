//! One side of a plane across an axis, and what of rays and boxes lies in it.

use super::num::narrow;
use super::{Aabb, Axis, Ray, Space};
use glam::Vec3;

/// The side of a plane across an axis.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, serde::Serialize, serde::Deserialize)]
pub enum Side {
    /// Where the coordinate is less.
    #[default]
    Below,
    /// Where it is greater.
    Above,
}

impl Side {
    /// The one across the plane.
    pub const fn other(self) -> Self {
        match self {
            Self::Below => Self::Above,
            Self::Above => Self::Below,
        }
    }
}

/// All points on one side of a plane across an axis, those of the plane among them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HalfSpace {
    /// The axis that the plane is perpendicular to.
    pub axis: Axis,
    /// Its coordinate there.
    pub at: f32,
    /// The side.
    pub side: Side,
}

impl HalfSpace {
    /// 1 where greater coordinates are inside, -1 where lesser ones are.
    fn sign(&self) -> f32 {
        match self.side {
            Side::Below => -1.0,
            Side::Above => 1.0,
        }
    }

    /// What of a ray lies in it: origin and direction stay, and with them the t of what it meets; the interval ends, or
    /// begins, at the plane. Where nothing is left the ray is not valid any more and misses everything.
    pub fn cut(&self, ray: &Ray) -> Ray {
        let (axis, sign) = (self.axis.index(), f64::from(self.sign()));
        // In 64 bits, so that the end is rounded once.
        let height = sign * (f64::from(ray.origin[axis]) - f64::from(self.at));
        let rise = sign * f64::from(ray.dir[axis]);
        let crossing = narrow(-height / rise);
        let nothing = Ray { tmin: f32::INFINITY, tmax: 0.0, ..*ray };
        match () {
            // It begins outside and never comes in as far as 32 bits reach.
            () if rise > 0.0 && crossing == f32::INFINITY => nothing,
            () if rise > 0.0 => Ray { tmin: ray.tmin.max(crossing), ..*ray },
            () if rise < 0.0 => Ray { tmax: ray.tmax.min(crossing), ..*ray },
            // Along the plane.
            () if height >= 0.0 => *ray,
            () => nothing,
        }
    }

    /// Whether a box lies outside altogether.
    pub fn misses(&self, bounds: &Aabb) -> bool {
        match self.side {
            Side::Below => bounds.min[self.axis.index()] > self.at,
            Side::Above => bounds.max[self.axis.index()] < self.at,
        }
    }

    /// Normal and offset: a point `p` is inside where `normal · p + offset` is not negative.
    pub fn plane(&self) -> (Vec3, f32) {
        let mut normal = Vec3::ZERO;
        normal[self.axis.index()] = self.sign();
        (normal, -self.sign() * self.at)
    }

    /// The same in the scaled space; there too without rounding, but for denormals.
    pub fn scaled(&self, space: &Space) -> Self {
        Self { at: narrow(f64::from(self.at) * space.scale()), ..*self }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ABOVE: HalfSpace = HalfSpace { axis: Axis::Y, at: 2.0, side: Side::Above };
    const BELOW: HalfSpace = HalfSpace { side: Side::Below, ..ABOVE };

    #[test]
    fn a_ray_begins_or_ends_at_the_plane() {
        let up = Ray { origin: Vec3::ZERO, dir: Vec3::new(1.0, 0.5, 0.0), tmin: 1.0, tmax: 10.0 };
        assert_eq!(ABOVE.cut(&up), Ray { tmin: 4.0, ..up });
        assert_eq!(BELOW.cut(&up), Ray { tmax: 4.0, ..up });
        // From the other side the eye is inside first.
        let down = Ray { origin: Vec3::Y * 3.0, dir: Vec3::NEG_Y, ..up };
        assert_eq!(ABOVE.cut(&Ray { tmin: 0.0, ..down }), Ray { tmin: 0.0, tmax: 1.0, ..down });
        assert_eq!(BELOW.cut(&down), down);
    }

    #[test]
    fn of_a_ray_outside_nothing_is_left() {
        let away = Ray::new(Vec3::Y, Vec3::NEG_Y);
        assert!(!ABOVE.cut(&away).is_valid() && BELOW.cut(&away) == away);
        let along = Ray::new(Vec3::Y, Vec3::X);
        assert!(!ABOVE.cut(&along).is_valid() && BELOW.cut(&along) == along);
        let within = Ray::new(Vec3::Y * 2.0, Vec3::X);
        assert!(ABOVE.cut(&within) == within && BELOW.cut(&within) == within, "the plane belongs to both");
        // It would come in beyond all numbers.
        let hardly = Ray::new(Vec3::ZERO, Vec3::new(1.0, f32::from_bits(1), 0.0));
        assert!(!ABOVE.cut(&hardly).is_valid());
        let ends_before = Ray { tmax: 1.0, ..Ray::new(Vec3::ZERO, Vec3::Y) };
        assert!(!ABOVE.cut(&ends_before).is_valid());
    }

    #[test]
    fn boxes_and_points_are_told_apart() {
        let low = Aabb { min: Vec3::ZERO, max: Vec3::ONE };
        let touching = Aabb { min: Vec3::ZERO, max: Vec3::splat(2.0) };
        assert!(ABOVE.misses(&low) && !ABOVE.misses(&touching) && !BELOW.misses(&low) && !BELOW.misses(&touching));
        for (half, inside) in [(ABOVE, 3.0), (BELOW, 1.0)] {
            let (normal, offset) = half.plane();
            assert!(normal.dot(Vec3::Y * inside) + offset > 0.0 && normal.dot(Vec3::Y * 2.0) + offset == 0.0);
        }
        let space = Space::new(&Aabb { min: Vec3::ZERO, max: Vec3::splat(4.0) });
        assert_eq!(ABOVE.scaled(&space).at, space.point(Vec3::splat(2.0)).y);
    }
}
