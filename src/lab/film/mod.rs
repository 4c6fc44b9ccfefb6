//! How a structure came to be, as a film: `replay` the cells that were divided or merged, from what the tree is at last; then,
//! where nodes were moved once the tree was built, `moves`, round by round and by gain, for which the tree is built once more.

mod moves;
mod replay;
#[cfg(test)]
mod tests;

use std::sync::Arc;

use super::format;
use crate::accel::cell::Layout;
use crate::accel::outline::{Outline, OutlineError};
use crate::accel::params::{ParamValues, Value};
use crate::accel::{Accel, BVH, BuildCx, BuildError, Moved};
use crate::task::{Cancelled, OverBudget};
use moves::Moves;
pub use replay::{Order, Replay};

/// Events one by one, at most; of more there is one for each level or round.
pub const MOST: usize = 4096;

/// What a film is of.
#[derive(Clone, Copy)]
pub struct Subject<'a> {
    /// The structure's name in the registry.
    pub id: &'a str,
    /// The structure.
    pub accel: &'a dyn Accel,
    /// How it was built.
    pub params: &'a ParamValues,
}

impl Subject<'_> {
    /// Whether the moves of its nodes can be seen: of the BVH alone, whose cells are the nodes that are moved, and not of two
    /// levels.
    pub fn has_moves(&self) -> bool {
        self.id == BVH && is_reinserted(self.params) && self.accel.levels().is_none()
    }
}

/// Whether nodes were moved once the tree was built.
pub fn is_reinserted(params: &ParamValues) -> bool {
    is(params, "reinsertion", "on")
}

fn is(params: &ParamValues, id: &str, choice: &'static str) -> bool {
    params.get(id) == Some(Value::Choice(choice))
}

/// Whether there is anything to show: not of a single cell, nor of a grid, whose cells are all there at once.
pub fn is_possible(accel: &dyn Accel) -> bool {
    !accel.root().is_leaf() && !matches!(accel.layout(), Layout::Flat { .. })
}

/// `1 cell`, `1 024 cells`.
fn counted(n: u64, what: &str) -> String {
    format!("{} {what}{}", format::count(n), if n == 1 { "" } else { "s" })
}

/// Why there is no film.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum FilmError {
    /// Stopped.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
    /// It does not fit.
    #[error("it would take more memory than there is: {0}. Raise the memory budget.")]
    Memory(#[from] OverBudget),
    /// The list of cells is not whole.
    #[error("the list of cells ends at the instances. Raise the memory budget.")]
    Cut,
    /// The upper level is divided, and what is below it merged.
    #[error("the level above is divided and the trees below it are merged, so no one order holds for both. Use another builder.")]
    TwoOrders,
    /// The tree could not be built once more.
    #[error("to see its nodes moved it is built once more, and {0}")]
    Build(BuildError),
    /// The list of the cells before nodes were moved does not fit.
    #[error(transparent)]
    Outline(OutlineError),
    /// Built once more it is another tree.
    #[error(
        "reinsertion came to another tree this time, since its time ran out at another round. Set its time limit to 0 for one that does not depend on the time."
    )]
    Another,
}

impl From<BuildError> for FilmError {
    fn from(e: BuildError) -> Self {
        match e {
            BuildError::Cancelled(cancelled) => cancelled.into(),
            BuildError::Memory { over, .. } => over.into(),
            e => Self::Build(e),
        }
    }
}

impl From<OutlineError> for FilmError {
    fn from(e: OutlineError) -> Self {
        match e {
            OutlineError::Cancelled(cancelled) => cancelled.into(),
            e @ OutlineError::Memory(_) => Self::Outline(e),
        }
    }
}

/// The film. A position in it is how many events have happened, from 0 to [`Self::last`].
pub struct Film {
    /// Cells divided or merged, of the tree before nodes were moved if they were.
    replay: Replay,
    /// What came then.
    moves: Option<Moves>,
    /// The SAH cost at each position.
    costs: Vec<f64>,
}

/// What is to be seen at a position.
#[derive(Clone, Copy)]
pub enum Seen<'a> {
    /// The whole cells that are in no other, after so many events; of a structure of its own, if it is there.
    Cells(&'a Replay, u32, Option<&'a dyn Accel>),
    /// Nodes that were moved, in a tree of which the root alone is shown.
    Moves(&'a [Moved], &'a Outline),
    /// The leaves of the finished structure.
    Finished(&'a Outline),
}

impl<'a> Seen<'a> {
    /// The cells that it is of.
    pub fn outline(&self) -> &'a Outline {
        match self {
            Self::Cells(replay, ..) => replay.outline(),
            Self::Moves(_, outline) | Self::Finished(outline) => outline,
        }
    }

    /// Whether a cell is whole, so that it is shown unless a cell around it is.
    pub fn is_whole(&self, row: u32) -> bool {
        match self {
            Self::Cells(replay, at, _) => replay.is_whole(row, *at),
            Self::Moves(..) => true,
            Self::Finished(outline) => outline.below(row).is_empty(),
        }
    }
}

impl Film {
    /// Makes the film of a structure from the list of its cells; where its nodes were moved it is built once more.
    ///
    /// # Errors
    /// The list ends at the instances, stopped, it does not fit, two orders would be mixed, or the tree is another one when it is
    /// built once more.
    pub fn of(subject: &Subject<'_>, outline: Arc<Outline>, cx: &BuildCx) -> Result<Self, FilmError> {
        let moves = if subject.has_moves() { Moves::of(subject, Arc::clone(&outline), cx)? } else { None };
        let Some((moves, before)) = moves else {
            let replay = Replay::of(subject.accel, outline, subject.params, (MOST, cx))?;
            let costs = replay.costs().to_vec();
            return Ok(Self { replay, moves: None, costs });
        };
        let left = MOST.saturating_sub(moves.last() as usize);
        let replay = Replay::of(moves.before(), before, subject.params, (left, cx))?;
        let costs = [replay.costs(), moves.costs()].concat();
        Ok(Self { replay, moves: Some(moves), costs })
    }

    /// The way the builder works.
    pub const fn order(&self) -> Order {
        self.replay.order()
    }

    /// Whether nodes are moved in it.
    pub const fn has_moves(&self) -> bool {
        self.moves.is_some()
    }

    /// What is to be said of the order at a position: of moves it is the one in which they were made.
    pub fn order_at(&self, at: u32) -> &'static str {
        match self.seen(at) {
            Seen::Moves(..) => "Moves by gain",
            Seen::Cells(..) | Seen::Finished(_) => "Reconstructed order",
        }
    }

    /// The last position.
    pub fn last(&self) -> u32 {
        self.replay.last() + self.moves.as_ref().map_or(0, Moves::last)
    }

    /// What is to be seen at a position.
    pub fn seen(&self, at: u32) -> Seen<'_> {
        match (&self.moves, at.checked_sub(self.replay.last() + 1)) {
            (Some(moves), Some(event)) => moves.seen(event),
            (moves, _) => Seen::Cells(&self.replay, at, moves.as_ref().map(Moves::before)),
        }
    }

    /// The SAH cost at a position, the last one beyond the end: that of the tree so far, as [`Replay`] says. While nodes are moved
    /// it is that of one triangle in a leaf; at the end it is the cost of the finished structure.
    pub fn cost(&self, at: u32) -> f64 {
        let cost = self.costs.get(at as usize).or(self.costs.last());
        cost.copied().unwrap_or(0.0)
    }

    /// The same at all positions.
    pub fn costs(&self) -> &[f64] {
        &self.costs
    }

    /// What happened last, in a sentence.
    pub fn tell(&self, at: u32) -> String {
        let at = at.min(self.last());
        let (what, of) = match (&self.moves, at.checked_sub(self.replay.last() + 1)) {
            (Some(moves), Some(event)) => (moves.tell(event), "of the tree"),
            _ => (self.replay.tell(at), if self.order() == Order::Splits { "of the tree" } else { "so far" }),
        };
        format!("{what}, SAH cost {of} {}.", format::number(self.cost(at)))
    }
}
