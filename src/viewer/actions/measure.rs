//! What is measured and checked.

use super::List;
use crate::lab::Fairness;
use crate::viewer::command::Command;
use crate::viewer::settings::Workspace;
use crate::viewer::state::State;
use crate::viewer::timings::Column;

/// Adds them.
pub(super) fn add(list: &mut List, state: &State) {
    let free = state.can_measure();
    list.add("Measure all structures", Command::Measure).if_possible(free);
    list.add("Time the tiles of the view", Command::TimeTiles).if_possible(free && state.tiles.shown);
    list.add("Look for causes of slow rays", Command::FindCauses).if_possible(free);
    list.add("Measure quality against its cost", Command::MeasureTradeoffs).if_possible(free);
    list.add("Measure time against triangles", Command::MeasureScaling).if_possible(free);
    for fairness in Fairness::ALL {
        let other = fairness != state.terms_of_timings.fairness && state.measuring.is_none();
        list.add(format!("Measure: {}", fairness.name().to_lowercase()), Command::Fairness(fairness)).if_possible(other);
    }
    for column in Column::ALL {
        list.add(format!("Sort timings by {}", column.name()), Command::SortTimings(column));
    }
    list.add("Measure what leaving out saves", Command::MeasureNeeds).if_possible(free);
    list.add("Make a reference", Command::MakeReference).if_possible(free && state.has_curves());
    list.add("Check this model", Command::CheckModel).if_possible(free);
    list.add("Run the stability lab", Command::RunLab).if_possible(!state.is_measuring() && !state.is_checking());
    let here = state.settings.workspace == Workspace::Check;
    for (i, row) in state.checks.model.iter().flat_map(|check| &check.structures).enumerate() {
        let possible = here && state.checks.marked != Some(i);
        list.add(format!("Mark the rays of {}", row.id), Command::MarkModel(Some(i))).if_possible(possible);
    }
    list.add("Mark no rays", Command::MarkModel(None)).if_possible(here && state.checks.marked.is_some());
}
