//! The space that structures work in: the scene scaled by a power of two to an extent of about 1,
//! so that nothing over- or underflows however large or small the model is.
//!
//! A ray is brought there in three exact or bounded steps:
//! 1. the origin is scaled (exact but for denormals);
//! 2. the direction is scaled by the power of two that brings its greatest component into (1/2, 1],
//!    and t by its inverse (exact);
//! 3. an origin farther than [`FAR`] extents away is moved along the ray to within a few extents
//!    of the scene, worked out in 64 bits and rounded once. The displacement, half an ulp of the
//!    new origin, is below the triangle tests' own error; without it their error would grow with
//!    the distance. All structures get the same moved ray, so they still agree to the bit.

use super::eight::{Points, Rays};
use super::num::narrow;
use super::{Aabb, Ray};
use crate::simd::Simd;
use glam::{DAffine3, DVec3, Vec3};

/// Beyond this many extents from the scene's box an origin is moved closer.
pub const FAR: f64 = 8.0;

/// The map from the world to the scaled space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Space {
    /// Scaled coordinate = world coordinate times this power of two.
    scale: f64,
    /// It and one over it, if 32 bits hold both.
    narrow: Option<(f32, f32)>,
    /// The bounds of the scene, scaled.
    bounds: Aabb,
    /// The same and [`FAR`] extents around them.
    surroundings: Aabb,
}

/// A ray in the scaled space, with what turns its t back into the world's.
#[derive(Clone, Copy, Debug)]
pub struct Entered {
    /// The ray as the structures see it.
    pub ray: Ray,
    /// The way back.
    pub back: Back,
}

/// What turns a t of the scaled space into the world's.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Back {
    offset: f64,
    scale: f64,
}

impl Back {
    /// Of a ray that is the world's own.
    pub const NONE: Self = Self { offset: 0.0, scale: 1.0 };

    /// Of a ray that was scaled and not moved, by the product of what its t is multiplied by.
    #[inline(always)]
    pub fn scaled(scale: f32) -> Self {
        Self { offset: 0.0, scale: scale.into() }
    }

    /// The world's t of a t of the scaled ray.
    #[inline(always)]
    pub fn world_t(&self, t: f32) -> f32 {
        narrow((f64::from(t) + self.offset) * self.scale)
    }

    /// How far a scaled t may be off for having been written as that world's t: nothing, but for rays that were moved and
    /// for numbers with few digits.
    pub fn rounding(&self, world_t: f32) -> f64 {
        if self.offset == 0.0 && world_t.is_normal() {
            return 0.0;
        }
        (f64::from(world_t.next_up()) - f64::from(world_t)) / self.scale
    }

    /// The t of the scaled ray of a world's t.
    pub fn scaled_t(&self, t: f32) -> f32 {
        narrow(f64::from(t) / self.scale - self.offset)
    }
}

impl Space {
    /// The space for a scene that lies in `world_bounds` (finite, or empty).
    pub fn new(world_bounds: &Aabb) -> Self {
        if world_bounds.is_empty() {
            return Self::of(1.0, Aabb { min: Vec3::ZERO, max: Vec3::ZERO });
        }
        let size = (world_bounds.max.as_dvec3() - world_bounds.min.as_dvec3()).max_element();
        let far = world_bounds.min.as_dvec3().abs().max(world_bounds.max.as_dvec3().abs()).max_element();
        let extent = if size > 0.0 { size } else { far };
        let scale = if extent > 0.0 { power_of_two_at_most(1.0 / extent) } else { 1.0 };
        // Far from the origin the coordinates outgrow the extent; they must still be finite.
        let scale = if far * scale > 1e30 { power_of_two_at_most(1e30 / far) } else { scale };
        let scaled = |p: Vec3| (p.as_dvec3() * scale).as_vec3();
        Self::of(scale, Aabb { min: scaled(world_bounds.min), max: scaled(world_bounds.max) })
    }

    fn of(scale: f64, bounds: Aabb) -> Self {
        let far = Vec3::splat(narrow(FAR * extent(&bounds)));
        let surroundings = Aabb { min: bounds.min - far, max: bounds.max + far };
        Self { scale, narrow: PowerOfTwo { value: scale, inverse: 1.0 / scale }.narrow(), bounds, surroundings }
    }

    /// The power of two that world lengths are multiplied by.
    pub fn scale(&self) -> f64 {
        self.scale
    }

    /// The scene's bounds in this space.
    pub fn bounds(&self) -> &Aabb {
        &self.bounds
    }

    /// A world point in this space.
    #[inline]
    pub fn point(&self, p: Vec3) -> Vec3 {
        (p.as_dvec3() * self.scale).as_vec3()
    }

    /// A point of this space in the world.
    #[inline]
    pub fn world_point(&self, p: Vec3) -> Vec3 {
        (p.as_dvec3() / self.scale).as_vec3()
    }

    /// A valid world ray in this space.
    #[inline]
    pub fn enter(&self, ray: &Ray) -> Entered {
        let up = to_at_most_one(ray.dir.abs().max_element());
        // Products with powers of two that 32 bits hold are what 64 bits would be rounded to.
        if let (Some((scale, unscale)), Some((up, down))) = (self.narrow, up.narrow()) {
            let origin = ray.origin * scale;
            let t_unscale = down * scale;
            if self.is_near(origin) && (MIN..=MAX).contains(&t_unscale) {
                let ray = Ray { origin, dir: ray.dir * up, tmin: ray.tmin * t_unscale, tmax: ray.tmax * t_unscale };
                return Entered { ray, back: Back { offset: 0.0, scale: f64::from(up) * f64::from(unscale) } };
            }
        }
        self.enter_from_afar(ray, up)
    }

    /// Eight valid rays at once, and what turns each t back into the world's; nothing if one of those in
    /// `lanes` has to go the long way.
    #[inline(always)]
    pub fn enter_eight<S: Simd>(&self, s: S, rays: &Rays<S::F>, lanes: u32) -> Option<(Rays<S::F>, S::F)> {
        let (scale, unscale) = self.narrow?;
        let (scale, unscale) = (s.splat(scale), s.splat(unscale));
        let (least, most) = (s.splat(MIN), s.splat(MAX));
        // The power of two from which the longest component is at most 1, as `to_at_most_one`: the exponent
        // of its bits, rounded up.
        let longest = rays.dir.abs(s).greatest(s);
        let down = s.and_bits(s.add_bits(longest, s.splat_bits((1 << 23) - 1)), s.splat_bits(0xFF << 23));
        let up = s.sub_bits(s.splat_bits(254 << 23), down);
        let (origin, t_unscale, t_scale) = (rays.origin.times(s, scale), s.mul(down, scale), s.mul(up, unscale));
        let (min, max) = (Points::splat(s, self.surroundings.min), Points::splat(s, self.surroundings.max));
        let near = s.and(min.at_most(s, origin), origin.at_most(s, max));
        let usual = s.and(s.and(s.le(least, longest), s.le(longest, most)), s.and(s.le(least, t_unscale), s.le(t_unscale, most)));
        let usual = s.and(usual, near);
        if lanes & !s.bits(usual) != 0 {
            return None;
        }
        let rays =
            Rays { origin, dir: rays.dir.times(s, up), tmin: s.mul(rays.tmin, t_unscale), tmax: s.mul(rays.tmax, t_unscale) };
        Some((rays, t_scale))
    }

    /// The same for any origin and any scale.
    #[cold]
    fn enter_from_afar(&self, ray: &Ray, up: PowerOfTwo) -> Entered {
        let origin = ray.origin.as_dvec3() * self.scale;
        let dir = ray.dir.as_dvec3() * up.value;
        // world t = t of this space * scale: lengths grow by `scale`, the direction by `up`.
        let scale = up.value / self.scale;
        let near = self.is_near(origin.as_vec3());
        let offset = if near { 0.0 } else { self.approach(origin, dir) };
        let moved = if offset > 0.0 { origin + dir * offset } else { origin };
        let back = Back { offset, scale };
        let (tmin, tmax) = (back.scaled_t(ray.tmin).max(0.0), back.scaled_t(ray.tmax));
        Entered { ray: Ray { origin: moved.as_vec3(), dir: dir.as_vec3(), tmin, tmax }, back }
    }

    /// A ray of another space in this one, to which `map` leads from there; that space's t comes [`Back`].
    ///
    /// What 32 bits hold of the ray is rounded once, and origins beyond [`FAR`] extents are moved along the ray to within a
    /// few extents. The interval ends later by as much as keeps every t in it that is rounded to no more than the end there.
    #[inline]
    pub fn enter_mapped(&self, ray: &Ray, map: &DAffine3) -> Entered {
        let (origin, dir) = (map.transform_point3(ray.origin.as_dvec3()), map.transform_vector3(ray.dir.as_dvec3()));
        let up = power_of_two_at_most(1.0 / dir.abs().max_element());
        let dir = dir * up;
        let offset = if self.is_near(origin.as_vec3()) { 0.0 } else { self.near_enough(origin, dir) };
        let back = Back { offset, scale: up };
        let tmin = back.scaled_t(ray.tmin).max(0.0);
        let tmax = back.scaled_t(ray.tmax.next_up()).next_up();
        Entered { ray: Ray { origin: (origin + dir * offset).as_vec3(), dir: dir.as_vec3(), tmin, tmax }, back }
    }

    /// How far to move a far origin along a direction whose greatest component is in (1/2, 1]: to before a sphere around
    /// the box, and no more than a few extents.
    #[inline]
    fn near_enough(&self, origin: DVec3, dir: DVec3) -> f64 {
        let (min, max) = (self.bounds.min.as_dvec3(), self.bounds.max.as_dvec3());
        let along = (0.5 * (min + max) - origin).dot(dir) / dir.length_squared();
        // The box reaches less than 0.87 extents from its middle, which the ray passes in 1.74 of t at most.
        (along - 2.0 * extent(&self.bounds)).max(0.0)
    }

    /// Whether an origin is within [`FAR`] extents of the box.
    #[inline(always)]
    fn is_near(&self, origin: Vec3) -> bool {
        origin.cmpge(self.surroundings.min).all() && origin.cmple(self.surroundings.max).all()
    }

    /// How far along the ray to move a far origin: to two extents before the point nearest to the
    /// scene's centre.
    #[cold]
    fn approach(&self, origin: DVec3, dir: DVec3) -> f64 {
        let (min, max) = (self.bounds.min.as_dvec3(), self.bounds.max.as_dvec3());
        let extent = extent(&self.bounds);
        let along = (0.5 * (min + max) - origin).dot(dir) / dir.length_squared();
        let before = 2.0 * extent / dir.length();
        // The box lies within one diagonal of the nearest point; the rest is margin.
        (along - 2.0 * before).max(0.0)
    }
}

/// The greatest power of two that is at most `x` (positive and finite; a normal number).
fn power_of_two_at_most(x: f64) -> f64 {
    const EXPONENT: u64 = 0x7FF0_0000_0000_0000;
    f64::from_bits(x.clamp(f64::MIN_POSITIVE, 1e300).to_bits() & EXPONENT)
}

/// The longest edge, not zero.
fn extent(bounds: &Aabb) -> f64 {
    (bounds.max.as_dvec3() - bounds.min.as_dvec3()).max_element().max(f64::MIN_POSITIVE)
}

/// A power of two, and one over it.
#[derive(Clone, Copy, Debug)]
struct PowerOfTwo {
    value: f64,
    inverse: f64,
}

/// The least and the greatest power of two whose inverse is a normal number, too.
const MIN: f32 = 1.0 / (1u128 << 126) as f32;
const MAX: f32 = (1u128 << 126) as f32;

impl PowerOfTwo {
    /// Both in 32 bits, if they are normal numbers there.
    #[inline(always)]
    fn narrow(self) -> Option<(f32, f32)> {
        (f64::from(MIN)..=f64::from(MAX)).contains(&self.value).then_some((narrow(self.value), narrow(self.inverse)))
    }
}

/// The greatest power of two that brings `x` (positive and finite) to at most 1.
#[inline(always)]
fn to_at_most_one(x: f32) -> PowerOfTwo {
    const MANTISSA: u32 = 52;
    const BIAS: u64 = 1023;
    let bits = f64::from(x).to_bits();
    let up_to = (bits >> MANTISSA) + u64::from(bits << (64 - MANTISSA) != 0);
    PowerOfTwo { value: f64::from_bits((2 * BIAS - up_to) << MANTISSA), inverse: f64::from_bits(up_to << MANTISSA) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scaling_by_a_power_of_two_changes_nothing_but_the_scale() {
        let bounds = Aabb { min: Vec3::new(-1.0, 0.0, 2.0), max: Vec3::new(3.0, 1.0, 2.5) };
        let ray = Ray { origin: Vec3::new(0.1, 5.0, -2.0), dir: Vec3::new(0.3, -0.7, 0.2), tmin: 0.5, tmax: 100.0 };
        let here = Space::new(&bounds).enter(&ray);
        for k in [-90, -30, 17, 90] {
            let s = 2.0f32.powi(k);
            let scaled = Space::new(&Aabb { min: bounds.min * s, max: bounds.max * s });
            let there = scaled.enter(&Ray { origin: ray.origin * s, dir: ray.dir * s, ..ray });
            assert_eq!(here.ray, there.ray);
            assert_eq!(here.back.world_t(0.7), there.back.world_t(0.7));
        }
    }

    #[test]
    fn a_far_origin_is_moved_close_and_t_is_put_back() {
        let space = Space::new(&Aabb { min: Vec3::splat(-1.0), max: Vec3::splat(1.0) });
        let entered = space.enter(&Ray::new(Vec3::new(1e6, 0.25, 0.0), Vec3::NEG_X));
        assert!(entered.ray.origin.length() < FAR as f32);
        let t = entered.ray.origin.x - 0.5; // to the plane x = 1, at 0.5 once scaled
        assert_eq!(entered.back.world_t(t), 1e6 - 1.0);
        assert_eq!(entered.ray.origin.y, 0.125);
    }

    #[test]
    fn the_power_of_two_is_the_greatest_that_keeps_to_one() {
        for x in [1.0, 0.75, 2.0, 3.0, 1e-45, f32::MAX, 1e-38, 0.999_999_94, 1.000_000_1] {
            let up = to_at_most_one(x);
            assert_eq!(up.value, power_of_two_at_most(1.0 / f64::from(x)), "{x}");
            assert_eq!(up.value * up.inverse, 1.0);
            assert!(f64::from(x) * up.value <= 1.0 && f64::from(x) * up.value > 0.5);
        }
    }

    #[test]
    fn the_short_way_is_the_long_way() {
        let world = Aabb { min: Vec3::new(-3.0, 1.0, 20.0), max: Vec3::new(7.0, 1.5, 29.0) };
        for k in [-100, -60, 0, 1, 60, 100] {
            let s = 2.0f32.powi(k);
            let space = Space::new(&Aabb { min: world.min * s, max: world.max * s });
            for (dir, tmin, tmax) in
                [(Vec3::new(0.3, -1e-30, 5.0), 0.1, 7.7), (Vec3::new(-1e-42, 3e-39, 0.0), 0.0, f32::INFINITY)]
            {
                for origin in [Vec3::new(1.0, 1.2, 22.0), Vec3::new(-1e-3, 60.0, 1e-41)] {
                    let ray = Ray { origin: origin * s, dir, tmin: tmin * s, tmax: tmax * s };
                    let (short, long) = (space.enter(&ray), space.enter_from_afar(&ray, to_at_most_one(dir.abs().max_element())));
                    assert_eq!((short.ray, short.back), (long.ray, long.back), "{ray:?}");
                }
            }
        }
    }

    #[test]
    fn extremes_stay_finite() {
        for far in [f32::MAX, 1e-45, 1e30] {
            let space = Space::new(&Aabb { min: Vec3::ZERO, max: Vec3::splat(far) });
            assert!(space.bounds().max.is_finite() && space.bounds().max.x >= 0.25, "{far}");
            let entered = space.enter(&Ray::new(Vec3::ZERO, Vec3::new(1e-45, f32::MAX, 0.0)));
            assert!(entered.ray.is_valid());
        }
    }
}
