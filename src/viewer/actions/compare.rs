//! Pictures beside each other, and what they err by.

use super::List;
use crate::accel::registry;
use crate::viewer::command::Command;
use crate::viewer::panes::{Arrange, LETTERS, MOST, PaneChoice, Shows};
use crate::viewer::state::State;
use crate::viewer::tradeoffs::{Goodness, Miss, Plot};

/// One step of moving a divider.
const DIVIDER_STEP: f32 = 0.05;

/// Adds them.
pub(super) fn add(list: &mut List, state: &State) {
    let second = state.settings.panes.others.first().map(|choice| choice.entry().id);
    for entry in registry::ALL {
        let with = list.add(format!("Compare with {}", entry.name), Command::PutBeside(Some(entry.id)));
        with.if_possible(state.offers_panes() && second != Some(entry.id));
    }
    panes(list, state);
    errors(list, state);
}

/// Pictures beside each other.
fn panes(list: &mut List, state: &State) {
    let (panes, comparing) = (&state.settings.panes, state.is_comparing());
    list.add("One picture again", Command::PutBeside(None)).if_possible(!panes.others.is_empty());
    let next = panes.others.len();
    for entry in registry::ALL {
        let add = Command::PutPane(next, PaneChoice::of(entry, &state.settings));
        list.add(format!("Compare also with {}", entry.name), add).if_possible(comparing && next + 1 < MOST);
    }
    for (which, choice) in panes.on_screen().iter().enumerate() {
        let letter = LETTERS[which + 1];
        list.add(format!("Close pane {letter}"), Command::ClosePane(which)).if_possible(comparing);
        list.add(format!("Parameters of pane {letter}"), Command::TunePane(Some(which))).if_possible(comparing);
        let less = PaneChoice { shows: Shows::Difference, ..choice.clone() };
        let possible = comparing && state.settings.mode.is_heat() && choice.shows != Shows::Difference;
        list.add(format!("Difference: A less {letter}"), Command::PutPane(which, less)).if_possible(possible);
    }
    for arrange in Arrange::ALL {
        let other = comparing && arrange != panes.arrange;
        list.add(format!("Compare in: {}", arrange.label()), Command::Arrange(arrange)).if_possible(other);
    }
    let strips = comparing && panes.arrange == Arrange::Divider;
    for (which, at) in panes.places().into_iter().enumerate().filter(|_| strips) {
        for (way, by) in [("left", -DIVIDER_STEP), ("right", DIVIDER_STEP)] {
            let to = (at + by).clamp(0.0, 1.0);
            let name = format!("Divider {} to the {way}", which + 1);
            list.add(name, Command::Divider(which, to)).if_possible(to != at);
        }
    }
    list.add("Fit the shared range of colours", Command::FitRange).if_possible(state.shares_ranges());
}

/// What of errors is drawn.
fn errors(list: &mut List, state: &State) {
    let (trade, here) = (&state.tradeoffs, state.settings.workspace.shows_errors());
    for plot in Plot::ALL {
        let name = format!("Plot of errors: {}", plot.name());
        list.add(name, Command::ErrorPlot(plot)).if_possible(here && plot != trade.plot);
    }
    for miss in Miss::ALL {
        let possible = here && trade.plot == Plot::Intersection && miss != trade.miss;
        list.add(format!("Draw of intersections: {}", miss.name()), Command::Miss(miss)).if_possible(possible);
    }
    for goodness in Goodness::ALL {
        let possible = here && trade.plot == Plot::Model && goodness != trade.goodness;
        list.add(format!("Draw of structures: {}", goodness.name()), Command::Goodness(goodness)).if_possible(possible);
    }
    let image = trade.plot == Plot::Image && state.has_curves();
    let (name, table) = if state.errors.as_table { ("Errors as plots", false) } else { ("Errors as a table", true) };
    list.add(name, Command::ErrorsAsTable(table)).if_possible(image);
    let shot = state.errors.chosen.is_some();
    list.add("Back to the present picture", Command::Shot(None, false)).if_possible(here && shot);
}
