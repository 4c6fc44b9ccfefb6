//! States without a window: what compared pictures share, and what becomes of them where memory is short.

use std::sync::mpsc::channel;

use super::*;
use crate::accel::registry;
use crate::geometry::tri::TestKind;
use crate::task::Budget;
use crate::viewer::command::Command;
use crate::viewer::panes::{Arrange, PaneChoice, Shows};
use crate::viewer::settings::{BoxColor, OverlaySettings};

/// Nobody is asked for a file.
struct NoDialog;

impl FileDialog for NoDialog {
    fn pick(&self, _: Arc<dyn Fn() + Send + Sync>) -> Receiver<Option<PathBuf>> {
        channel().1
    }

    fn save(&self, _: &str, _: Arc<dyn Fn() + Send + Sync>) -> Receiver<Option<PathBuf>> {
        channel().1
    }
}

/// A structure that shows what A does.
fn beside(id: &str) -> PaneChoice {
    PaneChoice { structure: id.to_owned(), ..PaneChoice::default() }
}

/// A structure that shows something of its own.
fn showing(id: &str, mode: Mode) -> PaneChoice {
    PaneChoice { shows: Shows::Mode(mode), ..beside(id) }
}

/// A BVH of the teapot with others beside it, at rest, and the memory that they take.
fn compare(others: Vec<PaneChoice>) -> (State, Budget) {
    let budget = Budget::unlimited();
    let shared = Shared::new(Pool::new("work", 2), budget.clone(), Arc::new(|| {}));
    let mut settings = Settings { workspace: Workspace::Compare, max_samples: 1, ..Settings::default() };
    (settings.panes.arrange, settings.panes.others) = (Arrange::Four, others);
    let mut state = State::new(settings, shared, Box::new(NoDialog), Graphics::None).expect("threads");
    state.size_px = [64, 48];
    state.carry_out(Command::Open("builtin:teapot".to_owned()));
    settle(&mut state);
    assert!(state.is_split(), "{:?}", state.error);
    (state, budget)
}

/// Takes in what jobs bring until nothing is going on.
fn settle(state: &mut State) {
    let start = Instant::now();
    let mut quiet = 0;
    while quiet < 2 {
        assert!(start.elapsed() < Duration::from_secs(60), "waited in vain; error: {:?}", state.error);
        state.advance();
        quiet = if state.is_busy() { 0 } else { quiet + 1 };
        std::thread::sleep(Duration::from_millis(2));
    }
    state.shared.wait_for_memory();
}

fn do_it(state: &mut State, command: Command) {
    state.carry_out(command);
    settle(state);
}

fn color_by(state: &mut State, color: BoxColor) {
    let overlay = OverlaySettings { color, boxes: true, ..state.settings.overlay };
    do_it(state, Command::Overlay(overlay));
}

/// What a pane's structure is built from.
fn key_of(state: &State, which: usize) -> Key {
    state.panes.all[which].built.as_ref().expect("built").key.clone()
}

#[test]
fn pictures_of_one_structure_share_one_list_of_cells() {
    let (mut state, _) = compare(vec![beside("bvh"), beside("kdtree"), beside("kdtree")]);
    color_by(&mut state, BoxColor::Triangles);
    let first = state.tree.outline.clone().expect("listed");
    assert_eq!(Arc::strong_count(&first), 3, "A's, B's and this one");
    let beside = state.panes.outline_of(&key_of(&state, 1)).expect("listed");
    assert_eq!(Arc::strong_count(&beside), 3, "C's, D's and this one");
    // A takes the list of a structure that stands beside it already.
    do_it(&mut state, Command::Structure("kdtree"));
    assert!(state.tree.outline.as_ref().is_some_and(|outline| Arc::ptr_eq(outline, &beside)));
    assert_eq!((Arc::strong_count(&beside), Arc::strong_count(&first)), (4, 2), "of the other one B is left");
}

#[test]
fn pictures_of_one_structure_share_what_was_counted() {
    let (mut state, _) = compare(vec![beside("bvh"), beside("kdtree"), beside("kdtree")]);
    color_by(&mut state, BoxColor::Visits);
    let count = |state: &State, which: usize| {
        let of = state.visited_view(&key_of(state, which));
        let visits = state.panes.visits_of(&of).expect("counted");
        let first = state.visiting.found_of(&of).is_some_and(|first| Arc::ptr_eq(&first, &visits));
        (first, Arc::strong_count(&visits) - 1)
    };
    assert_eq!((count(&state, 0), count(&state, 1)), ((true, 2), (false, 2)), "A and B, C and D");
    do_it(&mut state, Command::Structure("kdtree"));
    assert_eq!((count(&state, 0), count(&state, 1)), ((false, 1), (true, 3)), "B; A, C and D");
    // Of another view they are counted anew, once of each structure.
    state.camera.eye *= 1.1;
    settle(&mut state);
    assert_eq!((count(&state, 0), count(&state, 1)), ((false, 1), (true, 3)));
}

#[test]
fn lists_that_did_not_fit_are_made_once_there_is_memory() {
    let (mut state, budget) = compare(vec![beside("bvh"), beside("kdtree")]);
    budget.set_limit(budget.used() + 1000);
    color_by(&mut state, BoxColor::Triangles);
    let listed = |state: &State| [0, 1].map(|which| state.panes.outline_of(&key_of(state, which)).is_some());
    assert!(state.tree.failed.is_some() && listed(&state) == [false, false]);
    assert!(state.error.take().is_some_and(|error| error.contains("Can't colour the boxes of ")));
    do_it(&mut state, Command::Memory(Some(1 << 10)));
    assert!(state.tree.outline.is_some() && listed(&state) == [true, true], "{:?}", state.tree.failed);
    assert_eq!(state.error, None);
}

#[test]
fn a_list_beside_takes_the_room_of_structures_that_are_only_kept() {
    let bvh = registry::find("bvh").expect("registered");
    let test = bvh.tests().find(|test| *test != TestKind::default()).expect("several");
    let (mut state, budget) = compare(vec![PaneChoice { test, ..beside("bvh") }]);
    let before = budget.used();
    for id in ["kdtree", "grid", "bvh"] {
        do_it(&mut state, Command::Structure(id));
    }
    let spare = budget.used() - before;
    assert!(spare > 100_000 && state.kept_structures().count() == 4, "{spare} bytes");
    // A's list stays, that beside goes.
    color_by(&mut state, BoxColor::Triangles);
    assert!(state.tree.outline.as_ref().is_some_and(|outline| outline.len() < 1 << 14), "one step of its charge");
    color_by(&mut state, BoxColor::Depth);
    assert!(state.tree.outline.is_some() && state.panes.outline_of(&key_of(&state, 0)).is_none());
    // A step takes 541 kB: there is room for it without the others alone.
    budget.set_limit(budget.used() - spare + 600_000);
    color_by(&mut state, BoxColor::Triangles);
    assert!(state.panes.outline_of(&key_of(&state, 0)).is_some() && state.error.is_none(), "{:?}", state.error);
    let kept: Vec<Key> = state.kept_structures().map(|built| built.key.clone()).collect();
    assert!(kept.len() < 4 && kept.contains(&key_of(&state, 0)) && kept.contains(&state.wanted_key()), "{kept:?}");
}

#[test]
fn a_range_goes_with_the_pictures_that_it_was_set_for() {
    let (mut state, budget) = compare(vec![showing("bvh", Mode::Nodes)]);
    let set = |state: &mut State| {
        let range = Range { min: 500.0, max: 900.0 };
        do_it(state, Command::HeatRange(Some(range)));
        assert_eq!(state.panes.all[0].picture.as_ref().map(|picture| picture.range), Some(range));
    };
    let suits = |state: &State| {
        let picture = state.panes.all[0].picture.as_ref().expect("traced");
        state.range.is_none() && picture.range == picture.suits
    };
    do_it(&mut state, Command::PutPane(0, showing("bvh", Mode::Prims)));
    set(&mut state);
    do_it(&mut state, Command::Undo);
    assert!(state.heat_kind() == Some(Mode::Nodes) && suits(&state));
    set(&mut state);
    do_it(&mut state, Command::Redo);
    assert!(state.heat_kind() == Some(Mode::Prims) && suits(&state));
    // What has no room on the screen has no range either.
    do_it(&mut state, Command::PutPane(0, beside("bvh")));
    do_it(&mut state, Command::PutPane(1, showing("bvh", Mode::Nodes)));
    state.carry_out(Command::HeatRange(Some(Range { min: 500.0, max: 900.0 })));
    do_it(&mut state, Command::Arrange(Arrange::Two));
    assert!(state.heat_kind().is_none() && state.range.is_none());
    // Nor has what cannot be built.
    do_it(&mut state, Command::PutPane(0, showing("bvh", Mode::Nodes)));
    set(&mut state);
    budget.set_limit(0);
    state.carry_out(Command::PutPane(0, showing("kdtree", Mode::Nodes)));
    assert!(state.range.is_some(), "another structure, and the same amounts");
    state.settings.panes.others.truncate(1);
    settle(&mut state);
    assert!(state.settings.panes.others.is_empty() && state.range.is_none());
    assert!(state.error.as_ref().is_some_and(|error| error.starts_with("Can't build k-d tree beside: ")), "{:?}", state.error);
}
