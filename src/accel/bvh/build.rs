//! From parameters to a tree: the builder, then the passes over what it made.

use std::sync::Arc;

use super::ID;
use super::binned::Binned;
use super::boxes::{Bounds, PrimBox, prim_boxes};
use super::costs::Costs;
use super::draft::Draft;
use super::lbvh::Curve;
use super::median::{ObjectMedian, SpatialMiddle};
use super::preset::Builder;
use super::reinsertion::{self, Log, Patience, Round};
use super::sbvh::{self, Sbvh, Work};
use super::slice::{Heuristic, InPlace, Slice};
use super::subtree::Subtree;
use super::sweep::Sweep;
use super::topdown::{self, Limits};
use super::tree::{Built, MAX_DEPTH, Node, Packed};
use super::{morton, ploc};
use crate::accel::params::ParamValues;
use crate::accel::{BuildCx, BuildError, Fits};
use crate::geometry::{Aabb, num};
use crate::scene::Geometry;
use crate::task::{Charge, OverBudget};

/// What the parameters ask for.
struct Plan {
    builder: Builder,
    costs: Costs,
    bins: u32,
    limits: Limits,
    radius: usize,
    alpha: f64,
    /// References that spatial splits may add.
    allowance: usize,
    reinsertion: Option<Patience>,
    remarks: Vec<String>,
}

impl Plan {
    fn of(p: &ParamValues, triangles: usize) -> Self {
        let (builder, remark) = Builder::of(p, triangles);
        let patience = Patience { gain: p.float("reinsertion_gain"), secs: p.float("reinsertion_secs") };
        let splits = builder == Builder::Sbvh;
        Self {
            builder,
            costs: Costs { c_trav: p.float("c_trav"), c_isect: p.float("c_isect") },
            bins: p.int("bins"),
            limits: Limits { max_leaf: p.int("max_leaf"), max_depth: p.int("max_depth") },
            radius: p.int("radius") as usize,
            alpha: p.float("alpha"),
            allowance: if splits { sbvh::allowance(triangles, p.float("duplication")) } else { 0 },
            reinsertion: (p.choice("reinsertion") == "on").then_some(patience),
            remarks: remark.into_iter().collect(),
        }
    }

    /// Whether the builder leaves it to a pass to choose the leaves.
    const fn needs_leaves(&self) -> bool {
        matches!(self.builder, Builder::Lbvh | Builder::Ploc) || self.reinsertion.is_some()
    }

    /// While leaves are still to be chosen there is one for each triangle, as deep as it takes.
    fn build_limits(&self) -> Limits {
        if self.needs_leaves() { Limits { max_leaf: 1, max_depth: MAX_DEPTH } } else { self.limits }
    }

    fn peak_bytes(&self, triangles: usize) -> u64 {
        let refs = triangles + self.allowance;
        let order = match self.builder {
            Builder::Sweep => 3 * size_of::<(u32, u32)>() + 3 * size_of::<u32>() + size_of::<f64>(),
            Builder::Lbvh | Builder::Ploc => 2 * size_of::<morton::Coded>() + 2 * size_of::<Node>(),
            Builder::Sbvh => 2 * size_of::<PrimBox>(),
            Builder::Median | Builder::Midpoint | Builder::Binned => 0,
        };
        // Nodes exist twice while subtrees are joined or arranged.
        let each = size_of::<PrimBox>() + order + size_of::<Packed>();
        let arranging = if self.needs_leaves() { Draft::arranging_bytes(refs) } else { 0 };
        (refs * each + 2 * Draft::bytes(refs) + arranging) as u64
    }
}

/// What a builder made, before it is packed for a traversal.
#[derive(Debug)]
pub struct Drafted {
    /// The tree.
    pub draft: Draft,
    /// Whether leaves hold parts of triangles, which may then be in several.
    pub splits: bool,
    /// What the builder decided by itself, in words for the user.
    pub remarks: Vec<String>,
    /// The memory that building takes at most, what is made of it by [`build`] included.
    pub peak: Charge,
}

/// What `auto` may do.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Auto {
    /// Every triangle stays whole: the tree finds the hits of brute force to the bit.
    Whole,
    /// Triangles are cut where that pays.
    MayCut,
}

/// Builds a tree over all live triangles.
///
/// # Errors
/// Cancelled, or over the memory budget.
pub fn draft(geometry: &Geometry, p: &ParamValues, auto: Auto, cx: &BuildCx) -> Result<Drafted, BuildError> {
    let n = geometry.live_count();
    let drafted = Plan::of(p, n).drafted(geometry, cx)?;
    if auto == Auto::Whole || !Builder::is_auto(p) || n > CUT_UP_TO {
        return Ok(drafted);
    }
    let overlap = drafted.draft.overlap();
    if overlap < CUT_FROM {
        return Ok(drafted);
    }
    let remark = format!("Builder: auto took sbvh, as siblings overlap by {:.0} %.", 100.0 * overlap);
    let cutting = Plan::cutting(p, n, remark);
    // Where the memory does not suffice for it, the tree that there is will do.
    let more = cutting.peak_bytes(n).saturating_sub(drafted.peak.bytes());
    if cx.budget.charge(more).is_err() {
        return Ok(drafted);
    }
    drop(drafted);
    cutting.drafted(geometry, cx)
}

/// From this overlap of siblings on (see [`Draft::overlap`]) cutting triangles pays. Of eleven models those with 0.19
/// and less gained at most 7 % of the SAH cost, and one lost 2 %; a car, a truck and a plant, with 0.23 to 0.32,
/// gained 18 to 30 %; a soup, with 0.21, gained 3 %, and hair, with 0.28, 5 %.
const CUT_FROM: f64 = 0.22;
/// Up to so many triangles `auto` looks for that: cutting takes four to ten times as long as binning.
const CUT_UP_TO: usize = 1_000_000;

impl Plan {
    /// With triangles cut, whatever the parameters say about the builder.
    fn cutting(p: &ParamValues, triangles: usize, remark: String) -> Self {
        let allowance = sbvh::allowance(triangles, p.float("duplication"));
        Self { builder: Builder::Sbvh, allowance, remarks: vec![remark], ..Self::of(p, triangles) }
    }

    fn drafted(mut self, geometry: &Geometry, cx: &BuildCx) -> Result<Drafted, BuildError> {
        let n = geometry.live_count();
        let most = cx.most(num::MAX_INDEX);
        if n + self.allowance > most / 2 {
            return Err(BuildError::TooMany { structure: ID, what: "nodes", limit: most as u64, remedy: "Use a smaller model." });
        }
        let peak = cx.budget.charge(self.peak_bytes(n)).map_err(too_large)?;
        cx.progress.start("bound", n as u64);
        let prims = prim_boxes(geometry, cx)?;
        let draft = if n == 0 { Draft { nodes: Vec::new(), refs: Vec::new() } } else { self.draft(geometry, prims, cx)? };
        Ok(Drafted { draft, splits: self.builder == Builder::Sbvh, remarks: self.remarks, peak })
    }
}

/// Builds a BVH over all live triangles, and packs them.
///
/// # Errors
/// Cancelled, or over the memory budget.
pub fn build(geometry: &Arc<Geometry>, p: &ParamValues, cx: &BuildCx) -> Result<Built, BuildError> {
    packed(geometry, draft(geometry, p, Auto::Whole, cx)?, cx)
}

fn packed(geometry: &Arc<Geometry>, drafted: Drafted, cx: &BuildCx) -> Result<Built, BuildError> {
    let Drafted { draft, splits, remarks, peak } = drafted;
    cx.progress.start("pack", draft.refs.len() as u64);
    let packed = draft.pack(geometry, cx)?;
    drop(peak);
    let bytes = draft.nodes.capacity() * size_of::<Node>() + size_of_val(&packed[..]);
    let charge = cx.budget.charge(bytes as u64).map_err(too_large)?;
    Ok(Built { geometry: Arc::clone(geometry), nodes: draft.nodes, packed, splits, remarks, _charge: charge })
}

/// How a tree came to be whose nodes were moved once it was built.
#[derive(Debug)]
pub struct Recorded {
    /// The tree before, with one triangle in a leaf.
    pub before: Built,
    /// What was moved, round by round; nothing if it gained nothing and was undone.
    pub rounds: Vec<Round>,
    /// The SAH cost of the finished tree.
    pub sah: f64,
}

/// Builds the tree anew and watches its nodes being moved, keeping at most so many moves of each round; nothing if the parameters
/// do not ask for that.
///
/// # Errors
/// Cancelled, or over the memory budget.
pub fn recorded(geometry: &Arc<Geometry>, p: &ParamValues, most: usize, cx: &BuildCx) -> Result<Option<Recorded>, BuildError> {
    let n = geometry.live_count();
    let mut plan = Plan::of(p, n);
    if n == 0 || plan.reinsertion.is_none() {
        return Ok(None);
    }
    let peak = cx.budget.charge(plan.peak_bytes(n) + Log::bytes(most) as u64).map_err(too_large)?;
    cx.progress.start("bound", n as u64);
    let divided = plan.divided(geometry, prim_boxes(geometry, cx)?, cx)?;
    let copy = Draft { nodes: divided.nodes.clone(), refs: divided.refs.clone() };
    let mut log = Log::new(most);
    let moved = plan.reinserted(divided, Some(&mut log), cx)?;
    let finished = moved.arranged(geometry, &plan.costs, plan.limits, cx)?;
    let whole = finished.nodes.first().map_or(0.0, |root| root.bounds().area());
    let sah = if whole > 0.0 { finished.sum(&plan.costs) / whole } else { 0.0 };
    drop(finished);
    let one_each = Limits { max_leaf: 1, max_depth: MAX_DEPTH };
    let draft = copy.arranged(geometry, &plan.costs, one_each, cx)?;
    let splits = plan.builder == Builder::Sbvh;
    let before = packed(geometry, Drafted { draft, splits, remarks: plan.remarks, peak }, cx)?;
    Ok(Some(Recorded { before, rounds: log.rounds, sah }))
}

/// A tree over boxes, one in a leaf, whatever is in them; leaves refer to them by their index.
///
/// # Errors
/// Cancelled.
pub fn over_boxes(boxes: &[Aabb], cx: &BuildCx) -> Result<Draft, BuildError> {
    let boxed = |(i, b): (usize, &Aabb)| PrimBox::new(&Bounds::from(b), num::index(i));
    let mut prims: Vec<PrimBox> = boxes.iter().enumerate().map(boxed).collect();
    let binned = Binned { bins: 32, costs: Costs { c_trav: 1.0, c_isect: 1.0 } };
    let limits = Limits { max_leaf: 1, max_depth: MAX_DEPTH };
    let tree = in_place(binned, &mut prims, limits, cx)?;
    Ok(cx.pool.run(|| tree.joined(&cx.cancel))?)
}

/// What [`over_boxes`] takes while it works.
pub const fn bytes_over_boxes(boxes: usize) -> usize {
    boxes * (size_of::<Aabb>() + size_of::<PrimBox>()) + 2 * Draft::bytes(boxes)
}

fn too_large(over: OverBudget) -> BuildError {
    BuildError::Memory {
        structure: ID,
        over,
        remedy: "Raise the memory budget, or use grid, which packs no triangles.",
        fits: Fits::default(),
    }
}

impl Plan {
    fn draft(&mut self, geometry: &Geometry, prims: Vec<PrimBox>, cx: &BuildCx) -> Result<Draft, BuildError> {
        let draft = self.divided(geometry, prims, cx)?;
        if !self.needs_leaves() {
            return Ok(draft);
        }
        let draft = self.reinserted(draft, None, cx)?;
        draft.arranged(geometry, &self.costs, self.limits, cx)
    }

    /// What the builder makes, before any pass over it.
    fn divided(&self, geometry: &Geometry, mut prims: Vec<PrimBox>, cx: &BuildCx) -> Result<Draft, BuildError> {
        cx.progress.start("split", prims.len() as u64);
        let limits = self.build_limits();
        let binned = Binned { bins: self.bins, costs: self.costs };
        let tree = match self.builder {
            Builder::Median => in_place(ObjectMedian, &mut prims, limits, cx),
            Builder::Midpoint => in_place(SpatialMiddle, &mut prims, limits, cx),
            Builder::Binned => in_place(binned, &mut prims, limits, cx),
            Builder::Sweep => {
                let mut lists = cx.pool.run(|| Sweep::sorted(&prims, cx))?;
                let sweep = Sweep::new(&prims, self.costs);
                cx.pool.run(|| topdown::build(&sweep, Sweep::work(&mut lists), limits, cx))
            }
            Builder::Sbvh => {
                let root_area = prims.iter().fold(Bounds::EMPTY, |b, p| b.union(p.bounds())).half_area();
                let sbvh = Sbvh { geometry, binned, costs: self.costs, alpha: self.alpha, root_area };
                cx.pool.run(|| topdown::build(&sbvh, Work::new(std::mem::take(&mut prims), self.allowance), limits, cx))
            }
            Builder::Lbvh => {
                let codes = morton::sorted(&prims, cx)?;
                cx.pool.run(|| topdown::build(&Curve { boxes: &prims }, &codes[..], limits, cx))
            }
            Builder::Ploc => cx.pool.run(|| ploc::build(&prims, self.radius, cx)).map(Subtree::List),
        }?;
        // Before the nodes exist twice.
        drop(prims);
        Ok(cx.pool.run(|| tree.joined(&cx.cancel))?)
    }

    /// The optimised tree, unless its SAH cost is higher once leaves are chosen: the pass looks at
    /// areas only. A log of what was undone is empty.
    fn reinserted(&mut self, draft: Draft, mut log: Option<&mut Log>, cx: &BuildCx) -> Result<Draft, BuildError> {
        let Some(patience) = self.reinsertion else { return Ok(draft) };
        let mut better = Draft { nodes: draft.nodes.clone(), refs: draft.refs.clone() };
        reinsertion::optimise(&mut better, patience, log.as_deref_mut(), cx)?;
        let cost = |draft: &Draft| draft.cost(&self.costs, self.limits.max_leaf, cx);
        let (before, after) = (cost(&draft)?, cost(&better)?);
        let kept = after <= before;
        let share = if before > 0.0 { 100.0 * (1.0 - after / before) } else { 0.0 };
        let text =
            if kept { format!("it lowered the SAH cost by {share:.1} %") } else { "undone, since it gained nothing".to_owned() };
        self.remarks.push(format!("Reinsertion: {text}."));
        if let Some(log) = log.filter(|_| !kept) {
            log.rounds.clear();
        }
        Ok(if kept { better } else { draft })
    }
}

fn in_place(
    heuristic: impl Heuristic + Send,
    prims: &mut [PrimBox],
    limits: Limits,
    cx: &BuildCx,
) -> Result<Subtree, BuildError> {
    cx.pool.run(|| topdown::build(&InPlace::new(heuristic), Slice::new(prims), limits, cx))
}
