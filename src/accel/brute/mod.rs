//! No structure: every ray is tested against every triangle, `brute` always, `bound` only if the
//! ray meets the box around them all (the lecture's first step).

use std::marker::PhantomData;
use std::ops::ControlFlow;
use std::sync::Arc;

use super::best::Best;
use super::cell::{Cell, CellId, CellKind, Cells, Layout, MemoryPart, Shape};
use super::probe::{Off, Probe};
use super::{BuildCx, BuildError, Hit, PrimHit, Query, Structure, Traced, in_scaled_space};
use crate::geometry::Ray;
use crate::geometry::num;
use crate::geometry::tri::TriTest;
use crate::scene::{Geometry, PrimRef};
use crate::task::{Cancel, Cancelled};

/// A flat list of triangles, tested with `T`; behind one box if `BOUND`.
#[derive(Debug)]
pub struct Brute<T, const BOUND: bool> {
    geometry: Arc<Geometry>,
    test: PhantomData<T>,
}

/// Triangles tested between two looks at the cancel flag: about a millisecond.
const TESTS_PER_CHECK: usize = 1 << 16;

impl<T: TriTest, const BOUND: bool> Brute<T, BOUND> {
    /// There is nothing to build.
    pub fn build(geometry: &Arc<Geometry>, cx: &BuildCx) -> Result<Self, BuildError> {
        cx.cancel.check()?;
        Ok(Self { geometry: Arc::clone(geometry), test: PhantomData })
    }

    #[inline(always)]
    fn trace_checked<Q: Query, P: Probe>(
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
        probe.leaf();
        let count = self.geometry.live_count();
        for start in (0..count).step_by(TESTS_PER_CHECK) {
            check()?;
            for i in start..count.min(start + TESTS_PER_CHECK) {
                let prim = self.geometry.live(i);
                if best.test(&test, &self.geometry.corners(prim), prim, query, probe) {
                    return Ok(best.found());
                }
            }
        }
        Ok(best.found())
    }
}

impl<T: TriTest, const BOUND: bool> Structure for Brute<T, BOUND> {
    fn geometry(&self) -> &Arc<Geometry> {
        &self.geometry
    }

    fn trace_one<Q: Query, P: Probe>(&self, ray: &Ray, query: &Q, probe: &mut P) -> Option<PrimHit> {
        self.trace_checked(ray, query, probe, || Ok(())).unwrap_or(None)
    }

    fn trace_batch<Q: Query>(
        &self,
        rays: &[Ray],
        query: &Q,
        hits: &mut [Option<Hit>],
        cancel: &Cancel,
    ) -> Result<Traced, Cancelled> {
        let mut traced = Traced::default();
        for (ray, hit) in rays.iter().zip(hits) {
            let local = |ray: &Ray| self.trace_checked(ray, query, &mut Off, || cancel.check());
            *hit = in_scaled_space(&self.geometry, ray, &mut traced, local)?;
        }
        Ok(traced)
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
        Vec::new()
    }
}
