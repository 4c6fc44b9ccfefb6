//! What serves an audience: larger and without panels, views that are kept, terms with their figures.

use eframe::egui::{Key, Modifiers, PointerButton, Role, vec2};

use crate::window::Window;

#[test]
fn a_presentation_is_larger_and_has_no_panels() {
    let mut w = Window::lecture();
    let (before, scale) = (w.viewport(), w.harness.ctx.pixels_per_point());
    w.key(Modifiers::NONE, Key::F10);
    w.step();
    assert!(w.state().presenting && !w.says("STATISTICS") && !w.says("TIMINGS") && !w.says("SCENE"));
    assert!((w.harness.ctx.pixels_per_point() / scale - 1.5).abs() < 1e-3);
    assert!(w.viewport().width() * 1.5 > 1.3 * before.width());
    w.settle();
    w.key(Modifiers::NONE, Key::Escape);
    w.step();
    assert!(!w.state().presenting && w.says("STATISTICS"));
    assert_eq!(w.harness.ctx.pixels_per_point(), scale);
}

#[test]
fn views_are_kept_with_what_was_selected() {
    let mut w = Window::with_model("builtin:teapot?triangles=1000");
    w.press_in_one_frame(w.viewport().center());
    w.until("a selection", |s| s.picked.is_some());
    w.settle();
    let (camera, path) = (w.state().camera, w.state().picked.as_ref().expect("clicked").ids());
    w.key(Modifiers::COMMAND, Key::D);
    w.drag(w.viewport().center(), vec2(120.0, 10.0), PointerButton::Primary, Modifiers::NONE);
    w.button("k-d tree");
    w.settle();
    assert!(w.state().camera != camera && w.state().picked.is_none());
    w.key(Modifiers::COMMAND, Key::D);
    let names: Vec<String> = w.state().bookmarks.iter().map(|bookmark| bookmark.name.clone()).collect();
    assert_eq!(names, ["view 1 (BVH)", "view 2 (k-d tree)"]);
    w.button("View");
    w.button_that_contains("Bookmarks");
    w.button("view 1 (BVH)");
    w.settle();
    assert_eq!((w.state().camera, w.shown()), (camera, Some("bvh")));
    assert_eq!(w.state().picked.as_ref().map(|picked| picked.ids()), Some(path));
    // Of another model there are none.
    w.open_path("builtin:lecture");
    w.settle();
    assert!(w.state().bookmarks.is_empty());
}

#[test]
fn terms_have_their_figures() {
    let mut w = Window::lecture();
    w.button("Help");
    w.button("Terms");
    w.step();
    assert!(w.has(Role::Window, "Terms") && w.says("Surface area heuristic (SAH)"));
    let sah = w.state().shown.as_ref().and_then(|shown| shown.stats.as_ref()).expect("counted").sah;
    assert!(w.says(&boxwood::viewer::format::number(sah)));
    w.key(Modifiers::NONE, Key::Escape);
    w.step();
    assert!(!w.has(Role::Window, "Terms"));
}

#[test]
fn views_stay_where_the_same_model_is_opened_anew() {
    let mut w = Window::with_model("builtin:sphere-flake?triangles=50000");
    w.key(Modifiers::COMMAND, Key::D);
    w.click(Role::CheckBox, "Flatten instances");
    w.settle();
    assert_eq!(w.state().instances, boxwood::viewer::model::Instances::Flattened);
    assert_eq!(w.state().bookmarks.len(), 1);
}
