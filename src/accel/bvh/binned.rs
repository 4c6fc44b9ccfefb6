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

#[derive(Clone, Copy)]
struct Bin {
    bounds: Bounds,
    count: u32,
}

const EMPTY: Bin = Bin { bounds: Bounds::EMPTY, count: 0 };

impl Bin {
    #[inline(always)]
    fn join(self, other: Self) -> Self {
        Self { bounds: self.bounds.union(other.bounds), count: self.count + other.count }
    }

    #[inline(always)]
    fn cost(&self) -> f64 {
        self.bounds.half_area() * f64::from(self.count)
    }
}

/// The buckets of all three axes.
type Bins<const N: usize> = [[Bin; N]; 3];

/// Triangles from which on a node is binned in parallel, and in what portions.
const PARALLEL: usize = 1 << 15;
const CHUNK: usize = 1 << 13;

impl Binned {
    /// The best plane between buckets; `None` if all centres fall into one on every axis. Few
    /// triangles fill few buckets, and clearing all would cost more than filling those.
    pub fn best(&self, prims: &[PrimBox], centres: &Bounds, cx: &BuildCx) -> Result<Option<BinSplit>, BuildError> {
        let bins = (self.bins as usize).min(2 * prims.len()).max(2);
        match prims.len() {
            0..=4 => self.among::<8>(bins.min(8), prims, centres, cx),
            5..=64 => self.among::<16>(bins.min(16), prims, centres, cx),
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
        let counted = count::<N>(prims, &scale, cx)?;
        let on_axis = |axis: usize| {
            let (children, first_right, sides) = cheapest(&counted[axis], bins)?;
            Some(BinSplit { rule: scale.rule(axis, first_right), children, sides })
        };
        Ok((0..3).filter_map(on_axis).min_by(|a, b| a.children.total_cmp(&b.children)))
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
fn count<const N: usize>(prims: &[PrimBox], scale: &Scale, cx: &BuildCx) -> Result<Bins<N>, BuildError> {
    let chunk = |prims: &[PrimBox]| {
        let mut bins: Bins<N> = [[EMPTY; N]; 3];
        for prim in prims {
            let (at, bounds) = (scale.buckets(prim), prim.bounds());
            for (bins, at) in bins.iter_mut().zip(at) {
                let bin = &mut bins[at];
                bin.bounds = bin.bounds.union(bounds);
                bin.count += 1;
            }
        }
        bins
    };
    if prims.len() < PARALLEL {
        return Ok(chunk(prims));
    }
    let join = |a: Bins<N>, b: Bins<N>| std::array::from_fn(|k| std::array::from_fn(|i| a[k][i].join(b[k][i])));
    let checked = |prims: &[PrimBox]| cx.cancel.check().map(|()| chunk(prims));
    Ok(prims.par_chunks(CHUNK).map(checked).try_reduce(|| [[EMPTY; N]; 3], |a, b| Ok(join(a, b)))?)
}

/// Among the first `n` buckets: the first on the right of the plane with the least `half area * count` summed over both
/// sides, that sum, and the sides' boxes; `None` if all triangles fall into one bucket. One sweep
/// from the right, one from the left.
fn cheapest<const N: usize>(bins: &[Bin; N], n: usize) -> Option<(f64, usize, [Bounds; 2])> {
    let mut right_cost = [0.0; N];
    let mut right_side = [Bounds::EMPTY; N];
    let mut right = EMPTY;
    for i in (1..n).rev() {
        right = right.join(bins[i]);
        right_side[i] = right.bounds;
        right_cost[i] = if right.count == 0 { f64::INFINITY } else { right.cost() };
    }
    let mut left = EMPTY;
    let mut best: Option<(f64, usize, [Bounds; 2])> = None;
    for first_right in 1..n {
        left = left.join(bins[first_right - 1]);
        if left.count == 0 {
            continue;
        }
        let cost = left.cost() + right_cost[first_right];
        if cost < best.map_or(f64::INFINITY, |b| b.0) {
            best = Some((cost, first_right, [left.bounds, right_side[first_right]]));
        }
    }
    best
}
