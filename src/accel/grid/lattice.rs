//! Where the cells of a grid are. All in 64 bits: a plane's position comes from its number, never
//! from a running sum.

use crate::geometry::{Aabb, num};
use glam::DVec3;

/// Equal cells over a box.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lattice {
    /// The least corner; an array, since axes are picked by number.
    pub min: [f64; 3],
    /// The edges of one cell.
    pub cell: [f64; 3],
    /// Cells along each axis, at least 1.
    pub resolution: [usize; 3],
    /// How far a triangle test may find a triangle beside the ray: triangles are sorted into every
    /// cell that comes this near, so the cells that a ray steps through hold all that it can hit.
    /// Twelve unit roundoffs of the greatest distance from a ray's origin to the scene, as
    /// [`crate::geometry::Slabs`] derives it; origins farther away are moved closer.
    pub slack: f64,
}

/// The most cells along an axis.
const MAX_RESOLUTION: f64 = 4096.0;
/// The most along an axis of a lattice inside a cell, so that eight bits hold it.
const MAX_WITHIN: f64 = 255.0;

impl Lattice {
    /// About `density` cells for each of `prims` triangles over `bounds`, as near to cubes as that
    /// allows (Cleary, Wyvill, Birtwistle and Vatti 1983; Wald et al. 2006, §3.1).
    pub fn new(bounds: &Aabb, prims: usize, density: f64) -> Self {
        let extent = (bounds.max - bounds.min).max_element();
        let reach = f64::from(extent) * (crate::geometry::space::FAR + 2.0);
        let slack = (12.0 * f64::from(num::UNIT_ROUNDOFF) * reach).max(f64::from(f32::MIN_POSITIVE));
        let size = (bounds.max.as_dvec3() - bounds.min.as_dvec3()).max(DVec3::splat(slack));
        let wanted = (density * prims as f64).max(1.0);
        let resolution = resolution(size, wanted, slack, MAX_RESOLUTION);
        // A little room, so that no rounding puts anything on the outermost planes.
        let room = DVec3::splat(2.0 * slack);
        let (min, size) = (bounds.min.as_dvec3() - room, size + 2.0 * room);
        let per_axis = DVec3::new(resolution[0] as f64, resolution[1] as f64, resolution[2] as f64);
        Self { min: min.into(), cell: (size / per_axis).into(), resolution, slack }
    }

    /// Cells along each axis for a lattice inside one of this one's cells, with about `density` cells
    /// for each of `refs` references.
    pub fn resolution_within(&self, refs: u32, density: f64) -> [u8; 3] {
        let resolution = resolution(DVec3::from(self.cell), (density * f64::from(refs)).max(1.0), self.slack, MAX_WITHIN);
        resolution.map(|n| u8::try_from(n).unwrap_or(u8::MAX))
    }

    /// The lattice inside a cell, of at least one cell along each axis.
    #[inline(always)]
    pub fn within(&self, at: [usize; 3], resolution: [u8; 3]) -> Self {
        let min = [0, 1, 2].map(|k| self.plane(k, at[k]));
        let cell = [0, 1, 2].map(|k| self.cell[k] / f64::from(resolution[k]));
        Self { min, cell, resolution: resolution.map(usize::from), slack: self.slack }
    }

    /// The number of cells.
    pub const fn count(&self) -> usize {
        self.resolution[0] * self.resolution[1] * self.resolution[2]
    }

    /// The number of a cell.
    #[inline(always)]
    pub const fn index(&self, at: [usize; 3]) -> usize {
        (at[2] * self.resolution[1] + at[1]) * self.resolution[0] + at[0]
    }

    /// The cell of a number.
    pub const fn at(&self, index: usize) -> [usize; 3] {
        let [nx, ny, _] = self.resolution;
        [index % nx, index / nx % ny, index / (nx * ny)]
    }

    /// The plane before the `i`-th layer of cells.
    #[inline(always)]
    pub fn plane(&self, axis: usize, i: usize) -> f64 {
        self.min[axis] + self.cell[axis] * i as f64
    }

    /// The layer that a coordinate is in; the nearest for one outside.
    #[inline(always)]
    pub fn layer(&self, axis: usize, x: f64) -> usize {
        num::floor_index((x - self.min[axis]) / self.cell[axis], self.resolution[axis] - 1)
    }

    /// The box of a cell, rounded to 32 bits.
    pub fn bounds(&self, at: [usize; 3]) -> Aabb {
        let corner = |up: usize| DVec3::new(self.plane(0, at[0] + up), self.plane(1, at[1] + up), self.plane(2, at[2] + up));
        Aabb { min: corner(0).as_vec3(), max: corner(1).as_vec3() }
    }

    /// Whether a box lies inside.
    pub fn holds(&self, b: &Aabb) -> bool {
        let inside = |k| f64::from(b.min[k]) >= self.plane(k, 0) && f64::from(b.max[k]) <= self.plane(k, self.resolution[k]);
        inside(0) && inside(1) && inside(2)
    }

    /// The layers that an interval on an axis comes within `slack` of, both ends included.
    pub fn layers(&self, axis: usize, from: f32, to: f32) -> (usize, usize) {
        (self.layer(axis, f64::from(from) - self.slack), self.layer(axis, f64::from(to) + self.slack))
    }
}

/// Cells along each axis for about `wanted` in all. An axis too short for two cells gets one, and
/// the others share what it leaves; no cell is smaller than a few times the slack.
fn resolution(size: DVec3, wanted: f64, slack: f64, most: f64) -> [usize; 3] {
    let mut long = [true; 3];
    loop {
        let axes = long.iter().filter(|l| **l).count();
        let volume: f64 = (0..3).filter(|k| long[*k]).map(|k| size[k]).product();
        let edge = (volume / wanted).powf(1.0 / axes.max(1) as f64).max(8.0 * slack);
        let Some(short) = (0..3).find(|k| long[*k] && size[*k] < edge) else {
            return std::array::from_fn(|k| {
                let cells = if long[k] { (size[k] / edge).round().clamp(1.0, most) } else { 1.0 };
                num::floor_index(cells, num::MAX_INDEX)
            });
        };
        long[short] = false;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    #[test]
    fn cells_follow_the_number_of_triangles() {
        let cube = Aabb { min: Vec3::ZERO, max: Vec3::ONE };
        assert_eq!(Lattice::new(&cube, 1000, 1.0).resolution, [10, 10, 10]);
        let flat = Aabb { min: Vec3::ZERO, max: Vec3::new(1.0, 1.0, 0.0) };
        assert_eq!(Lattice::new(&flat, 100, 1.0).resolution, [10, 10, 1], "a flat scene gets one layer");
        let point = Lattice::new(&Aabb { min: Vec3::ONE, max: Vec3::ONE }, 0, 4.0);
        assert_eq!(point.count(), 1);
    }

    #[test]
    fn a_lattice_in_a_cell_fills_it() {
        let lattice = Lattice::new(&Aabb { min: Vec3::ZERO, max: Vec3::new(3.0, 2.0, 1.0) }, 50, 1.0);
        let at = [2, 1, 0];
        let within = lattice.within(at, lattice.resolution_within(100, 2.0));
        let (outer, count) = (lattice.bounds(at), within.count());
        assert!((100..400).contains(&count), "{count}");
        assert_eq!(within.bounds([0; 3]).min, outer.min);
        assert!(within.bounds(within.resolution.map(|n| n - 1)).max.distance(outer.max) <= f32::EPSILON);
        assert_eq!(lattice.resolution_within(0, 64.0), [1; 3], "an empty cell stays whole");
    }

    #[test]
    fn numbers_and_cells_are_the_same() {
        let lattice = Lattice::new(&Aabb { min: Vec3::ZERO, max: Vec3::new(3.0, 2.0, 1.0) }, 500, 2.0);
        assert!((0..lattice.count()).all(|i| lattice.index(lattice.at(i)) == i));
        let at = lattice.at(lattice.count() / 2);
        let centre = lattice.bounds(at).centre();
        assert_eq!([0, 1, 2].map(|k| lattice.layer(k, f64::from(centre[k]))), at);
    }
}
