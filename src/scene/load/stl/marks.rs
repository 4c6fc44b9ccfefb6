//! A mark for each corner that is the first at its position, and how many are before it: its vertex.

use std::sync::atomic::{AtomicU64, Ordering::Relaxed};

use glam::Vec3;
use rayon::prelude::*;

use super::table::Table;
use crate::geometry::num;
use crate::scene::LoadCx;
use crate::sys::zeros_in_large_pages;
use crate::task::Cancelled;

/// Words of 64 corners that one thread takes at a time.
const BLOCK: usize = 1 << 9;

/// One bit a corner, and the ones before each word of them (Jacobson, "Space-efficient static trees and
/// graphs", 1989, section 2).
pub(super) struct Marks {
    words: Vec<AtomicU64>,
    before: Vec<u32>,
    count: u32,
}

impl Marks {
    /// Bytes of the marks of so many corners.
    pub const fn bytes(corners: usize) -> u64 {
        corners.div_ceil(64) as u64 * 12
    }

    /// The first corners of a table, out of so many.
    pub fn of(table: &mut Table, corners: usize, cx: &LoadCx) -> Result<Self, Cancelled> {
        let words: Vec<AtomicU64> = zeros_in_large_pages(corners.div_ceil(64));
        table.each_first(cx, |corner| {
            words[corner as usize / 64].fetch_or(1 << (corner % 64), Relaxed);
        })?;
        let mut count = 0;
        let mut before = zeros_in_large_pages(words.len());
        for (to, word) in before.iter_mut().zip(&words) {
            *to = count;
            count += word.load(Relaxed).count_ones();
        }
        Ok(Self { words, before, count })
    }

    /// How many there are.
    pub fn count(&self) -> usize {
        self.count as usize
    }

    /// Whether a corner has one.
    #[inline(always)]
    pub fn has(&self, corner: u32) -> bool {
        self.words[corner as usize / 64].load(Relaxed) >> (corner % 64) & 1 == 1
    }

    /// How many are before a corner.
    #[inline(always)]
    pub fn rank(&self, corner: u32) -> u32 {
        let word = corner as usize / 64;
        let earlier = self.words[word].load(Relaxed) & ((1 << (corner % 64)) - 1);
        self.before[word] + earlier.count_ones()
    }

    /// The positions of the marked corners, in their order.
    pub fn positions(&self, cx: &LoadCx, position: impl Fn(u32) -> Vec3 + Sync) -> Result<Vec<Vec3>, Cancelled> {
        let mut positions = zeros_in_large_pages(self.count());
        let mut rest = &mut positions[..];
        let mut blocks = Vec::with_capacity(self.words.len().div_ceil(BLOCK));
        for first in (0..self.words.len()).step_by(BLOCK) {
            let end = self.before.get(first + BLOCK).copied().unwrap_or(self.count);
            let (block, after) = rest.split_at_mut((end - self.before[first]) as usize);
            blocks.push((first, block));
            rest = after;
        }
        let fill = |(first, block): (usize, &mut [Vec3])| {
            block.iter_mut().zip(self.from(first)).for_each(|(to, corner)| *to = position(corner));
            cx.cancel.check()
        };
        cx.pool.run(|| blocks.into_par_iter().try_for_each(fill))?;
        Ok(positions)
    }

    /// The marked corners from a word on.
    fn from(&self, first: usize) -> impl Iterator<Item = u32> {
        let bits = |(word, bits): (usize, &AtomicU64)| {
            let mut left = bits.load(Relaxed);
            std::iter::from_fn(move || {
                let bit = (left != 0).then(|| left.trailing_zeros())?;
                left &= left - 1;
                Some(num::index(word * 64) + bit)
            })
        };
        self.words.iter().enumerate().skip(first).flat_map(bits)
    }
}
