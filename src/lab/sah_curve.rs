//! What dividing a node would have cost: the surface area heuristic over all candidate planes on
//! three axes, beside the cost of a leaf and of the division that was chosen (MacDonald and Booth
//! 1990). Costs are per line through the node: `C_trav + C_isect (A_l n_l + A_r n_r) / A`.

use std::ops::ControlFlow;

use crate::accel::cell::{Cell, Descend, Layout, walk_below};
use crate::accel::stats::SahWeights;
use crate::accel::{Accel, Split};
use crate::geometry::{Aabb, Axis};
use crate::scene::{Geometry, PrimRef};
use crate::task::{Cancel, Cancelled};

/// A candidate: where it crosses the node, from 0 to 1 along its axis, and what it would cost.
pub type Candidate = (f64, f64);

/// The costs of dividing one node.
#[derive(Clone, Debug, PartialEq)]
pub struct SahCurves {
    /// Candidates on each axis, by place; thinned out to what a plot can show, the cheapest kept.
    pub axes: [Vec<Candidate>; 3],
    /// The cost of not dividing.
    pub leaf: f64,
    /// What the structure's own division costs; none for a leaf.
    pub chosen: Option<Chosen>,
    /// Triangles below the node.
    pub triangles: usize,
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

/// Works the curves out; `None` for nodes without area, with too many triangles, or with fewer than
/// two.
///
/// # Errors
/// [`Cancelled`] if asked to stop.
pub fn of_node(accel: &dyn Accel, node: &Cell, weights: SahWeights, cancel: &Cancel) -> Result<Option<SahCurves>, Cancelled> {
    let bounds = *node.shape.bounds();
    let partition = matches!(accel.layout(), Layout::Partition);
    let Some(prims) = below(accel, node, cancel)? else { return Ok(None) };
    if prims.len() < 2 || bounds.area() <= 0.0 {
        return Ok(None);
    }
    let geometry = accel.geometry_of(node.id.instance);
    let clip = |b: Aabb| if partition { b.intersection(bounds) } else { b };
    let boxes: Vec<Aabb> = prims.iter().map(|p| clip(Aabb::of_triangle(&geometry.corners(*p)))).collect();
    let mut axes = [const { Vec::new() }; 3];
    for (axis, curve) in Axis::ALL.into_iter().zip(&mut axes) {
        cancel.check()?;
        let node = Node { bounds, boxes: &boxes, axis, weights };
        *curve = thinned(if partition { node.planes() } else { node.centres() });
    }
    let chosen = chosen(accel, node, weights, cancel)?;
    let leaf = weights.c_isect * boxes.len() as f64;
    Ok(Some(SahCurves { axes, leaf, chosen, triangles: boxes.len() }))
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

/// A node and the boxes in it, along one axis.
struct Node<'a> {
    bounds: Aabb,
    boxes: &'a [Aabb],
    axis: Axis,
    weights: SahWeights,
}

impl Node<'_> {
    fn cost(&self, children: f64) -> f64 {
        self.weights.c_trav + self.weights.c_isect * children / self.bounds.area()
    }

    fn place(&self, x: f32) -> f64 {
        let k = self.axis.index();
        let (min, size) = (f64::from(self.bounds.min[k]), f64::from(self.bounds.size()[k]));
        if size > 0.0 { (f64::from(x) - min) / size } else { 0.0 }
    }

    /// A hierarchy's candidates: between every two neighbouring centres.
    fn centres(&self) -> Vec<Candidate> {
        let k = self.axis.index();
        let mut order: Vec<&Aabb> = self.boxes.iter().collect();
        order.sort_unstable_by(|a, b| a.centre_twice()[k].total_cmp(&b.centre_twice()[k]));
        let mut right = vec![0.0; order.len()];
        let mut side = Aabb::EMPTY;
        for (i, b) in order.iter().enumerate().rev() {
            side = side.union(**b);
            right[i] = side.area() * (order.len() - i) as f64;
        }
        let mut left = Aabb::EMPTY;
        let candidate = |(i, b): (usize, &&Aabb)| {
            left = left.union(**b);
            let place = self.place(0.5 * (b.centre()[k] + order[i + 1].centre()[k]));
            (place, self.cost(left.area() * (i + 1) as f64 + right[i + 1]))
        };
        order.iter().enumerate().take(order.len() - 1).map(candidate).collect()
    }

    /// A partition's candidates: every face of every box inside the cell.
    fn planes(&self) -> Vec<Candidate> {
        let k = self.axis.index();
        let sorted = |of: fn(&Aabb) -> glam::Vec3| {
            let mut ends: Vec<f32> = self.boxes.iter().map(|b| of(b)[k]).collect();
            ends.sort_unstable_by(f32::total_cmp);
            ends
        };
        let (starts, ends) = (sorted(|b| b.min), sorted(|b| b.max));
        let mut planes: Vec<f32> = starts.iter().chain(&ends).copied().collect();
        planes.sort_unstable_by(f32::total_cmp);
        planes.dedup();
        planes.retain(|x| self.bounds.min[k] < *x && *x < self.bounds.max[k]);
        let candidate = |pos: f32| {
            // One that lies in the plane counts below.
            let flat = starts.partition_point(|s| *s <= pos) - starts.partition_point(|s| *s < pos);
            let touching = ends.partition_point(|e| *e <= pos) - ends.partition_point(|e| *e < pos);
            let below = starts.partition_point(|s| *s < pos) + flat.min(touching);
            let above = ends.len() - ends.partition_point(|e| *e <= pos);
            let (low, high) = self.bounds.split(self.axis, pos);
            (self.place(pos), self.cost(low.area() * below as f64 + high.area() * above as f64))
        };
        planes.into_iter().map(candidate).collect()
    }
}

/// What the children that there are cost.
fn chosen(accel: &dyn Accel, node: &Cell, weights: SahWeights, cancel: &Cancel) -> Result<Option<Chosen>, Cancelled> {
    let mut children = Vec::new();
    accel.children(node, &mut |child| {
        children.push(child);
        ControlFlow::Continue(())
    });
    if children.is_empty() {
        return Ok(None);
    }
    let mut sum = 0.0;
    let mut sides = Vec::new();
    for child in &children {
        let Some(prims) = below(accel, child, cancel)? else { return Ok(None) };
        sum += child.shape.area() * prims.len() as f64;
        sides.push(prims);
    }
    let cost = weights.c_trav + weights.c_isect * sum / node.shape.area();
    let bounds = node.shape.bounds();
    let plane = match (node.split, &sides[..]) {
        (Some(Split::Axis { axis, pos }), _) => Some((axis, pos)),
        (_, [left, right]) => {
            Axis::ALL.into_iter().find_map(|axis| between(accel.geometry_of(node.id.instance), axis, left, right))
        }
        _ => None,
    };
    let at = |(axis, pos): (Axis, f32)| {
        let node = Node { bounds: *bounds, boxes: &[], axis, weights };
        (axis, node.place(pos))
    };
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
