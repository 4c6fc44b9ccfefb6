//! A uniform grid: equal cells, and a ray that steps from one to the next.

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

/// What the builder makes.
#[derive(Debug)]
pub struct Built {
    /// What it was built over.
    pub geometry: Arc<Geometry>,
    /// Where the cells are.
    pub lattice: Lattice,
    /// The references of each.
    pub contents: Contents,
    /// What the builder decided, in words.
    pub remarks: Vec<String>,
}

/// A uniform grid traced with the triangle test `T`.
#[derive(Debug)]
pub struct Grid<T> {
    built: Built,
    test: PhantomData<T>,
}

impl<T: TriTest> Grid<T> {
    /// Takes what the builder made.
    pub const fn new(built: Built) -> Self {
        Self { built, test: PhantomData }
    }
}

impl<T: TriTest> Structure for Grid<T> {
    fn geometry(&self) -> &Arc<Geometry> {
        &self.built.geometry
    }

    #[inline]
    fn trace_one<Q: Query, P: Probe>(&self, ray: &Ray, query: &Q, probe: &mut P) -> Option<PrimHit> {
        let Built { geometry, lattice, contents, .. } = &self.built;
        let test = T::prepare(ray, geometry.bounds());
        let mut best = Best::new(ray.tmin, ray.tmax);
        let line = Line::new(ray, lattice.slack);
        let mut walk = Walk::enter(lattice, &line)?;
        loop {
            let cell = lattice.index(walk.at);
            probe.node();
            probe.at(num::index(cell + 1));
            let over = contents.test(cell, geometry, &test, &mut best, (query, probe));
            if over || walk.step(best.t()) != Step::In {
                return best.found();
            }
        }
    }
}

impl<T: TriTest> Cells for Grid<T> {
    fn root(&self) -> Cell {
        let shape = Shape::Box(*self.built.geometry.bounds());
        Cell { id: CellId { instance: 0, node: 0 }, depth: 0, shape, split: None, kind: CellKind::Inner }
    }

    /// The root's children are all cells, numbered from 1.
    fn children(&self, cell: &Cell, each: &mut dyn FnMut(Cell) -> ControlFlow<()>) {
        if cell.id.node > 0 {
            return;
        }
        for i in 0..self.built.lattice.count() {
            let shape = Shape::Box(self.built.lattice.bounds(self.built.lattice.at(i)));
            let kind = CellKind::Leaf { prims: num::index(self.built.contents.of(i).len()) };
            let id = CellId { instance: 0, node: num::index(i + 1) };
            if each(Cell { id, depth: 1, shape, split: None, kind }).is_break() {
                return;
            }
        }
    }

    fn prims(&self, cell: &Cell, each: &mut dyn FnMut(PrimRef)) {
        if let Some(i) = (cell.id.node as usize).checked_sub(1) {
            self.built.contents.of(i).iter().for_each(|prim| each(*prim));
        }
    }

    fn layout(&self) -> Layout {
        Layout::Flat { resolution: self.built.lattice.resolution.map(num::index), slack: num::narrow(self.built.lattice.slack) }
    }

    fn remarks(&self) -> Vec<String> {
        self.built.remarks.clone()
    }

    fn memory(&self) -> Vec<MemoryPart> {
        self.built.contents.memory().to_vec()
    }
}
