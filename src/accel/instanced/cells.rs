//! Both levels as cells.
//!
//! A cell of the upper level has instance 0; below entry e it is e + 1. There a cell's shape is in the mesh's own scaled
//! space, and [`Cells::level`] says where that is.

use std::ops::ControlFlow;

use super::{Below, Instanced};
use crate::accel::Accel;
use crate::accel::bvh::Node;
use crate::accel::cell::{Cell, CellId, CellKind, Cells, Form, Layout, Level, MemoryPart, Shape};
use crate::scene::PrimRef;

impl Instanced {
    fn top_cell(&self, at: u32, node: &Node, depth: u32) -> Cell {
        let id = CellId { instance: 0, node: at };
        Cell { id, depth, shape: Shape::Box(node.bounds()), split: None, kind: CellKind::Inner }
    }

    /// The root below an entry.
    fn root_below(&self, entry: u32, depth: u32) -> Option<Cell> {
        let accel = self.accel_below(entry + 1)?;
        let root = accel.root();
        Some(Cell { id: CellId { instance: entry + 1, ..root.id }, depth, ..root })
    }

    /// The structure whose cells have this instance.
    fn accel_below(&self, instance: u32) -> Option<&dyn Accel> {
        Some(self.below(instance.checked_sub(1)?)?.accel())
    }
}

impl Cells for Instanced {
    fn root(&self) -> Cell {
        if let Some(root) = self.top.nodes.first() {
            return self.top_cell(0, root, 0);
        }
        let shape = Shape::Box(*self.geometry.space().bounds());
        Cell { id: CellId { instance: 0, node: 0 }, depth: 0, shape, split: None, kind: CellKind::Inner }
    }

    fn children(&self, cell: &Cell, each: &mut dyn FnMut(Cell) -> ControlFlow<()>) {
        let CellId { instance, node } = cell.id;
        if let Some(accel) = self.accel_below(instance) {
            let depth = cell.depth + 1; // grids take their root to be at 0
            return accel.children(cell, &mut |child| each(Cell { id: CellId { instance, ..child.id }, depth, ..child }));
        }
        if let Some((top, left)) = self.top.nodes.get(node as usize).and_then(|top| Some((top, top.left()?))) {
            debug_assert!(top.count() == 0);
            for at in [left, left + 1] {
                if each(self.top_cell(at, &self.top.nodes[at as usize], cell.depth + 1)).is_break() {
                    return;
                }
            }
            return;
        }
        let range = self.top.nodes.get(node as usize).map_or(0..self.top.entries.len(), Node::range);
        for below in self.top.entries[range].iter().filter_map(|entry| self.root_below(*entry, cell.depth + 1)) {
            if each(below).is_break() {
                return;
            }
        }
    }

    fn prims(&self, cell: &Cell, each: &mut dyn FnMut(PrimRef)) {
        if let Some(accel) = self.accel_below(cell.id.instance) {
            accel.prims(cell, each);
        }
    }

    fn form(&self, cell: &Cell) -> Form {
        match self.accel_below(cell.id.instance) {
            Some(accel) => accel.form(cell),
            None => Form::Box(*cell.shape.bounds()),
        }
    }

    /// The lower structures may be cells that divide space; what holds for both levels is that they nest.
    fn layout(&self) -> Layout {
        let whole = self.parts.iter().chain(&self.rest).all(|accel| accel.layout() == Layout::Hierarchy);
        if whole { Layout::Hierarchy } else { Layout::SplitHierarchy }
    }

    fn layout_of(&self, instance: u32) -> Layout {
        // The upper level is a BVH.
        self.accel_below(instance).map_or(Layout::Hierarchy, |accel| accel.layout())
    }

    fn level(&self, instance: u32) -> Option<Level> {
        match self.below(instance.checked_sub(1)?)? {
            Below::Part(place, _) => Some(Level { instance: Some(place.instance), scene_from_level: place.scene_from_part() }),
            Below::Rest(_) => Some(Level { instance: None, scene_from_level: glam::DAffine3::IDENTITY }),
        }
    }

    /// Each mesh decided for itself: what the largest did stands for the others.
    fn remarks(&self) -> Vec<String> {
        let mut remarks = vec![format!("Two levels: {} meshes in {} places.", self.parts.len(), self.places().len())];
        let largest = self.parts.iter().chain(&self.rest).max_by_key(|accel| accel.geometry().live_count());
        remarks.extend(largest.map(|accel| accel.remarks()).unwrap_or_default());
        remarks
    }

    fn memory(&self) -> Vec<MemoryPart> {
        let top = size_of_val(&self.top.nodes[..]) + size_of_val(&self.top.entries[..]);
        let mut parts = vec![MemoryPart { name: "top level", bytes: top as u64 }];
        for part in self.parts.iter().chain(&self.rest).flat_map(|accel| accel.memory()) {
            match parts.iter_mut().find(|known| known.name == part.name) {
                Some(known) => known.bytes += part.bytes,
                None => parts.push(part),
            }
        }
        parts
    }
}
