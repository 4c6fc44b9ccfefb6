//! The baselines: divide in the middle of the triangles, or in the middle of the space they fill
//! (Kay and Kajiya 1986, §5; Goldsmith and Salmon 1987 compare both). They ask for no cost, so every
//! leaf comes down to its size.

use super::slice::{Heuristic, Slice};
use super::topdown::Divided;
use crate::accel::{BuildCx, BuildError};

/// Half of the triangles on each side, by their centres along the axis on which these spread most.
#[derive(Clone, Copy, Debug)]
pub struct ObjectMedian;

impl Heuristic for ObjectMedian {
    fn divide<'a>(&self, slice: Slice<'a>, may_be_leaf: bool, cx: &BuildCx) -> Result<Divided<Slice<'a>>, BuildError> {
        if may_be_leaf {
            return Ok(Divided::Whole(slice));
        }
        cx.cancel.check()?;
        let axis = slice.axis();
        let (left, right) = slice.halve(axis);
        Ok(Divided::Two(left, right))
    }
}

/// The plane in the middle of the box around the centres, across its longest axis.
#[derive(Clone, Copy, Debug)]
pub struct SpatialMiddle;

impl Heuristic for SpatialMiddle {
    fn divide<'a>(&self, slice: Slice<'a>, may_be_leaf: bool, _: &BuildCx) -> Result<Divided<Slice<'a>>, BuildError> {
        let axis = slice.axis().index();
        let (min, size) = (slice.centres.min()[axis], slice.centres.size()[axis]);
        let middle = min + size * 0.5;
        // Equal centres, or so near that the middle rounds to an end, are on one side.
        if may_be_leaf || !(min < middle && middle < min + size) {
            return Ok(Divided::Whole(slice));
        }
        let (left, right) = slice.partition(|p| p.centre_twice()[axis] < middle);
        Ok(Divided::Two(left, right))
    }
}
