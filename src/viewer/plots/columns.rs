//! How the amounts of a heat map are spread, in its colours.

use super::Titles;
use crate::lab::plot::Columns;
use crate::render::colormap::viridis;
use crate::viewer::panels::heat::{self, Shown};
use crate::viewer::state::State;

/// The histogram of the heat map on the screen, with the ends of its colours.
pub fn heat(state: &State, title: &Titles<'_>) -> Option<Columns> {
    let Shown { of, name, spread } = heat::on_screen(state)?;
    let structures = of.iter().map(|entry| entry.name).collect::<Vec<_>>().join(", ");
    Some(Columns {
        title: title(&format!("{structures}, how amounts are spread")),
        axes: [name, "pixels; heights are square roots".to_owned()],
        width: f64::from(spread.histogram.width),
        counts: spread.histogram.counts,
        ends: [spread.range.min, spread.range.max].map(f64::from),
        colors: viridis,
    })
}
