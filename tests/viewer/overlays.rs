//! Boxes at a depth, leaves, cells.

use boxwood::lab::format::count;
use eframe::egui::{Key, Modifiers, Role};
use egui_kittest::kittest::Queryable;

use crate::window::Window;

/// Boxes drawn and boxes there are, once they are collected.
fn boxes(w: &mut Window) -> (usize, usize) {
    w.settle();
    let c = &w.state().collected;
    let said = format!("Showing {} of {} boxes", count(c.shown as u64), count(c.total as u64));
    let none = c.total == 0 && w.says("No boxes at this depth");
    assert!(none || w.says(&said), "{said}");
    (c.shown, c.total)
}

fn set_depth(w: &mut Window, depth: f64) {
    w.harness.get_by_role_and_label(Role::Slider, "Depth").set_value_accesskit(depth);
    w.harness.run_steps(2);
}

#[test]
fn the_slider_sets_the_depth_of_the_boxes() {
    let mut w = Window::lecture();
    let mut last = 0;
    for depth in [0u8, 1, 2] {
        set_depth(&mut w, depth.into());
        assert_eq!(w.state().settings.overlay.depth, u32::from(depth));
        let (shown, total) = boxes(&mut w);
        assert_eq!((shown, total), (1 << depth, 1 << depth), "the lecture's tree is full to depth 2");
        assert_ne!(last, w.state().overlay.as_ref().expect("collected").generation);
        last = w.state().overlay.as_ref().expect("collected").generation;
    }
    // The same by hand.
    w.harness.get_by_role_and_label(Role::Slider, "Depth").focus();
    w.step();
    w.key(Modifiers::NONE, Key::ArrowRight);
    assert_eq!(w.state().settings.overlay.depth, 3);
}

#[test]
fn leaves_only_shows_every_leaf() {
    let mut w = Window::lecture();
    let leaves = w.state().shown.as_ref().and_then(|b| b.stats.clone()).expect("counted").leaves;
    w.click(Role::CheckBox, "Leaves only");
    let (shown, total) = boxes(&mut w);
    assert_eq!((shown as u64, total as u64), (leaves, leaves));
}

#[test]
fn a_range_of_depths_shows_the_levels_above() {
    let mut w = Window::lecture();
    set_depth(&mut w, 2.0);
    w.click(Role::CheckBox, "Range of depths");
    w.harness.get_by_role_and_label(Role::Slider, "from").set_value_accesskit(0.0);
    w.harness.run_steps(2);
    assert_eq!(boxes(&mut w), (7, 7));
}

#[test]
fn boxes_can_be_switched_off() {
    let mut w = Window::lecture();
    w.click(Role::CheckBox, "Node boxes");
    assert_eq!(boxes(&mut w), (0, 0));
}

#[test]
fn a_grid_shows_its_cells_and_has_no_depth() {
    let mut w = Window::with_model("builtin:teapot");
    w.button("Grid");
    w.settle();
    assert!(!w.has(Role::Slider, "Depth"));
    let occupied = boxes(&mut w).1;
    w.click(Role::CheckBox, "Empty cells too");
    let all = boxes(&mut w).1;
    assert!(occupied > 1 && all > occupied, "{occupied} of {all}");
}

#[test]
fn a_kd_tree_shows_its_planes() {
    let mut w = Window::lecture();
    w.button("k-d tree");
    w.settle();
    set_depth(&mut w, 0.0);
    boxes(&mut w);
    assert_eq!(w.state().overlay.as_ref().expect("collected").planes.len(), 1);
    w.click(Role::CheckBox, "Split planes");
    boxes(&mut w);
    assert!(w.state().overlay.as_ref().expect("collected").planes.is_empty());
}
