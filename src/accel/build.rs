//! What a build takes, and why it may end without a structure.

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
}

impl BuildCx {
    /// Nothing can stop it, nobody listens, no limit on memory: for tests and small tools.
    pub fn unattended(threads: usize) -> Self {
        Self { cancel: Cancel::new(), progress: Progress::new(), pool: Pool::new("build", threads), budget: Budget::unlimited() }
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
}
