//! What runs, and how it is stopped.

use crate::viewer::command::Command;
use crate::viewer::state::State;

/// Whether each of those things goes on, and how it is ended, by name: the innermost first, as Esc ends them.
pub fn running(state: &State) -> Vec<(bool, &'static str, Command)> {
    let building = state.pane_in_building().map(|(which, _)| which);
    let rays = state.ray_list.reading.is_some() || state.ray_list.tracing.is_some();
    vec![
        (state.measuring.is_some(), "Stop measuring all structures", Command::CancelMeasure),
        (state.building.is_some(), "Stop building", Command::CancelBuild),
        (state.loading.is_some(), "Stop opening the model", Command::CancelLoad),
        (state.error.is_some(), "Dismiss the message", Command::Dismiss),
        (state.needing.is_some(), "Stop measuring what leaving out saves", Command::CancelNeeds),
        (state.causes.running.is_some(), "Stop looking for causes", Command::CancelCauses),
        (state.fits.running.is_some(), "Stop comparing bounding volumes", Command::CancelFitVolumes),
        (state.tiles.running.is_some(), "Stop timing the tiles", Command::CancelTiles),
        (state.rays.following.is_some(), "Stop following the ray", Command::CancelFollow),
        (state.brute.marking, "Mark no rectangle", Command::MarkRectangle(false)),
        (state.brute.running.is_some(), "Stop comparing with brute force", Command::CancelBrute),
        (state.is_hiding(), "Stop sorting out triangles", Command::CancelHide),
        (state.filming.making.is_some(), "Stop making the film", Command::CloseFilm),
        (rays, "Stop reading or tracing the file of rays", Command::CancelRays),
        (state.panes.tuned.is_some(), "Close the parameters of the pane", Command::TunePane(None)),
        (building.is_some(), "Stop building a pane", Command::ClosePane(building.unwrap_or_default())),
        (state.checks.checking.is_some(), "Stop checking the model", Command::CancelCheck),
        (state.errors.making.is_some(), "Stop making the reference", Command::CancelReference),
        (state.tradeoffs.running.is_some(), "Stop measuring quality against its cost", Command::CancelTradeoffs),
        (state.tradeoffs.growing.is_some(), "Stop measuring time against triangles", Command::CancelScaling),
        (state.exports.report.is_some(), "Stop making the report", Command::CancelReport),
        (state.tour.is_some(), "Leave the tour", Command::Tour(None)),
    ]
}
