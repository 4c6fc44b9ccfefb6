//! Names for those who cannot see the window, and keys for those who have no mouse.

use std::collections::BTreeSet;

use boxwood::render::Mode;
use eframe::egui::{Key, Modifiers, Role};
use egui_kittest::kittest::{NodeT, Queryable};

use crate::window::Window;

#[track_caller]
fn all_named(w: &mut Window, when: &str) {
    w.step();
    let unnamed = w.harness.unnamed_widgets();
    assert!(unnamed.is_empty(), "{when}: {}", unnamed.join("\n"));
    // A tooltip is no name: it is what egui falls back to.
    let sentences: Vec<String> = w
        .harness
        .get_all_by(|n| n.label().is_some_and(|l| l.ends_with('.')))
        .filter(|n| !matches!(n.accesskit_node().role(), Role::Canvas | Role::GenericContainer | Role::Label | Role::Pane))
        .map(|n| format!("{:?}", n.accesskit_node().label()))
        .collect();
    assert!(sentences.is_empty(), "{when}: {}", sentences.join("\n"));
}

#[test]
fn everything_that_can_be_used_has_a_name() {
    let mut w = Window::lecture();
    w.click(Role::DisclosureTriangle, "Parameters");
    for button in ["BVH", "k-d tree", "Grid", "Brute force"] {
        w.button(button);
        w.settle();
        all_named(&mut w, button);
    }
    for menu in ["File", "View", "Window", "Help"] {
        w.button(menu);
        all_named(&mut w, menu);
        w.key(Modifiers::NONE, Key::Escape);
    }
    w.key(Modifiers::COMMAND, Key::L);
    all_named(&mut w, "the field for a path");
    w.key(Modifiers::NONE, Key::Escape);
    w.key(Modifiers::NONE, Key::Questionmark);
    all_named(&mut w, "the page of keys");
    w.key(Modifiers::NONE, Key::Escape);
    w.key(Modifiers::NONE, Key::F2);
    w.until("the tree", |s| s.tree.outline.is_some());
    w.button("Deepest leaf");
    w.settle();
    all_named(&mut w, "the Structure workspace");
    w.key(Modifiers::NONE, Key::F3);
    all_named(&mut w, "the Ray workspace");
    w.key(Modifiers::COMMAND, Key::P);
    all_named(&mut w, "the palette");
    w.key(Modifiers::NONE, Key::Escape);
    w.key(Modifiers::NONE, Key::F5);
    all_named(&mut w, "the Check workspace");
    w.button("Run the lab");
    w.until("a case", |s| !s.checks.cases.is_empty());
    w.button("Cancel");
    all_named(&mut w, "the matrix");
}

#[test]
fn tab_reaches_the_main_controls() {
    let mut w = Window::lecture();
    let mut reached = BTreeSet::new();
    for _ in 0..120 {
        w.key(Modifiers::NONE, Key::Tab);
        let focused = w.harness.query_by(|n| n.is_focused() && n.role() != Role::Window);
        reached.extend(focused.and_then(|n| n.accesskit_node().label()).map(|l| l.split('.').next().unwrap_or(&l).to_owned()));
    }
    let wanted = [
        "File",
        "View",
        "Window",
        "Help",
        "BVH",
        "k-d tree",
        "Grid",
        "Watertight",
        "Parameters",
        "Node boxes",
        "Leaves only",
        "Depth",
        "Measure",
        "3D viewport",
    ];
    let missed: Vec<_> = wanted.iter().filter(|name| !reached.contains(**name)).collect();
    assert!(missed.is_empty(), "Tab does not reach {missed:?}; it reaches {reached:?}");
}

/// What a screen reader has to say of the view.
fn described(w: &Window) -> String {
    w.harness.get_by_role_and_label(Role::Canvas, "3D viewport").accesskit_node().description().unwrap_or_default()
}

#[track_caller]
fn describes(w: &Window, parts: &[&str]) {
    let said = described(w);
    for part in parts {
        assert!(said.contains(part), "{part}: {said}");
    }
}

#[test]
fn the_viewport_says_what_is_to_be_seen() {
    let mut w = Window::lecture();
    describes(&w, &["builtin:lecture. ", "BVH, boxes at depth 3, 1 samples a pixel. "]);
    w.button("k-d tree");
    w.settle();
    describes(&w, &["k-d tree, boxes at depth"]);
    w.button("Grid");
    w.settle();
    describes(&w, &["Grid, 1 samples a pixel."]);
}

#[test]
fn what_is_written_over_the_picture_is_said_too() {
    let mut w = Window::with_model("builtin:teapot?triangles=1000");
    let boxes = |w: &Window| format!("Showing {} of {} boxes.", w.state().collected.shown, w.state().collected.total);
    describes(&w, &[&boxes(&w)]);
    w.press_in_one_frame(w.viewport().center());
    w.until("a selection", |s| s.picked.is_some());
    w.settle();
    let picked = w.state().picked.as_ref().expect("clicked").text.clone();
    describes(&w, &[&format!("{picked}."), &boxes(&w)]);
    w.choose("Shaded", Mode::Nodes.label());
    w.settle();
    describes(&w, &["Colours show ", ", from "]);
    w.button("k-d tree");
    w.until("the change", |s| s.change.is_some());
    w.step();
    let change = w.state().change.as_ref().expect("just now").0.clone();
    describes(&w, &[&format!("{change}.")]);
}
