//! What was made of a model is made again when its workspace file is opened: hidden triangles, the list of rays, the film, volumes
//! around a node, times of tiles; and figures are looked at as before.

use std::path::Path;

use boxwood::accel::outline::Rank;
use boxwood::geometry::Ray;
use boxwood::lab::Fairness;
use boxwood::lab::follow::to_text;
use boxwood::render::{Mode, Range};
use boxwood::viewer::settings::Workspace;
use boxwood::viewer::timings::Column;
use boxwood::viewer::tradeoffs::Plot;
use boxwood::viewer::workspace_file::{Look, Made, RaysFile, WorkspaceFile};
use eframe::egui::{Event, Key, Modifiers, Role, vec2};
use egui_kittest::kittest::Queryable;

use crate::window::{Setup, Window};

pub const TEAPOT: &str = "builtin:teapot?triangles=1000";

/// High enough for everything of the panels to be in sight.
pub const HIGH: f32 = 2400.0;
pub const LOW: f32 = 800.0;

/// A window whose file dialogs answer with this path, as soon as it is there.
pub fn begin(model: &str, answer: &Path, height: f32) -> Window {
    let mut setup = Setup { size: vec2(1280.0, height), answer: Some(answer.to_path_buf()), ..Setup::default() };
    setup.options.model = Some(model.to_owned());
    Window::new(setup)
}

/// The same, settled.
pub fn open(model: &str, answer: &Path, height: f32) -> Window {
    begin(model, answer, height).settled()
}

/// Saves the window to a file that is not there yet, and reads that.
pub fn saved(w: &mut Window, path: &Path) -> WorkspaceFile {
    let _ = std::fs::remove_file(path);
    w.key(Modifiers::COMMAND, Key::S);
    w.until("the file", |_| path.exists());
    WorkspaceFile::read(&path.to_string_lossy()).expect("just written")
}

/// Writes some rays through the model, straight down.
fn write_rays(w: &Window, path: &Path) {
    let bounds = w.state().model.as_ref().expect("open").bounds();
    let above = bounds.centre() + glam::Vec3::Z * 2.0 * bounds.size().max_element();
    let ray = |i: u8| Ray::new(above + glam::Vec3::X * bounds.size().x * (f32::from(i) / 10.0 - 0.5), glam::Vec3::NEG_Z);
    let lines: String = (0..=10).map(|i| format!("{}\n", to_text(&ray(i)))).collect();
    std::fs::write(path, lines).expect("written");
}

pub fn count_of_hidden(w: &Window) -> Option<u64> {
    w.state().visible().map(|visible| visible.count())
}

/// Chooses how figures are shown: the terms and the order of timings, the range of a heat map, and a plot.
fn choose_looks(w: &mut Window) {
    w.choose("Shaded", Mode::Nodes.label());
    w.settle();
    w.choose(Fairness::LikeForLike.name(), Fairness::Best.name());
    w.button("Sort by Mrays/s");
    w.click(Role::SpinButton, "Least amount");
    w.key(Modifiers::COMMAND, Key::A);
    w.harness.event(Event::Text("2".to_owned()));
    w.step();
    w.key(Modifiers::NONE, Key::Enter);
    w.key(Modifiers::NONE, Key::F4);
    w.button(Plot::Model.name());
    let state = w.state();
    assert!(state.range.is_some_and(|range| range.min == 2.0) && state.tradeoffs.plot == Plot::Model);
    assert_eq!((state.terms_of_timings.fairness, state.terms_of_timings.column), (Fairness::Best, Column::Rate));
}

/// Hides the fullest leaf in a view that is kept, then shows the deepest alone; returns how many are hidden in each.
fn hide_some(w: &mut Window) -> [Option<u64>; 2] {
    w.button(Rank::References.name());
    w.settle();
    w.button("Hide");
    w.until("hidden triangles", |s| s.visible().is_some());
    w.settle();
    w.key(Modifiers::COMMAND, Key::D);
    let first = count_of_hidden(w);
    w.button(Rank::Depth.name());
    w.settle();
    w.button("Isolate");
    w.until("isolated triangles", |s| s.visible().map(|visible| visible.count()) != first);
    w.settle();
    [first, count_of_hidden(w)]
}

#[test]
fn nothing_that_was_made_is_lost_between_saving_and_opening() {
    let folder = tempfile::tempdir().expect("a folder");
    let [path, rays] = ["lesson.boxwood", "down.rays"].map(|name| folder.path().join(name));
    let mut w = open(TEAPOT, &path, HIGH);
    choose_looks(&mut w);
    // A file of rays, of which one is followed.
    write_rays(&w, &rays);
    w.open_path(&rays.to_string_lossy());
    w.until("the list", |s| s.ray_list.traced.is_some());
    w.settle();
    w.harness.get_by_role_and_label(Role::List, "Rays of the file").focus();
    w.step();
    for _ in 0..2 {
        w.key(Modifiers::NONE, Key::ArrowDown);
        w.settle();
    }
    w.until("its steps", |s| !s.rays.columns.is_empty());
    w.settle();
    let followed = w.state().ray_list.row(1).expect("a row").0;
    assert_eq!(w.state().ray_list.chosen, Some(1));
    // The film, hidden triangles, and volumes around a node.
    w.key(Modifiers::NONE, Key::F2);
    w.until("the tree", |s| s.tree.outline.is_some());
    w.settle();
    w.button("Make the film");
    w.until("the film", |s| s.filming.film.is_some());
    w.settle();
    (0..3).for_each(|_| w.button("Forward"));
    let hidden = hide_some(&mut w);
    w.button(Rank::Overlap.name());
    w.settle();
    w.button("Compare bounding volumes");
    w.until("volumes", |s| s.fitting().is_some());
    w.settle();
    w.button("26-DOP");
    w.settle();
    let before = saved(&mut w, &path);
    assert_eq!(w.state().error, None);
    assert_eq!((before.made.hidden.len(), before.made.hidden_now), (2, Some(0)));
    let rays = Some(RaysFile { path: rays.to_string_lossy().into_owned(), followed: Some(followed) });
    assert_eq!((&before.made.rays, before.made.film, before.made.volumes), (&rays, Some(3), true));
    let compared = |w: &Window| w.state().overlay.as_ref().map_or(0, |overlay| overlay.compared.len());
    assert!(compared(&w) > 12);
    drop(w);

    // Another window makes it all again, and would save the same.
    let mut w = open(&path.to_string_lossy(), &path, HIGH);
    let state = w.state();
    assert_eq!((&state.error, state.settings.workspace), (&None, Workspace::Structure));
    assert_eq!((state.filming.film.is_some(), state.filming.at), (true, 3));
    assert_eq!((state.fitting().is_some(), state.fits.drawn), (true, Some("kdop26")));
    assert!(compared(&w) > 12);
    assert_eq!(count_of_hidden(&w), hidden[1]);
    let after = saved(&mut w, &path);
    assert_eq!((&after.look, &after.made), (&before.look, &before.made));
    assert_eq!(after.selected, before.selected);
    let look = after.look.expect("said");
    assert!(look.plot == Plot::Model && look.range.is_some_and(|range| range.min == 2.0));
    assert_eq!((look.terms.fairness, look.terms.column), (Fairness::Best, Column::Rate));
    // The view that was kept has its own hidden triangles, and the file of rays the same row.
    w.button("View");
    w.button_that_contains("Bookmarks");
    w.button("view 1 (BVH)");
    w.settle();
    assert_eq!(count_of_hidden(&w), hidden[0]);
    w.key(Modifiers::NONE, Key::F3);
    w.until("the list", |s| s.ray_list.traced.is_some());
    w.settle();
    let list = &w.state().ray_list;
    assert_eq!((list.chosen, list.row(1).map(|row| row.0)), (Some(1), Some(followed)));
    assert_eq!(w.state().rays.ray, list.row(1).map(|row| row.1));
}

#[test]
fn tiles_are_timed_again_where_they_were() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("tiles.boxwood");
    let mut setup = Setup { size: vec2(1280.0, 800.0), alone: true, answer: Some(path.clone()), ..Setup::default() };
    setup.options.model = Some(TEAPOT.to_owned());
    let mut w = Window::new(setup).settled();
    w.choose("Shaded", "Nanoseconds by tile");
    let untimed = saved(&mut w, &path);
    w.settle();
    w.button("Time the tiles");
    w.until("times", |s| s.tiles.found.is_some());
    w.settle();
    let timed = saved(&mut w, &path);
    let tiles = |file: &WorkspaceFile| (file.look.as_ref().is_some_and(|look| look.tiles), file.made.tiles);
    assert_eq!((tiles(&untimed), tiles(&timed)), ((true, false), (true, true)));
    w.settle();
    for (file, timed) in [(&untimed, false), (&timed, true)] {
        file.write(&path).expect("written");
        w.open_path(TEAPOT);
        w.settle();
        w.choose("Nanoseconds by tile", "Shaded");
        w.settle();
        w.open_path(&path.to_string_lossy());
        w.until("the workspace", |s| s.tiles.shown);
        w.settle();
        assert_eq!((w.state().tiles.found.is_some(), w.state().shows_tiles()), (timed, timed));
        assert_eq!(w.says("Not timed."), !timed);
    }
}

#[test]
fn what_cannot_be_made_again_is_told_and_the_rest_opens() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("odd.boxwood");
    let mut w = open(TEAPOT, &path, LOW);
    let mut file = saved(&mut w, &path);
    w.settle();
    file.look = Some(Look {
        range: Some(Range { min: 5.0, max: 1.0 }),
        shared: vec![(Mode::Nodes, Range { min: 1.0, max: 1.0 })],
        plot: Plot::Scaling,
        film_speed: Some(1e30),
        ray_speed: Some(-4.0),
        ..Look::default()
    });
    let gone = folder.path().join("gone.rays").to_string_lossy().into_owned();
    file.made = Made {
        hidden: vec![serde_json::from_str(r#"{"of": 5, "runs": "2 3"}"#).expect("as it is written")],
        hidden_now: Some(0),
        rays: Some(RaysFile { path: gone, followed: Some(3) }),
        film: Some(u32::MAX),
        tiles: false,
        volumes: true,
        drawn: Some("cube".to_owned()),
    };
    file.write(&path).expect("written");
    w.open_path(&path.to_string_lossy());
    w.until("a message", |s| s.error.is_some());
    w.settle();
    let state = w.state();
    let error = state.error.clone().expect("told");
    let volumes = "Can't compare bounding volumes again: the node that they were around is not selected.";
    for part in ["gone.rays", "hidden in a model of 5 triangles", volumes] {
        assert_eq!(error.matches(part).count(), 1, "{part}: {error}");
    }
    assert_eq!(error.matches("The rest of the workspace is open.").count(), 3, "{error}");
    assert!(state.visible().is_none() && state.ray_list.file.is_none() && state.fitting().is_none());
    assert_eq!((state.fits.drawn, state.tradeoffs.plot, state.settings.workspace), (None, Plot::Scaling, Workspace::View));
    assert_eq!((state.filming.speed, state.rays.speed), (10_000.0, 0.5));
    assert!(state.range.is_some_and(|range| range.min == 5.0 && range.max > 5.0));
    assert!(state.filming.film.is_some() && state.filming.at == state.filming.last(), "there is no later position");
    // It is told once.
    w.button("Dismiss");
    w.settle();
    assert_eq!(w.state().error, None);
    // A set that there is not is hidden nowhere.
    (file.made, file.look) = (Made { hidden_now: Some(7), ..Made::default() }, None);
    file.write(&path).expect("written");
    w.open_path(TEAPOT);
    w.settle();
    w.open_path(&path.to_string_lossy());
    w.settle();
    assert_eq!((&w.state().error, count_of_hidden(&w)), (&None, None));
    assert_eq!(w.state().tradeoffs.plot, Plot::Scaling, "what a file does not say stays");
}

#[test]
fn a_film_that_a_structure_has_not_and_volumes_of_a_node_that_is_not_there_are_told() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("grid.boxwood");
    let mut w = open(TEAPOT, &path, LOW);
    let mut file = saved(&mut w, &path);
    w.settle();
    file.settings.structure = "grid".to_owned();
    file.selected = vec![(0, 0), (0, u32::MAX)];
    file.made = Made { film: Some(3), volumes: true, ..Made::default() };
    file.write(&path).expect("written");
    w.open_path(&path.to_string_lossy());
    w.until("the grid", |s| s.shown.as_ref().is_some_and(|shown| shown.key.entry.id == "grid"));
    w.settle();
    let error = w.state().error.clone().expect("told");
    for part in ["Can't make the film again: this structure has none.", "Can't compare bounding volumes again: the node"] {
        assert_eq!(error.matches(part).count(), 1, "{part}: {error}");
    }
    assert!(w.state().filming.film.is_none() && w.state().fitting().is_none());
    w.button("Dismiss");
    w.settle();
    assert_eq!(w.state().error, None, "it is told once");
}

#[test]
fn a_file_that_is_saved_before_all_is_made_again_holds_it_all_the_same() {
    let folder = tempfile::tempdir().expect("a folder");
    let [path, rays] = ["large.boxwood", "down.rays"].map(|name| folder.path().join(name));
    let mut w = open("builtin:soup?triangles=300000", &path, LOW);
    write_rays(&w, &rays);
    let triangles = w.state().model.as_ref().expect("open").geometry.counts().triangles;
    let mut file = saved(&mut w, &path);
    drop(w);
    let runs = format!(r#"{{"of": {triangles}, "runs": "1000 200 {}"}}"#, triangles - 1200);
    file.selected = vec![(0, 0)];
    file.made = Made {
        hidden: vec![serde_json::from_str(&runs).expect("as it is written")],
        hidden_now: Some(0),
        rays: Some(RaysFile { path: rays.to_string_lossy().into_owned(), followed: Some(4) }),
        film: Some(3),
        tiles: false,
        volumes: true,
        drawn: Some("sphere".to_owned()),
    };
    file.write(&path).expect("written");
    let mut w = begin(&path.to_string_lossy(), &path, LOW);
    w.until("the build", |s| s.model.is_some() && s.building.is_some());
    let again = saved(&mut w, &path);
    assert_eq!((&again.made, &again.look), (&file.made, &file.look));
    w.settle();
    let state = w.state();
    assert_eq!((&state.error, state.filming.at, state.fits.drawn), (&None, 3, Some("sphere")));
    assert!(state.filming.film.is_some() && state.fitting().is_some());
    assert_eq!(count_of_hidden(&w), Some(200));
}
