//! Which cells of a lattice a triangle belongs into: those it overlaps or comes within the slack of.

use super::contents::Overlapped;
use super::lattice::Lattice;
use crate::geometry::{Aabb, num, triangle_overlaps_box};
use crate::task::{Cancel, Cancelled};
use glam::Vec3;

/// Cells a large triangle is tested against between two looks at the cancel flag.
const CELLS_PER_CHECK: usize = 1 << 16;

impl Overlapped for Lattice {
    fn overlapped(
        &self,
        tri: &[Vec3; 3],
        cancel: &Cancel,
        each: &mut impl FnMut(usize) -> Result<(), Cancelled>,
    ) -> Result<(), Cancelled> {
        let b = Aabb::of_triangle(tri);
        let [x, y, z] = [0, 1, 2].map(|k| self.layers(k, b.min[k], b.max[k]));
        // A triangle inside one layer on two axes overlaps every cell of its box.
        let in_a_row = [x, y, z].iter().filter(|l| l.0 == l.1).count() >= 2 && self.holds(&b);
        let slack = Vec3::splat(num::narrow(self.slack).next_up());
        let mut seen = 0;
        for k in z.0..=z.1 {
            for j in y.0..=y.1 {
                seen += x.1 - x.0 + 1;
                if seen >= CELLS_PER_CHECK {
                    cancel.check()?;
                    seen = 0;
                }
                for i in x.0..=x.1 {
                    let at = [i, j, k];
                    let cell = self.bounds(at);
                    let near = Aabb { min: cell.min - slack, max: cell.max + slack };
                    if in_a_row || triangle_overlaps_box(tri, &near) {
                        each(self.index(at))?;
                    }
                }
            }
        }
        Ok(())
    }
}
