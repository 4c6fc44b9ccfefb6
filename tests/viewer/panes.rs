//! Pictures of several structures beside each other.

use std::sync::Arc;

use boxwood::render::{Mode, Picture, Range};
use boxwood::viewer::ViewerOptions;
use boxwood::viewer::panels::split::{Place, places};
use boxwood::viewer::panes::{Arrange, Shows};
use boxwood::viewer::state::State;
use eframe::egui::{Event, Key, Modifiers, PointerButton, Role, vec2};
use egui_kittest::kittest::{NodeT, Queryable};

use crate::window::{Setup, Window};

/// A window that compares structures, as the command line opens it.
pub fn setup(ids: &[&str], arrange: Arrange, mode: Mode) -> Setup {
    let options = ViewerOptions {
        model: Some("builtin:teapot?triangles=1000".to_owned()),
        samples: Some(1),
        mode: Some(mode),
        panes: ids.iter().map(|id| (*id).to_owned()).collect(),
        arrange: Some(arrange),
        ..ViewerOptions::default()
    };
    Setup { size: vec2(1280.0, 900.0), options, ..Setup::default() }
}

pub fn compare(ids: &[&str], arrange: Arrange, mode: Mode) -> Window {
    Window::new(setup(ids, arrange, mode)).settled()
}

/// Does something that is found by its name.
pub fn by_name(w: &mut Window, name: &str) {
    w.key(Modifiers::COMMAND, Key::P);
    w.harness.event(Event::Text(name.to_owned()));
    w.step();
    w.key(Modifiers::NONE, Key::Enter);
    w.step();
}

/// The pictures on the screen, that of the shown structure first.
pub fn pictures(s: &State) -> Vec<Arc<Picture>> {
    s.picture.iter().chain(s.panes.all.iter().filter_map(|pane| pane.picture.as_ref())).cloned().collect()
}

fn union(pictures: &[Arc<Picture>]) -> Range {
    let all = pictures.iter().map(|picture| picture.suits);
    all.reduce(|a, b| Range { min: a.min.min(b.min), max: a.max.max(b.max) }).expect("some")
}

fn ids(w: &Window) -> Vec<String> {
    w.state().settings.panes.others.iter().map(|choice| choice.structure.clone()).collect()
}

pub fn place(w: &Window, which: usize) -> Place {
    places(w.viewport(), Some(&w.state().settings.panes), 1.0)[which]
}

#[test]
fn three_structures_share_one_range_and_one_legend() {
    let mut w = compare(&["bvh", "kdtree", "grid"], Arrange::Divider, Mode::Nodes);
    assert_eq!((w.shown(), w.state().panes.all.len()), (Some("bvh"), 2));
    let all = pictures(w.state());
    assert_eq!(all.len(), 3);
    let range = union(&all);
    assert!(all.iter().all(|picture| picture.range == range && picture.progress.done), "{range:?}");
    assert!(all.iter().any(|picture| picture.suits != range), "they differ by themselves");
    let legends = |w: &Window| w.texts().iter().filter(|t| t.text == "Nodes visited a ray").count();
    assert_eq!(legends(&w), 1);
    assert!(w.has(Role::Slider, "Divider of A and B") && w.has(Role::Slider, "Divider of B and C"));
    for name in ["BVH: ", "k-d tree: ", "Grid: "] {
        assert!(w.texts().iter().any(|t| t.text.starts_with(name) && t.text.contains(" spp, built in ")), "{name}");
    }
    assert!(w.harness.unnamed_widgets().is_empty(), "{:?}", w.harness.unnamed_widgets());
    let said = w.harness.get_by_role(Role::Canvas).accesskit_node().description().unwrap_or_default();
    for part in ["Compared in: Divider.", "A, BVH: ", "B, k-d tree: ", "C, Grid: ", "Colours show Nodes visited a ray"] {
        assert!(said.contains(part), "{part}: {said}");
    }
    // Colours stay while the camera moves, until somebody asks.
    w.wheel(w.viewport().center() + vec2(40.0, 0.0), 6);
    w.settle();
    let all = pictures(w.state());
    assert!(all.iter().all(|picture| picture.range == range && picture.camera == w.state().camera));
    w.button("Auto-fit");
    w.settle();
    let all = pictures(w.state());
    let range = union(&all);
    assert!(all.iter().all(|picture| picture.range == range), "{range:?}");
    // One that shows something else has a range and a legend of its own.
    w.harness.get_by_role_and_label(Role::ComboBox, "Picture of C").click();
    w.step();
    w.step();
    w.button(Mode::Prims.label());
    w.settle();
    assert_eq!(w.state().settings.panes.others[1].shows, Shows::Mode(Mode::Prims));
    assert!(legends(&w) == 1 && w.says("Primitives tested a ray"));
    let all = pictures(w.state());
    assert_eq!((all[0].range, all[2].range), (union(&all[..2]), all[2].suits));
    // One picture again has its own range.
    w.choose("and k-d tree", "No second");
    w.settle();
    let alone = w.state().picture.as_ref().expect("traced");
    assert!(w.state().panes.all.is_empty() && alone.range == alone.suits);
}

#[test]
fn panes_show_the_whole_view_and_follow_one_camera() {
    let mut w = compare(&["bvh", "kdtree"], Arrange::Two, Mode::Shaded);
    let (left, right) = (place(&w, 0).view, place(&w, 1).view);
    assert!(left.width() < 0.5 * w.viewport().width() && left.size() == right.size());
    let size = w.state().size_px;
    assert_eq!(size, [left.width() as u32, left.height() as u32]);
    let whole = |w: &Window| {
        let all = pictures(w.state());
        all.len() == 2 && all.iter().all(|p| [p.width, p.height] == size && p.camera == w.state().camera && p.progress.done)
    };
    assert!(whole(&w));
    assert_eq!(pictures(w.state())[0].rgba, pictures(w.state())[1].rgba, "structures show the same");
    assert!(
        w.state().panes.all[0].overlay.as_ref().is_some_and(|overlay| !overlay.boxes.is_empty() || !overlay.planes.is_empty())
    );
    // A drag in either pane turns both.
    for (view, by) in [(right, 50.0), (left, -80.0)] {
        let before = w.state().camera;
        w.drag(view.center(), vec2(by, 10.0), PointerButton::Primary, Modifiers::NONE);
        assert_ne!(w.state().camera, before);
        w.settle();
        assert!(whole(&w));
    }
    // The same place of either is the same place of the model.
    let mut texts = Vec::new();
    for view in [left, right] {
        w.press_in_one_frame(view.center());
        w.until("what was clicked", |s| s.picked.is_some());
        w.settle();
        texts.push(w.state().picked.as_ref().expect("clicked").text.clone());
    }
    assert_eq!(texts[0], texts[1]);
    // Four have room for two more.
    w.choose("Two panes", "Four panes");
    w.settle();
    assert!(w.says("No structure here yet.") && w.state().size_px[1] < size[1]);
    w.choose("Add C", "C: Grid");
    w.settle();
    w.choose("Add D", "D: Octree");
    w.settle();
    assert_eq!(pictures(w.state()).len(), 4);
    assert!(!w.says("No structure here yet."));
    assert!(w.harness.query_by(|n| n.role() == Role::ComboBox && n.label().as_deref() == Some("One more structure")).is_none());
    // What has no room rests, and comes back.
    w.choose("Four panes", "Two panes");
    w.settle();
    assert_eq!((w.state().panes.all.len(), ids(&w).len()), (1, 3));
}

#[test]
fn a_structure_is_compared_with_itself_of_other_parameters() {
    let mut w = compare(&["bvh", "bvh"], Arrange::Divider, Mode::Nodes);
    w.button("Parameters of B");
    w.settle();
    w.choose("auto", "sbvh");
    w.settle();
    let builder = |w: &Window| w.state().panes.all[0].built.as_ref().map(|built| built.key.params.choice("builder"));
    assert_eq!(builder(&w), Some("sbvh"));
    assert_eq!(w.state().shown.as_ref().map(|shown| shown.key.params.choice("builder")), Some("auto"));
    assert!(w.says("BVH builder=sbvh: "));
    w.key(Modifiers::COMMAND, Key::Z);
    w.settle();
    assert_eq!(builder(&w), Some("auto"));
    assert!(w.state().panes.tuned.is_some());
    w.key(Modifiers::NONE, Key::Escape);
    assert!(w.state().panes.tuned.is_none());
}

#[test]
fn what_a_structure_does_more_is_orange_and_what_the_other_does_blue() {
    let mut setup = setup(&["bvh", "kdtree"], Arrange::Two, Mode::Nodes);
    setup.options.difference = true;
    let mut w = Window::new(setup).settled();
    let pane = &w.state().panes.all[0];
    let (first, second) = (w.state().picture.clone().expect("traced"), pane.picture.clone().expect("traced"));
    let less = pane.difference.clone().expect("worked out");
    assert_eq!((less.width, less.height, less.camera), (first.width, first.height, first.camera));
    assert!(less.range.min == -less.range.max && less.range.max >= 1.0, "{:?}", less.range);
    let (a, b) = (first.amounts.as_ref().expect("asked for"), second.amounts.as_ref().expect("asked for"));
    let (mut more, mut fewer) = (0, 0);
    for (i, (a, b)) in a.values.iter().zip(&b.values).enumerate().filter(|(_, (a, b))| !a.is_nan() && !b.is_nan()) {
        let [red, blue] = [less.rgba[4 * i], less.rgba[4 * i + 2]];
        match a - b {
            d if d > 0.2 * less.range.max => {
                more += 1;
                assert!(red > blue, "{a} less {b}: {red} {blue}");
            }
            d if d < -0.2 * less.range.max => {
                fewer += 1;
                assert!(blue > red, "{a} less {b}: {red} {blue}");
            }
            _ => {}
        }
    }
    assert!(more + fewer > 100, "{more} {fewer}");
    assert!(w.says("Nodes visited a ray, A less B") && w.says(" more in k-d") && w.says(" more in BVH"));
    let said = w.harness.get_by_role(Role::Canvas).accesskit_node().description().unwrap_or_default();
    assert!(said.contains("Colours of B show Nodes visited a ray, A less B"), "{said}");
    // It follows the camera.
    w.drag(place(&w, 1).view.center(), vec2(60.0, 0.0), PointerButton::Primary, Modifiers::NONE);
    w.settle();
    assert_eq!(w.state().panes.all[0].difference.as_ref().map(|less| less.camera), Some(w.state().camera));
    // Colours that are no amounts have none.
    w.choose(Mode::Nodes.label(), Mode::Shaded.label());
    w.settle();
    assert!(w.state().panes.all[0].difference.is_none() && pictures(w.state()).iter().all(|p| p.amounts.is_none()));
}

#[test]
fn panes_are_added_closed_and_taken_back() {
    let mut w = compare(&["bvh", "kdtree"], Arrange::Divider, Mode::Nodes);
    w.choose("Add C", "C: Grid");
    w.settle();
    assert_eq!((ids(&w), pictures(w.state()).len()), (vec!["kdtree".to_owned(), "grid".to_owned()], 3));
    let grid = Arc::clone(&w.state().panes.all[1].built.as_ref().expect("built").accel);
    w.button("Close B");
    let stays = w.state().panes.all[0].built.as_ref().is_some_and(|built| Arc::ptr_eq(&built.accel, &grid));
    assert!(ids(&w) == ["grid"] && stays, "the other one goes on");
    w.settle();
    w.key(Modifiers::COMMAND, Key::Z);
    w.settle();
    assert_eq!((ids(&w), pictures(w.state()).len()), (vec!["kdtree".to_owned(), "grid".to_owned()], 3));
    w.key(Modifiers::COMMAND | Modifiers::SHIFT, Key::Z);
    w.settle();
    assert_eq!(ids(&w), ["grid"]);
    // Another structure in its place keeps what is shown.
    w.harness.get_by_role_and_label(Role::ComboBox, "Structure of B").click();
    w.step();
    w.step();
    w.button("B: Octree");
    w.settle();
    assert_eq!(ids(&w), ["octree"]);
    // Elsewhere nothing of it is held.
    w.key(Modifiers::NONE, Key::F1);
    w.settle();
    assert!(w.state().panes.all.is_empty() && ids(&w) == ["octree"]);
    w.key(Modifiers::NONE, Key::F4);
    w.settle();
    assert_eq!(pictures(w.state()).len(), 2);
}

#[test]
fn panes_are_saved_and_opened() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("lesson.boxwood");
    let mut w = Window::new(Setup { answer: Some(path.clone()), ..setup(&["bvh", "kdtree", "bvh"], Arrange::Four, Mode::Nodes) });
    w.settle();
    w.key(Modifiers::COMMAND, Key::S);
    w.until("the file", |_| path.exists());
    w.settle();
    let panes = w.state().settings.panes.clone();
    drop(w);
    let mut w = Window::with_model(&path.to_string_lossy());
    w.until("the panes", State::is_split);
    w.settle();
    assert_eq!(w.state().settings.panes, panes);
    assert_eq!(pictures(w.state()).len(), 3);
}

#[test]
fn what_is_chosen_while_measuring_is_built_afterwards() {
    let mut w = Window::new(Setup { alone: true, ..setup(&["bvh", "kdtree"], Arrange::Two, Mode::Nodes) }).settled();
    w.button("Model");
    w.button("Measure");
    w.until("it measures", State::is_measuring);
    // A structure that is chosen meanwhile is built afterwards.
    by_name(&mut w, "Compare also with Grid");
    assert_eq!(ids(&w), ["kdtree", "grid"]);
    assert!(w.state().panes.all.get(1).is_none_or(|pane| pane.built.is_none() && pane.building.is_none()));
    w.button("Cancel");
    w.settle();
    assert!(w.state().panes.all.len() == 2 && w.state().is_split() && w.state().settings.panes.arrange == Arrange::Four);
    w.button("Close C");
    w.settle();
    assert_eq!(w.state().panes.all.len(), 1);
}
