//! How fast the window answers: its longest frame, and how soon a picture follows a click.

use std::time::Duration;

use super::format;
use super::state::{Answer, State};
use crate::lab::statistics::median;

/// A frame whose work takes longer is late.
const LATE: Duration = Duration::from_millis(16);
/// Times of work are counted in steps of this many microseconds.
const BIN_US: u128 = 100;
/// Steps; what takes longer is in the last.
const BINS: usize = 10_000;
/// The part of all frames that [`OwnWork::usual`] covers.
const USUAL: f64 = 0.99;

/// What a scripted window says of itself at the end.
#[derive(Clone, Debug, Default)]
pub struct Pace {
    /// The longest frame while something was loaded or built, in seconds of the window's thread.
    longest_busy: f64,
    /// The longest frame of all.
    longest: f64,
    /// Frames drawn.
    frames: u64,
    /// The longest that the window's thread worked for a frame, tessellation included, besides having it drawn.
    own_longest: Duration,
    /// Frames for which it worked longer than [`LATE`].
    own_late: u64,
    /// Frames by how long it worked for them.
    own_work: OwnWork,
    /// The first picture of all.
    first: Option<Answer>,
    /// How soon the first picture came after each change of the camera.
    turns: Vec<Answer>,
    /// The same for switches to structures that are kept.
    switches: Vec<Answer>,
    /// Seconds to the first picture of full resolution.
    full: Option<f64>,
}

impl Pace {
    /// Takes note of a frame that took `secs` of the window's thread.
    pub fn frame(&mut self, secs: Option<f64>, state: &State) {
        let secs = secs.unwrap_or(0.0);
        self.frames += 1;
        self.longest = self.longest.max(secs);
        if state.loading.is_some() || state.building.is_some() {
            self.longest_busy = self.longest_busy.max(secs);
        }
        self.first = self.first.or(state.answer);
        if let Some(p) = state.picture.as_ref().map(|p| p.progress)
            && p.step == 1
        {
            self.full.get_or_insert(p.secs);
        }
    }

    /// Takes note of how long the window's thread worked for a frame besides having it drawn: waiting for a picture, or for
    /// a processor that others have, is no work.
    pub fn own_work(&mut self, time: Duration) {
        self.own_longest = self.own_longest.max(time);
        self.own_late += u64::from(time > LATE);
        self.own_work.add(time);
    }

    /// Takes note of the answer to a change of the camera.
    pub fn turned(&mut self, answer: Answer) {
        self.turns.push(answer);
    }

    /// Takes note of the answer to a switch to a kept structure.
    pub fn switched(&mut self, answer: Answer) {
        self.switches.push(answer);
    }

    /// The same in words.
    pub fn report(&self, state: &State) -> String {
        let load = state.model.as_ref().map(|m| format!("loaded in {}; ", format::duration(m.load_secs))).unwrap_or_default();
        let build = state.shown.as_ref().map(|b| format!("{} built in {}; ", b.key.entry.id, format::duration(b.build_secs)));
        let first = self.first.map(|a| format!("first picture (1/{} resolution) {} later; ", a.step, format::duration(a.secs)));
        let full = self.full.map(|secs| format!("one sample a pixel after {}; ", format::duration(secs)));
        let frames = format!(
            "longest frame {} while loading or building, {} in all, of {}; work of the window's thread, tessellation included, {} at most, {} or less in 99 % of them, more than 16 ms in {}{}",
            format::duration(self.longest_busy),
            format::duration(self.longest),
            format::count(self.frames),
            format::duration(self.own_longest.as_secs_f64()),
            format::or_missing(self.own_work.usual(), |time| format::duration(time.as_secs_f64())),
            format::count(self.own_late),
            crate::sys::peak_memory_bytes()
                .map(|peak| format!("; at most {} of memory", format::bytes(peak)))
                .unwrap_or_default()
        );
        let turns = answers("after a turn of the camera", &self.turns);
        let switches = answers("after a switch to a kept structure", &self.switches);
        format!(
            "{load}{}{}{}{turns}{switches}{frames}",
            build.unwrap_or_default(),
            first.unwrap_or_default(),
            full.unwrap_or_default()
        )
    }
}

/// Frames by how long the window's thread worked for them.
#[derive(Clone, Debug, Default)]
struct OwnWork(Vec<u32>);

impl OwnWork {
    fn add(&mut self, time: Duration) {
        self.0.resize(BINS, 0);
        let bin = usize::try_from(time.as_micros() / BIN_US).unwrap_or(BINS);
        self.0[bin.min(BINS - 1)] += 1;
    }

    /// What it worked at most for 99 of 100 frames; nothing before the first frame, and where that is beyond the last step.
    fn usual(&self) -> Option<Duration> {
        let most = USUAL * self.0.iter().map(|n| f64::from(*n)).sum::<f64>();
        let mut so_far = 0.0;
        let bin = self.0.iter().take(BINS - 1).position(|n| {
            so_far += f64::from(*n);
            so_far >= most && so_far > 0.0
        })?;
        Some(Duration::from_micros(u64::try_from((bin as u128 + 1) * BIN_US).unwrap_or(u64::MAX)))
    }
}

/// The median and the longest of some answers.
fn answers(what: &str, answers: &[Answer]) -> String {
    let Some(coarsest) = answers.iter().map(|a| a.step).max() else { return String::new() };
    let secs: Vec<f64> = answers.iter().map(|a| a.secs).collect();
    let longest = secs.iter().copied().fold(0.0, f64::max);
    let (usual, longest, n) = (format::duration(median(&secs)), format::duration(longest), secs.len());
    format!("{what} {usual}, at most {longest} (n = {n}, 1/{coarsest} resolution or finer); ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ninety_nine_of_a_hundred_frames_are_within() {
        let mut work = OwnWork::default();
        assert_eq!(work.usual(), None);
        (1..=100).for_each(|ms| work.add(Duration::from_millis(ms) / 2));
        // The hundredth is longer: 50 ms.
        assert_eq!(work.usual(), Some(Duration::from_micros(49_600)));
        (0..10).for_each(|_| work.add(Duration::from_secs(2)));
        assert_eq!(work.usual(), None, "one in a hundred takes longer than is told apart");
    }
}
