//! No structure: every ray is tested against every triangle, `brute` always, `bound` only if the
//! ray meets the box around them all (the lecture's first step).

use std::marker::PhantomData;
use std::ops::ControlFlow;
use std::sync::Arc;

use super::best::Best;
use super::cell::{Cell, CellId, CellKind, Cells, Layout, MemoryPart, Shape};
use super::probe::Probe;
use super::{BuildCx, BuildError, Fits, PrimHit, Query, Structure};
use crate::geometry::Ray;
use crate::geometry::num;
use crate::geometry::tri::{self, Block, Eight, TriTest};
use crate::scene::{Geometry, PrimRef};
use crate::simd::{LANES, Portable};
use crate::task::{Cancel, Cancelled, Charge};
use rayon::prelude::*;

/// A flat list of triangles, tested with `T` eight at a time; behind one box if `BOUND`.
#[derive(Debug)]
pub struct Brute<T, const BOUND: bool> {
    geometry: Arc<Geometry>,
    blocks: Vec<Block>,
    _charge: Charge,
    test: PhantomData<T>,
}

/// Blocks tested between two looks at the cancel flag: well under a millisecond.
const BLOCKS_PER_CHECK: usize = 1 << 13;
/// Blocks packed between two words of how far it is.
const CHUNK: usize = 1 << 11;

impl<T: TriTest, const BOUND: bool> Brute<T, BOUND> {
    /// Packs the triangles side by side; there is nothing else to build.
    pub fn build(geometry: &Arc<Geometry>, cx: &BuildCx) -> Result<Self, BuildError> {
        cx.cancel.check()?;
        let n = geometry.live_count();
        let count = n.div_ceil(LANES);
        let structure = if BOUND { "bound" } else { "brute" };
        let too_large =
            |over| BuildError::Memory { structure, over, remedy: "Raise the memory budget, or use grid.", fits: Fits::default() };
        let charge = cx.budget.charge((count * size_of::<Block>()) as u64).map_err(too_large)?;
        cx.progress.start("pack", n as u64);
        let corners = |b: usize| (b * LANES..n.min((b + 1) * LANES)).map(|i| geometry.corners(geometry.live(i)));
        let pack = |b: usize| {
            if b.is_multiple_of(CHUNK) {
                cx.progress.advance((CHUNK * LANES) as u64);
            }
            // Whoever has stopped it gets no structure.
            if cx.cancel.is_cancelled() { Block::new([]) } else { Block::new(corners(b)) }
        };
        let mut blocks = Vec::new();
        cx.pool.run(|| (0..count).into_par_iter().map(pack).collect_into_vec(&mut blocks));
        cx.cancel.check()?;
        Ok(Self { geometry: Arc::clone(geometry), blocks, _charge: charge, test: PhantomData })
    }

    #[inline(always)]
    fn trace_with_checks<Q: Query, P: Probe>(
        &self,
        ray: &Ray,
        query: &Q,
        probe: &mut P,
        mut check: impl FnMut() -> Result<(), Cancelled>,
    ) -> Result<Option<PrimHit>, Cancelled> {
        let test = T::prepare(ray, self.geometry.bounds());
        let mut best = Best::new(ray.tmin, ray.tmax);
        if BOUND {
            let (entry, exit) = test.slabs().interval(self.geometry.bounds());
            if entry > exit || entry > ray.tmax || exit < ray.tmin {
                return Ok(None);
            }
        }
        probe.node();
        probe.at(0);
        probe.leaf();
        for (c, blocks) in self.blocks.chunks(BLOCKS_PER_CHECK).enumerate() {
            check()?;
            for (b, block) in blocks.iter().enumerate() {
                let first = (c * BLOCKS_PER_CHECK + b) * LANES;
                if self.trace_block(&test, block, first, query, probe, &mut best) {
                    return Ok(best.found());
                }
            }
        }
        Ok(best.found())
    }

    /// A first look at all, then the whole test of those that may be met. True if the search is over.
    #[inline(always)]
    fn trace_block<Q: Query, P: Probe>(
        &self,
        test: &T,
        block: &Block,
        first: usize,
        query: &Q,
        probe: &mut P,
        best: &mut Best,
    ) -> bool {
        let lanes = LANES.min(self.geometry.live_count() - first);
        let mut left = test.may_meet(Portable, &tri::corners(Portable, block, test.axes())) & ((1 << lanes) - 1);
        // The others were tested, too, and missed.
        (left.count_ones()..num::index(lanes)).for_each(|_| probe.prim());
        while left != 0 {
            let lane = left.trailing_zeros() as usize;
            left &= left - 1;
            let prim = self.geometry.live(first + lane);
            if best.test_in_doubt(test, &block.triangle(lane), prim, query, probe) {
                return true;
            }
        }
        false
    }
}

impl<T: TriTest, const BOUND: bool> Structure for Brute<T, BOUND> {
    fn geometry(&self) -> &Arc<Geometry> {
        &self.geometry
    }

    fn trace_one<Q: Query, P: Probe>(&self, ray: &Ray, query: &Q, probe: &mut P) -> Option<PrimHit> {
        self.trace_with_checks(ray, query, probe, || Ok(())).unwrap_or(None)
    }

    fn trace_stoppable<Q: Query, P: Probe>(
        &self,
        ray: &Ray,
        query: &Q,
        probe: &mut P,
        cancel: &Cancel,
    ) -> Result<Option<PrimHit>, Cancelled> {
        self.trace_with_checks(ray, query, probe, || cancel.check())
    }
}

impl<T: TriTest, const BOUND: bool> Cells for Brute<T, BOUND> {
    fn root(&self) -> Cell {
        Cell {
            id: CellId { instance: 0, node: 0 },
            depth: 0,
            shape: Shape::Box(*self.geometry.bounds()),
            split: None,
            kind: CellKind::Leaf { prims: num::index(self.geometry.live_count()) },
        }
    }

    fn children(&self, _: &Cell, _: &mut dyn FnMut(Cell) -> ControlFlow<()>) {}

    fn prims(&self, _: &Cell, each: &mut dyn FnMut(PrimRef)) {
        (0..self.geometry.live_count()).for_each(|i| each(self.geometry.live(i)));
    }

    fn layout(&self) -> Layout {
        Layout::Hierarchy
    }

    fn memory(&self) -> Vec<MemoryPart> {
        vec![MemoryPart { name: "packed triangles", bytes: size_of_val(&self.blocks[..]) as u64 }]
    }
}
