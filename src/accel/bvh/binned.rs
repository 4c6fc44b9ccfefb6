//! Binned SAH (Wald 2007, "On fast Construction of SAH-based Bounding Volume Hierarchies", §3):
//! the centres are sorted into equal buckets on each axis, and only the planes between buckets are
//! tried.

use rayon::prelude::*;

use super::boxes::{Bounds, PrimBox};
use super::costs::Costs;
use super::slice::{Heuristic, Slice};
use super::topdown::Divided;
use crate::accel::{BuildCx, BuildError};
use crate::geometry::num;

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
    first_right: u32,
}

impl BinRule {
    /// Whether the triangle belongs to the left child.
    #[inline(always)]
    pub fn goes_left(&self, prim: &PrimBox) -> bool {
        // In buckets, the least centre at 0; the greatest is a hair below their number.
        bucket((prim.centre_twice()[self.axis] - self.origin) * self.per_unit) < self.first_right
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

/// From centres to buckets on all axes.
#[derive(Clone, Copy, Debug)]
struct Scale {
    origin: glam::Vec4,
    /// Buckets per doubled unit; 0 on an axis where all centres are equal.
    per_unit: glam::Vec4,
    bins: usize,
}

impl Scale {
    fn new(centres: &Bounds, bins: usize) -> Self {
        // A hair less than `bins`, so that the greatest centre falls into the last bucket; a width
        // too small for its reciprocal counts as none.
        let width = bins as f32 * (1.0 - 4.0 * f32::EPSILON);
        let per_unit = |size: f32| if (width / size).is_finite() { width / size } else { 0.0 };
        let size = centres.size();
        let per_unit = glam::Vec4::new(per_unit(size.x), per_unit(size.y), per_unit(size.z), 0.0);
        Self { origin: centres.min(), per_unit, bins }
    }

    fn rule(&self, axis: usize, first_right: usize) -> BinRule {
        BinRule { axis, origin: self.origin[axis], per_unit: self.per_unit[axis], first_right: num::index(first_right) }
    }

    #[inline(always)]
    fn buckets(&self, prim: &PrimBox) -> [usize; 3] {
        let at = (prim.centre_twice() - self.origin) * self.per_unit;
        [at.x, at.y, at.z].map(|x| (bucket(x) as usize).min(self.bins - 1))
    }
}

/// The bucket of a place in them.
#[inline(always)]
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "`as` saturates")]
const fn bucket(x: f32) -> u32 {
    x as u32
}

/// The buckets of an axis.
#[derive(Clone, Copy)]
struct Bins<const N: usize> {
    bounds: [Bounds; N],
    counts: [u32; N],
}

impl<const N: usize> Bins<N> {
    const EMPTY: Self = Self { bounds: [Bounds::EMPTY; N], counts: [0; N] };

    #[inline(always)]
    fn add(&mut self, at: usize, bounds: Bounds) {
        self.bounds[at] = self.bounds[at].union(bounds);
        self.counts[at] += 1;
    }

    fn join(&mut self, other: &Self) {
        for i in 0..N {
            self.bounds[i] = self.bounds[i].union(other.bounds[i]);
            self.counts[i] += other.counts[i];
        }
    }
}

/// Triangles from which on a node is binned in parallel, and in what portions.
const PARALLEL: usize = 1 << 15;
const CHUNK: usize = 1 << 13;

impl Binned {
    /// The best plane between buckets; `None` if all centres fall into one on every axis. Few
    /// triangles fill few buckets, and clearing all would cost more than filling those.
    pub fn best(&self, prims: &[PrimBox], centres: &Bounds, cx: &BuildCx) -> Result<Option<BinSplit>, BuildError> {
        let bins = (self.bins as usize).min(2 * prims.len()).max(2);
        match (prims.len(), bins) {
            (0..=4, _) => self.among::<8>(bins.min(8), prims, centres, cx),
            (_, 0..=16) | (5..=64, _) => self.among::<16>(bins.min(16), prims, centres, cx),
            (_, 0..=32) => self.among::<32>(bins, prims, centres, cx),
            _ => self.among::<{ MAX_BINS as usize }>(bins, prims, centres, cx),
        }
    }

    fn among<const N: usize>(
        &self,
        bins: usize,
        prims: &[PrimBox],
        centres: &Bounds,
        cx: &BuildCx,
    ) -> Result<Option<BinSplit>, BuildError> {
        let scale = Scale::new(centres, bins);
        let mut counted = [Bins::<N>::EMPTY; 3];
        if prims.len() < PARALLEL {
            count(prims, &scale, &mut counted);
        } else {
            counted = count_in_parallel(prims, &scale, cx)?;
        }
        let mut best: Option<BinSplit> = None;
        for (axis, bins_on_axis) in counted.iter().enumerate() {
            let least = best.map_or(f64::INFINITY, |b| b.children);
            if let Some((children, first_right, sides)) = cheapest(bins_on_axis, bins, least) {
                best = Some(BinSplit { rule: scale.rule(axis, first_right), children, sides });
            }
        }
        Ok(best)
    }
}

impl Heuristic for Binned {
    fn divide<'a>(&self, slice: Slice<'a>, may_be_leaf: bool, cx: &BuildCx) -> Result<Divided<Slice<'a>>, BuildError> {
        let best = self.best(slice.prims, &slice.centres, cx)?;
        let pays = |split: &BinSplit| {
            !may_be_leaf || self.costs.split(slice.bounds.half_area(), split.children) < self.costs.leaf(&slice)
        };
        let Some(split) = best.filter(pays) else { return Ok(Divided::Whole(slice)) };
        let (left, right) = slice.partition(|p| split.rule.goes_left(p));
        Ok(Divided::Two(left, right))
    }
}

/// Sorts the triangles into the buckets of all axes in one pass.
fn count<const N: usize>(prims: &[PrimBox], scale: &Scale, bins: &mut [Bins<N>; 3]) {
    for prim in prims {
        let ([x, y, z], bounds) = (scale.buckets(prim), prim.bounds());
        bins[0].add(x, bounds);
        bins[1].add(y, bounds);
        bins[2].add(z, bounds);
    }
}

fn count_in_parallel<const N: usize>(prims: &[PrimBox], scale: &Scale, cx: &BuildCx) -> Result<[Bins<N>; 3], BuildError> {
    let chunk = |mut bins: [Bins<N>; 3], prims: &[PrimBox]| {
        cx.cancel.check()?;
        count(prims, scale, &mut bins);
        Ok(bins)
    };
    let join = |mut a: [Bins<N>; 3], b: [Bins<N>; 3]| {
        a.iter_mut().zip(&b).for_each(|(a, b)| a.join(b));
        Ok(a)
    };
    let none = || [Bins::EMPTY; 3];
    prims.par_chunks(CHUNK).try_fold(none, chunk).try_reduce(none, join)
}

/// Among the first `n` buckets: the first on the right of the plane with the least `half area *
/// count` summed over both sides, that sum, and the sides' boxes; `None` if all triangles fall into
/// one bucket, or if no plane costs less than `least`. One sweep from the right, one from the left.
fn cheapest<const N: usize>(bins: &Bins<N>, n: usize, least: f64) -> Option<(f64, usize, [Bounds; 2])> {
    let mut right_cost = [f64::INFINITY; N];
    let (mut side, mut count) = (Bounds::EMPTY, 0);
    for i in (1..n).rev() {
        side = side.union(bins.bounds[i]);
        count += bins.counts[i];
        if count > 0 {
            right_cost[i] = side.half_area() * f64::from(count);
        }
    }
    let (mut left, mut count) = (Bounds::EMPTY, 0);
    let mut best: Option<(f64, usize, Bounds)> = None;
    for (first_right, right_cost) in right_cost.iter().enumerate().take(n).skip(1) {
        left = left.union(bins.bounds[first_right - 1]);
        count += bins.counts[first_right - 1];
        if count > 0 {
            let cost = left.half_area() * f64::from(count) + right_cost;
            if cost < best.map_or(least, |b| b.0) {
                best = Some((cost, first_right, left));
            }
        }
    }
    let (cost, first_right, left) = best?;
    let right = bins.bounds[first_right..n].iter().fold(Bounds::EMPTY, |b, bin| b.union(*bin));
    Some((cost, first_right, [left, right]))
}
