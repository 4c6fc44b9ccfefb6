//! The stability lab: every structure and every triangle test on scenes that are known to break ray tracers, against
//! an oracle that does not round.
//!
//! ```text
//! cases ─► rays ─► oracle: what each ray passes, exactly ─► judge: what a test may report of it
//!    └───► structures ─► what they report ──────────────────┴─► rows: wrong answers, ulps, nanoseconds ─► matrix
//! ```
//!
//! The rules, and how the bounds are derived: docs/stability.md.

mod boxes;
pub mod cases;
mod dyadic;
mod ground;
mod judge;
mod matrix;
mod on_scene;
mod oracle;
mod price;
mod row;
mod shrink;
mod ulps;
mod visits;

pub use boxes::{Asker, BoxRow, BoxTest};
pub use judge::Wrong;
pub use matrix::{CaseRow, Options, check_case};
pub use on_scene::{Answers, DifferingRay, Reference, SceneRow, answers_of};
pub use price::{TestPrice, prices};
pub use row::{Row, Verdict, WrongRay};
pub use shrink::{check, shrink};
