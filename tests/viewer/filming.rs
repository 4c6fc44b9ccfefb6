//! The film of the build, in the Structure workspace.

use std::time::Duration;

use boxwood::viewer::settings::Workspace;
use eframe::egui::{Key, Modifiers, PointerButton, Role, vec2};
use egui_kittest::kittest::Queryable;

use crate::window::{Setup, Window};

/// A window in the Structure workspace with the cells listed.
fn open(model: &str) -> Window {
    let mut setup = Setup { size: vec2(1280.0, 800.0), ..Setup::default() };
    setup.options.model = Some(model.to_owned());
    let mut w = Window::new(setup).settled();
    w.button("Structure workspace");
    w.until("the cells are listed", |s| s.tree.outline.is_some());
    w.settle();
    w
}

fn make(w: &mut Window) {
    w.button("Make the film");
    w.until("the film", |s| s.filming.film.is_some());
    w.settle();
}

/// Boxes of the present event, and those that stand out.
fn drawn(w: &mut Window) -> (usize, usize) {
    w.settle();
    let lit = w.state().overlay.as_ref().map_or(0, |overlay| overlay.lit.len());
    (w.state().collected.total, lit)
}

#[test]
fn the_build_is_stepped_forward_and_back() {
    let mut w = open("builtin:teapot?triangles=1000");
    let before = drawn(&mut w);
    assert!(w.says("The build, in reconstructed order."));
    make(&mut w);
    let film = w.state().filming.film.clone().expect("made");
    assert!(w.says("Reconstructed order") && w.says(&film.tell(0)));
    assert_eq!((w.state().filming.at, drawn(&mut w)), (0, (1, 0)), "the root alone");
    w.button("Forward");
    assert_eq!((w.state().filming.at, drawn(&mut w)), (1, (2, 3)), "its children, and all three stand out");
    assert!(w.says(&film.tell(1)));
    w.key(Modifiers::NONE, Key::Period);
    assert_eq!((w.state().filming.at, drawn(&mut w)), (2, (3, 3)));
    w.key(Modifiers::NONE, Key::Comma);
    assert_eq!((w.state().filming.at, drawn(&mut w)), (1, (2, 3)));
    w.button("Back");
    assert_eq!(drawn(&mut w), (1, 0));
    w.harness.get_by_role_and_label(Role::Slider, "Event").set_value_accesskit(7.0);
    w.harness.run_steps(2);
    assert_eq!((w.state().filming.at, drawn(&mut w).0), (7, 8));
    w.button("End");
    let (total, lit) = drawn(&mut w);
    let leaves = w.state().shown.as_ref().and_then(|shown| shown.stats.clone()).expect("counted").leaves;
    assert_eq!((w.state().filming.at, lit), (film.last(), 3));
    assert!(total as u64 == leaves || w.state().collected.more, "{total} of {leaves}");
    w.button("Start");
    assert_eq!(drawn(&mut w), (1, 0));
    let unnamed = w.harness.unnamed_widgets();
    assert!(unnamed.is_empty(), "{}", unnamed.join("\n"));
    w.button("Close the film");
    assert_eq!(drawn(&mut w), before, "as it was");
    assert!(w.state().filming.film.is_none() && w.has(Role::Button, "Make the film"));
}

#[test]
fn it_plays_at_any_speed_and_is_paused() {
    let mut w = open("builtin:teapot?triangles=1000");
    make(&mut w);
    w.button("Play");
    w.until("two events", |s| s.filming.at >= 2);
    w.key(Modifiers::NONE, Key::K);
    let at = w.state().filming.at;
    assert!(w.state().filming.playing.is_none());
    std::thread::sleep(Duration::from_millis(300));
    w.step();
    assert_eq!(w.state().filming.at, at);
    w.set_number("Speed of the film", "10000");
    assert_eq!(w.state().filming.speed, 10_000.0);
    w.button("Play");
    w.until("the end", |s| s.filming.at == s.filming.last());
    w.step();
    assert!(w.state().filming.playing.is_none(), "at the end it rests");
    // From the end it begins anew; another workspace lets it rest.
    w.set_number("Speed of the film", "1");
    w.button("Play");
    assert!(w.state().filming.playing.is_some() && w.state().filming.at < 10);
    w.button("View workspace");
    assert!(w.state().filming.playing.is_none());
}

#[test]
fn the_plot_is_clicked_and_the_boxes_are_those_of_its_workspace() {
    let mut w = open("builtin:teapot?triangles=1000");
    let before = drawn(&mut w);
    make(&mut w);
    let plot = w.harness.get_by_role_and_label(Role::Image, "SAH cost over the film").rect();
    w.drag(plot.center(), vec2(0.0, 0.0), PointerButton::Primary, Modifiers::NONE);
    w.settle();
    let (at, last) = (w.state().filming.at, w.state().filming.last());
    assert!(at.abs_diff(last / 2) <= last / 20, "{at} of {last}");
    assert_eq!(drawn(&mut w).0 as u32, at + 1);
    w.button("View workspace");
    assert_eq!(drawn(&mut w), before);
    w.button("Structure workspace");
    assert_eq!(drawn(&mut w).0 as u32, at + 1);
    // Another structure has another.
    w.button("k-d tree");
    w.until("its cells", |s| s.shown.as_ref().is_some_and(|b| b.key.entry.id == "kdtree") && s.tree.outline.is_some());
    w.settle();
    assert!(w.state().filming.film.is_none());
    make(&mut w);
    w.button("Forward");
    w.settle();
    assert_eq!(w.state().overlay.as_ref().expect("collected").planes.len(), 1, "the plane that divides the root");
    for name in ["Grid", "Brute force"] {
        w.button(name);
        w.settle();
        assert_eq!(w.state().settings.workspace, Workspace::Structure);
        assert!(!w.has(Role::Button, "Make the film"), "{name} has none");
    }
}

#[test]
fn making_it_is_stopped_and_many_cells_are_told_by_level() {
    let mut w = open("builtin:soup?triangles=300000");
    w.button("Make the film");
    w.button("Cancel the film");
    assert!(w.state().filming.making.is_none());
    w.settle();
    assert!(w.state().filming.film.is_none() && w.state().error.is_none());
    make(&mut w);
    let film = w.state().filming.film.clone().expect("made");
    assert!(film.last() < 100 && film.tell(2).starts_with("Level 2 of "), "too many to be told one by one");
}

const MOVED: &str = "White: what was moved. Orange: its parent before, which is gone. Blue: its parent since.";

#[test]
fn nodes_that_reinsertion_moved_are_shown_with_their_parents() {
    let mut w = open("builtin:soup?triangles=200");
    w.button("View workspace");
    w.click(Role::DisclosureTriangle, "Parameters");
    w.step();
    w.choose("off", "on");
    w.button("Structure workspace");
    w.until("the optimised tree", |s| {
        s.shown.as_ref().is_some_and(|b| b.key.params.choice("reinsertion") == "on") && s.tree.outline.is_some()
    });
    w.settle();
    make(&mut w);
    let film = w.state().filming.film.clone().expect("made");
    assert!(film.has_moves() && w.says(&film.tell(0)));
    assert!(w.says("The tree was built once more, with one triangle in a leaf, to see which nodes reinsertion moves then."));
    w.button("End");
    let leaves = w.state().shown.as_ref().and_then(|shown| shown.stats.clone()).expect("counted").leaves;
    let (total, lit) = drawn(&mut w);
    assert_eq!((total as u64, lit), (leaves, 0), "the finished structure");
    w.button("Back");
    assert_eq!(drawn(&mut w), (1, 3), "the root, what was moved and its two parents");
    assert!(w.says(&film.tell(film.last() - 1)) && film.tell(film.last() - 1).starts_with("Reinsertion "));
    assert!(w.says("Moves by gain"));
    let [plot, said] = [(Role::Image, "SAH cost over the film"), (Role::Label, MOVED)]
        .map(|(role, name)| w.harness.get_by_role_and_label(role, name).rect());
    assert!(said.bottom() <= plot.bottom(), "all of it is seen: {said} in {plot}");
    let colors: Vec<[u8; 4]> = w.state().overlay.as_ref().expect("collected").lit.iter().map(|lit| lit.color).collect();
    assert!(colors[0] != colors[1] && colors[1] != colors[2] && colors[2] == [255; 4], "{colors:?}");
}
