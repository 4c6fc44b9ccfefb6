//! What a slot of a node refers to, in 32 bits.

/// Another node, the triangles of a leaf, or nothing.
///
/// ```text
/// node   00 00pppp pppppppp pppppppp pppppppp   its place, in units
/// leaf   10 ccpppp pppppppp pppppppp pppppppp   blocks - 1, the place of the first
/// NONE   11 111111 11111111 11111111 11111111
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(transparent)]
pub struct Child(u32);

const LEAF: u32 = 1 << 31;
const COUNT_AT: u32 = 28;
const KIND_AT: u32 = 30;
const PLACE: u32 = (1 << COUNT_AT) - 1;

/// The most blocks of a leaf.
pub const MAX_BLOCKS: usize = 4;
/// The most units that can be referred to: 8 GiB.
pub const MAX_UNITS: usize = PLACE as usize;

impl Child {
    /// Nothing: a slot that is not used.
    pub const NONE: Self = Self(u32::MAX);

    /// A node.
    pub const fn node(place: u32) -> Self {
        Self(place)
    }

    /// The triangles in some blocks, at least one and at most [`MAX_BLOCKS`].
    pub const fn leaf(first: u32, blocks: u32) -> Self {
        Self(LEAF | (blocks - 1) << COUNT_AT | first)
    }

    /// The same `by` units on.
    pub const fn moved(self, by: u32) -> Self {
        match self {
            Self::NONE => self,
            _ => Self(self.0 + by),
        }
    }

    #[inline(always)]
    pub const fn is_node(self) -> bool {
        self.0 & LEAF == 0
    }

    /// The place of a node, or of a leaf's first block: what its cell is called.
    #[inline(always)]
    pub const fn place(self) -> u32 {
        self.0 & PLACE
    }

    /// The blocks of a leaf.
    #[inline(always)]
    pub const fn blocks(self) -> u32 {
        (self.0 >> COUNT_AT & 3) + 1
    }

    /// What it is as a number below 4: [`Self::NODE`], [`Self::BLOCKS`], or [`Self::NOTHING`].
    #[inline(always)]
    pub const fn kind(self) -> usize {
        (self.0 >> KIND_AT) as usize
    }

    /// The kind of nodes.
    pub const NODE: usize = 0;
    /// The kind of leaves.
    pub const BLOCKS: usize = 2;
    /// The kind of [`Self::NONE`].
    pub const NOTHING: usize = 3;

    #[inline(always)]
    pub const fn is_none(self) -> bool {
        self.0 == Self::NONE.0
    }

    /// A leaf without its first block, which takes so many units, and whether there are others.
    #[inline(always)]
    pub const fn shortened(self, units: u32) -> (Self, bool) {
        (Self(self.0.wrapping_sub(1 << COUNT_AT).wrapping_add(units)), self.0 >> COUNT_AT & 3 != 0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_goes_in_comes_out() {
        assert!(Child::node(5).is_node() && Child::node(5).place() == 5);
        for blocks in 1..=MAX_BLOCKS as u32 {
            for first in [0, 1, PLACE - 5] {
                let leaf = Child::leaf(first, blocks);
                assert!(!leaf.is_node() && leaf != Child::NONE);
                assert_eq!((leaf.place(), leaf.blocks()), (first, blocks));
                let (rest, any) = leaf.shortened(5);
                assert_eq!(any.then_some(rest), (blocks > 1).then(|| Child::leaf(first + 5, blocks - 1)));
            }
        }
    }
}
