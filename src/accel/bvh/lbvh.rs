//! The linear BVH: triangles on the Morton curve, divided where the highest bit of their codes
//! changes (Lauterbach et al. 2009). It is the tree of Karras 2012, whose nodes find their ranges
//! independently of each other for the sake of thousands of threads; few threads do better by
//! dividing subtrees side by side.

use super::boxes::PrimBox;
use super::morton::Coded;
use super::topdown::{Divide, Divided};
use crate::accel::{BuildCx, BuildError};
use crate::geometry::Aabb;
use crate::scene::PrimRef;

/// Divides ranges of the curve.
#[derive(Debug)]
pub struct Curve<'a> {
    /// What the codes' indices refer to.
    pub boxes: &'a [PrimBox],
}

impl<'a> Divide for Curve<'a> {
    type Work = &'a [Coded];

    fn count(&self, range: &Self::Work) -> usize {
        range.len()
    }

    fn divide(&self, range: Self::Work, _: bool, _: &BuildCx) -> Result<Divided<Self::Work>, BuildError> {
        let (first, last) = (range[0].0, range[range.len() - 1].0);
        let Some(bit) = (first ^ last).checked_ilog2() else { return Ok(Divided::Whole(range)) };
        let mid = range.partition_point(|(code, _)| code >> bit & 1 == 0);
        let (left, right) = range.split_at(mid);
        Ok(Divided::Two(left, right))
    }

    fn halve(&self, range: Self::Work) -> (Self::Work, Self::Work) {
        range.split_at(range.len() / 2)
    }

    fn leaf(&self, range: Self::Work, refs: &mut Vec<PrimRef>) -> Aabb {
        let boxes = range.iter().map(|(_, i)| &self.boxes[*i as usize]);
        boxes.fold(Aabb::EMPTY, |bounds, prim| {
            refs.push(prim.prim());
            bounds.union(prim.bounds().aabb())
        })
    }
}
