//! How a structure came to be, as a film that is replayed from what it is at last: cells divided from the root down, breadth
//! first, or, where the builder works from the leaves up, clusters merged by round. The order is reconstructed: the structure
//! does not keep in which order its builder really went, and threads share the work.

use std::collections::BTreeMap;
use std::sync::Arc;

use super::format;
use crate::accel::Accel;
use crate::accel::cell::Layout;
use crate::accel::outline::Outline;
use crate::accel::params::{ParamValues, Value};
use crate::accel::stats::SahWeights;
use crate::geometry::num;
use crate::task::{Budget, Cancel, Cancelled, Charge, OverBudget, Progress};

/// Events one by one, at most; of more there is one for each level.
pub const MOST: usize = 4096;
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

/// Whether nodes were moved once the tree was built. Which ones, and when, the finished tree does not say.
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
}

/// What happens, in order.
#[derive(Debug)]
enum Events {
    /// One cell after another: its row, and how many cells it is divided into or merged from.
    Rows(Vec<(u32, u32)>),
    /// All cells of a level or round at once: which, and how many there are.
    Levels(Vec<(u32, u32)>),
}

/// The film. A position in it is how many events have happened, from 0 to [`Self::last`].
pub struct Film {
    outline: Arc<Outline>,
    order: Order,
    events: Events,
    /// The SAH cost at each position.
    costs: Vec<f64>,
    /// The round of each row, where cells are merged.
    rounds: Vec<u8>,
    /// What the levels of cells below instances count from, so that they come after the upper ones.
    shift: u32,
    /// Triangles of the model.
    triangles: u64,
    /// What cells hold, called one: references where a triangle may be in several.
    held: &'static str,
    charge: Charge,
}

impl Film {
    /// Makes the film of a structure from the list of its cells.
    ///
    /// # Errors
    /// The list ends at the instances, stopped, it does not fit, or two orders would be mixed.
    pub fn of(
        accel: &dyn Accel,
        outline: Arc<Outline>,
        params: &ParamValues,
        (budget, cancel, progress): (&Budget, &Cancel, &Progress),
    ) -> Result<Self, FilmError> {
        if outline.is_cut() {
            return Err(FilmError::Cut);
        }
        let (order, two_levels) = (Order::of(params), accel.levels().is_some());
        if order == Order::Merges && two_levels {
            return Err(FilmError::TwoOrders);
        }
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
        let mut film = Self { outline, order, events, costs: Vec::new(), rounds, shift, triangles, held, charge };
        film.fill(&costs, cancel, progress)?;
        film.charge.grow(BYTES * film.costs.len() as u64)?;
        Ok(film)
    }

    /// Looks at all cells once, and puts them in order, or counts them by level if they are too many.
    fn fill(&mut self, costs: &Costs<'_>, cancel: &Cancel, progress: &Progress) -> Result<(), FilmError> {
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
            if rows.len() <= MOST {
                rows.push(row);
            }
        }
        self.costs.push(cost);
        let mut after = |change: f64| {
            cost += change;
            cost
        };
        if rows.len() <= MOST {
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

    /// The SAH cost at a position, the last one beyond the end. From the root down it is that of the tree so far, with cells that
    /// are yet to be divided as leaves that hold all references below them, and the undivided root each triangle once; from the leaves up it is what leaves and merged
    /// cells come to so far. At the end both are the cost of the finished structure.
    pub fn cost(&self, at: u32) -> f64 {
        let cost = self.costs.get(at as usize).or(self.costs.last());
        cost.copied().unwrap_or(0.0)
    }

    /// The same at all positions.
    pub fn costs(&self) -> &[f64] {
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

    fn level(&self, row: u32) -> u32 {
        match self.order {
            Order::Merges => self.rounds[row as usize].into(),
            Order::Splits => {
                let lower = self.shift > 0 && self.outline.id(row).instance > 0;
                self.outline.row(row).depth + if lower { self.shift } else { 0 }
            }
        }
    }

    /// What happened last, in a sentence.
    pub fn tell(&self, at: u32) -> String {
        let at = at.min(self.last());
        let (number, last) = (format::count(at.into()), format::count(self.last().into()));
        let what = match (at.checked_sub(1), &self.events) {
            (None, _) => self.tell_start(),
            (Some(i), Events::Rows(rows)) => self.tell_cell(rows[i as usize], &number, &last),
            (Some(i), Events::Levels(levels)) => {
                let cells = levels[i as usize].1.into();
                match self.order {
                    Order::Splits => format!("Level {number} of {last}: {} divided", counted(cells, "cell")),
                    Order::Merges => format!("Round {number} of {last}: {}", counted(cells, "merge")),
                }
            }
        };
        let of = match self.order {
            Order::Splits => "of the tree",
            Order::Merges => "so far",
        };
        format!("{what}, SAH cost {of} {}.", format::number(self.cost(at)))
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

/// `1 cell`, `1 024 cells`.
fn counted(n: u64, what: &str) -> String {
    format!("{} {what}{}", format::count(n), if n == 1 { "" } else { "s" })
}

/// `1, 2 and 3`.
fn listed(parts: &[String]) -> String {
    match parts.split_last() {
        Some((last, rest)) if !rest.is_empty() => format!("{} and {last}", rest.join(", ")),
        _ => parts.concat(),
    }
}

/// The round of each row: 0 of leaves, and one more than the latest of those it is made of.
fn rounds(outline: &Outline, charge: &mut Charge, cancel: &Cancel) -> Result<Vec<u8>, FilmError> {
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
fn levels_above(outline: &Outline, cancel: &Cancel) -> Result<u32, FilmError> {
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accel::{BuildCx, registry};
    use crate::geometry::tri::TestKind;
    use crate::scene::{Geometry, LoadCx, open};

    fn try_film(model: &str, id: &str, set: &[(&str, &str)], bytes: u64) -> Result<Film, FilmError> {
        let (cx, load) = (BuildCx::unattended(1), LoadCx::unattended());
        let geometry = Arc::new(Geometry::with_instances(&open(model, &load).expect("built in"), &load).expect("fits"));
        let entry = registry::find(id).expect("registered");
        let mut params = entry.defaults();
        set.iter().for_each(|(id, value)| params.set(id, value).expect("in range"));
        let accel = entry.build(&geometry, TestKind::Watertight, &params, &cx).expect("builds");
        let on = (&cx.budget, &cx.cancel, &cx.progress);
        let outline = Outline::of(accel.as_ref(), SahWeights::of(&params), on).expect("small");
        Film::of(accel.as_ref(), Arc::new(outline), &params, (&Budget::new(bytes), &cx.cancel, &cx.progress))
    }

    fn film(model: &str, id: &str, set: &[(&str, &str)]) -> Film {
        try_film(model, id, set, 1 << 30).expect("made")
    }

    const SMALL: &str = "builtin:soup?triangles=200";
    const KINDS: [(&str, &[(&str, &str)]); 7] = [
        ("bvh", &[]),
        ("bvh", &[("builder", "ploc")]),
        ("wide", &[]),
        ("wide", &[("builder", "ploc")]),
        ("kdtree", &[]),
        ("octree", &[]),
        ("grid2", &[]),
    ];

    /// The whole cells that are in no other, and how many rows without others below are in them.
    fn seen(film: &Film, at: u32) -> (Vec<u32>, u32) {
        let outline = film.outline();
        let (mut whole, mut open, mut leaves) = (Vec::new(), vec![0], 0);
        while let Some(row) = open.pop() {
            if film.is_whole(row, at) {
                whole.push(row);
                leaves += (row..outline.behind(row)).filter(|row| outline.below(*row).is_empty()).count() as u32;
            } else {
                open.extend(outline.children(row));
            }
        }
        (whole, leaves)
    }

    #[test]
    fn cells_are_divided_after_those_around_them_and_merged_before() {
        for (id, set) in KINDS {
            let film = film(SMALL, id, set);
            let Events::Rows(rows) = &film.events else { panic!("{id}: few") };
            let inner = (0..film.outline().len()).filter(|row| !film.outline().below(*row).is_empty());
            assert_eq!(rows.len(), inner.count(), "{id}: each once");
            for (i, (row, _)) in rows.iter().enumerate() {
                let parent = film.outline().parent(*row).map(|parent| rows.iter().position(|other| other.0 == parent));
                let before = parent.flatten().is_none_or(|parent| parent < i);
                let first = i == if film.order() == Order::Splits { 0 } else { rows.len() - 1 };
                assert_eq!(parent.is_none(), first, "{id}: {i}");
                assert!(parent.is_none() || before == (film.order() == Order::Splits), "{id}: {i}");
            }
            let levels: Vec<u32> = rows.iter().map(|row| film.level(row.0)).collect();
            assert!(levels.is_sorted(), "{id}: by level or round");
        }
    }

    #[test]
    fn what_is_seen_holds_every_leaf_once_at_every_position() {
        for (id, set) in KINDS {
            let film = film(SMALL, id, set);
            let (outline, merges) = (film.outline(), film.order() == Order::Merges);
            let all = seen(&film, 0).1;
            let mut expected = if merges { all } else { 1 };
            for at in 0..=film.last() {
                if let Some(row) = film.just(at) {
                    let more = outline.children(row).count() as u32 - 1;
                    expected = if merges { expected - more } else { expected + more };
                }
                let (whole, leaves) = seen(&film, at);
                assert_eq!((whole.len() as u32, leaves), (expected, all), "{id}: {at} of {}", film.last());
            }
            assert_eq!(expected, if merges { 1 } else { all }, "{id}");
        }
    }

    #[test]
    fn the_cost_ends_at_that_of_the_finished_structure() {
        for entry in registry::ALL {
            let film = film(SMALL, entry.id, &[]);
            let (end, sah) = (film.cost(film.last()), film.outline().sah());
            assert!((end / sah - 1.0).abs() < 1e-5, "{}: {end} and {sah}", entry.id);
            assert_eq!(film.cost(u32::MAX), end);
        }
        for film in [film(SMALL, "bvh", &[("builder", "ploc")]), film("builtin:sphere-flake", "bvh", &[])] {
            assert!((film.cost(film.last()) / film.outline().sah() - 1.0).abs() < 1e-5);
        }
        let film = film(SMALL, "bvh", &[("c_isect", "2")]);
        let one_leaf = 2.0 * f64::from(film.outline().row(0).references);
        assert!((film.cost(0) / one_leaf - 1.0).abs() < 1e-6, "{}", film.cost(0));
        // However often the cells of a partition hold a triangle.
        let film = self::film(SMALL, "kdtree", &[("c_isect", "2")]);
        assert!((film.cost(0) / (2.0 * film.triangles as f64) - 1.0).abs() < 1e-6, "{}", film.cost(0));
    }

    #[test]
    fn of_too_many_cells_each_level_is_an_event() {
        for (set, order) in [(&[][..], Order::Splits), (&[("builder", "ploc")], Order::Merges)] {
            let film = film("builtin:soup?triangles=20000", "bvh", set);
            let Events::Levels(levels) = &film.events else { panic!("many") };
            let inner = (0..film.outline().len()).filter(|row| !film.outline().below(*row).is_empty()).count();
            assert_eq!((film.order(), levels.iter().map(|level| level.1 as usize).sum::<usize>()), (order, inner));
            assert!(inner > MOST && film.last() < 100 && film.just(3).is_none());
            assert!((film.cost(film.last()) / film.outline().sah() - 1.0).abs() < 1e-5);
            let all = seen(&film, 0).1;
            assert!((0..=film.last()).all(|at| seen(&film, at).1 == all));
            let at_last = seen(&film, film.last()).0.len() as u32;
            assert_eq!(at_last, if order == Order::Splits { all } else { 1 });
        }
    }

    #[test]
    fn the_upper_level_is_divided_first() {
        let film = film("builtin:sphere-flake?triangles=100000", "bvh", &[]);
        let level = |row: u32| (film.outline().id(row).instance > 0, film.level(row));
        let inner = (0..film.outline().len()).filter(|row| !film.outline().below(*row).is_empty());
        let mut levels: Vec<(bool, u32)> = inner.map(level).collect();
        levels.sort_unstable();
        assert!(levels.iter().any(|level| level.0) && levels.is_sorted_by_key(|level| level.1));
        let refused = try_film("builtin:sphere-flake?triangles=100000", "bvh", &[("builder", "ploc")], 1 << 30);
        assert!(matches!(refused, Err(FilmError::TwoOrders)));
    }

    #[test]
    fn events_are_told_in_sentences() {
        let split = film(SMALL, "bvh", &[]);
        let all = split.outline().row(0).references;
        assert!(
            split.tell(0).starts_with(&format!("Before the first split: {all} triangles in one cell, SAH cost of the tree "))
        );
        let parts: Vec<u32> = split.outline().children(0).map(|part| split.outline().row(part).references).collect();
        let (last, cost) = (split.last(), format::number(split.cost(1)));
        let told = format!("Split 1 of {last}: {all} triangles into {} and {}, SAH cost of the tree {cost}.", parts[0], parts[1]);
        assert_eq!(split.tell(1), told);
        let kd = film(SMALL, "kdtree", &[]);
        let parts: Vec<u32> = kd.outline().children(0).map(|part| kd.outline().row(part).references).collect();
        assert!(kd.outline().row(0).references > all, "some triangles are in several leaves");
        assert!(kd.tell(0).starts_with(&format!("Before the first split: {all} triangles in one cell, ")), "{}", kd.tell(0));
        let told = format!(": {all} triangles into {} and {} references, SAH cost of the tree ", parts[0], parts[1]);
        assert!(kd.tell(1).contains(&told), "{}", kd.tell(1));
        let second = counted(kd.outline().row(kd.just(2).expect("a cell")).references.into(), "reference");
        assert!(kd.tell(2).contains(&format!(": {second} into ")), "{}", kd.tell(2));
        let merge = film(SMALL, "bvh", &[("builder", "ploc")]);
        assert!(
            merge.tell(1).contains(", in round 1: ")
                && merge.tell(u32::MAX).contains(&format!(" into {all} triangles, SAH cost so far "))
        );
        assert_eq!(listed(&["1".to_owned(), "2".to_owned(), "3".to_owned()]), "1, 2 and 3");
        assert_eq!((counted(1, "cell"), counted(2, "merge")), ("1 cell".to_owned(), "2 merges".to_owned()));
    }

    #[test]
    fn it_stops_when_asked() {
        let (film, cx) = (film(SMALL, "bvh", &[]), BuildCx::unattended(1));
        cx.cancel.cancel();
        assert_eq!(levels_above(film.outline(), &cx.cancel), Err(Cancelled.into()));
        let mut charge = cx.budget.charge(0).expect("nothing");
        assert_eq!(rounds(film.outline(), &mut charge, &cx.cancel), Err(Cancelled.into()));
    }

    #[test]
    fn there_is_none_of_a_list_that_ends_at_the_instances() {
        let (cx, load) = (BuildCx::unattended(1), LoadCx::unattended());
        let scene = open("builtin:sphere-flake?triangles=100000", &load).expect("built in");
        let geometry = Arc::new(Geometry::with_instances(&scene, &load).expect("fits"));
        let entry = registry::find("bvh").expect("registered");
        let params = entry.defaults();
        let accel = entry.build(&geometry, TestKind::Watertight, &params, &cx).expect("builds");
        // The first rows are charged less than that, and those after them more.
        let budget = Budget::new(1 << 20);
        let outline = Outline::of(accel.as_ref(), SahWeights::of(&params), (&budget, &cx.cancel, &cx.progress));
        let cut = outline.expect("the upper level fits");
        assert!(cut.is_cut());
        let made = Film::of(accel.as_ref(), Arc::new(cut), &params, (&cx.budget, &cx.cancel, &cx.progress));
        assert!(matches!(made, Err(FilmError::Cut)));
    }

    #[test]
    fn what_does_not_fit_is_refused_and_grids_have_none() {
        assert!(matches!(try_film(SMALL, "bvh", &[], 100), Err(FilmError::Memory(_))));
        assert!(matches!(try_film(SMALL, "bvh", &[("builder", "ploc")], 100), Err(FilmError::Memory(_))));
        let (cx, load) = (BuildCx::unattended(1), LoadCx::unattended());
        let geometry = Arc::new(Geometry::new(&open(SMALL, &load).expect("built in"), &load).expect("fits"));
        for entry in registry::ALL {
            let accel = entry.build(&geometry, TestKind::Watertight, &entry.defaults(), &cx).expect("builds");
            assert_eq!(is_possible(accel.as_ref()), !["brute", "bound", "grid"].contains(&entry.id), "{}", entry.id);
        }
    }
}
