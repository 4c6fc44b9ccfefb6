//! How fast the window answers: its longest frame, and how soon a picture follows a click.

use super::format;
use super::state::State;

/// What a scripted window says of itself at the end.
#[derive(Clone, Copy, Debug, Default)]
pub struct Pace {
    /// The longest frame while something was loaded or built, in seconds of the window's thread.
    longest_busy: f64,
    /// The longest frame of all.
    longest: f64,
    /// Frames drawn.
    frames: u64,
    /// The first picture of all: seconds after its structure was shown, and its coarseness.
    first: Option<(f64, u32)>,
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
        if let Some(p) = state.picture.as_ref().map(|p| p.progress) {
            self.first.get_or_insert((p.secs, p.step));
            if p.step == 1 {
                self.full.get_or_insert(p.secs);
            }
        }
    }

    /// The same in words.
    pub fn report(&self, state: &State) -> String {
        let load = state.model.as_ref().map(|m| format!("loaded in {}; ", format::duration(m.load_secs))).unwrap_or_default();
        let build = state.shown.as_ref().map(|b| format!("{} built in {}; ", b.key.entry.id, format::duration(b.build_secs)));
        let first =
            self.first.map(|(secs, step)| format!("first picture (1/{step} resolution) {} later; ", format::duration(secs)));
        let full = self.full.map(|secs| format!("one sample a pixel after {}; ", format::duration(secs)));
        let frames = format!(
            "longest frame {} while loading or building, {} in all, of {}",
            format::duration(self.longest_busy),
            format::duration(self.longest),
            format::count(self.frames)
        );
        format!("{load}{}{}{}{frames}", build.unwrap_or_default(), first.unwrap_or_default(), full.unwrap_or_default())
    }
}
