//! What a pass took: rays, and thread time by what it went to.

use std::time::{Duration, Instant};

/// The work of a pass, or of several. Times are those of all threads together.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Work {
    /// Rays traced, of all kinds.
    pub rays: u64,
    /// Finding what they hit.
    pub tracing: Duration,
    /// Light at what they hit.
    pub shading: Duration,
    /// Making rays and adding up samples.
    pub rest: Duration,
    /// Contributions of light that were cut down ([`super::Transport::clamp`]).
    pub clamped: u64,
    /// The light that they lost: sums of red, green and blue.
    pub lost: f64,
}

impl std::ops::AddAssign for Work {
    fn add_assign(&mut self, other: Self) {
        self.rays += other.rays;
        self.tracing += other.tracing;
        self.shading += other.shading;
        self.rest += other.rest;
        self.clamped += other.clamped;
        self.lost += other.lost;
    }
}

impl std::ops::Add for Work {
    type Output = Self;

    fn add(mut self, other: Self) -> Self {
        self += other;
        self
    }
}

/// A watch that is read between the parts of a thread's work.
pub(super) struct Watch(Instant);

impl Watch {
    pub fn start() -> Self {
        Self(Instant::now())
    }

    /// Adds the time since it was last read.
    pub fn lap(&mut self, to: &mut Duration) {
        let now = Instant::now();
        *to += now - self.0;
        self.0 = now;
    }
}
