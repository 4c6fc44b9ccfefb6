//! What colours of amounts stand for.

use super::format;
use super::state::State;
use crate::render::Range;
use crate::render::colormap::{difference, viridis};

/// Colours from one end of a range, 0, to the other, 1.
pub type Colors = fn(f32) -> [f32; 3];

/// What colours of amounts stand for.
pub struct Heat {
    /// What they are amounts of.
    pub name: String,
    /// The colours.
    pub colors: Colors,
    /// What their ends stand for.
    pub ends: [String; 2],
    /// The same as amounts.
    pub range: Range,
}

impl Heat {
    /// Colours of a range.
    pub fn new(name: String, range: Range, colors: Colors) -> Self {
        Self { name, colors, ends: [range.min, range.max].map(|end| format::number(end.into())), range }
    }
}

/// What the colours of the shown structure's picture stand for, if they are those of amounts.
pub fn heat(state: &State) -> Option<Heat> {
    if state.is_held() && state.errors.chosen.is_some_and(|chosen| chosen.difference) {
        let range = state.on_screen()?.range;
        return Some(Heat::new("Brightness less the reference's".to_owned(), range, |t| difference(2.0 * t - 1.0)));
    }
    let each = state.settings.heat_rays.each();
    if state.shows_tiles() {
        return Some(Heat::new(format!("Nanoseconds {each}, by tile"), state.on_screen()?.range, viridis));
    }
    let range = state.picture.as_ref().filter(|_| state.settings.mode.is_heat())?.range;
    Some(Heat::new(format!("{} {each}", state.settings.mode.label()), range, viridis))
}
