//! What a build takes, and why it may end without a structure.

use crate::geometry::num;
use crate::geometry::tri::TestKind;
use crate::task::{Budget, Cancel, Cancelled, OverBudget, Pool, Progress};

/// What every build takes besides the geometry and the parameters.
#[derive(Clone, Debug)]
pub struct BuildCx {
    /// Stops it within 100 ms.
    pub cancel: Cancel,
    /// Hears how far it is, by phase.
    pub progress: Progress,
    /// The threads it runs on.
    pub pool: Pool,
    /// Memory is asked for here before it is taken, or as it grows.
    pub budget: Budget,
    /// The most entries of a list that is indexed: as many as 32 bits number, unless a test takes less.
    pub indices: usize,
}

impl BuildCx {
    /// A build that can be stopped, listened to, and limited in memory.
    pub const fn new(cancel: Cancel, progress: Progress, pool: Pool, budget: Budget) -> Self {
        Self { cancel, progress, pool, budget, indices: num::MAX_INDEX }
    }

    /// Nothing can stop it, nobody listens, no limit on memory: for tests and small tools.
    pub fn unattended(threads: usize) -> Self {
        Self::new(Cancel::new(), Progress::new(), Pool::new("build", threads), Budget::unlimited())
    }

    /// The most entries of a list of which nodes can index so many.
    pub fn most(&self, nodes_hold: usize) -> usize {
        nodes_hold.min(self.indices)
    }
}

/// Why there is no structure.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum BuildError {
    /// The user stopped it.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
    /// It would not fit.
    #[error("the {structure} is too large: {over}. {remedy}")]
    Memory {
        /// The structure's id.
        structure: &'static str,
        /// The figures.
        over: OverBudget,
        /// What would fit.
        remedy: &'static str,
    },
    /// It would need indices of more than its nodes hold.
    #[error("the {structure} would need more than {limit} {what}. {remedy}")]
    TooMany {
        /// The structure's id.
        structure: &'static str,
        /// Of what.
        what: &'static str,
        /// The most there can be.
        limit: u64,
        /// What would fit.
        remedy: &'static str,
    },
    /// It stands in other structures.
    #[error("the {structure} does not have the triangle test '{}'. Use watertight, fast or exact, or brute for the others.", test.id())]
    NoSuchTest {
        /// The structure's id.
        structure: &'static str,
        /// The test.
        test: TestKind,
    },
}
