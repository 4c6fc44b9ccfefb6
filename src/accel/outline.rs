//! Every cell of a structure in a few bytes, in the order of a walk: what a tree of ten million nodes is scrolled and
//! searched by. Cells themselves are made on demand; see [`super::Cells`].

use std::ops::{ControlFlow, Range};

use super::Accel;
use super::cell::{Cell, CellId, CellKind, Descend, Shape, bounds_in_scene, walk};
use super::stats::SahWeights;
use crate::geometry::{Aabb, num};
use crate::task::{Budget, Cancel, Cancelled, Charge, OverBudget, Progress};

/// A row of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Row {
    /// Which cell it is.
    pub id: CellId,
    /// Steps from the root.
    pub depth: u32,
    /// References in it and below.
    pub references: u32,
    /// Cells below it.
    pub below: u32,
    /// The chance that a random line through the root meets it: its area over the root's.
    pub chance: f64,
    /// The part of the structure's SAH cost that it and what is below it make up, from 0 to 1.
    pub share: f64,
    /// The part that it makes up by itself.
    pub own_share: f64,
    /// The chance that a line that meets it meets the overlap of two of its children:
    /// `sum over pairs of children of A(a and b) / A(n)`; `None` for leaves, and where cells divide space.
    pub overlap: Option<f64>,
    /// It is an instance, and what is below it is left out; see [`Outline::is_cut`].
    pub cut: bool,
}

impl Row {
    /// Whether it holds no cells.
    pub const fn is_leaf(&self) -> bool {
        self.below == 0 && !self.cut
    }
}

/// All rows, parents before children.
pub struct Outline {
    nodes: Vec<u32>,
    /// Nothing where there is one level.
    instances: Vec<u32>,
    parents: Vec<u32>,
    behind: Vec<u32>,
    depths: Vec<u8>,
    references: Vec<u32>,
    chances: Vec<f32>,
    shares: Vec<f32>,
    /// What each adds to the SAH cost by itself.
    own: Vec<f32>,
    /// NaN where there is none.
    overlaps: Vec<f32>,
    /// The cells below instances are left out, since they are too many.
    cut: bool,
    sah: f64,
    greatest: [(Rank, Option<u32>); Rank::ALL.len()],
    charge: Charge,
}

/// Why there is no outline.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum OutlineError {
    /// Stopped.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
    /// It does not fit.
    #[error("the list of its cells would take more memory than there is: {0}. Raise the memory budget.")]
    Memory(OverBudget),
}

/// Bytes of a row, the instance not counted.
const BYTES: u64 = 7 * 4 + 1 + 4;
/// The most children of a node whose overlaps are worked out.
const MOST_PAIRED: usize = 64;
/// Rows between two looks at whether to stop, and two charges.
const PER_CHECK: usize = 1 << 14;

impl Outline {
    /// Walks the structure once. Where cells below instances do not fit, it ends at the instances.
    ///
    /// # Errors
    /// Stopped, or even that does not fit.
    pub fn of(
        accel: &dyn Accel,
        weights: SahWeights,
        (budget, cancel, progress): (&Budget, &Cancel, &Progress),
    ) -> Result<Self, OutlineError> {
        match Walker::new(accel, weights, budget, false)?.walk(cancel, progress) {
            Err(OutlineError::Memory(_)) if accel.levels().is_some() => {
                Walker::new(accel, weights, budget, true)?.walk(cancel, progress)
            }
            other => other,
        }
    }

    /// Cells.
    pub fn len(&self) -> u32 {
        num::index(self.nodes.len())
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.nodes.is_empty()
    }

    /// Whether cells below instances are left out.
    pub const fn is_cut(&self) -> bool {
        self.cut
    }

    /// Whether what is below a row is left out.
    fn is_cut_at(&self, i: usize) -> bool {
        self.cut && self.instances[i] > 0
    }

    fn is_leaf_at(&self, i: usize) -> bool {
        self.behind[i] == num::index(i + 1) && !self.is_cut_at(i)
    }

    /// The structure's SAH cost, as [`super::stats::Stats::sah`] for one level. Of two, instances are met as often as the box
    /// around their mesh's box, and what is left out costs nothing.
    pub const fn sah(&self) -> f64 {
        self.sah
    }

    /// A row by its number.
    ///
    /// # Panics
    /// If there is none of that number.
    pub fn row(&self, at: u32) -> Row {
        let i = at as usize;
        Row {
            id: self.id(at),
            depth: self.depths[i].into(),
            references: self.references[i],
            below: self.behind[i] - at - 1,
            chance: f64::from(self.chances[i]),
            share: f64::from(self.shares[i]),
            own_share: f64::from(self.own[i]) * over(self.sah),
            overlap: Some(f64::from(self.overlaps[i])).filter(|overlap| !overlap.is_nan()),
            cut: self.is_cut_at(i),
        }
    }

    /// Which cell a row is.
    pub fn id(&self, at: u32) -> CellId {
        CellId { instance: self.instances.get(at as usize).copied().unwrap_or(0), node: self.nodes[at as usize] }
    }

    /// The cell around one.
    pub fn parent(&self, at: u32) -> Option<u32> {
        self.parents.get(at as usize).copied().filter(|_| at > 0)
    }

    /// The row behind all that are below one.
    pub fn behind(&self, at: u32) -> u32 {
        self.behind[at as usize]
    }

    /// The rows below one.
    pub fn below(&self, at: u32) -> Range<u32> {
        at + 1..self.behind(at)
    }

    /// The children of a cell, in their order.
    pub fn children(&self, at: u32) -> impl Iterator<Item = u32> + '_ {
        let end = self.behind(at);
        let mut next = at + 1;
        std::iter::from_fn(move || {
            let child = next;
            (child < end).then(|| {
                next = self.behind(child);
                child
            })
        })
    }

    /// The rows from the root to one, both included.
    pub fn path(&self, at: u32) -> Vec<u32> {
        let mut path: Vec<u32> = std::iter::successors(Some(at), |at| self.parent(*at)).collect();
        path.reverse();
        path
    }

    /// The next sibling, the first again after the last.
    pub fn sibling(&self, at: u32) -> Option<u32> {
        let (parent, next) = (self.parent(at)?, self.behind(at));
        Some(if next < self.behind(parent) { next } else { parent + 1 })
    }

    /// The row of a cell, by those above it from the root on.
    pub fn find(&self, path: &[CellId]) -> Option<u32> {
        let is = |at: u32, id: &CellId| {
            self.nodes.get(at as usize) == Some(&id.node) && self.instances.get(at as usize).is_none_or(|i| *i == id.instance)
        };
        let mut at = 0;
        if !is(at, path.first()?) {
            return None;
        }
        for id in &path[1..] {
            // Children of a grid have consecutive numbers, and there are millions of them.
            let first = at + 1;
            let guess = first.saturating_add(id.node.wrapping_sub(*self.nodes.get(first as usize)?));
            let guessed = self.below(at).contains(&guess) && self.parent(guess) == Some(at) && is(guess, id);
            at = if guessed { guess } else { self.children(at).find(|child| is(*child, id))? };
        }
        Some(at)
    }

    /// Makes the cells from the root to one.
    ///
    /// # Errors
    /// [`Cancelled`] if asked to stop.
    pub fn cells(&self, accel: &dyn Accel, at: u32, cancel: &Cancel) -> Result<Vec<Cell>, Cancelled> {
        let ids: Vec<CellId> = self.path(at).into_iter().map(|at| self.id(at)).collect();
        cells_along(accel, &ids, cancel)
    }

    /// Walks the cells below and including one, which has this row, with their rows: none of those that are left out.
    pub fn walk_below(
        &self,
        accel: &dyn Accel,
        top: &Cell,
        row: u32,
        visit: &mut dyn FnMut(&Cell, u32) -> ControlFlow<(), Descend>,
    ) -> ControlFlow<()> {
        match visit(top, row) {
            ControlFlow::Break(()) => ControlFlow::Break(()),
            ControlFlow::Continue(Descend::No) => ControlFlow::Continue(()),
            ControlFlow::Continue(Descend::Yes) => {
                let (mut next, end) = (row + 1, self.behind(row));
                let mut onwards = ControlFlow::Continue(());
                accel.children(top, &mut |child| {
                    if onwards.is_continue() && next < end {
                        onwards = self.walk_below(accel, &child, next, visit);
                        next = self.behind(next);
                    }
                    onwards
                });
                onwards
            }
        }
    }

    /// The row of which something is greatest, the first of several; nothing where it is not known of any.
    pub fn greatest(&self, of: Rank) -> Option<u32> {
        self.greatest.iter().find(|(rank, _)| *rank == of)?.1
    }

    /// Gives back what vectors hold beyond their ends.
    fn fit(&mut self) {
        let numbers = [&mut self.nodes, &mut self.instances, &mut self.parents, &mut self.behind, &mut self.references];
        numbers.into_iter().for_each(Vec::shrink_to_fit);
        self.depths.shrink_to_fit();
        [&mut self.chances, &mut self.shares, &mut self.own, &mut self.overlaps].into_iter().for_each(Vec::shrink_to_fit);
    }

    /// The least chance that a line meets a cell and nothing that is in it: neither a child nor a reference.
    fn wasted(&self, i: usize, cancel: &Cancel) -> Result<f32, Cancelled> {
        if self.is_cut_at(i) || (self.is_leaf_at(i) && self.references[i] > 0) {
            return Ok(0.0);
        }
        let mut met = 0.0;
        for (k, child) in self.children(num::index(i)).enumerate() {
            // A grid's cell has millions.
            if k.is_multiple_of(PER_CHECK) {
                cancel.check()?;
            }
            met += f64::from(self.chances[child as usize]);
        }
        Ok((f64::from(self.chances[i]) - met) as f32)
    }

    fn find_greatest(&self, of: Rank, cancel: &Cancel) -> Result<Option<u32>, Cancelled> {
        let leaf = |i: usize| self.is_leaf_at(i);
        let inner = |i: usize| !leaf(i);
        let value = |i: usize| -> Result<Option<f32>, Cancelled> {
            Ok(match of {
                Rank::Depth => leaf(i).then(|| f32::from(self.depths[i])),
                Rank::References => leaf(i).then_some(self.references[i] as f32),
                Rank::Cost => (i > 0).then_some(self.own[i]),
                Rank::Overlap => inner(i).then_some(self.overlaps[i] * self.chances[i]).filter(|x| !x.is_nan()),
                Rank::Empty => Some(self.wasted(i, cancel)?).filter(|wasted| *wasted > 0.0),
            })
        };
        let mut best: Option<(usize, f32)> = None;
        for i in 0..self.nodes.len() {
            if i.is_multiple_of(PER_CHECK) {
                cancel.check()?;
            }
            if let Some(value) = value(i)?
                && best.is_none_or(|(_, most)| value > most)
            {
                best = Some((i, value));
            }
        }
        Ok(best.map(|(i, _)| num::index(i)))
    }
}

/// Makes the cells along a path from the root; nothing if the structure does not have them. A grid has millions of children,
/// of which each is looked at.
///
/// # Errors
/// [`Cancelled`] if asked to stop.
pub fn cells_along(accel: &dyn Accel, path: &[CellId], cancel: &Cancel) -> Result<Vec<Cell>, Cancelled> {
    let root = accel.root();
    if path.first() != Some(&root.id) {
        return Ok(Vec::new());
    }
    let mut cells = vec![root];
    let mut looked = 0usize;
    for id in &path[1..] {
        cancel.check()?;
        let (mut found, mut stopped) = (None, Ok(()));
        accel.children(&cells[cells.len() - 1], &mut |child| {
            looked += 1;
            if looked.is_multiple_of(PER_CHECK) {
                stopped = cancel.check();
            }
            if child.id == *id {
                found = Some(child);
            }
            if found.is_some() || stopped.is_err() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        });
        stopped?;
        let Some(found) = found else { return Ok(Vec::new()) };
        cells.push(found);
    }
    Ok(cells)
}

/// What rows are ranked by.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Rank {
    /// The deepest leaf.
    Depth,
    /// The fullest leaf.
    References,
    /// The cell but the root with the greatest part of the SAH cost by itself.
    Cost,
    /// The node whose children's overlap is met most often.
    Overlap,
    /// The cell that is met most often with nothing in it being met.
    Empty,
}

impl Rank {
    /// All, in the order of menus.
    pub const ALL: [Self; 5] = [Self::Cost, Self::Depth, Self::References, Self::Overlap, Self::Empty];

    /// What the row is.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Depth => "Deepest leaf",
            Self::References => "Fullest leaf",
            Self::Cost => "Dearest cell",
            Self::Overlap => "Worst overlap",
            Self::Empty => "Emptiest cell",
        }
    }

    /// The name on the command line.
    pub const fn id(self) -> &'static str {
        match self {
            Self::Depth => "deepest",
            Self::References => "fullest",
            Self::Cost => "dearest",
            Self::Overlap => "overlap",
            Self::Empty => "emptiest",
        }
    }

    /// How it is chosen, in a sentence.
    pub const fn help(self) -> &'static str {
        match self {
            Self::Depth => "The leaf with the most steps from the root.",
            Self::References => "The leaf with the most triangles.",
            Self::Cost => {
                "The cell, not the root, with the greatest part of the SAH cost by itself: C A(n)/A(root) over the whole."
            }
            Self::Overlap => "The node whose children's overlap a random line meets most often.",
            Self::Empty => {
                "The cell that a random line meets most often without meeting any of its children, or that is empty: A(n) less the areas of its children, over A(root)."
            }
        }
    }
}

impl std::str::FromStr for Rank {
    type Err = String;

    fn from_str(s: &str) -> Result<Self, String> {
        let known = Self::ALL.into_iter().find(|rank| rank.id() == s);
        known.ok_or_else(|| format!("there is no such cell: use {}", Self::ALL.map(Self::id).join(", ")))
    }
}

/// One over something, nothing over nothing.
fn over(whole: f64) -> f64 {
    if whole > 0.0 { 1.0 / whole } else { 0.0 }
}

/// A cell whose children are being walked.
struct Open {
    at: u32,
    depth: u32,
    cost: f64,
    references: u64,
}

/// Makes an outline.
struct Walker<'a> {
    accel: &'a dyn Accel,
    outline: Outline,
    open: Vec<Open>,
    /// What makes an area of the present level a chance.
    over_area: f64,
    level: u32,
    root_area: f64,
    weights: SahWeights,
    children: Vec<Aabb>,
    room: usize,
}

impl<'a> Walker<'a> {
    fn new(accel: &'a dyn Accel, weights: SahWeights, budget: &Budget, cut: bool) -> Result<Self, OutlineError> {
        let root_area = accel.root().shape.area();
        let charge = budget.charge(0).map_err(OutlineError::Memory)?;
        let outline = Outline {
            nodes: Vec::new(),
            instances: Vec::new(),
            parents: Vec::new(),
            behind: Vec::new(),
            depths: Vec::new(),
            references: Vec::new(),
            chances: Vec::new(),
            shares: Vec::new(),
            own: Vec::new(),
            overlaps: Vec::new(),
            cut,
            sah: 0.0,
            greatest: Rank::ALL.map(|rank| (rank, None)),
            charge,
        };
        Ok(Self {
            accel,
            outline,
            open: Vec::new(),
            over_area: over(root_area),
            level: 0,
            root_area,
            weights,
            children: Vec::new(),
            room: 0,
        })
    }

    fn walk(mut self, cancel: &Cancel, progress: &Progress) -> Result<Outline, OutlineError> {
        progress.start("cells", 0);
        let accel = self.accel;
        let mut stopped = Ok(());
        walk(accel, &mut |cell| {
            if self.outline.nodes.len() == self.room {
                stopped = cancel.check().map_err(OutlineError::from).and_then(|()| self.make_room());
                progress.advance(PER_CHECK as u64);
            }
            if stopped.is_err() {
                return ControlFlow::Break(());
            }
            self.visit(cell);
            ControlFlow::Continue(if self.outline.cut && cell.id.instance > 0 { Descend::No } else { Descend::Yes })
        });
        stopped?;
        self.close(0);
        let outline = &mut self.outline;
        let whole = over(outline.sah) as f32;
        outline.shares.iter_mut().for_each(|share| *share = (*share * whole).min(1.0));
        self.outline.fit();
        for rank in Rank::ALL {
            let greatest = self.outline.find_greatest(rank, cancel)?;
            self.outline.greatest.iter_mut().filter(|known| known.0 == rank).for_each(|known| known.1 = greatest);
        }
        Ok(self.outline)
    }

    /// Charges the next rows. Vectors grow by doubling: what they hold until the walk is over is not told.
    fn make_room(&mut self) -> Result<(), OutlineError> {
        let levels = if self.accel.levels().is_some() { 4 } else { 0 };
        self.outline.charge.grow(PER_CHECK as u64 * (BYTES + levels)).map_err(OutlineError::Memory)?;
        self.room += PER_CHECK;
        Ok(())
    }

    fn visit(&mut self, cell: &Cell) {
        self.close(cell.depth);
        self.enter_level(cell);
        let chance = cell.shape.area() * self.over_area;
        let outline = &mut self.outline;
        let at = num::index(outline.nodes.len());
        outline.nodes.push(cell.id.node);
        if self.accel.levels().is_some() {
            outline.instances.push(cell.id.instance);
        }
        outline.parents.push(self.open.last().map_or(0, |open| open.at));
        outline.behind.push(at + 1);
        outline.depths.push(u8::try_from(cell.depth).unwrap_or(u8::MAX));
        outline.references.push(cell.prims());
        outline.chances.push(chance as f32);
        outline.shares.push(0.0);
        let layout = self.accel.layout_of(cell.id.instance);
        let instance_of = |at: u32| outline.instances.get(at as usize).copied().unwrap_or(0);
        let first = self.open.last().is_none_or(|above| instance_of(above.at) != cell.id.instance);
        // Where rays step from cell to cell they enter all but the first.
        let steps = if layout.slack().is_some() { !first } else { !cell.is_leaf() };
        let tests = self.weights.c_isect * f64::from(cell.prims());
        let cost = chance * (tests + if steps { self.weights.c_trav } else { 0.0 });
        outline.own.push(cost as f32);
        // Boxes around volumes overlap where the volumes do not.
        let told = layout.nests() && cell.kind == CellKind::Inner && matches!(cell.shape, Shape::Box(_));
        let overlap = if told { self.overlap(cell) } else { f32::NAN };
        self.outline.overlaps.push(overlap);
        self.open.push(Open { at, depth: cell.depth, cost, references: cell.prims().into() });
    }

    /// Areas below an instance are those of its mesh's own space: the chance to meet its root is that of the box in the scene.
    fn enter_level(&mut self, cell: &Cell) {
        if cell.id.instance == self.level {
            return;
        }
        self.level = cell.id.instance;
        let own = over(cell.shape.area());
        let met = (bounds_in_scene(self.accel, cell).area() * over(self.root_area)).min(1.0);
        self.over_area = if self.level == 0 { over(self.root_area) } else { met * own };
    }

    fn overlap(&mut self, cell: &Cell) -> f32 {
        let boxes = &mut self.children;
        boxes.clear();
        self.accel.children(cell, &mut |child| {
            let same_space = child.id.instance == cell.id.instance;
            boxes.push(if same_space { *child.shape.bounds() } else { bounds_in_scene(self.accel, &child) });
            if boxes.len() > MOST_PAIRED { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        });
        // Pairs of a list without any structure are too many.
        if boxes.len() > MOST_PAIRED {
            return f32::NAN;
        }
        let pairs = boxes.iter().enumerate().flat_map(|(i, a)| boxes[..i].iter().map(move |b| a.intersection(*b)));
        let shared: f64 = pairs.map(|both| both.area()).sum();
        let area = cell.shape.area();
        if area > 0.0 { (shared / area) as f32 } else { f32::NAN }
    }

    /// Ends the cells that a cell of some depth is not below.
    fn close(&mut self, depth: u32) {
        while let Some(done) = self.open.pop_if(|open| open.depth >= depth) {
            let outline = &mut self.outline;
            let i = done.at as usize;
            outline.behind[i] = num::index(outline.nodes.len());
            outline.shares[i] = done.cost as f32;
            outline.references[i] = u32::try_from(done.references).unwrap_or(u32::MAX);
            match self.open.last_mut() {
                Some(above) => {
                    above.cost += done.cost;
                    above.references += done.references;
                }
                None => outline.sah = done.cost,
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accel::stats::Stats;
    use crate::accel::{BuildCx, registry};
    use crate::geometry::tri::TestKind;
    use crate::scene::{Geometry, LoadCx, open};
    use std::sync::Arc;

    fn of(model: &str, entry: &registry::Entry, budget: &Budget) -> (Box<dyn Accel>, Result<Outline, OutlineError>) {
        let (cx, load) = (BuildCx::unattended(1), LoadCx::unattended());
        let geometry = Arc::new(Geometry::with_instances(&open(model, &load).expect("built in"), &load).expect("fits"));
        let accel = entry.build(&geometry, TestKind::Watertight, &entry.defaults(), &cx).expect("builds");
        let weights = SahWeights::of(&entry.defaults());
        let outline = Outline::of(accel.as_ref(), weights, (budget, &cx.cancel, &cx.progress));
        (accel, outline)
    }

    #[test]
    fn it_agrees_with_the_walk_and_the_statistics_of_every_structure() {
        for entry in registry::ALL {
            let (accel, outline) = of("builtin:soup?triangles=3000", entry, &Budget::new(1 << 30));
            let outline = outline.expect("small");
            let stats =
                Stats::of_structure(accel.as_ref(), SahWeights::of(&entry.defaults()), &Cancel::new()).expect("not cancelled");
            let mut rows = Vec::new();
            walk(accel.as_ref(), &mut |cell| {
                rows.push(*cell);
                ControlFlow::Continue(Descend::Yes)
            });
            assert_eq!(rows.len(), outline.len() as usize, "{}", entry.id);
            assert!((outline.sah() / stats.sah - 1.0).abs() < 1e-9, "{}: {} and {}", entry.id, outline.sah(), stats.sah);
            assert_eq!(u64::from(outline.row(0).references), stats.references, "{}", entry.id);
            for (at, cell) in (0u32..).zip(&rows).step_by(97) {
                let row = outline.row(at);
                assert_eq!((row.id, row.depth, row.is_leaf()), (cell.id, cell.depth, cell.is_leaf()), "{}: {at}", entry.id);
                assert!((row.chance * rows[0].shape.area() / cell.shape.area() - 1.0).abs() < 1e-5 || cell.shape.area() == 0.0);
                let own: f64 = row.own_share + outline.children(at).map(|child| outline.row(child).share).sum::<f64>();
                assert!((own - row.share).abs() < 1e-4, "{}: {at}: {own} of {}", entry.id, row.share);
            }
        }
    }

    #[test]
    fn cells_are_found_and_made_again_at_both_levels() {
        for (model, id) in
            [("builtin:soup?triangles=3000", "bvh"), ("builtin:soup?triangles=3000", "grid"), ("builtin:sphere-flake", "bvh")]
        {
            let (accel, outline) = of(model, registry::find(id).expect("registered"), &Budget::new(1 << 30));
            let outline = outline.expect("small");
            for at in (0..outline.len()).step_by(61) {
                let cells = outline.cells(accel.as_ref(), at, &Cancel::new()).expect("not cancelled");
                let path: Vec<CellId> = cells.iter().map(|cell| cell.id).collect();
                assert_eq!(outline.find(&path), Some(at), "{model} {id}");
                assert_eq!(cells.len(), outline.path(at).len());
            }
            let cancel = Cancel::new();
            cancel.cancel();
            assert_eq!(outline.cells(accel.as_ref(), outline.len() - 1, &cancel), Err(Cancelled), "{model} {id}");
            for rank in Rank::ALL {
                assert_eq!(outline.find_greatest(rank, &cancel), Err(Cancelled), "{model} {id}");
            }
            assert!(outline.find(&[CellId { instance: 7, node: u32::MAX }]).is_none());
            let mut walked = 0;
            let whole = outline.walk_below(accel.as_ref(), &accel.root(), 0, &mut |cell, row| {
                assert_eq!((row, cell.id), (walked, outline.row(row).id), "{model} {id}");
                walked += 1;
                ControlFlow::Continue(Descend::Yes)
            });
            assert!(whole.is_continue() && walked == outline.len());
        }
    }

    #[test]
    fn siblings_go_round_and_the_greatest_are_found() {
        let (_, outline) = of("builtin:soup?triangles=3000", registry::find("bvh").expect("registered"), &Budget::new(1 << 30));
        let outline = outline.expect("small");
        let [left, right]: [u32; 2] = outline.children(0).collect::<Vec<_>>().try_into().expect("two");
        assert_eq!([left, right].map(|at| outline.sibling(at)), [Some(right), Some(left)]);
        assert_eq!(outline.sibling(0), None);
        let deepest = outline.row(outline.greatest(Rank::Depth).expect("a leaf"));
        assert!(deepest.is_leaf() && (0..outline.len()).all(|at| outline.row(at).depth <= deepest.depth));
        let fullest = outline.row(outline.greatest(Rank::References).expect("a leaf"));
        assert!((0..outline.len()).map(|at| outline.row(at)).all(|row| !row.is_leaf() || row.references <= fullest.references));
        let dearest = outline.row(outline.greatest(Rank::Cost).expect("more than the root"));
        assert!((1..outline.len()).all(|at| outline.row(at).own_share <= dearest.own_share * 1.000_01));
        assert!(outline.row(outline.greatest(Rank::Overlap).expect("boxes")).overlap.is_some());
        let wasted = |at: u32| outline.row(at).chance - outline.children(at).map(|child| outline.row(child).chance).sum::<f64>();
        let emptiest = outline.greatest(Rank::Empty).expect("boxes do not fill each other");
        let most = (0..outline.len()).filter(|at| !outline.row(*at).is_leaf()).map(wasted).fold(0.0, f64::max);
        assert!(most > 0.0 && (wasted(emptiest) - most).abs() < 1e-6);
    }

    #[test]
    fn what_does_not_fit_ends_at_the_instances_or_is_refused() {
        let bvh = registry::find("bvh").expect("registered");
        let (_, whole) = of("builtin:sphere-flake?triangles=100000", bvh, &Budget::new(1 << 30));
        let whole = whole.expect("fits");
        let room = PER_CHECK as u64 * (BYTES + 4);
        assert!(!whole.is_cut() && whole.len() as usize > PER_CHECK, "{}", whole.len());
        let (_, cut) = of("builtin:sphere-flake?triangles=100000", bvh, &Budget::new(room));
        let cut = cut.expect("the upper level fits");
        assert!(cut.is_cut() && cut.len() < whole.len());
        let (_, none) = of("builtin:soup?triangles=3000", bvh, &Budget::new(room / 2));
        assert!(matches!(none, Err(OutlineError::Memory(_))));
    }
}
