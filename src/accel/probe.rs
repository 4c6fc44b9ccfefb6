//! What a traversal can be watched with. The probe is a type parameter: rays that are timed are
//! compiled with [`Off`], which leaves nothing behind.

/// Hears what a traversal does.
pub trait Probe {
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

/// Nobody watches.
#[derive(Clone, Copy, Debug)]
pub struct Off;

impl Probe for Off {}

/// How much a traversal did.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counts {
    /// Nodes and cells entered, leaves among them.
    pub nodes: u64,
    /// Leaves entered.
    pub leaves: u64,
    /// Primitives tested; one that a mailbox skips is not.
    pub prims: u64,
    /// Hits found outside the cell they were found in: kept, not returned.
    pub outside: u64,
}

impl Probe for Counts {
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
    }
}
