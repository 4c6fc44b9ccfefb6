//! The triangles of a node as a part of one list, sorted in place: what builders work on that give
//! every triangle to one side.

use super::boxes::{Bounds, PrimBox};
use super::topdown::{Divide, Divided};
use crate::accel::{BuildCx, BuildError};
use crate::geometry::{Aabb, Axis};
use crate::scene::PrimRef;

/// A node's triangles, the box around them, and the box around their centres, doubled.
#[derive(Debug)]
pub struct Slice<'a> {
    pub prims: &'a mut [PrimBox],
    pub bounds: Bounds,
    pub centres: Bounds,
}

impl<'a> Slice<'a> {
    /// Of a whole list.
    pub fn new(prims: &'a mut [PrimBox]) -> Self {
        let sides = prims.iter().fold(Side::EMPTY, Side::with);
        Self { prims, bounds: sides.bounds, centres: sides.centres }
    }

    /// Moves what goes left to the front; the boxes of both sides are gathered on the way. `None` of
    /// the two may be empty.
    pub fn partition(self, goes_left: impl Fn(&PrimBox) -> bool) -> (Self, Self) {
        let (mut lo, mut hi) = (0, self.prims.len());
        let (mut left, mut right) = (Side::EMPTY, Side::EMPTY);
        loop {
            while lo < hi && goes_left(&self.prims[lo]) {
                left = left.with(&self.prims[lo]);
                lo += 1;
            }
            while lo < hi && !goes_left(&self.prims[hi - 1]) {
                right = right.with(&self.prims[hi - 1]);
                hi -= 1;
            }
            if lo >= hi {
                break;
            }
            self.prims.swap(lo, hi - 1);
        }
        debug_assert!(0 < lo && lo < self.prims.len(), "a split with an empty side");
        let (l, r) = self.prims.split_at_mut(lo);
        (left.of(l), right.of(r))
    }

    /// The object median along an axis, ties by number.
    pub fn halve(self, axis: Axis) -> (Self, Self) {
        let key = |p: &PrimBox| p.centre_twice()[axis.index()];
        let mid = self.prims.len() / 2;
        self.prims.select_nth_unstable_by(mid, |a, b| key(a).total_cmp(&key(b)).then(a.prim().cmp(&b.prim())));
        let (l, r) = self.prims.split_at_mut(mid);
        (Self::new(l), Self::new(r))
    }

    /// The axis along which the centres spread most.
    pub fn axis(&self) -> Axis {
        self.centres.longest_axis()
    }
}

/// What is gathered of one side of a partition.
#[derive(Clone, Copy)]
struct Side {
    bounds: Bounds,
    centres: Bounds,
}

impl Side {
    const EMPTY: Self = Self { bounds: Bounds::EMPTY, centres: Bounds::EMPTY };

    #[inline(always)]
    fn with(self, prim: &PrimBox) -> Self {
        Self { bounds: self.bounds.union(prim.bounds()), centres: self.centres.with(prim.centre_twice()) }
    }

    fn of(self, prims: &mut [PrimBox]) -> Slice<'_> {
        Slice { prims, bounds: self.bounds, centres: self.centres }
    }
}

/// Where to divide a slice.
pub trait Heuristic: Sync {
    /// Divides it, or not, as [`Divide::divide`] does.
    fn divide<'a>(&self, slice: Slice<'a>, may_be_leaf: bool, cx: &BuildCx) -> Result<Divided<Slice<'a>>, BuildError>;
}

/// A heuristic as the build loop wants it.
#[derive(Debug)]
pub struct InPlace<'a, H> {
    heuristic: H,
    list: std::marker::PhantomData<&'a mut [PrimBox]>,
}

impl<H: Heuristic> InPlace<'_, H> {
    /// Of a heuristic.
    pub const fn new(heuristic: H) -> Self {
        Self { heuristic, list: std::marker::PhantomData }
    }
}

impl<'a, H: Heuristic> Divide for InPlace<'a, H> {
    type Work = Slice<'a>;

    fn count(&self, slice: &Slice<'a>) -> usize {
        slice.prims.len()
    }

    fn divide(&self, slice: Slice<'a>, may_be_leaf: bool, cx: &BuildCx) -> Result<Divided<Slice<'a>>, BuildError> {
        self.heuristic.divide(slice, may_be_leaf, cx)
    }

    fn halve(&self, slice: Slice<'a>) -> (Slice<'a>, Slice<'a>) {
        let axis = slice.axis();
        slice.halve(axis)
    }

    fn leaf(&self, slice: Slice<'a>, refs: &mut Vec<PrimRef>) -> Aabb {
        refs.extend(slice.prims.iter().map(PrimBox::prim));
        slice.bounds.aabb()
    }
}
