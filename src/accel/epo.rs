//! End-point overlap (Aila, Karras and Laine 2013, "On quality metrics of bounding volume
//! hierarchies", §3): what a hierarchy costs the rays that end on a surface.
//!
//! A ray that ends on a triangle must visit every node that holds the end point. The nodes above the
//! triangle's own leaf it has to visit anyway; those of other subtrees that happen to lie there are
//! waste:
//!
//! ```text
//! EPO = sum over nodes of C(n) area(part of S in n that is not in n's subtree) / area(S)
//! ```
//!
//! with S all triangles, C(n) = C_trav for an inner node and C_isect prims for a leaf. So EPO is the
//! mean, over points spread evenly on S, of the cost of the foreign nodes that hold the point.

use std::ops::ControlFlow;

use rayon::prelude::*;

use super::cell::{Cell, Cells, Descend, Shape, walk};
use super::stats::SahWeights;
use crate::geometry::{Aabb, num, polygon};
use crate::scene::{Geometry, PrimRef};
use crate::task::{Budget, Cancel, Cancelled, Charge, OverBudget, Pool};

/// Triangles looked at, unless told otherwise; all of them where there are no more.
pub const MOST: usize = 1_000_000;

/// The weight of EPO in the blend unless told otherwise. Aila et al. fit it to measured times; no one
/// value suits every scene.
pub const ALPHA: f64 = 0.5;

/// End-point overlap and how well it is known.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize)]
pub struct Epo {
    /// In the unit of C_trav and C_isect.
    pub value: f64,
    /// The standard error of the estimate; 0 if every triangle was looked at.
    pub error: f64,
    /// Triangles looked at; 0 where space is divided, so that nothing can overlap.
    pub sampled: usize,
    /// Triangles there are.
    pub of: usize,
}

/// Why there is none.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum NoEpo {
    /// Asked to stop.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
    /// The copy of the nodes would not fit.
    #[error("end-point overlap: {0}")]
    Memory(#[from] OverBudget),
    /// Parts of triangles are worked out for boxes alone.
    #[error("end-point overlap is worked out for boxes alone")]
    NoBoxes,
    /// Nodes below a place are shared by others.
    #[error("end-point overlap is not worked out across two levels")]
    TwoLevels,
}

/// With what it is worked out.
#[derive(Clone, Debug)]
pub struct EpoCx {
    /// Triangles looked at, at most: where there are more, points are spread evenly over the surface,
    /// and the triangles they fall on looked at.
    pub most: usize,
    /// The threads.
    pub pool: Pool,
    /// For the copy of the nodes.
    pub budget: Budget,
    /// Stops it.
    pub cancel: Cancel,
}

impl Epo {
    /// Of a structure over `geometry`. Zero for one that divides space and lists in every leaf all
    /// triangles that overlap it: there is no part of a triangle in a leaf that does not hold it.
    ///
    /// # Errors
    /// [`NoEpo`] if asked to stop, over the memory budget, or if some node is no box.
    pub fn of(cells: &dyn Cells, geometry: &Geometry, weights: SahWeights, cx: &EpoCx) -> Result<Self, NoEpo> {
        let of = geometry.live_count();
        if !cells.layout().nests() || of == 0 {
            return Ok(Self { of, ..Self::default() });
        }
        let tree = Tree::of(cells, geometry, weights, cx)?;
        let _picks_memory = cx.budget.charge((of.min(cx.most) * size_of::<Pick>()) as u64)?;
        let picks = picks(geometry, cx)?;
        let foreign = |chunk: &[Pick]| {
            cx.cancel.check()?;
            let mut sums = [0.0; 3];
            for pick in chunk {
                let cost = tree.foreign_cost(&geometry.corners(pick.prim), pick.prim);
                [1.0, cost, cost * cost].iter().zip(&mut sums).for_each(|(x, sum)| *sum += pick.weight * x);
            }
            Ok(sums)
        };
        // Summed in order, so that threads leave no trace.
        let parts: Result<Vec<[f64; 3]>, Cancelled> = cx.pool.run(|| picks.par_chunks(CHUNK).map(foreign).collect());
        let [weight, sum, squares] = parts?.iter().fold([0.0; 3], |a, b| [a[0] + b[0], a[1] + b[1], a[2] + b[2]]);
        let value = if weight > 0.0 { sum / weight } else { 0.0 };
        // As of a simple random sample; spreading the points evenly makes the true error smaller.
        let variance = (squares / weight.max(f64::MIN_POSITIVE) - value * value).max(0.0);
        let error = if of > cx.most { (variance / cx.most.saturating_sub(1).max(1) as f64).sqrt() } else { 0.0 };
        Ok(Self { value, error, sampled: picks.len(), of })
    }

    /// `(1 - alpha) SAH + alpha EPO`: what Aila et al. predict the time of a ray with.
    pub fn blend(&self, sah: f64, alpha: f64) -> f64 {
        (1.0 - alpha) * sah + alpha * self.value
    }
}

/// Triangles between two looks at the cancel flag: a few milliseconds.
const CHUNK: usize = 1024;

/// A triangle that is looked at, and the share of the surface it stands for, in no unit of its own.
#[derive(Clone, Copy, Debug)]
struct Pick {
    prim: PrimRef,
    weight: f64,
}

/// All triangles by their areas; or those under so many points spread evenly over the surface, by the
/// points they have. The same every time.
fn picks(geometry: &Geometry, cx: &EpoCx) -> Result<Vec<Pick>, Cancelled> {
    let live = |i: usize| {
        let prim = geometry.live(i);
        Pick { prim, weight: polygon::area(&geometry.corners(prim)) }
    };
    let count = geometry.live_count();
    if count <= cx.most {
        return Ok((0..count).map(live).collect());
    }
    let starts: Vec<usize> = (0..count).step_by(CHUNK).collect();
    let area_of = |start: &usize| cx.cancel.check().map(|()| (*start..count.min(start + CHUNK)).map(|i| live(i).weight).sum());
    let areas: Result<Vec<f64>, Cancelled> = cx.pool.run(|| starts.par_iter().map(area_of).collect());
    let apart = areas?.iter().sum::<f64>() / cx.most as f64;

    let (mut picks, mut points, mut passed) = (Vec::new(), Points { next: 0, of: cx.most, apart }, 0.0);
    for i in 0..count {
        if i % CHUNK == 0 {
            cx.cancel.check()?;
        }
        let Pick { prim, weight } = live(i);
        passed += weight;
        let on_it = points.take_before(passed);
        if on_it > 0 {
            picks.push(Pick { prim, weight: on_it as f64 });
        }
    }
    Ok(picks)
}

/// Points along the surface, one triangle after the other laid end to end: one in each of equal
/// strata, at a place that the golden ratio chooses.
struct Points {
    next: usize,
    of: usize,
    apart: f64,
}

impl Points {
    /// How many there are that were not yet taken and lie before `end`.
    fn take_before(&mut self, end: f64) -> usize {
        const GOLDEN: f64 = 0.618_033_988_749_894_9;
        let first = self.next;
        let at = |i: usize| (i as f64 + (i as f64 * GOLDEN).fract()) * self.apart;
        while self.next < self.of && at(self.next) < end {
            self.next += 1;
        }
        self.next - first
    }
}

/// A node, each before what is below it.
#[derive(Clone, Copy, Debug)]
struct Node {
    bounds: Aabb,
    /// One past the last node below it.
    end: u32,
    /// C(n), rounded.
    cost: f32,
}

/// A structure as it is walked for each triangle, and in which leaves the triangles are.
struct Tree {
    nodes: Vec<Node>,
    /// A leaf of each triangle; no node for one in none.
    leaf: Vec<u32>,
    /// Further leaves of triangles that are in several, ascending.
    more: Vec<(PrimRef, u32)>,
    memory: Charge,
}

impl Tree {
    fn of(cells: &dyn Cells, geometry: &Geometry, weights: SahWeights, cx: &EpoCx) -> Result<Self, NoEpo> {
        let memory = cx.budget.charge(geometry.triangle_count() as u64 * 4)?;
        let leaf = vec![u32::MAX; geometry.triangle_count()];
        let mut tree = Self { nodes: Vec::new(), leaf, more: Vec::new(), memory };
        // The nodes from the root to the last one visited.
        let mut open: Vec<u32> = Vec::new();
        let mut visited = Ok(());
        walk(cells, &mut |cell| {
            visited = tree.add(cells, cell, weights, &mut open, cx);
            if visited.is_ok() { ControlFlow::Continue(Descend::Yes) } else { ControlFlow::Break(()) }
        });
        visited?;
        let end = num::index(tree.nodes.len());
        open.iter().for_each(|at| tree.nodes[*at as usize].end = end);
        tree.more.sort_unstable();
        Ok(tree)
    }

    /// Adds a node, those from the root to the last one being `open`.
    fn add(&mut self, cells: &dyn Cells, cell: &Cell, weights: SahWeights, open: &mut Vec<u32>, cx: &EpoCx) -> Result<(), NoEpo> {
        let Shape::Box(bounds) = cell.shape else { return Err(NoEpo::NoBoxes) };
        self.make_room(cell.prims() as usize, cx)?;
        let at = num::index(self.nodes.len());
        while open.len() > cell.depth as usize
            && let Some(ended) = open.pop()
        {
            self.nodes[ended as usize].end = at;
        }
        open.push(at);
        let cost = if cell.is_leaf() { weights.c_isect * f64::from(cell.prims()) } else { weights.c_trav };
        self.nodes.push(Node { bounds, end: at + 1, cost: num::narrow(cost) });
        cells.prims(cell, &mut |prim| match &mut self.leaf[prim as usize] {
            first if *first == u32::MAX => *first = at,
            _ => self.more.push((prim, at)),
        });
        Ok(())
    }

    /// Charges for the lists before they grow by a node and `refs` references; now and then looks
    /// whether to stop.
    fn make_room(&mut self, refs: usize, cx: &EpoCx) -> Result<(), NoEpo> {
        if self.nodes.len().is_multiple_of(CHUNK) {
            cx.cancel.check()?;
        }
        if self.nodes.len() == self.nodes.capacity() {
            let more = self.nodes.len().max(CHUNK);
            self.memory.grow((more * size_of::<Node>()) as u64)?;
            self.nodes.reserve_exact(more);
        }
        if self.more.capacity() - self.more.len() < refs {
            let more = self.more.len().max(refs);
            self.memory.grow((more * size_of::<(PrimRef, u32)>()) as u64)?;
            self.more.reserve_exact(more);
        }
        Ok(())
    }

    /// The summed C(n) of nodes that do not hold the triangle, each by the share of the triangle that
    /// lies in it. A node that the triangle does not meet has nothing below that it does.
    fn foreign_cost(&self, tri: &[glam::Vec3; 3], prim: PrimRef) -> f64 {
        let (own, bounds) = (polygon::area(tri), Aabb::of_triangle(tri));
        let from = self.more.partition_point(|(p, _)| *p < prim);
        let to = self.more.partition_point(|(p, _)| *p <= prim);
        let (first, more) = (self.leaf[prim as usize], &self.more[from..to]);
        let (mut cost, mut at) = (0.0, 0u32);
        while let Some(node) = self.nodes.get(at as usize) {
            let below = at..node.end;
            if below.contains(&first) || more.iter().any(|(_, leaf)| below.contains(leaf)) {
                at += 1;
                continue;
            }
            if bounds.intersection(node.bounds).is_empty() {
                at = node.end;
                continue;
            }
            let part = polygon::area_in_box(tri, &node.bounds);
            cost += f64::from(node.cost) * part;
            at = if part > 0.0 { at + 1 } else { node.end };
        }
        if own > 0.0 { cost / own } else { 0.0 }
    }
}

#[cfg(test)]
mod tests;
