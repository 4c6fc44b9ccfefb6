//! A two-level grid (Kalojanov, Billeter and Slusallek 2011, "Two-Level Grids for Ray Tracing on
//! GPUs"): the cells of a coarse grid are cut into grids of their own, each as fine as what is in it
//! asks for. So a small detailed thing in a large scene does not fall into one cell.
//!
//! ```text
//! tops     ┌ cell 0, whole ┐┌ cell 1, 2 x 1 x 1 ┐┌ cell 2 …
//! cells      0                1        2           3 …        of all cuts, one list
//! ```

use std::marker::PhantomData;
use std::ops::ControlFlow;
use std::sync::Arc;

use super::contents::Contents;
use super::lattice::Lattice;
use super::walk::{Line, Step, Walk};
use crate::accel::best::Best;
use crate::accel::cell::{Cell, CellId, CellKind, Cells, Layout, MemoryPart, Shape};
use crate::accel::probe::Probe;
use crate::accel::{PrimHit, Query, Structure};
use crate::geometry::tri::TriTest;
use crate::geometry::{Ray, num};
use crate::scene::{Geometry, PrimRef};
use crate::task::Charge;

/// How a cell of the coarse grid is cut. Eight bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Top {
    /// Its first cell in the list of all.
    pub first: u32,
    /// Cells along each axis, at least 1.
    pub resolution: [u8; 3],
}

impl Top {
    /// Not cut: it is a leaf itself.
    #[inline(always)]
    pub fn is_whole(&self) -> bool {
        self.resolution == [1; 3]
    }

    /// How many cells it is cut into.
    pub fn cells(&self) -> u32 {
        self.resolution.into_iter().map(u32::from).product()
    }
}

/// Where the cells of both levels are.
#[derive(Debug)]
pub struct Cuts {
    /// The coarse grid.
    pub lattice: Lattice,
    /// Its cells.
    pub tops: Vec<Top>,
}

impl Cuts {
    /// The grid in a cell of the coarse one.
    #[inline(always)]
    pub fn within(&self, at: [usize; 3], top: Top) -> Lattice {
        self.lattice.within(at, top.resolution)
    }
}

/// What the builder makes.
#[derive(Debug)]
pub struct Built {
    /// What it was built over.
    pub geometry: Arc<Geometry>,
    /// Where the cells are.
    pub cuts: Cuts,
    /// The references of each.
    pub contents: Contents,
    /// What the builder decided, in words.
    pub remarks: Vec<String>,
    /// The memory of the coarse cells.
    pub _charge: Charge,
}

/// A two-level grid traced with the triangle test `T`.
#[derive(Debug)]
pub struct TwoLevel<T> {
    built: Built,
    test: PhantomData<T>,
}

impl<T: TriTest> TwoLevel<T> {
    /// Takes what the builder made.
    pub const fn new(built: Built) -> Self {
        Self { built, test: PhantomData }
    }

    /// Takes a ray through one cell of the coarse grid. True if the search is over.
    #[inline(always)]
    fn visit<Q: Query, P: Probe>(
        &self,
        at: [usize; 3],
        line: &Line,
        test: &T,
        best: &mut Best,
        (query, probe): (&Q, &mut P),
    ) -> bool {
        let Built { geometry, cuts, contents, .. } = &self.built;
        let i = cuts.lattice.index(at);
        let top = cuts.tops[i];
        let first = top.first as usize;
        probe.node();
        probe.at(num::index(1 + i));
        if top.is_whole() {
            return contents.test(first, geometry, test, best, (query, probe));
        }
        let within = cuts.within(at, top);
        let Some(mut walk) = Walk::enter(&within, line) else { return false };
        loop {
            let cell = first + within.index(walk.at);
            probe.node();
            probe.at(num::index(self.first_cut() + cell));
            if contents.test(cell, geometry, test, best, (query, probe)) {
                return true;
            }
            match walk.step(best.t()) {
                Step::In => {}
                Step::Out => return false,
                Step::Done => return true,
            }
        }
    }

    /// Cells of the coarse grid are numbered from 1, those of the cuts from here on.
    fn first_cut(&self) -> usize {
        1 + self.built.cuts.tops.len()
    }

    fn top_cell(&self, i: usize) -> Cell {
        let Built { cuts, contents, .. } = &self.built;
        let top = cuts.tops[i];
        let prims = num::index(contents.of(top.first as usize).len());
        let kind = if top.is_whole() { CellKind::Leaf { prims } } else { CellKind::Inner };
        let shape = Shape::Box(cuts.lattice.bounds(cuts.lattice.at(i)));
        Cell { id: CellId { instance: 0, node: num::index(1 + i) }, depth: 1, shape, split: None, kind }
    }

    fn cut_cell(&self, first: u32, within: &Lattice, i: usize) -> Cell {
        let cell = first as usize + i;
        let kind = CellKind::Leaf { prims: num::index(self.built.contents.of(cell).len()) };
        let id = CellId { instance: 0, node: num::index(self.first_cut() + cell) };
        Cell { id, depth: 2, shape: Shape::Box(within.bounds(within.at(i))), split: None, kind }
    }
}

impl<T: TriTest> Structure for TwoLevel<T> {
    fn geometry(&self) -> &Arc<Geometry> {
        &self.built.geometry
    }

    #[inline]
    fn trace_one<Q: Query, P: Probe>(&self, ray: &Ray, query: &Q, probe: &mut P) -> Option<PrimHit> {
        let lattice = &self.built.cuts.lattice;
        let test = T::prepare(ray, self.built.geometry.bounds());
        let mut best = Best::new(ray.tmin, ray.tmax);
        let line = Line::new(ray, lattice.slack);
        let mut walk = Walk::enter(lattice, &line)?;
        loop {
            let over = self.visit(walk.at, &line, &test, &mut best, (query, probe));
            if over || walk.step(best.t()) != Step::In {
                return best.found();
            }
        }
    }
}

impl<T: TriTest> Cells for TwoLevel<T> {
    fn root(&self) -> Cell {
        let shape = Shape::Box(*self.built.geometry.bounds());
        Cell { id: CellId { instance: 0, node: 0 }, depth: 0, shape, split: None, kind: CellKind::Inner }
    }

    fn children(&self, cell: &Cell, each: &mut dyn FnMut(Cell) -> ControlFlow<()>) {
        let Built { cuts, .. } = &self.built;
        let Some(i) = (cell.id.node as usize).checked_sub(1) else {
            let _ = (0..cuts.tops.len()).try_for_each(|i| each(self.top_cell(i)));
            return;
        };
        if let Some(top) = cuts.tops.get(i).filter(|top| !top.is_whole()) {
            let within = cuts.within(cuts.lattice.at(i), *top);
            let _ = (0..within.count()).try_for_each(|k| each(self.cut_cell(top.first, &within, k)));
        }
    }

    fn prims(&self, cell: &Cell, each: &mut dyn FnMut(PrimRef)) {
        let node = cell.id.node as usize;
        let cell = match node.checked_sub(1).map(|i| self.built.cuts.tops.get(i)) {
            None => return,
            Some(Some(top)) if top.is_whole() => top.first as usize,
            Some(Some(_)) => return,
            Some(None) => node - self.first_cut(),
        };
        self.built.contents.of(cell).iter().for_each(|prim| each(*prim));
    }

    fn layout(&self) -> Layout {
        Layout::Nested { slack: num::narrow(self.built.cuts.lattice.slack) }
    }

    fn remarks(&self) -> Vec<String> {
        self.built.remarks.clone()
    }

    fn memory(&self) -> Vec<MemoryPart> {
        let coarse = MemoryPart { name: "coarse cells", bytes: size_of_val(&self.built.cuts.tops[..]) as u64 };
        [coarse].into_iter().chain(self.built.contents.memory()).collect()
    }
}

const _: () = assert!(size_of::<Top>() == 8);
