//! Eight triangles side by side, and a first look at all of them at once: which ones a ray may meet.
//! The operations are those of the test of one triangle, in the same order and unfused, so the look
//! never loses a hit.

use crate::geometry::eight::Points;
use crate::simd::{LANES, Lanes, Simd};
use glam::Vec3;

/// Where the corners of eight triangles are.
pub trait Eight {
    /// A coordinate of a corner of all of them; lanes without a triangle hold anything.
    fn corner<S: Simd>(&self, s: S, corner: usize, axis: usize) -> S::F;

    /// The triangle of a lane.
    fn triangle(&self, lane: usize) -> [Vec3; 3];
}

/// A corner of eight triangles, the axes in some order.
#[inline(always)]
fn corner<S: Simd>(s: S, triangles: &impl Eight, corner: usize, axes: [usize; 3]) -> Points<S::F> {
    let [x, y, z] = axes;
    Points { x: triangles.corner(s, corner, x), y: triangles.corner(s, corner, y), z: triangles.corner(s, corner, z) }
}

/// The corners of eight triangles.
#[inline(always)]
pub fn corners<S: Simd>(s: S, triangles: &impl Eight, axes: [usize; 3]) -> [Points<S::F>; 3] {
    [corner(s, triangles, 0, axes), corner(s, triangles, 1, axes), corner(s, triangles, 2, axes)]
}

/// Corners by corner, axis and lane.
#[derive(Clone, Copy, Debug, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C, align(32))]
pub struct Block {
    /// `corners[corner][axis][lane]`.
    corners: [[Lanes; 3]; 3],
}

impl Block {
    /// Of at most [`LANES`] triangles; lanes without one are NaN, which no ray meets.
    pub fn new(triangles: impl IntoIterator<Item = [Vec3; 3]>) -> Self {
        let mut block = Self { corners: [[[f32::NAN; LANES]; 3]; 3] };
        for (lane, tri) in triangles.into_iter().enumerate().take(LANES) {
            for (to, from) in block.corners.iter_mut().zip(tri) {
                (0..3).for_each(|axis| to[axis][lane] = from[axis]);
            }
        }
        block
    }
}

impl Eight for Block {
    #[inline(always)]
    fn corner<S: Simd>(&self, s: S, corner: usize, axis: usize) -> S::F {
        s.load(&self.corners[corner][axis])
    }

    #[inline(always)]
    fn triangle(&self, lane: usize) -> [Vec3; 3] {
        let [a, b, c] = &self.corners;
        [of_lane(a, lane), of_lane(b, lane), of_lane(c, lane)]
    }
}

/// One point of eight.
#[inline(always)]
fn of_lane([x, y, z]: &[Lanes; 3], lane: usize) -> Vec3 {
    Vec3::new(x[lane], y[lane], z[lane])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::tri::{Fast, TriTest, Watertight};
    use crate::geometry::{Aabb, Ray};
    use crate::simd::{Kernel, Portable, Road};
    use proptest::prelude::*;

    fn point() -> impl Strategy<Value = Vec3> {
        // Few distinct values, so that rays pass through edges and corners.
        let x = || prop_oneof![(-4i8..=4).prop_map(|i| f32::from(i) * 0.25), -1.0f32..1.0];
        (x(), x(), x()).prop_map(|(x, y, z)| Vec3::new(x, y, z))
    }

    struct Look<'a, T>(&'a T, &'a Block);

    impl<T: TriTest> Kernel for Look<'_, T> {
        type Out = u32;

        #[inline(always)]
        fn run<S: Simd>(self, s: S) -> u32 {
            self.0.may_meet(s, &corners(s, self.1, self.0.axes()))
        }
    }

    fn loses_nothing<T: TriTest>(ray: &Ray, triangles: &[[Vec3; 3]]) -> Result<(), TestCaseError> {
        let test = T::prepare(ray, &Aabb { min: Vec3::NEG_ONE, max: Vec3::ONE });
        let block = Block::new(triangles.iter().copied());
        for road in Road::all() {
            let found = road.run(Look(&test, &block));
            for (i, tri) in triangles.iter().enumerate() {
                prop_assert_eq!(block.triangle(i), *tri);
                prop_assert!(test.meet(tri).is_none() || found >> i & 1 == 1, "lane {} of {:?}, {}", i, ray, road.id());
            }
            prop_assert_eq!(found >> triangles.len(), 0, "lanes without a triangle are met by nothing");
            prop_assert_eq!(found, Portable.run(Look(&test, &block)));
        }
        Ok(())
    }

    proptest! {
        #[test]
        fn the_first_look_loses_no_hit(
            triangles in proptest::collection::vec([point(), point(), point()], 1..=LANES),
            origin in point(), dir in point().prop_filter("a direction", |d| *d != Vec3::ZERO),
        ) {
            let ray = Ray::new(origin * 2.0, dir);
            loses_nothing::<Watertight>(&ray, &triangles)?;
            loses_nothing::<Fast>(&ray, &triangles)?;
        }
    }

    #[test]
    fn most_misses_are_seen_at_once() {
        let far = [Vec3::new(0.5, 0.5, 0.0), Vec3::new(0.6, 0.5, 0.0), Vec3::new(0.5, 0.6, 0.0)];
        let ray = Ray::new(Vec3::new(-0.5, -0.5, -1.0), Vec3::Z);
        let bounds = Aabb { min: Vec3::NEG_ONE, max: Vec3::ONE };
        let block = Block::new([far; LANES]);
        assert_eq!(Portable.run(Look(&Watertight::prepare(&ray, &bounds), &block)), 0);
        assert_eq!(Portable.run(Look(&Fast::prepare(&ray, &bounds), &block)), 0);
    }
}
