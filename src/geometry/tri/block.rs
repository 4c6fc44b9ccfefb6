//! Eight triangles side by side, and a first look at all of them at once: which ones a ray may meet.
//! The operations are those of the test of one triangle, in the same order and unfused, so the look
//! never loses a hit.

use crate::simd::{LANES, Lanes, Simd};
use glam::Vec3;

/// Where the corners of eight triangles are.
pub trait Eight {
    /// A coordinate of a corner of all of them; lanes without a triangle hold anything.
    fn corner<S: Simd>(&self, s: S, corner: usize, axis: usize) -> S::F;

    /// The triangle of a lane.
    fn triangle(&self, lane: usize) -> [Vec3; 3];
}

/// Eight points.
#[derive(Clone, Copy)]
pub struct Points<F> {
    x: F,
    y: F,
    z: F,
}

// No closures: what is inlined into a road must say so, and closures cannot.
impl<F: Copy> Points<F> {
    /// The same point eight times.
    #[inline(always)]
    pub fn splat<S: Simd<F = F>>(s: S, p: Vec3) -> Self {
        Self { x: s.splat(p.x), y: s.splat(p.y), z: s.splat(p.z) }
    }

    /// A corner of eight triangles.
    #[inline(always)]
    pub fn corner<S: Simd<F = F>>(s: S, triangles: &impl Eight, corner: usize) -> Self {
        Self { x: triangles.corner(s, corner, 0), y: triangles.corner(s, corner, 1), z: triangles.corner(s, corner, 2) }
    }

    /// From other points to these.
    #[inline(always)]
    pub fn minus<S: Simd<F = F>>(self, s: S, other: Self) -> Self {
        Self { x: s.sub(self.x, other.x), y: s.sub(self.y, other.y), z: s.sub(self.z, other.z) }
    }

    /// In the order of [`Vec3::cross`].
    #[inline(always)]
    pub fn cross<S: Simd<F = F>>(self, s: S, other: Self) -> Self {
        Self {
            x: s.sub(s.mul(self.y, other.z), s.mul(other.y, self.z)),
            y: s.sub(s.mul(self.z, other.x), s.mul(other.z, self.x)),
            z: s.sub(s.mul(self.x, other.y), s.mul(other.x, self.y)),
        }
    }

    /// In the order of [`Vec3::dot`].
    #[inline(always)]
    pub fn dot<S: Simd<F = F>>(self, s: S, other: Self) -> F {
        s.add(s.add(s.mul(self.x, other.x), s.mul(self.y, other.y)), s.mul(self.z, other.z))
    }
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
        self.corners.each_ref().map(|c| Vec3::new(c[0][lane], c[1][lane], c[2][lane]))
    }
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
            self.0.may_meet(s, self.1)
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
        assert_eq!(Watertight::prepare(&ray, &bounds).may_meet(Portable, &block), 0);
        assert_eq!(Fast::prepare(&ray, &bounds).may_meet(Portable, &block), 0);
    }
}
