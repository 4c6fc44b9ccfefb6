//! Triangles of a leaf that holds their numbers alone: a first look at up to eight at a time, whose points are
//! fetched from all over the model, then the whole test of those that may be met.

use super::best::Best;
use super::hit::Query;
use super::probe::Probe;
use crate::geometry::eight::Points;
use crate::geometry::tri::TriTest;
use crate::scene::{Geometry, PrimRef};
use crate::simd::{Kernel, LANES, Simd};

/// Up to that many triangles are tested one after the other: fetching eight takes as long.
const FEW: usize = 2;

impl Best {
    /// Tests triangles as [`Self::test`] does one after the other. True if the search is over.
    #[inline(always)]
    pub fn test_all<T: TriTest, Q: Query, P: Probe>(
        &mut self,
        ray: &T,
        geometry: &Geometry,
        prims: &[PrimRef],
        (query, probe): (&Q, &mut P),
    ) -> bool {
        match probe.road() {
            Some(road) if prims.len() > FEW => prims.chunks(LANES).any(|prims| {
                let mut left = road.run(Look { ray, geometry, prims });
                while left != 0 {
                    let prim = prims[left.trailing_zeros() as usize];
                    left &= left - 1;
                    if self.test_in_doubt(ray, &geometry.corners(prim), prim, query, probe) {
                        return true;
                    }
                }
                false
            }),
            _ => prims.iter().any(|prim| self.test(ray, &geometry.corners(*prim), *prim, query, probe)),
        }
    }
}

/// Which of up to eight triangles a ray may meet, a bit for each: see [`TriTest::may_meet`].
struct Look<'a, T> {
    ray: &'a T,
    geometry: &'a Geometry,
    prims: &'a [PrimRef],
}

impl<T: TriTest> Kernel for Look<'_, T> {
    type Out = u32;

    #[inline(always)]
    fn run<S: Simd>(self, s: S) -> u32 {
        let (points, triangles) = self.geometry.indexed();
        let mut corners = [[0; LANES]; 3];
        for (lane, prim) in self.prims.iter().enumerate() {
            let [a, b, c] = triangles[*prim as usize];
            (corners[0][lane], corners[1][lane], corners[2][lane]) = (a, b, c);
        }
        let [x, y, z] = self.ray.axes();
        let mut found = [Points::all(s.splat(0.0)); 3];
        for (found, which) in found.iter_mut().zip(&corners) {
            let by_axis = s.gather(points, which);
            *found = Points { x: by_axis[x], y: by_axis[y], z: by_axis[z] };
        }
        self.ray.may_meet(s, &found) & ((1 << self.prims.len()) - 1)
    }
}
