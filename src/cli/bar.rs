//! A progress bar on standard error, where that is a terminal; nothing otherwise.

use std::io::IsTerminal;
use std::sync::mpsc::{self, RecvTimeoutError};
use std::time::Duration;

use indicatif::{ProgressBar, ProgressStyle};

use crate::task::Progress;

/// Runs `work`, showing how far `progress` is meanwhile.
pub fn watch<R>(title: &str, progress: &Progress, work: impl FnOnce() -> R) -> R {
    if !std::io::stderr().is_terminal() {
        return work();
    }
    std::thread::scope(|scope| {
        let (working, ended) = mpsc::channel::<()>();
        let draw = move || draw_until(&ended, title, progress);
        // Without a thread there is no bar, and the work is done all the same.
        let _ = std::thread::Builder::new().name("progress-bar".to_owned()).spawn_scoped(scope, draw);
        let result = work();
        drop(working);
        result
    })
}

/// Draws until the other end of the channel is dropped.
fn draw_until(ended: &mpsc::Receiver<()>, title: &str, progress: &Progress) {
    const STEPS: u64 = 1000;
    let bar = ProgressBar::new(STEPS);
    let known = ProgressStyle::with_template("{prefix} {msg:12} {bar:40} {percent:>3} %");
    let unknown = ProgressStyle::with_template("{prefix} {msg:12} {elapsed}");
    let (Ok(known), Ok(unknown)) = (known, unknown) else { return };
    bar.set_prefix(title.to_owned());
    while ended.recv_timeout(Duration::from_millis(100)) == Err(RecvTimeoutError::Timeout) {
        let now = progress.snapshot();
        bar.set_style(if now.fraction.is_some() { known.clone() } else { unknown.clone() });
        bar.set_message(now.phase);
        let done = f64::from(now.fraction.unwrap_or(0.0)) * STEPS as f64;
        bar.set_position(crate::geometry::num::floor_index(done, STEPS as usize) as u64);
        bar.tick();
    }
    bar.finish_and_clear();
}
