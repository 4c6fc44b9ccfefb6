//! What a build takes, and why it may end without a structure.

use crate::geometry::num;
use crate::geometry::tri::TestKind;
use crate::task::{Budget, Cancel, Cancelled, OverBudget, Pool, Progress, mib};

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

/// What would fit into the memory that is left.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Fits(pub Vec<Fit>);

/// A structure that would fit.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Fit {
    /// Its id, with the parameter that makes it fit.
    pub structure: String,
    /// Bytes that building it takes, about.
    pub bytes: u64,
}

impl std::fmt::Display for Fits {
    /// A sentence, after a blank; nothing if nothing was found.
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        for (i, Fit { structure, bytes }) in self.0.iter().enumerate() {
            let before = if i == 0 { " Would fit: " } else { ", " };
            write!(f, "{before}{structure} (about {})", mib(*bytes))?;
        }
        if self.0.is_empty() { Ok(()) } else { f.write_str(".") }
    }
}

/// Why there is no structure.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum BuildError {
    /// The user stopped it.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
    /// It would not fit.
    #[error("the {structure} is too large: {over}. {remedy}{fits}")]
    Memory {
        /// The structure's id.
        structure: &'static str,
        /// The figures.
        over: OverBudget,
        /// What can be done.
        remedy: &'static str,
        /// What would fit, once that was looked for.
        fits: Fits,
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
