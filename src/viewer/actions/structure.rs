//! Which structure is shown, its tree, and the film of its build.

use super::{FILM_BACK, FILM_FORWARD, FILM_PLAY, List};
use crate::accel::outline::Rank;
use crate::accel::registry;
use crate::geometry::tri::TestKind;
use crate::viewer::command::Command;
use crate::viewer::filming::SPEEDS;
use crate::viewer::state::State;

/// Adds them.
pub(super) fn add(list: &mut List, state: &State) {
    for entry in registry::ALL {
        let other = entry.id != state.settings.entry().id && !state.is_measuring();
        list.add(format!("Show {}", entry.name), Command::Structure(entry.id)).if_possible(other);
    }
    for test in TestKind::ALL {
        let other = test != state.settings.test_of(state.settings.entry()) && !state.is_measuring();
        list.add(format!("Triangle test: {}", test.name()), Command::Test(test)).if_possible(other);
    }
    let outline = state.tree.outline.as_ref();
    for rank in Rank::ALL {
        let row = outline.and_then(|outline| outline.greatest(rank));
        list.add(format!("Select: {}", rank.name()), Command::SelectRow(row.unwrap_or(0))).if_possible(row.is_some());
    }
    list.add("Open all of the tree", Command::OpenBelow(0)).if_possible(outline.is_some());
    list.add("Close the tree", Command::CloseTree).if_possible(outline.is_some());
    let found = state.causes.found.iter().flat_map(|found| &found.list).enumerate();
    for (i, row) in found.filter_map(|(i, finding)| Some((i, finding.row?))) {
        list.add(format!("Show finding {}", i + 1), Command::ShowCause(row));
    }
}

/// The film of the build.
pub(super) fn film(list: &mut List, state: &State) {
    let (filming, on_screen) = (&state.filming, state.film_on_screen().is_some());
    list.add("Make the film of the build", Command::MakeFilm).if_possible(state.can_make_film());
    let playing = filming.playing.is_some();
    let (name, play) = if playing { ("Film: pause", false) } else { ("Film: play", true) };
    list.add(name, Command::PlayFilm(play)).key(FILM_PLAY).if_possible(on_screen);
    let (at, last) = (filming.at, filming.last());
    let back = list.add("Film: back", Command::FilmTo(at.saturating_sub(1)));
    back.key(FILM_BACK).if_possible(on_screen && at > 0);
    let forward = list.add("Film: forward", Command::FilmTo(at.saturating_add(1)));
    forward.key(FILM_FORWARD).if_possible(on_screen && at < last);
    list.add("Film: start", Command::FilmTo(0)).if_possible(on_screen && at > 0);
    list.add("Film: end", Command::FilmTo(last)).if_possible(on_screen && at < last);
    for (name, speed) in [("Film: faster", filming.speed * 2.0), ("Film: slower", filming.speed / 2.0)] {
        let speed = speed.clamp(*SPEEDS.start(), *SPEEDS.end());
        list.add(name, Command::FilmSpeed(speed)).if_possible(on_screen && speed != filming.speed);
    }
    list.add("Film: close", Command::CloseFilm).if_possible(filming.film.is_some());
}
