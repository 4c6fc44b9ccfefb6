//! What a slot of a node refers to, in 32 bits.

/// Another node, the triangles of a leaf, or nothing.
///
/// ```text
/// node   0 iiiiiii iiiiiiii iiiiiiii iiiiiiii   index of a node
/// leaf   1 ccciiii iiiiiiii iiiiiiii iiiiiiii   blocks - 1, index of the first
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(transparent)]
pub struct Child(u32);

const LEAF: u32 = 1 << 31;
const COUNT_AT: u32 = 28;
const BLOCK: u32 = (1 << COUNT_AT) - 1;

/// The most blocks of a leaf.
pub const MAX_BLOCKS: usize = 7;
/// The most blocks, and nodes, that can be referred to.
pub const MAX_INDEX: usize = BLOCK as usize;

impl Child {
    /// Nothing: a slot that is not used.
    pub const NONE: Self = Self(u32::MAX);

    /// A node.
    pub const fn node(index: u32) -> Self {
        Self(index)
    }

    /// The triangles in some blocks, at least one and at most [`MAX_BLOCKS`].
    pub const fn leaf(first: u32, blocks: u32) -> Self {
        Self(LEAF | (blocks - 1) << COUNT_AT | first)
    }

    /// The same in longer lists: a node moved by `by`, blocks by `from`.
    pub const fn moved(self, by: u32, from: u32) -> Self {
        match self {
            Self::NONE => self,
            _ if self.is_node() => Self(self.0 + by),
            _ => Self(self.0 + from),
        }
    }

    /// What its cell is called in a structure of so many nodes: those by their index, then leaves by their
    /// first block.
    #[inline(always)]
    pub const fn id(self, nodes: usize) -> u32 {
        if self.is_node() { self.0 } else { nodes as u32 + (self.0 & BLOCK) }
    }

    #[inline(always)]
    pub const fn is_node(self) -> bool {
        self.0 & LEAF == 0
    }

    /// The index of a node.
    #[inline(always)]
    pub const fn index(self) -> usize {
        self.0 as usize
    }

    /// The first block of a leaf, and a leaf of the others if there are any.
    #[inline(always)]
    pub const fn split_first(self) -> (u32, Option<Self>) {
        // One block less, one place on.
        let rest = if self.0 >> COUNT_AT & 7 == 0 { None } else { Some(Self(self.0 - (1 << COUNT_AT) + 1)) };
        (self.0 & BLOCK, rest)
    }

    /// The index of a node, or of a leaf's first block.
    #[inline(always)]
    pub const fn place(self) -> usize {
        (self.0 & if self.is_node() { u32::MAX } else { BLOCK }) as usize
    }

    /// The blocks of a leaf.
    #[inline(always)]
    pub const fn blocks(self) -> std::ops::Range<usize> {
        let first = (self.0 & BLOCK) as usize;
        first..first + (self.0 >> COUNT_AT & 7) as usize + 1
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_goes_in_comes_out() {
        assert!(Child::node(5).is_node() && Child::node(5).index() == 5);
        for blocks in 1..=MAX_BLOCKS as u32 {
            for first in [0, 1, BLOCK] {
                let leaf = Child::leaf(first, blocks);
                assert!(!leaf.is_node() && leaf != Child::NONE);
                assert_eq!(leaf.blocks(), first as usize..(first + blocks) as usize);
                let rest = (blocks > 1).then(|| Child::leaf(first + 1, blocks - 1));
                if first < BLOCK {
                    assert_eq!(leaf.split_first(), (first, rest));
                }
            }
        }
    }
}
