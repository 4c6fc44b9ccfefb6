//! How a loader keeps pace: it counts the work that it does, tells it to whoever shows the
//! progress, and looks at the cancel flag every so often.

use super::LoadCx;
use crate::task::Cancelled;

/// Units of work, about a byte each, between two looks at the cancel flag: a few milliseconds even
/// where a byte takes 50 ns.
const EVERY: u64 = 1 << 16;

pub(super) struct Pace<'a> {
    cx: &'a LoadCx,
    pending: u64,
}

impl<'a> Pace<'a> {
    pub fn new(cx: &'a LoadCx) -> Self {
        Self { cx, pending: 0 }
    }

    /// Counts `units` of work as done.
    #[inline]
    pub fn step(&mut self, units: usize) -> Result<(), Cancelled> {
        self.pending += units as u64;
        if self.pending >= EVERY { self.look() } else { Ok(()) }
    }

    #[cold]
    fn look(&mut self) -> Result<(), Cancelled> {
        self.cx.progress.advance(self.pending);
        self.pending = 0;
        self.cx.cancel.check()
    }
}
