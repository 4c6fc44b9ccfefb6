//! A node that a ray is passing through: which of its octants are still ahead (Revelles, Ureña and
//! Lastra 2000, "An Efficient Parametric Algorithm for Octree Traversal").
//!
//! As there, octants are numbered as the ray sees them, bit k set for the half it meets second on
//! axis k, and everything is decided by the t at which the dividing planes are met. Here each plane
//! is met in an interval of t, its stated error; an octant is passed by only if the ray cannot
//! touch it.
//!
//! ```text
//!            ray's numbers, y = bit 1:    2 | 3      0, 1, 2, 3 is front to back: the ray
//!                               ray ─►    ──┼──      never goes from a half that it meets
//!                                         0 | 1      second back into the one it met first
//! ```

use super::node::{Node, UPPER, middle, part};
use crate::geometry::{Aabb, Along};
use glam::Vec3;

/// A node to be visited, its cell, and the part of the ray that may be in it.
#[derive(Clone, Copy, Debug)]
pub struct Visit {
    /// Its index.
    pub node: u32,
    /// What bounds it.
    pub cell: Aabb,
    /// The earliest t.
    pub entry: f32,
    /// The latest t.
    pub exit: f32,
}

/// An inner node on the way down to where the ray is.
#[derive(Clone, Copy, Debug)]
pub struct Frame {
    node: Node,
    cell: Aabb,
    entry: f32,
    exit: f32,
    /// The earliest and latest t of the planes; infinite on an undivided axis.
    early: Vec3,
    late: Vec3,
    /// Turns the ray's number of an octant into the node's.
    flip: u8,
    /// Octants still to be looked at, in the ray's numbers.
    todo: u8,
}

impl Frame {
    /// Nothing to do.
    pub const NONE: Self = Self {
        node: Node::leaf(0, 0),
        cell: Aabb::EMPTY,
        entry: 0.0,
        exit: 0.0,
        early: Vec3::ZERO,
        late: Vec3::ZERO,
        flip: 0,
        todo: 0,
    };

    /// For an inner node.
    #[inline(always)]
    pub fn new(node: Node, visit: &Visit, along: &[Along; 3]) -> Self {
        let Visit { cell, entry, exit, .. } = *visit;
        let (octants, middle) = (node.octants(), middle(&cell));
        let (mut early, mut late) = (Vec3::INFINITY, Vec3::INFINITY);
        let (mut flip, mut passed) = (0, 0);
        for k in 0..3 {
            if octants.axes >> k & 1 == 0 {
                continue;
            }
            (early[k], late[k]) = along[k].plane(middle[k]);
            flip |= u8::from(along[k].backward()) << k;
            if late[k] < entry {
                passed |= !UPPER[k];
            }
            if early[k] > exit {
                passed |= UPPER[k];
            }
        }
        let todo = flipped(octants.filled, flip) & !passed;
        Self { node, cell, entry, exit, early, late, flip, todo }
    }

    /// The next octant that the ray may touch before `best_t`.
    #[inline(always)]
    pub fn next(&mut self, best_t: f32) -> Option<Visit> {
        while self.todo != 0 {
            let number = (self.todo.trailing_zeros() & 7) as u8;
            self.todo &= self.todo - 1;
            let (mut entry, mut exit) = (self.entry, self.exit);
            for k in 0..3 {
                if number >> k & 1 == 1 {
                    entry = if self.early[k] > entry { self.early[k] } else { entry };
                } else {
                    exit = if self.late[k] < exit { self.late[k] } else { exit };
                }
            }
            if entry <= exit && entry <= best_t {
                let octant = self.flip ^ number;
                let cell = part(&self.cell, middle(&self.cell), self.node.octants().axes, octant);
                return Some(Visit { node: self.node.child(octant), cell, entry, exit });
            }
        }
        None
    }
}

/// A set of octants in the other numbers: bit i goes to bit `i ^ flip`.
#[inline(always)]
fn flipped(octants: u8, flip: u8) -> u8 {
    let swap = |set: u8, k: usize| (set & UPPER[k]) >> (1 << k) | (set & !UPPER[k]) << (1 << k);
    (0..3).fold(octants, |set, k| if flip >> k & 1 == 1 { swap(set, k) } else { set })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accel::octree::node::Octants;
    use crate::geometry::{Ray, Slabs};

    #[test]
    fn sets_are_flipped_bit_by_bit() {
        for flip in 0..8u8 {
            for octant in 0..8u8 {
                assert_eq!(flipped(1 << octant, flip), 1 << (octant ^ flip));
            }
        }
    }

    /// The octants that a ray visits in the cube from -1 to 1, in order.
    fn visited(origin: Vec3, dir: Vec3) -> Vec<u32> {
        let cell = Aabb { min: Vec3::splat(-1.0), max: Vec3::ONE };
        let slabs = Slabs::new(&Ray::new(origin, dir), &cell);
        let (entry, exit) = slabs.interval(&cell);
        let node = Node::inner(Octants { filled: 0xFF, axes: 7 }, 0);
        let mut frame = Frame::new(
            node,
            &Visit { node: 0, cell, entry: entry.max(0.0), exit },
            &[slabs.along(0), slabs.along(1), slabs.along(2)],
        );
        std::iter::from_fn(|| frame.next(f32::INFINITY).map(|visit| visit.node)).collect()
    }

    #[test]
    fn octants_come_front_to_back() {
        assert_eq!(visited(Vec3::new(-2.0, -0.5, -0.4), Vec3::X), [0, 1]);
        assert_eq!(visited(Vec3::new(2.0, 0.5, -0.4), Vec3::NEG_X), [3, 2]);
        assert_eq!(visited(Vec3::new(-0.9, -0.6, -0.3), Vec3::ONE), [0, 4, 6, 7]);
        assert_eq!(visited(Vec3::new(0.9, 0.6, 0.3), Vec3::NEG_ONE), [7, 3, 1, 0]);
        assert_eq!(visited(Vec3::new(0.5, 0.5, 0.5), Vec3::new(0.1, 1.0, 0.1)), [7], "starts in the last");
    }

    #[test]
    fn a_ray_along_a_plane_visits_both_sides() {
        assert_eq!(visited(Vec3::new(-2.0, 0.0, 0.5), Vec3::X), [4, 5, 6, 7]);
        let mut all = visited(Vec3::splat(-2.0), Vec3::ONE);
        assert_eq!(all.remove(0), 0);
        assert_eq!(all.pop(), Some(7), "through the centre: all that meet there may be touched");
    }
}
