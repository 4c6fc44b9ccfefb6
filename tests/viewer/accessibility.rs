//! Names for those who cannot see the window, and keys for those who have no mouse.

use std::collections::BTreeSet;

use boxwood::geometry::Axis;
use boxwood::render::Mode;
use boxwood::viewer::format;
use boxwood::viewer::theme::{self, Palette};
use eframe::egui::accesskit::Live;
use eframe::egui::{Key, Modifiers, Rect, Role, Shape, vec2};
use egui_kittest::kittest::{NodeT, Queryable};

use crate::window::{Setup, Window};

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

/// The name of what has the focus, and where it is.
fn focused(w: &Window) -> Option<(String, Rect)> {
    let node = w.harness.query_by(|n| n.is_focused() && n.role() != Role::Window)?;
    Some((node.accesskit_node().label().unwrap_or_default(), node.rect()))
}

fn gather_rings(shape: &Shape, ring: eframe::egui::Stroke, rings: &mut Vec<Rect>) {
    match shape {
        Shape::Vec(shapes) => shapes.iter().for_each(|shape| gather_rings(shape, ring, rings)),
        Shape::Rect(rect) if rect.stroke == ring => rings.push(rect.rect),
        _ => {}
    }
}

/// The rings of the last frame that show where keys go.
fn rings(w: &Window) -> Vec<Rect> {
    let ring = theme::focus_ring(Palette::of(w.harness.ctx.theme()));
    let mut rings = Vec::new();
    w.harness.output().shapes.iter().for_each(|clipped| gather_rings(&clipped.shape, ring, &mut rings));
    rings
}

/// Whether a ring is around what has the focus.
fn is_ringed(w: &Window) -> bool {
    focused(w).is_some_and(|(_, rect)| rings(w).iter().any(|ring| ring.expand(2.0).contains_rect(rect)))
}

#[test]
fn where_tab_has_come_to_is_seen() {
    let mut w = Window::lecture();
    let mut wanted = BTreeSet::from([
        "File",
        "Help",
        "BVH",
        "Grid",
        "Leaves only",
        "Depth",
        "Picture",
        "Measure",
        "3D viewport",
        "Show as table: leaves",
    ]);
    assert!(rings(&w).is_empty());
    for _ in 0..90 {
        w.key(Modifiers::NONE, Key::Tab);
        let Some((name, _)) = focused(&w) else { continue };
        if wanted.remove(name.as_str()) {
            // What was out of sight is scrolled to.
            w.harness.run_steps(if is_ringed(&w) { 0 } else { 30 });
            assert!(is_ringed(&w), "{name} at {:?}: {:?}", focused(&w), rings(&w));
        }
    }
    assert!(wanted.is_empty(), "Tab does not reach {wanted:?}");
    // What is pressed is seen by itself.
    w.button("k-d tree");
    assert!(rings(&w).is_empty());
}

#[test]
fn f6_goes_from_panel_to_panel() {
    let mut w = Window::lecture();
    let view = w.viewport();
    let mut go = |modifiers| {
        w.key(modifiers, Key::F6);
        focused(&w).expect("something has the focus")
    };
    let (first, _) = go(Modifiers::NONE);
    assert_eq!(first, "File");
    let (name, at) = go(Modifiers::NONE);
    assert!(at.center().x < view.left(), "{name} is at the left");
    let (name, at) = go(Modifiers::NONE);
    assert!(view.x_range().contains(at.center().x) && at.center().y < view.bottom(), "{name} is in the middle");
    let (name, at) = go(Modifiers::NONE);
    assert!(view.x_range().contains(at.center().x) && at.center().y > view.bottom(), "{name} is below");
    let (name, at) = go(Modifiers::NONE);
    assert!(at.center().x > view.right(), "{name} is at the right");
    assert_eq!(go(Modifiers::NONE).0, "File");
    let (name, at) = go(Modifiers::SHIFT);
    assert!(at.center().x > view.right(), "{name} is at the right");
}

#[test]
fn rows_of_the_tree_are_one_stop_of_tab() {
    let mut w = Window::with_model("builtin:teapot?triangles=1000");
    w.key(Modifiers::NONE, Key::F2);
    w.until("the tree", |s| s.tree.outline.is_some());
    w.settle();
    w.harness.get_by_role_and_label(Role::Tree, "Cells").focus();
    w.step();
    let list = focused(&w).expect("the list").1;
    assert!(rings(&w).iter().any(|ring| ring.expand(2.0).contains_rect(list)));
    w.key(Modifiers::NONE, Key::Tab);
    let row = w.harness.query_by(|n| n.is_focused() && matches!(n.role(), Role::TreeItem | Role::DisclosureTriangle));
    assert!(row.is_none(), "{:?}", row.and_then(|row| row.accesskit_node().label()));
}

#[test]
fn what_is_dragged_is_moved_by_keys_too() {
    let mut w = Window::lecture();
    // A slider.
    let depth = w.state().settings.overlay.depth;
    w.harness.get_by_role_and_label(Role::Slider, "Depth").focus();
    w.step();
    w.key(Modifiers::NONE, Key::ArrowLeft);
    assert_eq!(w.state().settings.overlay.depth, depth - 1);
    // The edge of a panel.
    let width = w.viewport().width();
    let edges = w.harness.get_all_by_role_and_label(Role::Splitter, "Resize panel");
    let left = edges.min_by(|a, b| a.rect().center().x.total_cmp(&b.rect().center().x)).expect("edges");
    left.focus();
    w.step();
    w.step();
    w.key(Modifiers::NONE, Key::ArrowRight);
    w.step();
    assert!(w.viewport().width() < width, "{} of {width}", w.viewport().width());
}

#[test]
fn what_begins_and_ends_is_announced() {
    let mut w = Window::lecture();
    let said = |w: &Window| {
        let node = w.harness.get_by_role(Role::Status);
        assert_eq!(node.accesskit_node().live(), Live::Polite);
        node.accesskit_node().label().unwrap_or_default()
    };
    assert!(said(&w).ends_with(" has ended"), "{}", said(&w));
    w.open_path("builtin:no-such-scene");
    w.until("a message", |s| s.error.is_some());
    w.step();
    let error = w.harness.get_by(|n| n.live() == Live::Assertive && n.role() == Role::Label);
    assert!(error.accesskit_node().label().or(error.accesskit_node().value()).is_some_and(|text| text.contains("no-such-scene")));
}

#[test]
fn plots_can_be_read_as_tables() {
    // As tall as the panels: scrolling is another thing.
    let mut setup = Setup { size: vec2(1400.0, 1600.0), ..Setup::default() };
    setup.options.model = Some("builtin:teapot?triangles=1000".to_owned());
    let mut w = Window::new(setup).settled();
    w.click(Role::CheckBox, "Show as table: leaves");
    w.settle();
    let stats = w.state().shown.as_ref().and_then(|shown| shown.stats.clone()).expect("counted");
    let most = stats.leaf_sizes.iter().copied().max().expect("leaves");
    assert!(!w.has(Role::Image, "Leaf size histogram") && w.texts().iter().any(|t| t.text == format::count(most)));
    w.key(Modifiers::NONE, Key::F2);
    w.until("the tree", |s| s.tree.outline.is_some());
    w.button("Fullest leaf");
    w.settle();
    w.button("Parent");
    w.settle();
    w.click(Role::CheckBox, "Show as table: SAH cost");
    w.settle();
    let curves = w.state().curves.as_ref().and_then(|(_, curves)| curves.as_ref()).expect("a division");
    let middle = format::number(curves.at(Axis::X, 0.5).cost);
    assert!(w.says("Place") && w.texts().iter().any(|t| t.text == middle), "{middle}");
}
