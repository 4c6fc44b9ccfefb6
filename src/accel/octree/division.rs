//! Which parts of a cell each triangle overlaps, and what dividing it there costs by the surface
//! area heuristic (MacDonald and Booth 1990).

use rayon::prelude::*;

use super::node::{Octants, UPPER, middle, octants, part};
use crate::geometry::{Aabb, triangle_overlaps_box};
use crate::scene::{Geometry, PrimRef};
use crate::task::{Cancel, Cancelled};
use glam::Vec3;

/// The weights.
#[derive(Clone, Copy, Debug)]
pub struct Costs {
    /// Cost of a step.
    pub c_trav: f64,
    /// Cost of testing a triangle.
    pub c_isect: f64,
}

impl Costs {
    /// The cost of not dividing.
    pub fn leaf(&self, refs: usize) -> f64 {
        self.c_isect * refs as f64
    }
}

/// Triangles handled between two looks at the cancel flag.
pub const CHUNK: usize = 1 << 12;

/// A cell divided in the middle, and which of its triangles go where.
#[derive(Debug)]
pub struct Division {
    /// The parts that have triangles.
    pub octants: Octants,
    /// For each triangle the octants it overlaps, as bits.
    sets: Vec<u8>,
    /// For each octant its triangles.
    pub counts: [usize; 8],
    /// For each octant its cell.
    pub cells: [Aabb; 8],
}

impl Division {
    /// Divides a cell on `axes`; `refs` overlap it.
    pub fn new(cell: &Aabb, axes: u8, refs: &[PrimRef], geometry: &Geometry, cancel: &Cancel) -> Result<Self, Cancelled> {
        let middle = middle(cell);
        let cells = [0, 1, 2, 3, 4, 5, 6, 7].map(|octant| part(cell, middle, axes, octant));
        let all = octants(axes).fold(0, |all, octant| all | 1 << octant);
        let chunk = |refs: &[PrimRef]| {
            let set = |prim: &PrimRef| overlapped(&geometry.corners(*prim), all, middle, &cells);
            cancel.check().map(|()| refs.iter().map(set).collect::<Vec<u8>>())
        };
        let sets = if refs.len() <= CHUNK {
            chunk(refs)?
        } else {
            refs.par_chunks(CHUNK).map(chunk).collect::<Result<Vec<_>, _>>()?.concat()
        };
        let mut of_set = [0usize; 256];
        sets.iter().for_each(|set| of_set[usize::from(*set)] += 1);
        let counts =
            [0, 1, 2, 3, 4, 5, 6, 7].map(|octant| (0..256).filter(|set| set >> octant & 1 == 1).map(|set| of_set[set]).sum());
        let filled = (0..8).filter(|octant| counts[*octant] > 0).fold(0, |filled, octant| filled | 1 << octant);
        Ok(Self { octants: Octants { filled, axes }, sets, counts, cells })
    }

    /// References of all parts.
    pub fn references(&self) -> usize {
        self.counts.iter().sum()
    }

    /// The parts that have triangles.
    pub fn parts(&self) -> impl Iterator<Item = usize> + use<> {
        let filled = self.octants.filled;
        (0..8).filter(move |octant| filled >> octant & 1 == 1)
    }

    /// The cost of a cell of that area, if no part is divided further.
    pub fn cost(&self, costs: &Costs, area: f64) -> f64 {
        let part = |octant: usize| self.cells[octant].area() / area * costs.leaf(self.counts[octant]);
        costs.c_trav + self.parts().map(part).sum::<f64>()
    }

    /// The triangles of a part, in the order of `refs`, which are those it was made of.
    pub fn refs(&self, octant: usize, refs: &[PrimRef]) -> Vec<PrimRef> {
        let mut part = Vec::with_capacity(self.counts[octant]);
        part.extend(refs.iter().zip(&self.sets).filter(|(_, set)| *set >> octant & 1 == 1).map(|(prim, _)| *prim));
        part
    }
}

/// The octants among `all` that a triangle overlaps, as bits. Its box decides exactly on each axis;
/// where it leaves more than one octant, the triangle itself is tested.
fn overlapped(tri: &[Vec3; 3], all: u8, middle: Vec3, cells: &[Aabb; 8]) -> u8 {
    let b = Aabb::of_triangle(tri);
    let mut set = all;
    for k in 0..3 {
        if all & UPPER[k] == 0 {
            continue; // an undivided axis
        }
        if b.min[k] > middle[k] {
            set &= UPPER[k];
        }
        if b.max[k] < middle[k] {
            set &= !UPPER[k];
        }
    }
    if set.is_power_of_two() {
        return set;
    }
    let overlaps = |octant: &usize| set >> octant & 1 == 1 && triangle_overlaps_box(tri, &cells[*octant]);
    (0..8).filter(overlaps).fold(0, |set, octant| set | 1 << octant)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_triangle_is_in_the_parts_it_overlaps() {
        let cell = Aabb { min: Vec3::splat(-1.0), max: Vec3::ONE };
        let cells = [0, 1, 2, 3, 4, 5, 6, 7].map(|octant| part(&cell, Vec3::ZERO, 7, octant));
        let of = |tri: [[f32; 3]; 3]| overlapped(&tri.map(Vec3::from), 0xFF, Vec3::ZERO, &cells);
        assert_eq!(of([[0.1, 0.1, 0.1], [0.2, 0.1, 0.1], [0.1, 0.2, 0.1]]), 1 << 7);
        assert_eq!(of([[-0.1, 0.1, 0.1], [0.2, 0.1, 0.1], [0.1, 0.2, 0.1]]), 0b1100_0000);
        // Its box spans four octants, but it cuts off the corner of one of them.
        assert_eq!(of([[0.9, -0.1, 0.5], [-0.1, 0.9, 0.5], [0.8, 0.9, 0.5]]), 0b1110_0000);
        // In a dividing plane: on both sides.
        assert_eq!(of([[0.1, 0.1, 0.0], [0.2, 0.1, 0.0], [0.1, 0.2, 0.0]]), 0b1000_1000);
    }
}
