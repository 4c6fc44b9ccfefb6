//! How far a piece of work is, by phase, and how long each phase took.

use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Instant;

/// Written by the work, read by whoever shows it. Clones refer to the same work.
#[derive(Clone, Debug, Default)]
pub struct Progress(Arc<Inner>);

#[derive(Debug, Default)]
struct Inner {
    done: AtomicU64,
    total: AtomicU64,
    phases: Mutex<Vec<Started>>,
}

#[derive(Debug)]
struct Started {
    name: &'static str,
    at: Instant,
    secs: Option<f64>,
}

/// A phase that is over, or the one that runs.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct Phase {
    /// A short name in the imperative or the progressive: `parse`, `bin`, `sort`.
    pub name: &'static str,
    /// Wall-clock seconds from its start to its end, or to now.
    pub secs: f64,
}

/// What there is to show at this moment.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Snapshot {
    /// The running phase, empty before the first.
    pub phase: &'static str,
    /// The share of the running phase that is done, 0 to 1, where its total is known.
    pub fraction: Option<f32>,
}

impl Progress {
    /// Nothing has started yet.
    pub fn new() -> Self {
        Self::default()
    }

    /// Ends the running phase and starts the next. `total` is in whatever unit [`Self::advance`]
    /// counts; 0 where it cannot be known.
    pub fn start(&self, name: &'static str, total: u64) {
        let mut phases = self.0.phases.lock().unwrap_or_else(PoisonError::into_inner);
        end(&mut phases);
        phases.push(Started { name, at: Instant::now(), secs: None });
        self.0.done.store(0, Ordering::Relaxed);
        self.0.total.store(total, Ordering::Relaxed);
    }

    /// Counts `n` units of the running phase as done.
    pub fn advance(&self, n: u64) {
        self.0.done.fetch_add(n, Ordering::Relaxed);
    }

    /// Ends the last phase and returns the seconds of every phase in order.
    pub fn finish(&self) -> Vec<Phase> {
        let mut phases = self.0.phases.lock().unwrap_or_else(PoisonError::into_inner);
        end(&mut phases);
        phases.iter().map(|p| Phase { name: p.name, secs: p.secs.unwrap_or(0.0) }).collect()
    }

    /// The state at this moment.
    pub fn snapshot(&self) -> Snapshot {
        let phases = self.0.phases.lock().unwrap_or_else(PoisonError::into_inner);
        let total = self.0.total.load(Ordering::Relaxed);
        let done = self.0.done.load(Ordering::Relaxed);
        Snapshot {
            phase: phases.last().map_or("", |p| p.name),
            fraction: (total > 0).then(|| (done as f64 / total as f64).min(1.0) as f32),
        }
    }
}

fn end(phases: &mut [Started]) {
    if let Some(last) = phases.last_mut() {
        last.secs.get_or_insert_with(|| last.at.elapsed().as_secs_f64());
    }
}
