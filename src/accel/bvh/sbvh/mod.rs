//! Spatial splits in bounding volume hierarchies (Stich, Friedrich and Dietrich 2009): where the
//! children of the best object split overlap much, planes that cut triangles are tried too. A cut
//! triangle is in both children, each of which bounds only its part of it.
//!
//! How many references the cuts may add is settled beforehand: each node has an allowance, spends
//! what its cut takes and shares the rest among its children by their size. So memory is bounded, and
//! the tree does not depend on the order in which threads come to its nodes.

mod clip;
mod spatial;

use super::binned::Binned;
use super::boxes::{Bounds, PrimBox};
use super::costs::Costs;
use super::slice::Slice;
use super::topdown::{Divide, Divided};
use crate::accel::{BuildCx, BuildError};
use crate::geometry::{Aabb, num};
use crate::scene::{Geometry, PrimRef};
use spatial::{Cut, Spatial};

/// A builder with spatial splits.
#[derive(Debug)]
pub struct Sbvh<'a> {
    pub geometry: &'a Geometry,
    /// The object splits.
    pub binned: Binned,
    pub costs: Costs,
    /// Cuts are tried where the children of the object split overlap by more than this share of the
    /// root's area.
    pub alpha: f64,
    /// The root's area, halved.
    pub root_area: f64,
}

/// The references of a node, and how many more its cuts may make.
#[derive(Debug)]
pub struct Work {
    refs: Vec<PrimBox>,
    bounds: Bounds,
    centres: Bounds,
    allowance: usize,
}

impl Work {
    /// Of some references, with room for so many more.
    pub fn new(mut refs: Vec<PrimBox>, allowance: usize) -> Self {
        let Slice { bounds, centres, .. } = Slice::new(&mut refs);
        Self { refs, bounds, centres, allowance }
    }

    fn apart(self, goes_left: impl Fn(&PrimBox) -> bool + Sync) -> (Self, Self) {
        let Self { mut refs, bounds, centres, allowance } = self;
        let (left, right) = Slice { prims: &mut refs, bounds, centres }.partition(goes_left);
        let (left, right) = (left.kept(), right.kept());
        split_off(refs, left, right, allowance)
    }
}

/// What is known of one side: its size and boxes.
#[derive(Clone, Copy)]
pub struct Side {
    count: usize,
    bounds: Bounds,
    centres: Bounds,
}

impl Slice<'_> {
    fn kept(&self) -> Side {
        Side { count: self.prims.len(), bounds: self.bounds, centres: self.centres }
    }
}

/// The left ones lie first in `refs`. The allowance is shared by size.
fn split_off(mut refs: Vec<PrimBox>, left: Side, right: Side, allowance: usize) -> (Work, Work) {
    let share = allowance as u128 * left.count as u128 / (left.count + right.count).max(1) as u128;
    let share = usize::try_from(share).unwrap_or(allowance);
    let others = refs.split_off(left.count);
    refs.shrink_to_fit();
    let work = |refs, side: Side, allowance| Work { refs, bounds: side.bounds, centres: side.centres, allowance };
    (work(refs, left, share), work(others, right, allowance - share))
}

impl Divide for Sbvh<'_> {
    type Work = Work;

    fn count(&self, work: &Work) -> usize {
        work.refs.len()
    }

    fn divide(&self, mut work: Work, may_be_leaf: bool, cx: &BuildCx) -> Result<Divided<Work>, BuildError> {
        let object = self.binned.best(&work.refs, &work.bounds, &work.centres, cx)?;
        let overlap = object.map_or(f64::INFINITY, |o| {
            let both = o.sides[0].intersection(o.sides[1]);
            if both.is_empty() { 0.0 } else { both.half_area() }
        });
        let cut = if work.allowance > 0 && overlap > self.alpha * self.root_area {
            Spatial { geometry: self.geometry, bins: self.binned.bins }.best(&work.refs, &work.bounds, cx)?
        } else {
            None
        };
        let (area, count) = (work.bounds.half_area(), work.refs.len());
        let pays = |children: f64| !may_be_leaf || self.costs.split(area, children) < self.costs.triangles(area, count);
        let object_cost = object.map_or(f64::INFINITY, |o| o.children);
        if let Some(cut) = cut.filter(|cut| cut.children < object_cost && pays(cut.children)) {
            work = match self.cut(work, &cut, cx)? {
                Divided::Whole(work) => work,
                two => return Ok(two),
            };
        }
        match object.filter(|o| pays(o.children)) {
            Some(object) => {
                let (left, right) = work.apart(|p| object.rule.goes_left(p));
                Ok(Divided::Two(left, right))
            }
            None => Ok(Divided::Whole(work)),
        }
    }

    fn halve(&self, mut work: Work) -> (Work, Work) {
        let (bounds, centres) = (work.bounds, work.centres);
        let axis = centres.longest_axis();
        let (left, right) = Slice { prims: &mut work.refs, bounds, centres }.halve(axis);
        let (left, right) = (left.kept(), right.kept());
        split_off(work.refs, left, right, work.allowance)
    }

    fn leaf(&self, work: Work, refs: &mut Vec<PrimRef>) -> Aabb {
        refs.extend(work.refs.iter().map(PrimBox::prim));
        work.bounds.aabb()
    }
}

impl Sbvh<'_> {
    /// Cuts the node, unless that takes more than its allowance, or leaves a side empty.
    fn cut(&self, work: Work, cut: &Cut, cx: &BuildCx) -> Result<Divided<Work>, BuildError> {
        let spatial = Spatial { geometry: self.geometry, bins: self.binned.bins };
        let (left, right) = spatial.apart(&work.refs, cut, cx)?;
        let extra = (left.len() + right.len()).saturating_sub(work.refs.len());
        if extra > work.allowance || left.is_empty() || right.is_empty() || left.len().max(right.len()) >= work.refs.len() {
            return Ok(Divided::Whole(work));
        }
        let allowance = work.allowance - extra;
        let share = allowance as u128 * left.len() as u128 / (left.len() + right.len()) as u128;
        let share = usize::try_from(share).unwrap_or(allowance);
        drop(work);
        Ok(Divided::Two(Work::new(left, share), Work::new(right, allowance - share)))
    }
}

/// References that cuts may add to so many triangles.
pub fn allowance(triangles: usize, per_triangle: f64) -> usize {
    num::floor_index(triangles as f64 * per_triangle, num::MAX_INDEX - triangles.min(num::MAX_INDEX))
}
