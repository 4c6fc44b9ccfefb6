//! What every long function takes: a way to stop it, a place to report how far it is, a limit on
//! the memory it may take, and the threads it runs on.

mod budget;
mod cancel;
mod pool;
mod progress;
pub mod sort;

pub use budget::{Budget, Charge, OverBudget, mib};
pub use cancel::{Cancel, Cancelled};
pub use pool::Pool;
pub use progress::{Phase, Progress, Snapshot};
