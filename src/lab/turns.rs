//! Rounds in turns: A B C, B C A, C A B, so that whatever drifts meanwhile (clock speed, temperature,
//! another program) meets everybody.

use super::MeasureOptions;
use crate::task::{Cancel, Cancelled, Pool, Progress};

/// What [`Racer::share_done`] is of one that has enough.
pub const DONE: u64 = 1000;

/// One that does timed rounds.
pub trait Racer {
    /// Does one and takes the time.
    fn round(&mut self, pool: &Pool, cancel: &Cancel) -> Result<(), Cancelled>;

    /// How much of what it needs it has, in thousandths.
    fn share_done(&self, options: &MeasureOptions) -> u64;
}

/// The same of rounds that took so long.
pub fn share(secs: &[f64], options: &MeasureOptions) -> u64 {
    let rounds = secs.len() as f64 / options.min_rounds.max(1) as f64;
    let total = secs.iter().sum::<f64>() / options.min_secs.max(1e-9);
    crate::geometry::num::floor_index(rounds.min(total).min(1.0) * 1000.0, 1000) as u64
}

/// Goes round until everybody has enough.
pub fn take(
    racers: &mut [&mut dyn Racer],
    options: &MeasureOptions,
    pool: &Pool,
    cancel: &Cancel,
    progress: &Progress,
) -> Result<(), Cancelled> {
    let n = racers.len();
    for first in 0.. {
        if racers.iter().all(|racer| racer.share_done(options) >= DONE) {
            break;
        }
        for i in 0..n {
            let racer = &mut racers[(first + i) % n];
            let before = racer.share_done(options);
            if before < DONE {
                racer.round(pool, cancel)?;
                progress.advance(racer.share_done(options) - before);
            }
        }
    }
    Ok(())
}
