//! Mouse and keys in the viewport.

use boxwood::scene::{Camera, Projection};
use eframe::egui::{Event, Key, Modifiers, PointerButton, Role, Vec2, vec2};
use egui_kittest::kittest::Queryable;

use crate::window::Window;

fn teapot() -> Window {
    Window::with_model("builtin:teapot?triangles=1000")
}

fn distance(c: &Camera) -> f32 {
    c.eye.distance(c.target)
}

fn drag(w: &mut Window, by: Vec2, button: PointerButton, modifiers: Modifiers) -> (Camera, Camera) {
    let before = w.state().camera;
    w.drag(w.viewport().center(), by, button, modifiers);
    (before, w.state().camera)
}

#[test]
fn a_drag_orbits_and_a_new_picture_follows() {
    let mut w = teapot();
    let seen = w.state().picture.as_ref().expect("a picture").request;
    let (before, after) = drag(&mut w, vec2(120.0, 30.0), PointerButton::Primary, Modifiers::NONE);
    assert_eq!(before.target, after.target);
    assert!(before.eye.distance(after.eye) > 0.1 * distance(&before));
    assert!((distance(&after) / distance(&before) - 1.0).abs() < 1e-4);
    w.until("a picture from there", |s| {
        s.picture.as_ref().is_some_and(|p| p.request > seen && p.camera == after && p.progress.done)
    });
}

#[test]
fn a_small_move_is_a_click_that_turns_nothing() {
    let mut w = teapot();
    let (before, after) = drag(&mut w, vec2(2.0, 1.0), PointerButton::Primary, Modifiers::NONE);
    assert_eq!(before, after);
}

#[test]
fn shift_or_the_middle_button_pans() {
    let mut w = teapot();
    for (button, modifiers) in [(PointerButton::Primary, Modifiers::SHIFT), (PointerButton::Middle, Modifiers::NONE)] {
        let (before, after) = drag(&mut w, vec2(50.0, 20.0), button, modifiers);
        let (eye, target) = (after.eye - before.eye, after.target - before.target);
        assert!(eye.length() > 0.01 * distance(&before) && eye.distance(target) < 1e-4 * distance(&before), "{button:?}");
    }
}

#[test]
fn the_wheel_zooms_and_home_comes_back() {
    let mut w = teapot();
    let first = w.state().camera;
    w.wheel(w.viewport().center() + vec2(40.0, 10.0), 3);
    let closer = distance(&w.state().camera);
    assert!(closer < 0.95 * distance(&first), "{closer} of {}", distance(&first));
    w.wheel(w.viewport().center() + vec2(40.0, 10.0), -6);
    assert!(distance(&w.state().camera) > distance(&first));
    w.key(Modifiers::NONE, Key::Home);
    let framed = w.state().camera;
    w.drag(w.viewport().center(), vec2(0.0, 60.0), PointerButton::Middle, Modifiers::NONE);
    w.key(Modifiers::NONE, Key::Home);
    assert!(w.state().camera.eye.distance(framed.eye) < 1e-3 * distance(&framed));
}

/// A frame in which the camera moved is gone over twice, with the same input.
#[test]
fn a_key_turns_the_camera_once_and_in_its_own_frame() {
    let mut w = teapot();
    w.drag(w.viewport().center(), vec2(30.0, 0.0), PointerButton::Primary, Modifiers::NONE);
    let before = w.state().camera;
    let angle = |camera: &Camera| {
        let (a, b) = (before.eye - before.target, camera.eye - camera.target);
        (a.dot(b) / (a.length() * b.length())).clamp(-1.0, 1.0).acos()
    };
    let request = w.state().answer.map(|answer| answer.request);
    w.harness.key_press(Key::ArrowLeft);
    w.harness.step();
    let once = angle(&w.state().camera);
    assert!(once > 0.0, "the frame of the key shows the camera turned");
    w.settle();
    assert_eq!(angle(&w.state().camera), once, "and it is not turned again");
    assert_ne!(w.state().answer.map(|answer| answer.request), request);
    w.key(Modifiers::NONE, Key::ArrowLeft);
    let twice = angle(&w.state().camera);
    assert!((twice - 2.0 * once).abs() < 0.02 * once, "{once} and then {twice}");
}

#[test]
fn keys_work_whatever_has_the_focus_but_for_text_fields() {
    let mut w = teapot();
    let centre = w.viewport().center();
    w.drag(centre, vec2(60.0, 0.0), PointerButton::Primary, Modifiers::NONE);
    assert!(w.harness.get_by_role(Role::Canvas).is_focused(), "a click in the viewport gives it the focus");
    let before = w.state().camera;
    for (key, turned) in [(Key::ArrowLeft, true), (Key::ArrowUp, true), (Key::Plus, true)] {
        let from = w.state().camera;
        w.key(Modifiers::NONE, key);
        assert_eq!(w.state().camera != from, turned, "{key:?}");
    }
    assert!(w.harness.get_by_role(Role::Canvas).is_focused(), "arrows stay in the viewport");
    assert_eq!(before.projection, w.state().camera.projection);

    let flat = |w: &Window| matches!(w.state().camera.projection, Projection::Orthographic { .. });
    assert!(!flat(&w));
    w.key(Modifiers::NONE, Key::P);
    assert!(flat(&w), "P with the focus in the viewport");
    w.harness.get_by_role_and_label(Role::Button, "Grid").focus();
    w.step();
    w.key(Modifiers::NONE, Key::P);
    assert!(!flat(&w), "P with the focus on a button");

    w.key(Modifiers::COMMAND, Key::L);
    w.step();
    w.harness.event(Event::Text("p".into()));
    w.key(Modifiers::NONE, Key::P);
    assert!(!flat(&w), "P in a text field is a letter");
}

#[test]
fn keys_enlarge_everything() {
    let mut w = teapot();
    for (key, scale) in [(Key::Plus, 1.25), (Key::Equals, 1.5), (Key::Minus, 1.25), (Key::Num0, 1.0)] {
        w.key(Modifiers::COMMAND, key);
        assert_eq!(w.state().settings.scale, scale, "{key:?}");
        assert_eq!(w.harness.ctx.zoom_factor(), scale, "{key:?}");
    }
}

#[test]
fn escape_closes_an_open_menu_before_anything_else() {
    let mut w = teapot();
    w.key(Modifiers::NONE, Key::Questionmark);
    assert!(w.state().help);
    w.button("Window");
    w.step();
    assert!(w.says("Reset layout"));
    w.key(Modifiers::NONE, Key::Escape);
    w.step();
    assert!(!w.says("Reset layout") && w.state().help, "the menu is closed, the page is not");
    w.key(Modifiers::NONE, Key::Escape);
    assert!(!w.state().help);
}

#[test]
fn the_camera_has_a_history_of_its_own() {
    let mut w = teapot();
    let first = w.state().camera;
    w.drag(w.viewport().center(), vec2(90.0, 20.0), PointerButton::Primary, Modifiers::NONE);
    let orbited = w.state().camera;
    w.key(Modifiers::NONE, Key::P);
    let flat = w.state().camera;
    assert!(orbited != first && flat != orbited);
    let alt = |w: &mut Window, key| {
        w.key(Modifiers::ALT, key);
        w.state().camera
    };
    assert_eq!(alt(&mut w, Key::ArrowLeft), orbited);
    assert_eq!(alt(&mut w, Key::ArrowLeft), first, "a drag is one step");
    assert_eq!(alt(&mut w, Key::ArrowLeft), first, "there is nothing before");
    assert_eq!(alt(&mut w, Key::ArrowRight), orbited);
    w.key(Modifiers::COMMAND, Key::Z);
    assert_eq!(w.state().camera, orbited, "the camera is not what Ctrl+Z takes back");
}

#[test]
fn choices_are_taken_back_and_made_again() {
    let mut w = teapot();
    let redo = Modifiers::COMMAND | Modifiers::SHIFT;
    let shown = |w: &Window| w.state().shown.as_ref().map(|b| (b.key.entry.id, b.key.params.clone()));
    let first = shown(&w);
    w.set_parameter("Leaf size", "8");
    w.settle();
    let larger = shown(&w);
    w.button("Grid");
    w.settle();
    assert_eq!(shown(&w).map(|s| s.0), Some("grid"));
    w.key(Modifiers::COMMAND, Key::Z);
    w.settle();
    assert_eq!(shown(&w), larger);
    w.key(Modifiers::COMMAND, Key::Z);
    w.settle();
    assert!(shown(&w) == first && first != larger);
    w.key(redo, Key::Z);
    w.settle();
    assert_eq!(shown(&w), larger);

    w.press_in_one_frame(w.viewport().center());
    w.until("a selection", |s| s.picked.is_some());
    w.key(Modifiers::COMMAND, Key::Z);
    assert!(w.state().picked.is_none());
    w.key(redo, Key::Z);
    assert!(w.state().picked.is_some());
}
