//! What dividing a node would have cost: the surface area heuristic over all candidate planes on
//! three axes, beside the cost of a leaf and of the division that was chosen (MacDonald and Booth
//! 1990). Costs are per line through the node: `C_trav + C_isect (A_l n_l + A_r n_r) / A`.

use std::ops::ControlFlow;

use super::division::{Alternative, Division, Sorted, alternatives, cost_of};
use crate::accel::cell::{Cell, Descend, Layout, walk_below};
use crate::accel::params::{ParamValues, Value};
use crate::accel::stats::SahWeights;
use crate::accel::{Accel, Split};
use crate::geometry::{Aabb, Axis, Clipped};
use crate::scene::{Geometry, PrimRef};
use crate::task::{Cancel, Cancelled};
use glam::Vec3;

/// A candidate: where it crosses the node, from 0 to 1 along its axis, and what it would cost.
pub type Candidate = (f64, f64);

/// The costs of dividing one node.
#[derive(Clone, Debug, PartialEq)]
pub struct SahCurves {
    /// Candidates on each axis, by place; thinned out to what a plot can show, the cheapest kept.
    pub axes: [Vec<Candidate>; 3],
    /// The planes that a builder with buckets looks at, on each axis.
    pub buckets: [Vec<Candidate>; 3],
    /// The cost of not dividing.
    pub leaf: f64,
    /// What the structure's own division costs; none for a leaf.
    pub chosen: Option<Chosen>,
    /// What other rules would have chosen.
    pub others: Vec<Alternative>,
    /// Triangles below the node.
    pub triangles: usize,
    /// What is weighed, by axis.
    sorted: [Sorted; 3],
}

impl SahCurves {
    /// The division by any plane across an axis, at a place from 0 to 1.
    pub fn at(&self, axis: Axis, place: f64) -> Division {
        self.sorted[axis.index()].at(place.clamp(0.0, 1.0))
    }

    /// Where a place along an axis is in the space of the node.
    pub fn position(&self, axis: Axis, place: f64) -> f32 {
        self.sorted[axis.index()].position(place)
    }
}

/// The structure's own division.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Chosen {
    /// The axis and the place, where a plane divides the children's centres.
    pub plane: Option<(Axis, f64)>,
    /// Its cost, from the children as they are.
    pub cost: f64,
}

/// Nodes with more triangles are not looked at: the plot would come too late.
const MOST: usize = 2_000_000;
/// Points of a curve.
const POINTS: usize = 256;
/// Candidates between two looks at whether to stop.
const PER_CHECK: usize = 1 << 12;
/// Nodes with more children are lists rather than divisions.
const MOST_CHILDREN: usize = 1 << 12;
/// Buckets where the builder has none.
const BINS: u32 = 16;

/// Works the curves out, in the weights that the structure was built with; `None` for nodes without area, with too many
/// triangles, or with fewer than two.
///
/// # Errors
/// [`Cancelled`] if asked to stop.
pub fn of_node(accel: &dyn Accel, node: &Cell, params: &ParamValues, cancel: &Cancel) -> Result<Option<SahCurves>, Cancelled> {
    let weights = SahWeights::of(params);
    let bounds = *node.shape.bounds();
    let layout = accel.layout_of(node.id.instance);
    let partition = layout == Layout::Partition;
    // The upper level holds instances, not triangles.
    if accel.levels().is_some() && node.id.instance == 0 {
        return Ok(None);
    }
    let Some(prims) = below(accel, node, cancel)? else { return Ok(None) };
    if prims.len() < 2 || bounds.area() <= 0.0 {
        return Ok(None);
    }
    let geometry = accel.geometry_of(node.id.instance);
    // Where triangles are cut only the part in the cell counts, as builders have it.
    let cut = partition || layout == Layout::SplitHierarchy;
    let of = |corners: [Vec3; 3]| if cut { Clipped::new(&corners, &bounds).bounds() } else { Aabb::of_triangle(&corners) };
    let boxes: Vec<Aabb> = prims.iter().map(|p| of(geometry.corners(*p))).filter(|b| !b.is_empty()).collect();
    let sort = |axis| {
        cancel.check()?;
        Ok(if partition {
            Sorted::by_faces(bounds, &boxes, axis, (weights, bonus(params)))
        } else {
            Sorted::by_centres(bounds, &boxes, axis, weights)
        })
    };
    let [x, y, z] = Axis::ALL.map(sort);
    let sorted = [x?, y?, z?];
    let bins = if let Some(Value::Int(bins)) = params.get("bins") { bins } else { BINS };
    let candidate = |division: &Division| (division.plane.1, division.cost);
    let mut axes = [const { Vec::new() }; 3];
    let mut exact: Option<Division> = None;
    for (sorted, curve) in sorted.iter().zip(&mut axes) {
        cancel.check()?;
        let cheaper = |division: &Division| {
            if exact.is_none_or(|best| division.cost < best.cost) {
                exact = Some(*division);
            }
        };
        let looked = |at: usize| if at.is_multiple_of(PER_CHECK) { cancel.check() } else { Ok(()) };
        let one = |(at, division): (usize, Division)| looked(at).map(|()| candidate(&division));
        *curve = thinned(sorted.candidates().inspect(cheaper).enumerate().map(one).collect::<Result<_, _>>()?);
    }
    let buckets = [0, 1, 2].map(|k| sorted[k].buckets(bins).iter().map(candidate).collect());
    let others = alternatives(&sorted, &boxes, (exact, bins), cancel)?;
    let chosen = chosen(accel, node, &sorted, (weights, if partition { bonus(params) } else { 0.0 }), cancel)?;
    let leaf = weights.c_isect * boxes.len() as f64;
    Ok(Some(SahCurves { axes, buckets, leaf, chosen, others, triangles: boxes.len(), sorted }))
}

/// The share of the cost that a k-d tree forgives where a plane cuts off nothing but emptiness.
fn bonus(params: &ParamValues) -> f64 {
    if let Some(Value::Float(bonus)) = params.get("empty_bonus") { bonus } else { 0.0 }
}

/// All triangles below a node, each once; `None` if there are too many.
fn below(accel: &dyn Accel, node: &Cell, cancel: &Cancel) -> Result<Option<Vec<PrimRef>>, Cancelled> {
    let mut prims = Vec::new();
    let mut stopped = Ok(());
    walk_below(accel, *node, &mut |cell| {
        stopped = cancel.check();
        accel.prims(cell, &mut |p| prims.push(p));
        if stopped.is_err() || prims.len() > MOST { ControlFlow::Break(()) } else { ControlFlow::Continue(Descend::Yes) }
    });
    stopped?;
    prims.sort_unstable();
    prims.dedup();
    Ok((prims.len() <= MOST).then_some(prims))
}

/// What the children that there are cost.
fn chosen(
    accel: &dyn Accel,
    node: &Cell,
    sorted: &[Sorted; 3],
    (weights, bonus): (SahWeights, f64),
    cancel: &Cancel,
) -> Result<Option<Chosen>, Cancelled> {
    let mut children = Vec::new();
    accel.children(node, &mut |child| {
        children.push(child);
        if children.len() > MOST_CHILDREN { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    });
    if children.is_empty() || children.len() > MOST_CHILDREN {
        return Ok(None);
    }
    let mut sum = 0.0;
    let mut sides = Vec::new();
    for child in &children {
        let Some(prims) = below(accel, child, cancel)? else { return Ok(None) };
        sum += child.shape.area() * prims.len() as f64;
        sides.push(prims);
    }
    let forgiven = if sides.iter().any(Vec::is_empty) && matches!(node.split, Some(Split::Axis { .. })) { bonus } else { 0.0 };
    let cost = cost_of(weights, sum / node.shape.area(), forgiven);
    let plane = match (node.split, &sides[..]) {
        (Some(Split::Axis { axis, pos }), _) => Some((axis, pos)),
        (_, [left, right]) => {
            Axis::ALL.into_iter().find_map(|axis| between(accel.geometry_of(node.id.instance), axis, left, right))
        }
        _ => None,
    };
    let at = |(axis, pos): (Axis, f32)| (axis, sorted[axis.index()].place(pos));
    Ok(Some(Chosen { plane: plane.map(at), cost }))
}

/// The middle between the centres of both sides on an axis that divides them.
fn between(geometry: &Geometry, axis: Axis, left: &[PrimRef], right: &[PrimRef]) -> Option<(Axis, f32)> {
    let centre = |p: &PrimRef| Aabb::of_triangle(&geometry.corners(*p)).centre()[axis.index()];
    let range =
        |prims: &[PrimRef]| prims.iter().map(centre).fold((f32::INFINITY, f32::NEG_INFINITY), |(a, b), x| (a.min(x), b.max(x)));
    let (l, r) = (range(left), range(right));
    match () {
        () if l.1 <= r.0 => Some((axis, 0.5 * (l.1 + r.0))),
        () if r.1 <= l.0 => Some((axis, 0.5 * (r.1 + l.0))),
        () => None,
    }
}

/// At most [`POINTS`] candidates: the cheapest of each stretch.
fn thinned(candidates: Vec<Candidate>) -> Vec<Candidate> {
    if candidates.len() <= POINTS {
        return candidates;
    }
    let stretch = candidates.len().div_ceil(POINTS);
    candidates.chunks(stretch).filter_map(|c| c.iter().copied().min_by(|a, b| a.1.total_cmp(&b.1))).collect()
}
