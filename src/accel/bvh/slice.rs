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
    /// Of a whole list; a long one is looked through in parallel.
    pub fn new(prims: &'a mut [PrimBox]) -> Self {
        let (bounds, centres) = (bounds_of(prims), centres_of(prims));
        Self { prims, bounds, centres }
    }

    /// Moves what goes left to the front. `None` of the two may be empty.
    pub fn partition(self, goes_left: impl Fn(&PrimBox) -> bool + Sync) -> (Self, Self) {
        let (left, right) = self.partition_known(goes_left, [Bounds::EMPTY; 2]);
        (Self { bounds: bounds_of(left.prims), ..left }, Self { bounds: bounds_of(right.prims), ..right })
    }

    /// The same where the boxes of both sides are known; those of the centres are gathered on the way.
    pub fn partition_known(self, goes_left: impl Fn(&PrimBox) -> bool + Sync, sides: [Bounds; 2]) -> (Self, Self) {
        let (count, [left, right]) = partition(self.prims, &goes_left);
        debug_assert!(0 < count && count < self.prims.len(), "a split with an empty side");
        let (l, r) = self.prims.split_at_mut(count);
        (Self { prims: l, bounds: sides[0], centres: left }, Self { prims: r, bounds: sides[1], centres: right })
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

/// Triangles from which on a list is handled in two halves, side by side.
const PARALLEL: usize = 1 << 15;

/// How many go left, and the boxes of the centres of both sides. Halves are partitioned side by side, then
/// what is on the wrong side of the place where they meet changes places:
///
/// ```text
/// L1 L1 L1 R1 R1 | L2 R2 R2 R2    ─►    L1 L1 L1 L2 R1 | R1 R2 R2 R2
/// ```
fn partition(prims: &mut [PrimBox], goes_left: &(impl Fn(&PrimBox) -> bool + Sync)) -> (usize, [Bounds; 2]) {
    if prims.len() < PARALLEL {
        return partition_here(prims, goes_left);
    }
    let middle = prims.len() / 2;
    let (first, second) = prims.split_at_mut(middle);
    let ((l1, a), (l2, b)) = rayon::join(|| partition(first, goes_left), || partition(second, goes_left));
    let misplaced = (middle - l1).min(l2);
    first[l1..l1 + misplaced].swap_with_slice(&mut second[l2 - misplaced..l2]);
    (l1 + l2, [a[0].union(b[0]), a[1].union(b[1])])
}

/// By one thread, without a branch that depends on where a triangle goes: half of those would be foreseen wrongly.
/// Each changes places with the first of those that go right, itself if it does.
fn partition_here(prims: &mut [PrimBox], goes_left: &impl Fn(&PrimBox) -> bool) -> (usize, [Bounds; 2]) {
    let (mut count, mut centres) = (0, [Bounds::EMPTY; 2]);
    for i in 0..prims.len() {
        let prim = prims[i];
        let left = goes_left(&prim);
        prims[i] = prims[count];
        prims[count] = prim;
        count += usize::from(left);
        let side = &mut centres[usize::from(!left)];
        *side = side.with(prim.centre_twice());
    }
    (count, centres)
}

/// The box around triangles; of many by several threads.
fn bounds_of(prims: &[PrimBox]) -> Bounds {
    in_halves(prims, |prims| prims.iter().fold(Bounds::EMPTY, |b, prim| b.union(prim.bounds())))
}

/// The box around their centres, doubled.
fn centres_of(prims: &[PrimBox]) -> Bounds {
    in_halves(prims, |prims| prims.iter().fold(Bounds::EMPTY, |b, prim| b.with(prim.centre_twice())))
}

fn in_halves(prims: &[PrimBox], of: impl Fn(&[PrimBox]) -> Bounds + Copy + Sync) -> Bounds {
    if prims.len() < PARALLEL {
        return of(prims);
    }
    let (first, second) = prims.split_at(prims.len() / 2);
    let (a, b) = rayon::join(|| in_halves(first, of), || in_halves(second, of));
    a.union(b)
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::num;
    use glam::Vec3;

    #[test]
    fn long_lists_are_partitioned_as_short_ones_are() {
        for (n, share) in [(PARALLEL - 1, 0.5), (4 * PARALLEL + 3, 0.02), (4 * PARALLEL + 3, 0.5), (3 * PARALLEL, 0.98)] {
            let x = |i: usize| (i as f32 * 0.618_034).fract();
            let mut prims: Vec<PrimBox> = (0..n)
                .map(|i| PrimBox::new(&Bounds::from(&Aabb { min: Vec3::X * x(i), max: Vec3::ONE * x(i) }), num::index(i)))
                .collect();
            let goes_left = |p: &PrimBox| x(p.prim() as usize) < share;
            let expected = prims.iter().filter(|p| goes_left(p)).count();
            let (left, right) = Slice::new(&mut prims).partition(goes_left);
            assert_eq!(left.prims.len(), expected, "{n} {share}");
            assert!(left.prims.iter().all(goes_left) && !right.prims.iter().any(goes_left));
            for side in [left, right] {
                let (bounds, centres) = (bounds_of(side.prims), centres_of(side.prims));
                assert_eq!((side.bounds.aabb(), side.centres.aabb()), (bounds.aabb(), centres.aabb()));
            }
            let mut all: Vec<u32> = prims.iter().map(PrimBox::prim).collect();
            all.sort_unstable();
            assert!(all.iter().enumerate().all(|(i, p)| *p as usize == i));
        }
    }
}
