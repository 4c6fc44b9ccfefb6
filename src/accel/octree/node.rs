//! One node of an octree, and how its cell is divided.
//!
//! A cell is divided at its middle on every axis that is long enough, so it has eight children, or
//! four, or two: a flat scene gets a quadtree, and cells come near to cubes whatever the scene's
//! form. Bit k of an octant's number picks the upper half on axis k; it is 0 on an undivided axis.

use crate::geometry::{Aabb, Axis};
use glam::Vec3;

/// The share of its longest edge that an axis of a cell must have to be divided: the ratio between
/// halving an axis and leaving it that keeps both results equally far from a cube.
const LEAST_SHARE: f32 = std::f32::consts::FRAC_1_SQRT_2;

/// Eight bytes. Inner: `data` is the first child, and `tag` holds which octants have one (8 bits)
/// and which axes are divided (3 bits); children lie side by side, in the order of their octants,
/// and an octant without triangles has none. Leaf: `data` is the first reference, `tag` the number
/// of them with the highest bit set.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Node {
    tag: u32,
    data: u32,
}

const LEAF: u32 = 1 << 31;

/// The most references in a leaf that a tag can hold.
pub const MAX_LEAF: usize = (LEAF - 1) as usize;

impl Node {
    /// A leaf with `count` references from `first` on.
    pub const fn leaf(first: u32, count: u32) -> Self {
        Self { tag: count | LEAF, data: first }
    }

    /// A divided cell with children from `first` on.
    pub const fn inner(octants: Octants, first: u32) -> Self {
        Self { tag: octants.filled as u32 | (octants.axes as u32) << 8, data: first }
    }

    /// The same node with its children, or its references, moved.
    pub const fn moved(self, nodes: u32, refs: u32) -> Self {
        Self { data: self.data + if self.is_leaf() { refs } else { nodes }, ..self }
    }

    /// Whether it holds references.
    #[inline(always)]
    pub const fn is_leaf(self) -> bool {
        self.tag & LEAF != 0
    }

    /// How many references a leaf holds.
    #[inline(always)]
    pub const fn count(self) -> u32 {
        self.tag & !LEAF
    }

    /// Where the references of a leaf are.
    #[inline(always)]
    pub const fn refs(self) -> std::ops::Range<usize> {
        self.data as usize..self.data as usize + self.count() as usize
    }

    /// How the cell of an inner node is divided.
    #[inline(always)]
    pub const fn octants(self) -> Octants {
        Octants { filled: (self.tag & 0xFF) as u8, axes: (self.tag >> 8 & 7) as u8 }
    }

    /// The child in a filled octant.
    #[inline(always)]
    pub const fn child(self, octant: u8) -> u32 {
        self.data + (self.octants().filled & ((1 << octant) - 1)).count_ones()
    }
}

/// How a cell is divided, and which parts have triangles.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Octants {
    /// Bit i: octant i is not empty.
    pub filled: u8,
    /// Bit k: axis k is divided.
    pub axes: u8,
}

/// The octants in the upper half on each axis.
pub const UPPER: [u8; 3] = [0b1010_1010, 0b1100_1100, 0b1111_0000];

/// The planes that divide a cell: the only place that says where, so that the builder, the traversal
/// and the walk agree to the bit.
#[inline(always)]
pub fn middle(cell: &Aabb) -> Vec3 {
    cell.min * 0.5 + cell.max * 0.5
}

/// The axes on which a cell is divided, as bits; `least` is the shortest edge worth dividing.
pub fn divided(cell: &Aabb, least: f32) -> u8 {
    let (size, middle) = (cell.size(), middle(cell));
    let long = (size.max_element() * LEAST_SHARE).max(least);
    let divides = |k: usize| size[k] >= long && cell.min[k] < middle[k] && middle[k] < cell.max[k];
    Axis::ALL.into_iter().filter(|axis| divides(axis.index())).fold(0, |axes, axis| axes | 1 << axis.index())
}

/// The part of a cell that an octant is, divided on `axes` at `middle`.
#[inline(always)]
pub fn part(cell: &Aabb, middle: Vec3, axes: u8, octant: u8) -> Aabb {
    let mut part = *cell;
    for k in 0..3 {
        let upper = octant >> k & 1 == 1;
        if upper {
            part.min[k] = middle[k];
        } else if axes >> k & 1 == 1 {
            part.max[k] = middle[k];
        }
    }
    part
}

/// The octants of a cell divided on `axes`.
pub fn octants(axes: u8) -> impl Iterator<Item = u8> {
    (0..8).filter(move |octant| octant & !axes == 0)
}

const _: () = assert!(size_of::<Node>() == 8);

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_flat_cell_has_four_parts_and_a_long_one_two() {
        let cell = |x, y, z| Aabb { min: Vec3::ZERO, max: Vec3::new(x, y, z) };
        assert_eq!(octants(divided(&cell(1.0, 1.0, 1.0), 0.0)).count(), 8);
        assert_eq!(octants(divided(&cell(1.0, 0.0, 0.9), 0.0)).collect::<Vec<_>>(), [0, 1, 4, 5]);
        assert_eq!(octants(divided(&cell(0.1, 1.0, 0.4), 0.0)).collect::<Vec<_>>(), [0, 2]);
        assert_eq!(divided(&cell(1.0, 1.0, 1.0), 1.5), 0, "too small");
        assert_eq!(divided(&cell(0.0, 0.0, 0.0), 0.0), 0);
    }

    #[test]
    fn parts_cover_their_cell() {
        let cell = Aabb { min: Vec3::new(-0.3, 0.1, 5.0), max: Vec3::new(0.7, 0.9, 5.2) };
        for axes in 0..8 {
            let parts: Vec<_> = octants(axes).map(|o| part(&cell, middle(&cell), axes, o)).collect();
            assert_eq!(parts.len(), 1 << axes.count_ones());
            assert!(parts.iter().all(|p| cell.contains_box(p)));
            assert_eq!(parts.iter().fold(Aabb::EMPTY, |all, p| all.union(*p)), cell);
            let volume = |b: &Aabb| b.size().element_product();
            assert!((parts.iter().map(volume).sum::<f32>() / volume(&cell) - 1.0).abs() < 1e-5);
        }
    }

    #[test]
    fn nodes_keep_what_they_are_given() {
        let node = Node::inner(Octants { filled: 0b1010_0110, axes: 0b111 }, 40).moved(2, 9);
        assert!(!node.is_leaf());
        assert_eq!([1, 2, 5, 7].map(|o| node.child(o)), [42, 43, 44, 45]);
        let leaf = Node::leaf(7, 3).moved(2, 9);
        assert!(leaf.is_leaf());
        assert_eq!((leaf.refs(), leaf.count()), (16..19, 3));
    }
}
