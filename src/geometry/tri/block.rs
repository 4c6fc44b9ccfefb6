//! Eight triangles side by side, and a first look at all of them at once: which ones a ray may meet.
//! Written as loops over lanes that compilers turn into vector instructions; the operations are those
//! of the test of one triangle, in the same order, so the look never loses a hit.

use glam::Vec3;

/// Triangles in a block.
pub const LANES: usize = 8;

/// One number for each triangle of a block.
pub type Lanes = [f32; LANES];

/// Corners by corner, axis and lane.
#[derive(Clone, Copy, Debug)]
#[repr(align(32))]
pub struct Block {
    /// `corners[corner][axis][lane]`; lanes without a triangle are zero.
    pub corners: [[Lanes; 3]; 3],
}

impl Block {
    /// Of at most [`LANES`] triangles.
    pub fn new(triangles: impl IntoIterator<Item = [Vec3; 3]>) -> Self {
        let mut block = Self { corners: [[[0.0; LANES]; 3]; 3] };
        for (lane, tri) in triangles.into_iter().enumerate().take(LANES) {
            for (to, from) in block.corners.iter_mut().zip(tri) {
                (0..3).for_each(|axis| to[axis][lane] = from[axis]);
            }
        }
        block
    }

    /// The triangle of a lane.
    #[inline(always)]
    pub fn triangle(&self, lane: usize) -> [Vec3; 3] {
        self.corners.each_ref().map(|c| Vec3::new(c[0][lane], c[1][lane], c[2][lane]))
    }
}

/// `f` of each lane.
#[inline(always)]
pub(super) fn each(f: impl Fn(usize) -> f32) -> Lanes {
    let mut lanes = [0.0; LANES];
    for (i, lane) in lanes.iter_mut().enumerate() {
        *lane = f(i);
    }
    lanes
}

/// One bit for each lane.
#[inline(always)]
pub(super) fn mask(f: impl Fn(usize) -> bool) -> u32 {
    let mut bits = [0u32; LANES];
    for (i, bit) in bits.iter_mut().enumerate() {
        *bit = u32::from(f(i)) << i;
    }
    bits.iter().fold(0, |a, b| a | b)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::tri::{Fast, TriTest, Watertight};
    use crate::geometry::{Aabb, Ray};
    use proptest::prelude::*;

    fn point() -> impl Strategy<Value = Vec3> {
        // Few distinct values, so that rays pass through edges and corners.
        let x = || prop_oneof![(-4i8..=4).prop_map(|i| f32::from(i) * 0.25), -1.0f32..1.0];
        (x(), x(), x()).prop_map(|(x, y, z)| Vec3::new(x, y, z))
    }

    fn loses_nothing<T: TriTest>(ray: &Ray, triangles: &[[Vec3; 3]]) -> Result<(), TestCaseError> {
        let test = T::prepare(ray, &Aabb { min: Vec3::NEG_ONE, max: Vec3::ONE });
        let block = Block::new(triangles.iter().copied());
        let found = test.may_meet(&block);
        for (i, tri) in triangles.iter().enumerate() {
            prop_assert_eq!(block.triangle(i), *tri);
            prop_assert!(test.meet(tri).is_none() || found >> i & 1 == 1, "lane {} of {:?}", i, ray);
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
        assert_eq!(Watertight::prepare(&ray, &bounds).may_meet(&Block::new([far; LANES])), 0);
        assert_eq!(Fast::prepare(&ray, &bounds).may_meet(&Block::new([far; LANES])), 0);
    }
}
