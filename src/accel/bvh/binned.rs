//! Binned SAH (Wald 2007, "On fast Construction of SAH-based Bounding Volume Hierarchies", §3):
//! the centres are sorted into equal buckets on each axis, and only the planes between buckets are
//! tried.

use rayon::prelude::*;

use super::boxes::{Bounds, PrimBox};
use super::costs::Costs;
use super::few;
use super::slice::{Heuristic, Slice};
use super::topdown::Divided;
use crate::accel::{BuildCx, BuildError};
use glam::{IVec4, Mat4, Vec4};

/// The most buckets on an axis.
pub const MAX_BINS: u32 = 64;

/// The surface area heuristic over buckets.
#[derive(Clone, Copy, Debug)]
pub struct Binned {
    /// Buckets on each axis, 2 to [`MAX_BINS`].
    pub bins: u32,
    /// What a step and a test cost.
    pub costs: Costs,
}

/// The buckets below a number go left.
#[derive(Clone, Copy, Debug)]
pub struct BinRule {
    axis: usize,
    origin: f32,
    per_unit: f32,
    /// The number, as it is before [`bucket`] takes it.
    first_right: f32,
}

impl BinRule {
    /// Whether the triangle belongs to the left child.
    #[inline(always)]
    pub fn goes_left(&self, prim: &PrimBox) -> bool {
        // What is cut off of places at either end lies on the same side of the plane.
        (prim.centre_twice()[self.axis] - self.origin) * self.per_unit + WHOLE < self.first_right
    }
}

/// A plane between buckets.
#[derive(Clone, Copy, Debug)]
pub struct BinSplit {
    /// Which buckets go left.
    pub rule: BinRule,
    /// `half area * count` summed over both sides.
    pub children: f64,
    /// The boxes of both sides.
    pub sides: [Bounds; 2],
}

/// Added to a number of no more than 2^22, this rounds it to a whole one, which is then found in the lowest bits.
const WHOLE: f32 = (1u32 << 23) as f32;

/// The whole number.
#[inline(always)]
const fn bucket(x: f32) -> usize {
    (x.to_bits() & 0xff) as usize
}

/// From centres to buckets on all axes.
#[derive(Clone, Copy, Debug)]
struct Scale {
    /// The middle of the first bucket: numbers are rounded, not cut.
    origin: Vec4,
    /// Buckets per doubled unit; 0 on an axis where all centres are equal.
    per_unit: Vec4,
    last: Vec4,
}

impl Scale {
    fn new(centres: &Bounds, bins: usize) -> Self {
        // A width too small for its reciprocal counts as none.
        let per_unit = |size: f32| if (bins as f32 / size).is_finite() { bins as f32 / size } else { 0.0 };
        let size = centres.size();
        let per_unit = Vec4::new(per_unit(size.x), per_unit(size.y), per_unit(size.z), 0.0);
        Self { origin: centres.min() + size * (0.5 / bins as f32), per_unit, last: Vec4::splat((bins - 1) as f32) }
    }

    fn rule(&self, axis: usize, first_right: usize) -> BinRule {
        BinRule { axis, origin: self.origin[axis], per_unit: self.per_unit[axis], first_right: WHOLE + first_right as f32 }
    }

    /// The buckets on all axes.
    #[inline(always)]
    fn buckets(&self, prim: &PrimBox) -> [usize; 3] {
        let at = (prim.centre_twice() - self.origin) * self.per_unit;
        // The fourth lane holds nothing of meaning, and is not looked at.
        let places = at.max(Vec4::ZERO).min(self.last) + Vec4::splat(WHOLE);
        let [x, y, z, _] = places.to_array();
        [bucket(x), bucket(y), bucket(z)]
    }
}

/// The buckets of all axes side by side, so that one step looks at three planes.
#[derive(Clone, Copy)]
struct Bins<const N: usize> {
    bounds: [[Bounds; 3]; N],
    /// Whole numbers with a sign, since a processor turns those into floats at once.
    counts: [IVec4; N],
}

impl<const N: usize> Bins<N> {
    const EMPTY: Self = Self { bounds: [[Bounds::EMPTY; 3]; N], counts: [IVec4::ZERO; N] };

    /// Sorts triangles into the buckets of all axes in one pass.
    #[inline(always)]
    fn count(&mut self, prims: &[PrimBox], scale: &Scale) {
        for prim in prims {
            let bounds = prim.bounds();
            for (axis, at) in scale.buckets(prim).into_iter().enumerate() {
                let at = at % N;
                self.bounds[at][axis] = self.bounds[at][axis].union(bounds);
                self.counts[at][axis] += 1;
            }
        }
    }

    fn join(&mut self, other: &Self) {
        for i in 0..N {
            self.bounds[i] = union(&self.bounds[i], &other.bounds[i]);
            self.counts[i] += other.counts[i];
        }
    }

    /// The box of some buckets of an axis, and how many triangles there are in them.
    #[inline(always)]
    fn side(&self, axis: usize, from: usize, to: usize) -> (Bounds, i32) {
        let (mut bounds, mut count) = (Bounds::EMPTY, 0);
        for i in from..to {
            bounds = bounds.union(self.bounds[i][axis]);
            count += self.counts[i][axis];
        }
        (bounds, count)
    }

    /// On each axis, among the first `n` buckets: the first on the right of the plane with the least `half area *
    /// count` summed over both sides; the axis and that bucket of the least of all. `None` if all triangles fall into
    /// one bucket on every axis. One sweep from the right, one from the left; areas in units of the
    /// whole box, whatever its size.
    #[inline(always)]
    fn cheapest(&self, n: usize, whole: &Bounds) -> Option<(usize, usize)> {
        let unit = 1.0 / whole.size().truncate().max_element();
        let mut right = [Vec4::ZERO; N];
        let (mut side, mut count) = ([Bounds::EMPTY; 3], IVec4::ZERO);
        for i in (1..n).rev() {
            side = union(&side, &self.bounds[i]);
            count += self.counts[i];
            // Where there is nothing this is no number, and never less than another.
            right[i] = half_areas(&side, unit) * count.as_vec4();
        }
        let (mut least, mut first_right) = (Vec4::INFINITY, Vec4::ZERO);
        (side, count) = ([Bounds::EMPTY; 3], IVec4::ZERO);
        for (i, right) in right.iter().enumerate().take(n).skip(1) {
            side = union(&side, &self.bounds[i - 1]);
            count += self.counts[i - 1];
            let cost = half_areas(&side, unit) * count.as_vec4() + *right;
            let less = cost.cmplt(least);
            least = Vec4::select(less, cost, least);
            first_right = Vec4::select(less, Vec4::splat(WHOLE + i as f32), first_right);
        }
        let (least, first_right) = (least.to_array(), first_right.to_array());
        let best = if least[1] < least[0] { 1 } else { 0 };
        let best = if least[2] < least[best] { 2 } else { best };
        (least[best] < f32::INFINITY).then_some((best, bucket(first_right[best])))
    }
}

#[inline(always)]
fn union(a: &[Bounds; 3], b: &[Bounds; 3]) -> [Bounds; 3] {
    [a[0].union(b[0]), a[1].union(b[1]), a[2].union(b[2])]
}

/// Half the surface areas of three boxes.
#[inline(always)]
fn half_areas(boxes: &[Bounds; 3], unit: f32) -> Vec4 {
    let [a, b, c] = boxes;
    let (a, b, c) = (a.size() * unit, b.size() * unit, c.size() * unit);
    let by_axis = Mat4::from_cols(a, b, c, c).transpose();
    let (x, y, z) = (by_axis.x_axis, by_axis.y_axis, by_axis.z_axis);
    x * (y + z) + y * z
}

/// Triangles from which on a node is binned in parallel, and in what portions.
const PARALLEL: usize = 1 << 15;
const CHUNK: usize = 1 << 13;

impl Binned {
    /// The best plane between buckets; `None` if all centres fall into one on every axis. Few
    /// triangles fill few buckets, and clearing all would cost more than filling those.
    pub fn best(
        &self,
        prims: &[PrimBox],
        bounds: &Bounds,
        centres: &Bounds,
        cx: &BuildCx,
    ) -> Result<Option<BinSplit>, BuildError> {
        let bins = (self.bins as usize).min(2 * prims.len()).max(2);
        match (prims.len(), bins) {
            (0..=4, _) => self.among::<8>(bins.min(8), prims, bounds, centres, cx),
            (_, 0..=16) | (5..=64, _) => self.among::<16>(bins.min(16), prims, bounds, centres, cx),
            (_, 0..=32) => self.among::<32>(bins, prims, bounds, centres, cx),
            _ => self.among::<{ MAX_BINS as usize }>(bins, prims, bounds, centres, cx),
        }
    }

    fn among<const N: usize>(
        &self,
        bins: usize,
        prims: &[PrimBox],
        bounds: &Bounds,
        centres: &Bounds,
        cx: &BuildCx,
    ) -> Result<Option<BinSplit>, BuildError> {
        let scale = Scale::new(centres, bins);
        let counted = if prims.len() < PARALLEL {
            let mut counted = Bins::<N>::EMPTY;
            counted.count(prims, &scale);
            counted
        } else {
            count_in_parallel(prims, &scale, cx)?
        };
        let Some((axis, first_right)) = counted.cheapest(bins, bounds) else { return Ok(None) };
        let [(left, on_left), (right, on_right)] = [counted.side(axis, 0, first_right), counted.side(axis, first_right, bins)];
        let children = left.half_area() * f64::from(on_left) + right.half_area() * f64::from(on_right);
        Ok(Some(BinSplit { rule: scale.rule(axis, first_right), children, sides: [left, right] }))
    }
}

impl Heuristic for Binned {
    fn divide<'a>(&self, slice: Slice<'a>, may_be_leaf: bool, cx: &BuildCx) -> Result<Divided<Slice<'a>>, BuildError> {
        if slice.prims.len() <= few::MOST {
            return Ok(few::divide(slice, may_be_leaf, &self.costs));
        }
        let best = self.best(slice.prims, &slice.bounds, &slice.centres, cx)?;
        let pays = |split: &BinSplit| {
            !may_be_leaf || self.costs.split(slice.bounds.half_area(), split.children) < self.costs.leaf(&slice)
        };
        let Some(split) = best.filter(pays) else { return Ok(Divided::Whole(slice)) };
        let (left, right) = slice.partition_known(|p| split.rule.goes_left(p), split.sides);
        Ok(Divided::Two(left, right))
    }
}

fn count_in_parallel<const N: usize>(prims: &[PrimBox], scale: &Scale, cx: &BuildCx) -> Result<Bins<N>, BuildError> {
    let chunk = |mut bins: Bins<N>, prims: &[PrimBox]| {
        cx.cancel.check()?;
        bins.count(prims, scale);
        Ok(bins)
    };
    let join = |mut a: Bins<N>, b: Bins<N>| {
        a.join(&b);
        Ok(a)
    };
    let none = || Bins::EMPTY;
    prims.par_chunks(CHUNK).try_fold(none, chunk).try_reduce(none, join)
}
