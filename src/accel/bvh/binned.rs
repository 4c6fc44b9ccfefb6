//! Binned SAH (Wald 2007, "On fast Construction of SAH-based Bounding Volume Hierarchies", §3):
//! the centres are sorted into equal buckets on each axis, and only the planes between buckets are
//! tried.

use rayon::prelude::*;

use super::topdown::{Heuristic, PrimBox, SplitRule};
use crate::accel::{BuildCx, BuildError};
use crate::geometry::{Aabb, Axis, num};

/// The most buckets on an axis.
pub const MAX_BINS: u32 = 64;

/// The surface area heuristic over buckets.
#[derive(Clone, Copy, Debug)]
pub struct Binned {
    /// Buckets on each axis, 2 to [`MAX_BINS`].
    pub bins: u32,
    /// Cost of stepping into a node.
    pub c_trav: f64,
    /// Cost of testing a triangle.
    pub c_isect: f64,
}

/// The buckets below a number go left.
#[derive(Clone, Copy, Debug)]
pub struct BinRule {
    scale: Scale,
    first_right: usize,
}

impl SplitRule for BinRule {
    #[inline(always)]
    fn goes_left(&self, prim: &PrimBox) -> bool {
        self.scale.bin(prim) < self.first_right
    }
}

/// From a centre to its bucket on one axis.
#[derive(Clone, Copy, Debug)]
struct Scale {
    axis: Axis,
    /// Least centre, doubled.
    origin: f32,
    /// Buckets per doubled unit; 0 if all centres are equal.
    per_unit: f32,
    last: usize,
}

impl Scale {
    fn new(axis: Axis, centres: &Aabb, bins: u32) -> Self {
        let (origin, width) = (centres.min[axis.index()], centres.size()[axis.index()]);
        // A hair less than `bins`, so that the greatest centre falls into the last bucket; a
        // width too small for its reciprocal counts as none.
        let per_unit = bins as f32 * (1.0 - 4.0 * f32::EPSILON) / width;
        Self { axis, origin, per_unit: if per_unit.is_finite() { per_unit } else { 0.0 }, last: bins as usize - 1 }
    }

    #[inline(always)]
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "`as` saturates, and the bucket is clamped")]
    fn bin(&self, prim: &PrimBox) -> usize {
        let k = self.axis.index();
        let centre = prim.bounds.min[k] + prim.bounds.max[k];
        (((centre - self.origin) * self.per_unit) as usize).min(self.last)
    }
}

#[derive(Clone, Copy)]
struct Bin {
    bounds: Aabb,
    count: u32,
}

const EMPTY: Bin = Bin { bounds: Aabb::EMPTY, count: 0 };

impl Bin {
    fn join(self, other: Self) -> Self {
        Self { bounds: self.bounds.union(other.bounds), count: self.count + other.count }
    }

    fn cost(&self) -> f64 {
        self.bounds.area() * f64::from(self.count)
    }
}

/// The buckets of all three axes.
type Bins<const N: usize> = [[Bin; N]; 3];

/// Most nodes hold few triangles, which fill few buckets: clearing [`MAX_BINS`] for each would cost
/// more than filling them.
const FEW_BINS: usize = 8;

/// Triangles from which on a node is binned in parallel, and in what portions.
const PARALLEL: usize = 1 << 15;
const CHUNK: usize = 1 << 13;

impl Heuristic for Binned {
    type Split = BinRule;

    fn choose(&self, prims: &[PrimBox], bounds: &Aabb, may_be_leaf: bool, cx: &BuildCx) -> Result<Option<BinRule>, BuildError> {
        let bins = self.bins.min(num::index(prims.len()).saturating_mul(2)).max(2);
        if bins as usize <= FEW_BINS {
            self.choose_among::<FEW_BINS>(bins, prims, bounds, may_be_leaf, cx)
        } else {
            self.choose_among::<{ MAX_BINS as usize }>(bins, prims, bounds, may_be_leaf, cx)
        }
    }
}

impl Binned {
    fn choose_among<const N: usize>(
        &self,
        bins: u32,
        prims: &[PrimBox],
        bounds: &Aabb,
        may_be_leaf: bool,
        cx: &BuildCx,
    ) -> Result<Option<BinRule>, BuildError> {
        let centres = centres(prims, cx)?;
        let scales = Axis::ALL.map(|axis| Scale::new(axis, &centres, bins));
        let counted = count::<N>(prims, &scales, cx)?;
        let best =
            scales.iter().zip(&counted).filter_map(|(scale, bins)| cheapest(bins, scale)).min_by(|a, b| a.0.total_cmp(&b.0));
        let Some((children, rule)) = best else { return Ok(None) };
        let area = bounds.area();
        let split = self.c_trav * area + self.c_isect * children;
        let leaf = self.c_isect * area * prims.len() as f64;
        Ok((!may_be_leaf || split < leaf).then_some(rule))
    }
}

/// The box around all centres, doubled.
fn centres(prims: &[PrimBox], cx: &BuildCx) -> Result<Aabb, BuildError> {
    let chunk = |prims: &[PrimBox]| Aabb::of_points(prims.iter().map(|p| p.bounds.centre_twice()));
    if prims.len() < PARALLEL {
        return Ok(chunk(prims));
    }
    let checked = |prims: &[PrimBox]| cx.cancel.check().map(|()| chunk(prims));
    Ok(prims.par_chunks(CHUNK).map(checked).try_reduce(|| Aabb::EMPTY, |a, b| Ok(a.union(b)))?)
}

/// Sorts the triangles into the buckets of all axes in one pass.
fn count<const N: usize>(prims: &[PrimBox], scales: &[Scale; 3], cx: &BuildCx) -> Result<Bins<N>, BuildError> {
    let chunk = |prims: &[PrimBox]| {
        let mut bins: Bins<N> = [[EMPTY; N]; 3];
        for prim in prims {
            for (scale, bins) in scales.iter().zip(&mut bins) {
                let bin = &mut bins[scale.bin(prim)];
                bin.bounds = bin.bounds.union(prim.bounds);
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

/// The plane with the least `area * count` summed over both sides, and that sum; `None` if all
/// triangles fall into one bucket. One sweep from the right, one from the left.
fn cheapest<const N: usize>(bins: &[Bin; N], scale: &Scale) -> Option<(f64, BinRule)> {
    let mut right_cost = [0.0; N];
    let mut right = EMPTY;
    for i in (1..=scale.last).rev() {
        right = right.join(bins[i]);
        right_cost[i] = if right.count == 0 { f64::INFINITY } else { right.cost() };
    }
    let mut left = EMPTY;
    let mut best: Option<(f64, usize)> = None;
    for first_right in 1..=scale.last {
        left = left.join(bins[first_right - 1]);
        let cost = left.cost() + right_cost[first_right];
        if left.count > 0 && cost < best.map_or(f64::INFINITY, |b| b.0) {
            best = Some((cost, first_right));
        }
    }
    best.map(|(cost, first_right)| (cost, BinRule { scale: *scale, first_right }))
}
