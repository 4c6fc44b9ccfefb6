//! How the amounts of a heat map are spread, in its colours.

use super::Titles;
use crate::lab::plot::Columns;
use crate::render::colormap::viridis;
use crate::viewer::panels::heat;
use crate::viewer::state::State;

/// The histogram of the heat map on the screen, with the ends of its colours.
pub fn heat(state: &State, title: &Titles<'_>) -> Option<Columns> {
    let (shown, structure) = (heat::on_screen(state)?, state.shown.as_ref()?.key.entry.name);
    let histogram = &shown.amounts.histogram;
    Some(Columns {
        title: title(&format!("{structure}, how amounts are spread")),
        axes: [shown.name, "pixels; heights are square roots".to_owned()],
        width: f64::from(histogram.width),
        counts: histogram.counts.clone(),
        ends: [shown.range.min, shown.range.max].map(f64::from),
        colors: viridis,
    })
}
