//! Parameters of structures, and the triangle test.

use boxwood::geometry::tri::TestKind;
use eframe::egui::Role;
use egui_kittest::kittest::{NodeT, Queryable};

use crate::window::Window;

fn leaf_size(w: &Window) -> u32 {
    w.state().shown.as_ref().expect("shown").key.params.int("max_leaf")
}

#[test]
fn a_parameter_rebuilds_and_defaults_restore() {
    let mut w = Window::lecture();
    let default = leaf_size(&w);
    w.set_parameter("Leaf size", "8");
    w.until("the new one", |s| s.shown.as_ref().is_some_and(|b| b.key.params.int("max_leaf") == 8));
    w.settle();
    w.button("Defaults");
    w.settle();
    assert_eq!(leaf_size(&w), default);
    let button = w.harness.get_by_role_and_label(Role::Button, "Defaults").accesskit_node();
    assert!(button.is_disabled(), "there is nothing left to restore");
}

#[test]
fn a_choice_rebuilds() {
    let mut w = Window::lecture();
    w.click(Role::DisclosureTriangle, "Parameters");
    w.step();
    w.choose("near", "fixed");
    w.until("fixed order", |s| s.shown.as_ref().is_some_and(|b| b.key.params.choice("order") == "fixed"));
}

#[test]
fn the_other_triangle_test_rebuilds() {
    let mut w = Window::lecture();
    assert_eq!(w.state().shown.as_ref().map(|b| b.key.test), Some(TestKind::Watertight));
    w.click(Role::RadioButton, "Fast");
    w.until("fast", |s| s.shown.as_ref().is_some_and(|b| b.key.test == TestKind::Fast));
    w.click(Role::RadioButton, "Watertight");
    w.settle();
    assert_eq!(w.state().shown.as_ref().map(|b| b.key.test), Some(TestKind::Watertight));
}
