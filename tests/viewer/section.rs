//! Seeing inside: the model cut open, and a part of the picture checked by brute force.

use std::path::Path;

use boxwood::geometry::{Axis, Side};
use boxwood::scene::Section;
use boxwood::viewer::settings::Workspace;
use eframe::egui::{Key, Modifiers, PointerButton, Role, Vec2, vec2};
use egui_kittest::kittest::Queryable;

use crate::window::{Setup, Window};

const TEAPOT: &str = "builtin:teapot?triangles=1000";

fn window(model: &str, answer: Option<&Path>) -> Window {
    let mut setup = Setup { size: vec2(1280.0, 800.0), answer: answer.map(Path::to_path_buf), ..Setup::default() };
    setup.options.model = Some(model.to_owned());
    Window::new(setup).settled()
}

/// A window with a model that is cut open.
fn cut_open() -> Window {
    let mut w = window(TEAPOT, None);
    w.click(Role::DisclosureTriangle, "Section");
    w.harness.run_steps(30); // it unfolds
    w.click(Role::CheckBox, "Cut the model open");
    w.settle();
    w
}

/// Depths of the picture.
fn depths(w: &Window) -> Vec<f32> {
    w.state().picture.as_ref().expect("traced").depth.to_vec()
}

#[test]
fn a_model_is_cut_open_and_closed_again() {
    let mut w = window(TEAPOT, None);
    let whole = depths(&w);
    w.click(Role::DisclosureTriangle, "Section");
    w.harness.run_steps(30);
    w.click(Role::CheckBox, "Cut the model open");
    w.settle();
    assert!(w.state().settings.section.on && w.state().section().is_some());
    let cut = depths(&w);
    // Nothing comes nearer, something goes, and of some the inside is seen.
    let pairs = || whole.iter().zip(&cut);
    assert!(pairs().all(|(a, b)| b >= a));
    assert!(pairs().any(|(a, b)| a.is_finite() && !b.is_finite()));
    // The plane is drawn, and no box that is cut away.
    let overlay = w.state().overlay.clone().expect("collected");
    assert_eq!(overlay.planes.len(), 1);
    let section = w.state().section().expect("on").scaled(w.state().model.as_ref().expect("open").geometry.space());
    assert!(overlay.boxes.iter().all(|b| b.corner[0] <= section.at));

    w.button("Flip");
    w.settle();
    assert_eq!(w.state().settings.section.at.side, Side::Above);
    let other = depths(&w);
    assert!(cut.iter().zip(&other).zip(&whole).all(|((a, b), whole)| a.min(*b) == *whole), "both halves are the whole");
    w.click(Role::RadioButton, "y");
    w.harness.get_by_role_and_label(Role::Slider, "place").set_value_accesskit(0.25);
    w.settle();
    let at = w.state().settings.section.at;
    assert_eq!((at.axis, at.place), (Axis::Y, 0.25));

    // One step back for each but those that follow each other at once; forward again by the same keys.
    while w.state().settings.section.on {
        w.key(Modifiers::COMMAND, Key::Z);
    }
    w.settle();
    assert!(depths(&w) == whole, "taken back");
}

#[test]
fn what_is_cut_away_cannot_be_clicked() {
    let mut w = cut_open();
    let (cut, [width, _]) = (depths(&w), w.state().size_px);
    let rect = w.viewport();
    let place = |pixel: usize| {
        let (x, y) = (pixel as u32 % width, pixel as u32 / width);
        rect.min + vec2(x as f32 + 0.5, y as f32 + 0.5)
    };
    w.click(Role::CheckBox, "Cut the model open");
    w.settle();
    let whole = depths(&w);
    let gone = whole.iter().zip(&cut).enumerate().filter(|(_, (a, b))| a.is_finite() && !b.is_finite()).map(|(i, _)| i);
    let gone: Vec<usize> = gone.collect();
    let at = place(gone[gone.len() / 2]);
    w.press_in_one_frame(at);
    w.until("a triangle", |s| s.picked.is_some());
    w.click(Role::CheckBox, "Cut the model open");
    w.settle();
    w.press_in_one_frame(at);
    w.until("nothing there", |s| s.picked.is_none());
}

#[test]
fn a_section_stays_with_the_structure_and_goes_with_the_model() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("cut.boxwood");
    let mut setup = Setup { size: vec2(1280.0, 800.0), answer: Some(path.clone()), ..Setup::default() };
    let section = Section { axis: Axis::Z, place: 0.4, side: Side::Above };
    (setup.options.model, setup.options.section) = (Some(TEAPOT.to_owned()), Some(section));
    let mut w = Window::new(setup).settled();
    assert!(w.state().settings.section.on && w.state().settings.section.at == section);
    let cut = depths(&w);
    w.button("k-d tree");
    w.settle();
    assert!(w.state().settings.section.at == section && depths(&w) == cut);
    w.key(Modifiers::COMMAND, Key::S);
    w.until("the file", |_| path.exists());
    w.settle();
    w.open_path("builtin:menger?triangles=3000");
    w.until("the other model", |s| s.model.as_ref().is_some_and(|m| m.scene.name.contains("menger")));
    w.settle();
    assert!(!w.state().settings.section.on);
    w.open_path(&path.to_string_lossy());
    w.until("the first model", |s| s.model.as_ref().is_some_and(|m| m.scene.name.contains("teapot")));
    w.settle();
    assert!(w.state().settings.section.on && w.state().settings.section.at == section);
    assert!(depths(&w) == cut);
}

#[test]
fn a_rectangle_is_checked_by_brute_force() {
    let mut w = window(TEAPOT, None);
    let camera = w.state().camera;
    w.button("Mark a rectangle");
    assert!(w.state().brute.marking && w.says("Drag a rectangle in the view."));
    // Esc ends it.
    w.key(Modifiers::NONE, Key::Escape);
    assert!(!w.state().brute.marking);
    w.button("Mark a rectangle");
    let middle = w.viewport().center();
    w.drag(middle - Vec2::splat(20.0), vec2(40.0, 30.0), PointerButton::Primary, Modifiers::NONE);
    w.until("the comparison", |s| s.brute.found.is_some());
    let brute = &w.state().brute;
    let found = brute.found.clone().expect("there");
    assert!((30 * 40..=32 * 42).contains(&found.pixels) && found.pixels == found.all && found.unlike == 0, "{found:?}");
    assert!(!brute.marking && w.state().camera == camera, "the drag was not the camera's");
    w.step();
    assert!(w.says("pixels: all hits equal"));
    // Of another view it says nothing.
    w.drag(middle, vec2(60.0, 0.0), PointerButton::Primary, Modifiers::NONE);
    w.settle();
    assert!(w.state().brute.found.is_none() && w.state().camera != camera);
}

#[test]
fn the_whole_view_is_checked_without_a_mouse() {
    let mut w = window(TEAPOT, None);
    w.button("k-d tree");
    w.settle();
    w.key(Modifiers::NONE, Key::F3);
    assert_eq!(w.state().settings.workspace, Workspace::Ray);
    w.button("Check the whole view");
    w.until("the comparison", |s| s.brute.found.is_some());
    let [width, height] = w.state().size_px;
    let found = w.state().brute.found.clone().expect("there");
    assert_eq!(found.all, u64::from(width) * u64::from(height));
    assert!(found.pixels > 0 && found.unlike == found.rounded, "{found:?}");
    // A part of it by its numbers: at first the middle.
    w.button("Check these pixels");
    w.until("fewer pixels", |s| s.brute.found.as_ref().is_some_and(|part| part.all < found.all));
    let part = w.state().brute.found.clone().expect("there");
    assert_eq!(part.all, u64::from(width / 2) * u64::from(height / 2));
    // Against itself there is nothing to compare.
    w.button("Brute force");
    w.settle();
    assert!(!w.has(Role::Button, "Check the whole view"));
}

#[test]
fn triangles_of_a_cell_are_isolated_hidden_and_shown_again() {
    let mut w = window(TEAPOT, None);
    let whole = depths(&w);
    w.key(Modifiers::NONE, Key::F2);
    w.until("the tree", |s| s.tree.outline.is_some());
    w.settle();
    let all = depths(&w);
    w.button("Fullest leaf");
    w.settle();
    w.button("Isolate");
    w.until("the isolated triangles", |s| s.settings.visible.is_some());
    w.settle();
    let isolated = depths(&w);
    assert!(isolated.iter().zip(&all).all(|(a, b)| a >= b) && isolated != all);
    assert!(w.says("triangles are hidden"));
    // The same keys as in the tooltips.
    w.key(Modifiers::SHIFT, Key::H);
    w.settle();
    assert!(w.state().settings.visible.is_none() && depths(&w) == all);
    w.key(Modifiers::NONE, Key::H);
    w.until("the hidden triangles", |s| s.settings.visible.is_some());
    w.settle();
    let hidden = depths(&w);
    let both: Vec<f32> = isolated.iter().zip(&hidden).map(|(a, b)| a.min(*b)).collect();
    assert!(both == all, "isolated and hidden are the whole");
    // Each is a step that can be taken back.
    w.key(Modifiers::COMMAND, Key::Z);
    w.settle();
    assert!(w.state().settings.visible.is_none());
    w.key(Modifiers::COMMAND, Key::Z);
    w.settle();
    assert!(depths(&w) == isolated);
    // Another structure shows the same triangles.
    w.key(Modifiers::NONE, Key::F1);
    w.button("k-d tree");
    w.settle();
    assert!(w.state().visible().is_some());
    w.open_path(TEAPOT);
    w.settle();
    assert!(w.state().settings.visible.is_none());
    assert!(depths(&w) == whole);
}
