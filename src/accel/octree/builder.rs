//! The build loop of the octree: divide a cell in the middle, give each part the triangles that
//! overlap it, and again, until a leaf is better.
//!
//! A division that costs more than a leaf may still lead to parts that can be divided well (what lies
//! around the middle of a cell is in all its parts at first): one is tried, and undone if it came to
//! nothing. Since it can be undone it never makes the tree worse; more of them in a row gained nothing
//! on any built-in scene.

use std::sync::Arc;

use rayon::prelude::*;

use super::division::{CHUNK, Costs, Division};
use super::join::{List, Subtree, join};
use super::node::{Node, divided};
use super::tree::Built;
use crate::accel::{BuildCx, BuildError, Fits};
use crate::geometry::{Aabb, Slabs, num};
use crate::scene::{Geometry, PrimRef};
use crate::task::{Charge, OverBudget};

/// When to stop.
#[derive(Clone, Copy, Debug)]
pub struct Limits {
    /// Cells with no more triangles are not divided.
    pub max_leaf: u32,
    /// No cell is deeper.
    pub max_depth: u32,
    /// References for each triangle of the scene, on average, at most.
    pub max_refs: f64,
}

/// Triangles below which a subtree is built by one thread.
const FORK: usize = 4096;
/// Divisions in a row that may cost more than a leaf.
const BAD_DIVISIONS: u32 = 1;

/// Builds an octree over all live triangles.
///
/// # Errors
/// Cancelled, over the memory budget, or more nodes or references than fit their indices.
pub fn build(geometry: &Arc<Geometry>, costs: Costs, limits: Limits, cx: &BuildCx) -> Result<Built, BuildError> {
    let n = geometry.live_count();
    cx.progress.start("split", n as u64);
    let held = cx.budget.charge((n * size_of::<PrimRef>()) as u64).map_err(too_large)?;
    let mut refs = Vec::with_capacity(n);
    while refs.len() < n {
        cx.cancel.check()?;
        refs.extend((refs.len()..n.min(refs.len() + CHUNK)).map(|i| geometry.live(i)));
    }
    let bounds = *geometry.bounds();
    // Cells not much larger than the error of a ray are entered together with their neighbours.
    let least = 4.0 * Slabs::pad(bounds.centre(), &bounds).max_element();
    let builder = Builder { geometry, costs, limits, least, cx };
    let work = Work { cell: bounds, depth: 0, bad: 0, share: n as f64 };
    let (tree, _) = cx.pool.run(|| builder.subtree(work, refs, held))?;
    cx.progress.start("join", 0);
    let (nodes, refs, charge) = join(tree, cx)?;
    Ok(Built { geometry: Arc::clone(geometry), nodes, refs, _charge: charge })
}

/// The refusal for want of memory.
pub fn too_large(over: OverBudget) -> BuildError {
    BuildError::Memory {
        structure: "octree",
        over,
        remedy: "Raise the memory budget, lower max_refs or max_depth, or use bvh.",
        fits: Fits::default(),
    }
}

/// A cell to be divided, and what is known of it.
#[derive(Clone, Copy)]
struct Work {
    cell: Aabb,
    depth: u32,
    /// Divisions down to here that cost more than a leaf, in a row.
    bad: u32,
    /// The triangles of the scene that its references stand for: the parts of a cell have its share
    /// in proportion to their references.
    share: f64,
}

struct Builder<'a> {
    geometry: &'a Geometry,
    costs: Costs,
    limits: Limits,
    /// The shortest edge that is divided.
    least: f32,
    cx: &'a BuildCx,
}

impl Builder<'_> {
    /// Builds what is below a cell, and says what it costs. `held` is the memory of `refs`.
    fn subtree(&self, work: Work, refs: Vec<PrimRef>, held: Charge) -> Result<(Subtree, f64), BuildError> {
        if refs.len() < FORK {
            let mut list = List::new(self.charge(0)?);
            let cost = self.fill(&mut list, 0, work, &refs)?;
            return Ok((Subtree::List(list), cost));
        }
        let leaf = self.costs.leaf(refs.len());
        let Some((division, bad)) = self.divide(&work, &refs)? else { return Ok((self.large_leaf(refs, held)?, leaf)) };
        let area = work.cell.area();
        let _sets = self.charge(refs.len())?;
        let dealt: Result<Vec<_>, BuildError> = division.parts().map(|octant| self.part(&work, &division, bad, octant)).collect();
        let part = |(octant, work, held): (usize, Work, Charge)| {
            let (tree, cost) = self.subtree(work, division.refs(octant, &refs), held)?;
            Ok((tree, cost * work.cell.area() / area))
        };
        let parts: Result<Vec<_>, BuildError> = dealt?.into_par_iter().map(part).collect();
        let (trees, part_costs): (Vec<_>, Vec<f64>) = parts?.into_iter().unzip();
        let cost = self.costs.c_trav + part_costs.iter().sum::<f64>();
        if cost < leaf {
            return Ok((Subtree::Fork(division.octants, trees), cost));
        }
        Ok((self.large_leaf(refs, held)?, leaf))
    }

    /// The same by one thread: writes node `at` of a list and appends what is below it.
    fn fill(&self, list: &mut List, at: usize, work: Work, refs: &[PrimRef]) -> Result<f64, BuildError> {
        let leaf = self.costs.leaf(refs.len());
        let Some((division, bad)) = self.divide(&work, refs)? else {
            self.leaf(list, at, refs)?;
            return Ok(leaf);
        };
        let (first, first_ref) = (list.nodes.len(), list.refs.len());
        list.nodes[at] = Node::inner(division.octants, num::index(first));
        list.nodes.resize(first + division.parts().count(), Node::leaf(0, 0));
        let mut cost = self.costs.c_trav;
        for (i, octant) in division.parts().enumerate() {
            let part = self.below(&work, &division, bad, octant);
            let share = part.cell.area() / work.cell.area();
            cost += share * self.fill(list, first + i, part, &division.refs(octant, refs))?;
        }
        if cost < leaf {
            return Ok(cost);
        }
        list.nodes.truncate(first);
        list.refs.truncate(first_ref);
        self.leaf(list, at, refs)?;
        Ok(leaf)
    }

    /// How to divide a cell, and how many bad divisions in a row that makes; `None` for a leaf.
    fn divide(&self, work: &Work, refs: &[PrimRef]) -> Result<Option<(Division, u32)>, BuildError> {
        self.cx.cancel.check()?;
        let axes = divided(&work.cell, self.least);
        let done = refs.len() <= self.limits.max_leaf as usize || work.depth >= self.limits.max_depth || axes == 0;
        if !done {
            let division = Division::new(&work.cell, axes, refs, self.geometry, &self.cx.cancel)?;
            let pays = division.cost(&self.costs, work.cell.area()) < self.costs.leaf(refs.len());
            let bad = if pays { 0 } else { work.bad + 1 };
            if bad <= BAD_DIVISIONS && division.references() as f64 <= work.share * self.limits.max_refs {
                return Ok(Some((division, bad)));
            }
        }
        if work.share >= 1.0 {
            self.cx.progress.advance(num::floor_index(work.share, num::MAX_INDEX) as u64);
        }
        Ok(None)
    }

    fn below(&self, work: &Work, division: &Division, bad: u32, octant: usize) -> Work {
        let share = work.share * division.counts[octant] as f64 / division.references() as f64;
        Work { cell: division.cells[octant], depth: work.depth + 1, bad, share }
    }

    /// A part that is to be built on its own, and the memory of its references, not yet taken.
    fn part(&self, work: &Work, division: &Division, bad: u32, octant: usize) -> Result<(usize, Work, Charge), BuildError> {
        let held = self.charge(division.counts[octant] * size_of::<PrimRef>())?;
        Ok((octant, self.below(work, division, bad, octant), held))
    }

    fn leaf(&self, list: &mut List, at: usize, refs: &[PrimRef]) -> Result<(), BuildError> {
        list.nodes[at] = Node::leaf(num::index(list.refs.len()), num::index(refs.len()));
        list.refs.extend_from_slice(refs);
        list.charge().map_err(too_large)
    }

    fn large_leaf(&self, refs: Vec<PrimRef>, held: Charge) -> Result<Subtree, BuildError> {
        let mut list = List::new(held);
        self.leaf(&mut list, 0, &refs)?;
        Ok(Subtree::List(list))
    }

    fn charge(&self, bytes: usize) -> Result<Charge, BuildError> {
        self.cx.budget.charge(bytes as u64).map_err(too_large)
    }
}
