//! What is done while a workspace file is not yet open as a whole: saved, undone, another structure chosen; and what becomes of the
//! rest where a part of it cannot be hidden.

use boxwood::accel::outline::Rank;
use boxwood::accel::visibility::Written;
use boxwood::geometry::Axis;
use boxwood::viewer::workspace_file::Made;
use eframe::egui::{Key, Modifiers};

use crate::made_again::{HIGH, LOW, TEAPOT, begin, count_of_hidden, open, saved};
use crate::window::Window;

/// Large enough for its structures to take a while.
const SOUP: &str = "builtin:soup?triangles=300000";

fn written(of: u64, runs: &str) -> Written {
    serde_json::from_str(&format!(r#"{{"of": {of}, "runs": "{runs}"}}"#)).expect("as it is written")
}

fn triangles(w: &Window) -> u64 {
    w.state().model.as_ref().expect("open").geometry.triangle_count() as u64
}

#[test]
fn what_was_made_of_one_structure_is_not_saved_with_another() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("soup.boxwood");
    let mut w = open(SOUP, &path, LOW);
    let mut file = saved(&mut w, &path);
    drop(w);
    file.selected = vec![(0, 0)];
    file.made = Made { film: Some(3), volumes: true, drawn: Some("sphere".to_owned()), ..Made::default() };
    file.write(&path).expect("written");
    let mut w = begin(&path.to_string_lossy(), &path, LOW);
    w.until("the build", |s| s.model.is_some() && s.building.is_some());
    w.button("k-d tree");
    let again = saved(&mut w, &path);
    assert_eq!((again.settings.structure.as_str(), again.made, again.selected), ("kdtree", Made::default(), Vec::new()));
}

#[test]
fn a_cell_that_is_still_to_be_selected_is_saved_with_its_plane_and_its_volumes() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("cell.boxwood");
    let mut w = open(SOUP, &path, LOW);
    let mut file = saved(&mut w, &path);
    drop(w);
    // One of millions of cells is not found at once.
    file.settings.structure = "grid".to_owned();
    file.settings.params.insert("grid".to_owned(), [("density".to_owned(), "32".to_owned())].into());
    file.selected = vec![(0, 0), (0, 8_000_000)];
    file.tried = Some((Axis::Y.index(), 0.25));
    file.made = Made { volumes: true, drawn: Some("sphere".to_owned()), ..Made::default() };
    file.write(&path).expect("written");
    let mut w = begin(&path.to_string_lossy(), &path, LOW);
    w.until("the selection on its way", |s| s.tree.restoring && s.tree.selecting.is_some());
    assert!(w.state().picked.is_none() && w.state().is_busy());
    let again = saved(&mut w, &path);
    assert_eq!((&again.selected, again.tried, &again.made), (&file.selected, file.tried, &file.made));
    w.settle();
    let state = w.state();
    let ids = state.picked.as_ref().expect("selected").ids();
    assert_eq!(ids.iter().map(|id| (id.instance, id.node)).collect::<Vec<_>>(), file.selected);
    assert_eq!((state.tree.tried, state.tree.restoring, &state.error), (Some((Axis::Y, 0.25)), false, &None));
    let after = saved(&mut w, &path);
    assert_eq!((after.selected, after.tried), (file.selected, file.tried));
}

#[test]
fn nothing_is_undone_until_it_is_known_what_is_hidden_and_then_it_is_hidden_in_all_steps() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("hidden.boxwood");
    let mut w = open(SOUP, &path, LOW);
    let (mut file, of) = (saved(&mut w, &path), triangles(&w));
    drop(w);
    // So many sets that there is time before all are read.
    file.made.hidden = vec![written(of, &format!("0 {} 1000", of - 1000)); 3000];
    file.made.hidden_now = Some(0);
    file.write(&path).expect("written");
    let mut w = begin(&path.to_string_lossy(), &path, LOW);
    w.until("the model", |s| s.model.is_some() && s.is_hiding());
    w.button("Grid");
    let state = w.state();
    assert!(state.is_hiding(), "there was no time to do anything before");
    assert!(state.choices.has_back() && !state.can_undo());
    w.key(Modifiers::COMMAND, Key::Z);
    assert!(w.state().is_hiding(), "there was no time to do anything before");
    assert_eq!(w.state().settings.structure, "grid", "nothing is undone yet");
    w.until("hidden triangles", |s| s.visible().is_some());
    w.settle();
    let hidden = Some(of - 1000);
    assert_eq!((w.shown(), count_of_hidden(&w), w.state().can_undo()), (Some("grid"), hidden, true));
    w.key(Modifiers::COMMAND, Key::Z);
    w.settle();
    assert_eq!((w.shown(), count_of_hidden(&w), w.state().can_undo()), (Some("bvh"), hidden, false));
    w.key(Modifiers::COMMAND | Modifiers::SHIFT, Key::Z);
    w.settle();
    assert_eq!((w.shown(), count_of_hidden(&w)), (Some("grid"), hidden));
    // Steps are those of one model.
    w.open_path(TEAPOT);
    w.settle();
    assert!(!w.state().choices.has_back() && count_of_hidden(&w).is_none());
}

#[test]
fn a_set_that_cannot_be_hidden_takes_no_other_with_it() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("views.boxwood");
    let mut w = open(TEAPOT, &path, HIGH);
    w.key(Modifiers::NONE, Key::F2);
    w.until("the tree", |s| s.tree.outline.is_some());
    w.settle();
    w.button(Rank::References.name());
    w.settle();
    w.button("Hide");
    w.until("hidden triangles", |s| s.visible().is_some());
    w.settle();
    let hidden = count_of_hidden(&w);
    w.key(Modifiers::COMMAND, Key::D);
    let mut file = saved(&mut w, &path);
    assert_eq!((file.made.hidden.len(), file.made.hidden_now), (1, Some(0)));
    drop(w);
    // What the window hides is of another model, what the view that was kept hides is not.
    file.made.hidden.push(written(5, "2 3"));
    file.made.hidden_now = Some(1);
    file.write(&path).expect("written");
    let mut w = open(&path.to_string_lossy(), &path, HIGH);
    let error = w.state().error.clone().expect("told");
    for part in ["were hidden, 1 of 2 sets: ", "hidden in a model of 5 triangles", "The rest of the workspace is open."] {
        assert_eq!(error.matches(part).count(), 1, "{part}: {error}");
    }
    assert_eq!(count_of_hidden(&w), None);
    w.button("Dismiss");
    w.settle();
    let again = saved(&mut w, &path);
    assert_eq!((&again.made.hidden[..], again.made.hidden_now), (&file.made.hidden[..1], None));
    w.button("View");
    w.button_that_contains("Bookmarks");
    w.button("view 1 (BVH)");
    w.settle();
    assert_eq!(count_of_hidden(&w), hidden);
    // The other way round.
    file.made.hidden_now = Some(0);
    file.write(&path).expect("written");
    w.open_path(&path.to_string_lossy());
    w.until("a message", |s| s.error.is_some());
    w.settle();
    assert_eq!(count_of_hidden(&w), hidden);
}
