//! What the Structure workspace knows of the shown structure: its cells in the order of a walk, which of them are open, and
//! which is selected.

use std::sync::Arc;

use super::folding::Folding;
use super::kept::Key;
use super::workers::{Outlining, Selecting};
use crate::accel::outline::Outline;
use crate::geometry::Axis;

/// Everything of it.
#[derive(Default)]
pub struct Tree {
    /// The cells, once they are listed.
    pub outline: Option<Arc<Outline>>,
    /// Why they are not, in words for the user.
    pub failed: Option<String>,
    /// The structure that this is of.
    pub of: Option<Key>,
    /// The list, on its way.
    pub outlining: Option<(Key, Outlining)>,
    /// Which rows are to be seen.
    pub folding: Folding,
    /// The selected row.
    pub selected: Option<u32>,
    /// Grows whenever the selected row is to be brought into sight.
    pub moved: u64,
    /// A row whose cell is on its way.
    pub selecting: Option<Selecting>,
    /// That belongs to a bookmark or a file.
    pub restoring: bool,
    /// A plane that is tried in the selected node: across which axis, and where from 0 to 1.
    pub tried: Option<(Axis, f64)>,
    /// The outcome of the selected node was asked for, though outcomes are hidden.
    pub revealed: bool,
}

impl Tree {
    /// Takes in the cells of a structure.
    pub fn listed(&mut self, outline: Arc<Outline>) {
        self.folding = Folding::closed(&outline);
        self.folding.open(0, &outline);
        self.outline = Some(outline);
        self.failed = None;
    }

    /// Forgets the cells: another structure is shown.
    pub fn clear(&mut self) {
        *self = Self { moved: self.moved, ..Self::default() };
    }

    /// Another cell is selected, or none.
    pub fn select(&mut self, row: Option<u32>) {
        if row == self.selected {
            return;
        }
        self.selected = row;
        if let (Some(row), Some(outline)) = (row, &self.outline) {
            self.folding.reveal(row, outline);
            self.moved += 1;
        }
    }
}
