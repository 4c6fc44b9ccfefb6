//! A uniform grid and how a ray steps through it (Amanatides and Woo 1987), with each plane's t
//! worked out from the plane's number in 64 bits.

use std::marker::PhantomData;
use std::ops::ControlFlow;
use std::sync::Arc;

use super::lattice::Lattice;
use crate::accel::best::Best;
use crate::accel::cell::{Cell, CellId, CellKind, Cells, Layout, MemoryPart, Shape};
use crate::accel::probe::Probe;
use crate::accel::{PrimHit, Query, Structure};
use crate::geometry::tri::TriTest;
use crate::geometry::{Ray, num};
use crate::scene::{Geometry, PrimRef};
use crate::task::Charge;
use glam::DVec3;

/// What the builder makes.
#[derive(Debug)]
pub struct Built {
    /// What it was built over.
    pub geometry: Arc<Geometry>,
    /// Where the cells are.
    pub lattice: Lattice,
    /// Where each cell's references begin, and one past the last.
    pub starts: Vec<u32>,
    /// The cells' references, ascending in each.
    pub refs: Vec<PrimRef>,
    /// The memory of both.
    pub _charge: Charge,
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

    #[inline(always)]
    fn refs(&self, cell: usize) -> &[PrimRef] {
        &self.built.refs[self.built.starts[cell] as usize..self.built.starts[cell + 1] as usize]
    }
}

/// A ray on its way through the cells.
struct Walk<'a> {
    lattice: &'a Lattice,
    origin: DVec3,
    inv: DVec3,
    at: [usize; 3],
    /// The t at which each axis is next crossed; infinite for an axis it is parallel to.
    next: DVec3,
}

impl<'a> Walk<'a> {
    /// Starts where the ray's interval begins inside the grid; `None` if it misses it.
    #[inline(always)]
    fn enter(lattice: &'a Lattice, ray: &Ray) -> Option<Self> {
        let (origin, dir) = (ray.origin.as_dvec3(), ray.dir.as_dvec3());
        let inv = 1.0 / dir;
        // t of a hit carries the triangle test's error: start that much earlier.
        let mut entry = f64::from(ray.tmin) - 4.0 * lattice.slack;
        let mut exit = f64::from(ray.tmax) + 4.0 * lattice.slack;
        for k in 0..3 {
            let (low, high) = (lattice.plane(k, 0), lattice.plane(k, lattice.resolution[k]));
            if dir[k] == 0.0 {
                if origin[k] < low || origin[k] > high {
                    return None;
                }
            } else {
                let (a, b) = ((low - origin[k]) * inv[k], (high - origin[k]) * inv[k]);
                entry = entry.max(a.min(b));
                exit = exit.min(a.max(b));
            }
        }
        if entry > exit {
            return None;
        }
        let start = origin + dir * entry;
        let at = [0, 1, 2].map(|k| lattice.layer(k, start[k]));
        let mut walk = Self { lattice, origin, inv, at, next: DVec3::INFINITY };
        (0..3).filter(|k| dir[*k] != 0.0).for_each(|k| walk.next[k] = walk.crossing(k));
        Some(walk)
    }

    /// The t at which the ray leaves its layer on an axis.
    #[inline(always)]
    fn crossing(&self, k: usize) -> f64 {
        let plane = self.lattice.plane(k, self.at[k] + usize::from(self.inv[k] > 0.0));
        (plane - self.origin[k]) * self.inv[k]
    }

    /// The axis that is crossed next.
    #[inline(always)]
    fn axis(&self) -> usize {
        if self.next.x <= self.next.y && self.next.x <= self.next.z {
            0
        } else if self.next.y <= self.next.z {
            1
        } else {
            2
        }
    }

    /// Steps across an axis; false if that leaves the grid.
    #[inline(always)]
    fn step(&mut self, k: usize) -> bool {
        let last = if self.inv[k] > 0.0 { self.lattice.resolution[k] - 1 } else { 0 };
        if self.at[k] == last {
            return false;
        }
        if self.inv[k] > 0.0 {
            self.at[k] += 1;
        } else {
            self.at[k] -= 1;
        }
        self.next[k] = self.crossing(k);
        true
    }
}

impl<T: TriTest> Structure for Grid<T> {
    fn geometry(&self) -> &Arc<Geometry> {
        &self.built.geometry
    }

    /// A hit may lie outside the cell it was found in: it is kept, and the walk ends only when it
    /// lies before the next cell, less the slack along the axis that is crossed.
    #[inline]
    fn trace_one<Q: Query, P: Probe>(&self, ray: &Ray, query: &Q, probe: &mut P) -> Option<PrimHit> {
        let test = T::prepare(ray, self.built.geometry.bounds());
        let mut best = Best::new(ray.tmin, ray.tmax);
        let mut walk = Walk::enter(&self.built.lattice, ray)?;
        loop {
            probe.node();
            let refs = self.refs(self.built.lattice.index(walk.at));
            if !refs.is_empty() {
                probe.leaf();
                for prim in refs {
                    if best.test(&test, &self.built.geometry.corners(*prim), *prim, query, probe) {
                        return best.found();
                    }
                }
            }
            let axis = walk.axis();
            let earliest = walk.next[axis] - self.built.lattice.slack * walk.inv[axis].abs();
            if f64::from(best.t()) < earliest || !walk.step(axis) {
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
        if cell.depth > 0 {
            return;
        }
        for i in 0..self.built.lattice.count() {
            let shape = Shape::Box(self.built.lattice.bounds(self.built.lattice.at(i)));
            let kind = CellKind::Leaf { prims: num::index(self.refs(i).len()) };
            let id = CellId { instance: 0, node: num::index(i + 1) };
            if each(Cell { id, depth: 1, shape, split: None, kind }).is_break() {
                return;
            }
        }
    }

    fn prims(&self, cell: &Cell, each: &mut dyn FnMut(PrimRef)) {
        if let Some(i) = (cell.id.node as usize).checked_sub(1) {
            self.refs(i).iter().for_each(|prim| each(*prim));
        }
    }

    fn layout(&self) -> Layout {
        Layout::Flat { resolution: self.built.lattice.resolution.map(num::index), slack: num::narrow(self.built.lattice.slack) }
    }

    fn memory(&self) -> Vec<MemoryPart> {
        vec![
            MemoryPart { name: "cells", bytes: size_of_val(&self.built.starts[..]) as u64 },
            MemoryPart { name: "references", bytes: size_of_val(&self.built.refs[..]) as u64 },
        ]
    }
}
