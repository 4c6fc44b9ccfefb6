//! The stability lab: every structure and every triangle test on scenes that are known to break ray tracers, against
//! an oracle that does not round.
//!
//! ```text
//! cases ─► rays ─► oracle: what each ray passes, exactly ─► judge: what a test may report of it
//!    └───► structures ─► what they report ──────────────────┴─► matrix: wrong answers, ulps, nanoseconds
//! ```
//!
//! The rules, and how the bounds are derived: docs/stability.md.

pub mod cases;
mod dyadic;
mod judge;
mod matrix;
mod oracle;
mod shrink;
mod visits;

pub use judge::Wrong;
pub use matrix::{CaseRow, Options, Row, Verdict, check_case};
pub use shrink::{check, shrink};
