//! The threads a piece of work runs on. Builds, rendering and loading have pools of their own, so
//! that one never waits for the other's chunks.

use std::sync::Arc;

/// A named pool of worker threads. Clones share the threads.
#[derive(Clone, Debug)]
pub struct Pool(Arc<rayon::ThreadPool>);

impl Pool {
    /// `threads` workers called `name-0`, `name-1`, …; 0 means one for each core.
    ///
    /// Falls back to the fewest threads the system grants; with none it runs on the caller's.
    pub fn new(name: &'static str, threads: usize) -> Self {
        let threads = if threads == 0 { crate::sys::cores() } else { threads };
        let build = |n: usize| {
            let named = rayon::ThreadPoolBuilder::new().thread_name(move |i| format!("{name}-{i}"));
            if n == 0 { named.num_threads(1).use_current_thread() } else { named.num_threads(n) }.build()
        };
        let pool = build(threads).or_else(|_| build(1)).or_else(|_| build(0));
        Self(Arc::new(pool.unwrap_or_else(|e| unreachable!("a pool on the caller's own thread: {e}"))))
    }

    /// Runs `work` on the pool and waits for it; parallel iterators inside use its threads.
    pub fn run<R: Send>(&self, work: impl FnOnce() -> R + Send) -> R {
        self.0.install(work)
    }

    /// The number of workers.
    pub fn threads(&self) -> usize {
        self.0.current_num_threads()
    }
}
