//! What was found in view, who goes first where there is too much, and what is drawn of it.

use std::cmp::Reverse;

use super::plane_in;
use crate::accel::Accel;
use crate::accel::cell::{Cell, Form, Shape, Split};
use crate::geometry::Aabb;
use crate::viewer::wires;
use glam::DVec3;

/// Edges of a box.
pub(super) const BOX_EDGES: usize = 12;

/// A cell or its plane that is in view, and how large it is there.
pub(super) struct Found {
    pub(super) px: f32,
    pub(super) cell: Cell,
    /// From the root that depths count from.
    pub(super) depth: u32,
    pub(super) plane: bool,
    /// What its colour stands for.
    pub(super) value: f32,
    /// Who goes first among those that are about as large.
    pub(super) rank: u32,
}

impl Found {
    pub(super) fn new(cell: &Cell, depth: u32, px: f32) -> Self {
        let rank = scatter(cell.id.node ^ scatter(cell.id.instance));
        Self { px, cell: *cell, depth, plane: false, value: cell.depth as f32, rank }
    }

    pub(super) fn is_of_box(&self) -> bool {
        matches!(self.cell.shape, Shape::Box(_))
    }

    pub(super) fn order(&self) -> (Reverse<u32>, u32, bool) {
        (Reverse(size_class(self.px)), self.rank, self.plane)
    }
}

/// Sizes that differ by less than a factor of two are about the same: by size alone the cells of a
/// grid would all be taken from the corner that is nearest, or that rounding favours.
pub(super) fn size_class(px: f32) -> u32 {
    // The binary exponent. Whole pixels are common sizes, so no limit of a class falls on one.
    (px * 1.3).to_bits() >> 23
}

/// Numbers cells anew without any pattern, so that the first so many of neighbours are spread evenly,
/// and do not look like a structure. They stay the same while the view turns. (The finaliser of
/// MurmurHash3, Appleby 2011: every bit of the number changes half of the bits.)
fn scatter(node: u32) -> u32 {
    let x = (node ^ node >> 16).wrapping_mul(0x85EB_CA6B);
    let x = (x ^ x >> 13).wrapping_mul(0xC2B2_AE35);
    x ^ x >> 16
}

/// What is drawn of a cell or its plane, in the space of its level.
pub(super) enum Drawn {
    Cell(Form),
    /// A flat box.
    Plane(Aabb),
    /// A plane within a cell of any form.
    Polygon(Vec<DVec3>),
}

impl Drawn {
    pub(super) fn of(found: &Found, accel: &dyn Accel) -> Option<Self> {
        let (cell, form) = (&found.cell, accel.form(&found.cell));
        if !found.plane {
            return Some(Self::Cell(form));
        }
        match (form, cell.split?) {
            (Form::Box(bounds), Split::Axis { axis, pos }) => Some(Self::Plane(plane_in(&bounds, axis, pos))),
            (form, split) => Some(Self::Polygon(form.section(&split))).filter(|drawn| drawn.edges(0) > 0),
        }
    }

    /// How many edges it has, with circles of so many sides.
    pub(super) fn edges(&self, sides: usize) -> usize {
        match self {
            Self::Cell(form) => wires::line_count(form, sides),
            Self::Plane(_) => BOX_EDGES,
            Self::Polygon(corners) => corners.len(),
        }
    }
}
