//! What a traversal can be watched with. The probe is a type parameter: rays that are timed are
//! compiled with [`Off`], which leaves nothing behind.

use crate::scene::PrimRef;
use crate::simd::Road;

/// Hears what a traversal does.
pub trait Probe {
    /// Whether steps are heard: finding out why a node is left out costs something.
    const LISTENS: bool = false;
    /// Whether anything is heard or counted at all.
    const WATCHES: bool = true;

    /// On which road loose triangles are looked at several at a time; `None` where each is tested by itself, as
    /// those who count or listen want it.
    #[inline(always)]
    fn road(&self) -> Option<Road> {
        None
    }

    /// What follows is below this entry of the upper level, counted from 1, or in the upper level again for 0.
    #[inline(always)]
    fn level(&mut self, instance: u32) {
        let _ = instance;
    }

    /// The node or cell entered next, by its number in [`super::CellId`].
    #[inline(always)]
    fn at(&mut self, node: u32) {
        let _ = node;
    }

    /// So many entries wait on the stack of the traversal, or of the level that it is on.
    #[inline(always)]
    fn waiting(&mut self, entries: usize) {
        let _ = entries;
    }

    /// The bounds of a node were tested, to find out whether to enter it.
    #[inline(always)]
    fn bounds(&mut self, node: u32) {
        let _ = node;
    }

    /// A node or cell is left out.
    #[inline(always)]
    fn pruned(&mut self, node: u32, why: Prune) {
        let _ = (node, why);
    }

    /// A primitive was tested and met at some t, or not met in the interval that is left.
    #[inline(always)]
    fn tested(&mut self, prim: PrimRef, t: Option<f32>) {
        let _ = (prim, t);
    }

    /// A node or cell was entered: its bounds are met and not behind the best hit.
    #[inline(always)]
    fn node(&mut self) {}

    /// The node just entered is a leaf.
    #[inline(always)]
    fn leaf(&mut self) {}

    /// A primitive was tested.
    #[inline(always)]
    fn prim(&mut self) {}

    /// A hit was found outside the cell it was found in: kept, not returned, since something in a
    /// cell between may be hit before it.
    #[inline(always)]
    fn outside(&mut self) {}
}

/// Why a node or cell is left out.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Prune {
    /// The ray misses its bounds.
    Missed,
    /// It lies before the ray's start, or beyond its end.
    Outside,
    /// It begins behind the best hit so far.
    BehindHit,
}

/// One step of a traversal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Step {
    /// What follows is in cells of this instance (see [`super::CellId`]).
    Level(u32),
    /// A node or cell was entered.
    Entered(u32),
    /// A node or cell was left out.
    Pruned(u32, Prune),
    /// A primitive was tested: where it is met, if it is in the interval that was left.
    Tested(PrimRef, Option<f32>),
    /// The hit lies outside the cell it was found in: kept, not returned.
    OutsideCell,
}

/// Counts, and tells each step to a listener if there is one.
pub struct Watched<'a> {
    /// What is counted.
    pub counts: &'a mut Counts,
    /// Who hears the steps.
    pub listener: Option<&'a mut dyn FnMut(Step)>,
}

impl std::fmt::Debug for Watched<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Watched").field("counts", &self.counts).finish_non_exhaustive()
    }
}

impl Watched<'_> {
    fn tell(&mut self, step: Step) {
        if let Some(listener) = &mut self.listener {
            listener(step);
        }
    }
}

impl Probe for Watched<'_> {
    const LISTENS: bool = true;

    fn level(&mut self, instance: u32) {
        self.counts.level(instance);
        self.tell(Step::Level(instance));
    }

    fn waiting(&mut self, entries: usize) {
        self.counts.waiting(entries);
    }

    fn at(&mut self, node: u32) {
        self.tell(Step::Entered(node));
    }

    fn pruned(&mut self, node: u32, why: Prune) {
        self.tell(Step::Pruned(node, why));
    }

    fn tested(&mut self, prim: PrimRef, t: Option<f32>) {
        self.tell(Step::Tested(prim, t));
    }

    fn node(&mut self) {
        self.counts.node();
    }

    fn leaf(&mut self) {
        self.counts.leaf();
    }

    fn prim(&mut self) {
        self.counts.prim();
    }

    fn outside(&mut self) {
        self.counts.outside();
        self.tell(Step::OutsideCell);
    }
}

/// Nobody watches.
#[derive(Clone, Copy, Debug)]
pub struct Off {
    road: Option<Road>,
}

impl Off {
    /// With the best that this processor has; asked for once a batch.
    #[inline]
    pub fn best() -> Self {
        Self { road: Some(Road::best()).filter(|road| road.is_wide()) }
    }

    /// Without instructions that not every processor has.
    pub const fn plain() -> Self {
        Self { road: None }
    }

    /// Whether it is so.
    pub const fn is_plain(&self) -> bool {
        self.road.is_none()
    }
}

impl Probe for Off {
    const WATCHES: bool = false;

    #[inline(always)]
    fn road(&self) -> Option<Road> {
        self.road
    }
}

/// How much a traversal did.
#[derive(Clone, Copy, Debug, Default)]
pub struct Counts {
    /// Nodes and cells entered, leaves among them.
    pub nodes: u64,
    /// Leaves entered.
    pub leaves: u64,
    /// Primitives tested; one that a mailbox skips is not.
    pub prims: u64,
    /// Hits found outside the cell they were found in: kept, not returned.
    pub outside: u64,
    /// The most entries that waited on the stack at once, of one ray; those of the upper level wait while a ray is below. An
    /// entry is a node that was put aside; of an octree it is a node whose octants are not all done.
    pub stack: u64,
    /// Entries that wait on the stack of the present level, and on that of the level above.
    now: u64,
    above: u64,
}

impl PartialEq for Counts {
    /// What still waits is no part of what was done.
    fn eq(&self, other: &Self) -> bool {
        let done = |c: &Self| [c.nodes, c.leaves, c.prims, c.outside, c.stack];
        done(self) == done(other)
    }
}

impl Eq for Counts {}

impl Probe for Counts {
    #[inline(always)]
    fn level(&mut self, instance: u32) {
        (self.above, self.now) = if instance == 0 { (0, self.above) } else { (self.now, 0) };
    }

    #[inline(always)]
    fn waiting(&mut self, entries: usize) {
        self.now = entries as u64;
        self.stack = self.stack.max(self.above + self.now);
    }

    #[inline(always)]
    fn node(&mut self) {
        self.nodes += 1;
    }

    #[inline(always)]
    fn leaf(&mut self) {
        self.leaves += 1;
    }

    #[inline(always)]
    fn prim(&mut self) {
        self.prims += 1;
    }

    #[inline(always)]
    fn outside(&mut self) {
        self.outside += 1;
    }
}

impl std::ops::AddAssign for Counts {
    fn add_assign(&mut self, other: Self) {
        self.nodes += other.nodes;
        self.leaves += other.leaves;
        self.prims += other.prims;
        self.outside += other.outside;
        self.stack = self.stack.max(other.stack);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_level_above_waits_while_a_ray_is_below() {
        let mut counts = Counts::default();
        counts.waiting(3);
        counts.level(7);
        counts.waiting(2);
        counts.waiting(1);
        assert_eq!(counts.stack, 5);
        counts.level(0);
        counts.level(9); // another entry of the same leaf
        counts.waiting(4);
        assert_eq!(counts.stack, 7);
        counts.level(0);
        counts.waiting(0);
        let mut sum = Counts { nodes: 2, ..Counts::default() };
        sum += counts;
        sum += Counts::default();
        assert_eq!((sum.nodes, sum.stack), (2, 7), "of several rays it is the most");
    }
}
