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
    pub outlining: Option<Outlining>,
    /// Which rows are to be seen.
    pub folding: Folding,
    /// The same as they were at first.
    first: Folding,
    /// The selected row.
    pub selected: Option<u32>,
    /// Grows whenever the selected row is to be brought into sight.
    pub moved: u64,
    /// A row whose cell is on its way.
    pub selecting: Option<Selecting>,
    /// It is one of those that are walked over by keys.
    pub walking: bool,
    /// That belongs to a bookmark or a file, which await it.
    pub restoring: bool,
    /// A plane that is tried in the selected node: across which axis, and where from 0 to 1.
    pub tried: Option<(Axis, f64)>,
    /// The outcome of the selected node was asked for, though outcomes are hidden.
    pub revealed: bool,
}

/// The cells of a structure, and its rows with the root open: which takes a while where the root has millions of children.
#[derive(Clone)]
pub struct Listed {
    /// The cells.
    pub outline: Arc<Outline>,
    folding: Folding,
}

impl Listed {
    /// Of a list of cells. Not for the window's thread.
    pub fn of(outline: Arc<Outline>) -> Self {
        let mut folding = Folding::closed(&outline);
        folding.open(0, &outline);
        Self { outline, folding }
    }
}

impl Tree {
    /// Takes in the cells of a structure.
    pub fn listed(&mut self, listed: Listed) {
        (self.folding, self.first) = (listed.folding.clone(), listed.folding);
        self.outline = Some(listed.outline);
        self.failed = None;
    }

    /// Closes all but the root.
    pub fn close_all(&mut self) {
        self.folding.clone_from(&self.first);
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
