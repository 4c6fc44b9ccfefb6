//! Corners of faces: as the file writes them, as a piece of it keeps them, and as the faces of the
//! model name them.

use crate::geometry::num;
use crate::scene::load::text::number;

/// Stands for an attribute that a corner does not have.
pub(super) const NONE: u32 = u32::MAX;

/// More positions, or texture coordinates, or normals than these are refused, which leaves room in
/// 31 bits to count back from any of them (see [`kept`]).
pub(super) const MOST: usize = 2_000_000_000;

/// What a corner is made of: a position and, or [`NONE`], a texture coordinate and a normal.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) struct Corner {
    pub position: u32,
    pub uv: u32,
    pub normal: u32,
}

/// Which indices are kept of the corners of a face.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Layout {
    /// `v`
    Position,
    /// `v/vt`
    Uv,
    /// `v//vn`
    Normal,
    /// `v/vt/vn`, and every other way of writing, with a 0 for what is not there.
    Both,
}

impl Layout {
    /// Indices to a corner.
    pub const fn stride(self) -> usize {
        match self {
            Self::Position => 1,
            Self::Uv | Self::Normal => 2,
            Self::Both => 3,
        }
    }
}

/// How many positions, texture coordinates and normals there are, or were before some place.
pub(super) type Counts = [usize; 3];

/// `v`, `v/vt`, `v//vn` or `v/vt/vn` in numbers; `None` if it is something else.
pub(super) fn written(word: &[u8]) -> Option<[i64; 3]> {
    let mut indices = [0; 3];
    let mut parts = word.split(|b| *b == b'/');
    for (to, part) in indices.iter_mut().zip(&mut parts).filter(|(_, part)| !part.is_empty()) {
        *to = number(part)?;
    }
    parts.next().is_none().then_some(indices)
}

/// An index as a piece of `length` bytes keeps it, after `seen` statements of its kind in it: one
/// that counts from the first of the file as it is, one that counts back as less than 0. For that,
/// more than was ever `seen` is taken from it, which [`Places`] gives back. What is out of range
/// stays so.
#[inline(always)]
pub(super) fn kept(index: i64, seen: usize, length: usize) -> i32 {
    if index >= 0 {
        return i32::try_from(index).unwrap_or(i32::MAX);
    }
    let back = i64::try_from(length - seen).unwrap_or(i64::MAX).saturating_add(1);
    i32::try_from(index.saturating_sub(back)).unwrap_or(i32::MIN)
}

/// Where the indices of a piece point to.
pub(super) struct Places {
    /// What is added to those that count back.
    back: [i64; 3],
    totals: [i64; 3],
}

impl Places {
    /// For a piece of `length` bytes with `before` before it, in a file of `totals`.
    pub fn new(before: Counts, length: usize, totals: Counts) -> Self {
        let wide = |n: usize| i64::try_from(n).unwrap_or(i64::MAX);
        Self { back: before.map(|n| wide(n) + wide(length) + 1), totals: totals.map(wide) }
    }

    /// The corner that kept `indices` make, and whether an attribute of it is not there. Its
    /// position is [`NONE`] if there is no such.
    #[inline(always)]
    pub fn corner(&self, layout: Layout, indices: &[i32]) -> (Corner, bool) {
        let [v, vt, vn] = match (layout, indices) {
            (Layout::Position, &[v]) => [v, 0, 0],
            (Layout::Uv, &[v, vt]) => [v, vt, 0],
            (Layout::Normal, &[v, vn]) => [v, 0, vn],
            (_, &[v, vt, vn]) => [v, vt, vn],
            _ => [0; 3],
        };
        let corner = Corner { position: self.place(0, v), uv: self.place(1, vt), normal: self.place(2, vn) };
        (corner, (vt != 0 && corner.uv == NONE) || (vn != 0 && corner.normal == NONE))
    }

    #[inline(always)]
    fn place(&self, part: usize, kept: i32) -> u32 {
        let back = if kept > 0 { -1 } else { self.back[part] };
        let place = i64::from(kept) + back;
        let there = kept != 0 && (0..self.totals[part]).contains(&place);
        if there { u32::try_from(place).unwrap_or(NONE) } else { NONE }
    }
}

/// An index as written, counted from 1 or, negative, back from the last one `seen`.
pub(super) fn resolve(written: i64, seen: usize, total: usize) -> Option<u32> {
    let index = match written {
        0 => None,
        1.. => usize::try_from(written).ok().map(|i| i - 1),
        _ => usize::try_from(written.unsigned_abs()).ok().and_then(|back| seen.checked_sub(back)),
    };
    index.filter(|i| *i < total).map(num::index)
}
