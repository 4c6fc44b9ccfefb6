//! Cells divided from the root down, breadth first, or, where the builder works from the leaves up, clusters merged by round:
//! replayed from what the tree is at last. The order is reconstructed: the structure does not keep in which order its builder
//! really went, and threads share the work.

use std::collections::BTreeMap;
use std::sync::Arc;

use super::{FilmError, counted, is};
use crate::accel::outline::Outline;
use crate::accel::params::ParamValues;
use crate::accel::stats::SahWeights;
use crate::accel::{Accel, BuildCx};
use crate::geometry::num;
use crate::lab::format;
use crate::task::{Cancel, Cancelled, Charge, Progress};

/// Cells that one divides into of which each is told.
const TOLD: u32 = 8;
/// Rows between two looks at whether to stop.
const PER_CHECK: u32 = 1 << 14;
/// Bytes of an event: two numbers, and the cost after it.
const BYTES: u64 = 8 + 8;

/// The way a builder works.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Order {
    /// From the root down: cells are divided, breadth first.
    Splits,
    /// From the leaves up: clusters merge, by round. A cell's round is one more than the later one of those it is made of: the
    /// first in which it can have been made.
    Merges,
}

impl Order {
    /// How a structure with these parameters was built.
    pub fn of(params: &ParamValues) -> Self {
        if is(params, "builder", "ploc") { Self::Merges } else { Self::Splits }
    }
}

/// What happens, in order.
#[derive(Debug)]
pub(super) enum Events {
    /// One cell after another: its row, and how many cells it is divided into or merged from.
    Rows(Vec<(u32, u32)>),
    /// All cells of a level or round at once: which, and how many there are.
    Levels(Vec<(u32, u32)>),
}

/// The film of it. A position is how many events have happened, from 0 to [`Self::last`].
pub struct Replay {
    outline: Arc<Outline>,
    order: Order,
    pub(super) events: Events,
    /// The SAH cost at each position.
    costs: Vec<f64>,
    /// The round of each row, where cells are merged.
    rounds: Vec<u8>,
    /// What the levels of cells below instances count from, so that they come after the upper ones.
    shift: u32,
    /// Triangles of the model.
    pub(super) triangles: u64,
    /// What cells hold, called one: references where a triangle may be in several.
    held: &'static str,
    charge: Charge,
}

impl Replay {
    /// Makes it from the list of a structure's cells. Events are told one by one if there are so many at most, and otherwise
    /// there is one for each level.
    ///
    /// # Errors
    /// The list ends at the instances, stopped, it does not fit, or two orders would be mixed.
    pub(super) fn of(
        accel: &dyn Accel,
        outline: Arc<Outline>,
        params: &ParamValues,
        (most, cx): (usize, &BuildCx),
    ) -> Result<Self, FilmError> {
        if outline.is_cut() {
            return Err(FilmError::Cut);
        }
        let (order, two_levels) = (Order::of(params), accel.levels().is_some());
        if order == Order::Merges && two_levels {
            return Err(FilmError::TwoOrders);
        }
        let BuildCx { cancel, progress, budget, .. } = cx;
        progress.start("film", outline.len().into());
        let mut charge = budget.charge(0)?;
        let rounds = if order == Order::Merges { rounds(&outline, &mut charge, cancel)? } else { Vec::new() };
        let shift = if two_levels { levels_above(&outline, cancel)? } else { 0 };
        let events = Events::Rows(Vec::new());
        let triangles = accel.geometry().counts().live;
        let one_level = (!two_levels).then_some(triangles);
        let costs = Costs { accel, outline: &Arc::clone(&outline), c_isect: SahWeights::of(params).c_isect, order, one_level };
        let once = !outline.is_empty() && u64::from(outline.row(0).references) == triangles;
        let held = if accel.layout().nests() && once { "triangle" } else { "reference" };
        let mut replay = Self { outline, order, events, costs: Vec::new(), rounds, shift, triangles, held, charge };
        replay.fill(&costs, most, cancel, progress)?;
        replay.charge.grow(BYTES * replay.costs.len() as u64)?;
        Ok(replay)
    }

    /// Looks at all cells once, and puts them in order, or counts them by level if they are too many.
    fn fill(&mut self, costs: &Costs<'_>, most: usize, cancel: &Cancel, progress: &Progress) -> Result<(), FilmError> {
        let (mut rows, mut levels) = (Vec::new(), BTreeMap::<u32, (u32, f64)>::new());
        let mut cost = costs.at_first();
        for row in 0..self.outline.len() {
            if row.is_multiple_of(PER_CHECK) {
                cancel.check()?;
                progress.advance(PER_CHECK.into());
            }
            if self.outline.below(row).is_empty() {
                cost += costs.of_leaf_at_first(row);
                continue;
            }
            let level = levels.entry(self.level(row)).or_default();
            *level = (level.0 + 1, level.1 + costs.event(row, cancel)?.0);
            if rows.len() <= most {
                rows.push(row);
            }
        }
        self.costs.push(cost);
        let mut after = |change: f64| {
            cost += change;
            cost
        };
        if rows.len() <= most {
            rows.sort_unstable_by_key(|row| self.key(*row));
            let mut events = Vec::with_capacity(rows.len());
            for row in rows {
                let (change, parts) = costs.event(row, cancel)?;
                self.costs.push(after(change));
                events.push((row, parts));
            }
            self.events = Events::Rows(events);
        } else {
            self.costs.extend(levels.values().map(|level| after(level.1)));
            self.events = Events::Levels(levels.into_iter().map(|(level, (cells, _))| (level, cells)).collect());
        }
        Ok(())
    }

    /// The cells that it is of.
    pub fn outline(&self) -> &Outline {
        &self.outline
    }

    /// The way the builder works.
    pub const fn order(&self) -> Order {
        self.order
    }

    /// The last position.
    pub fn last(&self) -> u32 {
        let events = match &self.events {
            Events::Rows(rows) => rows.len(),
            Events::Levels(levels) => levels.len(),
        };
        num::index(events)
    }

    /// The SAH cost at each position. From the root down it is that of the tree so far, with cells that
    /// are yet to be divided as leaves that hold all references below them, and the undivided root each triangle once; from the leaves up it is what leaves and merged
    /// cells come to so far. At the end both are the cost of the finished structure.
    pub(super) fn costs(&self) -> &[f64] {
        &self.costs
    }

    /// The row of the cell that was just divided or merged; none at the start, nor where events are whole levels.
    pub fn just(&self, at: u32) -> Option<u32> {
        match &self.events {
            Events::Rows(rows) => Some(rows.get(at.checked_sub(1)? as usize)?.0),
            Events::Levels(_) => None,
        }
    }

    /// Whether a cell is whole at a position: not yet divided, or merged already, or a leaf. What is to be seen are the whole
    /// cells that are in no other whole one.
    pub fn is_whole(&self, row: u32, at: u32) -> bool {
        self.outline.below(row).is_empty() || self.has_happened(row, at) == (self.order == Order::Merges)
    }

    /// Whether a cell was divided or merged by then.
    fn has_happened(&self, row: u32, at: u32) -> bool {
        let Some(last) = at.checked_sub(1) else { return false };
        let last = last as usize;
        match &self.events {
            Events::Rows(rows) => rows.get(last).is_none_or(|event| self.key(row) <= self.key(event.0)),
            Events::Levels(levels) => levels.get(last).is_none_or(|(level, _)| self.level(row) <= *level),
        }
    }

    /// Which goes first.
    fn key(&self, row: u32) -> (u32, u32) {
        (self.level(row), row)
    }

    pub(super) fn level(&self, row: u32) -> u32 {
        match self.order {
            Order::Merges => self.rounds[row as usize].into(),
            Order::Splits => {
                let lower = self.shift > 0 && self.outline.id(row).instance > 0;
                self.outline.row(row).depth + if lower { self.shift } else { 0 }
            }
        }
    }

    /// What happened last, without an end.
    pub(super) fn tell(&self, at: u32) -> String {
        let (number, last) = (format::count(at.into()), format::count(self.last().into()));
        match (at.checked_sub(1), &self.events) {
            (None, _) => self.tell_start(),
            (Some(i), Events::Rows(rows)) => self.tell_cell(rows[i as usize], &number, &last),
            (Some(i), Events::Levels(levels)) => {
                let cells = levels[i as usize].1.into();
                match self.order {
                    Order::Splits => format!("Level {number} of {last}: {} divided", counted(cells, "cell")),
                    Order::Merges => format!("Round {number} of {last}: {}", counted(cells, "merge")),
                }
            }
        }
    }

    fn tell_start(&self) -> String {
        let all = counted(self.triangles, "triangle");
        match self.order {
            Order::Splits => format!("Before the first split: {all} in one cell"),
            Order::Merges => format!("Before the first merge: {all} in leaves"),
        }
    }

    fn tell_cell(&self, (row, parts): (u32, u32), number: &str, last: &str) -> String {
        // The root is the model: what cells hold more of them comes of dividing it.
        let whole = match self.order {
            Order::Splits if row == 0 => counted(self.triangles, "triangle"),
            _ => counted(self.outline.row(row).references.into(), self.held),
        };
        let parts = if parts > TOLD {
            format!("{} cells", format::count(parts.into()))
        } else {
            let held = |part: u32| format::count(self.outline.row(part).references.into());
            let listed = listed(&self.outline.children(row).map(held).collect::<Vec<_>>());
            let unlike = row == 0 && self.order == Order::Splits && self.held != "triangle";
            if unlike { format!("{listed} {}s", self.held) } else { listed }
        };
        match self.order {
            Order::Splits => format!("Split {number} of {last}: {whole} into {parts}"),
            Order::Merges => {
                let round = self.level(row);
                format!("Merge {number} of {last}, in round {round}: {parts} into {whole}")
            }
        }
    }
}

/// `1, 2 and 3`.
pub(super) fn listed(parts: &[String]) -> String {
    match parts.split_last() {
        Some((last, rest)) if !rest.is_empty() => format!("{} and {last}", rest.join(", ")),
        _ => parts.concat(),
    }
}

/// The round of each row: 0 of leaves, and one more than the latest of those it is made of.
pub(super) fn rounds(outline: &Outline, charge: &mut Charge, cancel: &Cancel) -> Result<Vec<u8>, FilmError> {
    charge.grow(outline.len().into())?;
    cancel.check()?;
    let mut rounds = vec![0u8; outline.len() as usize];
    // Children come after their parent.
    for row in (1..outline.len()).rev() {
        if row.is_multiple_of(PER_CHECK) {
            cancel.check()?;
        }
        if let Some(parent) = outline.parent(row) {
            let next = rounds[row as usize].saturating_add(1);
            let parent = &mut rounds[parent as usize];
            *parent = (*parent).max(next);
        }
    }
    Ok(rounds)
}

/// One more than the greatest depth of the upper level.
pub(super) fn levels_above(outline: &Outline, cancel: &Cancel) -> Result<u32, FilmError> {
    let mut deepest = 0;
    for row in 0..outline.len() {
        if row.is_multiple_of(PER_CHECK) {
            cancel.check()?;
        }
        if outline.id(row).instance == 0 {
            deepest = deepest.max(outline.row(row).depth);
        }
    }
    Ok(deepest + 1)
}

/// What cells cost before and after their event.
struct Costs<'a> {
    accel: &'a dyn Accel,
    outline: &'a Outline,
    c_isect: f64,
    order: Order,
    /// Triangles of the model, where there is one level: until it is divided the root holds each once.
    one_level: Option<u64>,
}

impl Costs<'_> {
    /// What a cell adds to the cost by itself.
    fn own(&self, row: u32) -> f64 {
        self.outline.row(row).own_share * self.outline.sah()
    }

    /// The same while it is not divided. Where rays step from cell to cell, they step into it all the same.
    fn undivided(&self, row: u32) -> f64 {
        if self.outline.below(row).is_empty() {
            return self.own(row);
        }
        let cell = self.outline.row(row);
        let references = self.one_level.filter(|_| row == 0).map_or(f64::from(cell.references), |triangles| triangles as f64);
        let tests = self.c_isect * cell.chance * references;
        let steps = self.accel.layout_of(cell.id.instance).slack().is_some();
        tests + if steps { self.own(row) } else { 0.0 }
    }

    /// The cost at the start, but for the leaves that are there.
    fn at_first(&self) -> f64 {
        match self.order {
            Order::Splits if self.outline.is_empty() => 0.0,
            Order::Splits => self.undivided(0),
            Order::Merges => 0.0,
        }
    }

    /// What a leaf adds to that.
    fn of_leaf_at_first(&self, row: u32) -> f64 {
        match self.order {
            Order::Splits => 0.0,
            Order::Merges => self.own(row),
        }
    }

    /// What a cell's event adds, and how many cells it is divided into or merged from.
    fn event(&self, row: u32, cancel: &Cancel) -> Result<(f64, u32), Cancelled> {
        let (mut sum, mut parts) = (0.0, 0u32);
        for part in self.outline.children(row) {
            // A grid's cell has millions.
            if parts.is_multiple_of(PER_CHECK) {
                cancel.check()?;
            }
            parts += 1;
            if self.order == Order::Splits {
                sum += self.undivided(part);
            }
        }
        let before = if self.order == Order::Splits { self.undivided(row) } else { 0.0 };
        Ok((self.own(row) + sum - before, parts))
    }
}
