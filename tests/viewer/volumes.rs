//! Bounding volumes: drawn as what they are, and compared around a node.

use boxwood::accel::outline::Rank;
use boxwood::viewer::settings::Levels;
use boxwood::viewer::theme::COMPARED;
use eframe::egui::{Key, Modifiers, Role, vec2};
use egui_kittest::kittest::Queryable;

use crate::window::{Setup, Window};

/// A window in the Structure workspace.
fn open(model: &str, structure: &str) -> Window {
    let mut setup = Setup { size: vec2(1280.0, 1700.0), ..Setup::default() };
    (setup.options.model, setup.options.structure) = (Some(model.to_owned()), Some(structure.to_owned()));
    let mut w = Window::new(setup).settled();
    w.button("Structure workspace");
    w.until("the cells are listed", |s| s.tree.outline.is_some());
    w.settle();
    w
}

#[test]
fn volumes_of_the_selected_node_stand_side_by_side() {
    let mut w = open("builtin:teapot?triangles=1000", "bvh");
    assert!(!w.has(Role::Button, "Compare bounding volumes"), "nothing is selected");
    w.button(Rank::Overlap.name());
    w.settle();
    w.button("Compare bounding volumes");
    w.until("rows", |s| s.fitting().is_some());
    w.settle();
    let fitting = w.state().fitting().expect("made").0.clone();
    let row = |id: &str| fitting.rows.iter().find(|row| row.id == id).expect("a row").clone();
    for (tight, loose) in [
        ("hull", "kdop26"),
        ("kdop26", "kdop18"),
        ("kdop26", "kdop14"),
        ("kdop14", "kdop8"),
        ("kdop18", "aabb"),
        ("kdop14", "aabb"),
    ] {
        assert!(row(tight).area <= row(loose).area * (1.0 + 1e-5), "{tight} {loose}");
    }
    assert!(w.says("Convex hull") && w.says("26-DOP") && !w.has(Role::Button, "Compare bounding volumes"));
    // A click draws one around the node, another puts it away.
    let drawn = |w: &Window| w.state().overlay.as_ref().map_or(0, |overlay| overlay.compared.len());
    assert_eq!(drawn(&w), 0);
    w.button("26-DOP");
    w.settle();
    assert!(drawn(&w) > 12, "{}", drawn(&w));
    let color = w.state().overlay.as_ref().expect("drawn").compared[0].color;
    assert_eq!(color, COMPARED.to_array());
    w.button("Sphere");
    w.settle();
    assert!(drawn(&w) > 48);
    w.button("Sphere");
    w.settle();
    assert_eq!(drawn(&w), 0);
    // Of another view they are compared anew; another node has none yet.
    w.key(Modifiers::NONE, Key::P);
    w.settle();
    assert!(w.says("Of an earlier view.") && w.has(Role::Button, "Compare bounding volumes"));
    w.button("Child");
    w.settle();
    assert!(w.state().fitting().is_none() && w.has(Role::Button, "Compare bounding volumes"));
}

#[test]
fn comparing_volumes_can_be_cancelled() {
    let mut w = open("builtin:terrain?triangles=200000", "bvh");
    w.harness.get_by(|n| n.role() == Role::TreeItem && n.label().is_some_and(|l| l.starts_with("node 0, depth 0"))).click();
    w.settle();
    w.button("Compare bounding volumes");
    w.button("Cancel comparing volumes");
    assert!(w.state().fits.running.is_none() && w.state().fitting().is_none() && w.state().error.is_none());
}

#[test]
fn the_selected_cell_of_a_bsp_is_drawn_with_its_own_edges() {
    let mut w = open("builtin:teapot?triangles=1000", "bsp");
    w.button(Rank::Depth.name());
    w.settle();
    let overlay = w.state().overlay.clone().expect("drawn");
    assert!(overlay.selected.is_none() && overlay.selected_lines.len() >= 6);
    assert!(w.says("shapes"));
}

#[test]
fn both_levels_are_offered_where_there_are_two() {
    let mut w = open("builtin:sphere-flake?triangles=100000", "bvh");
    let before = w.state().collected.total;
    w.choose("As one tree", "Both levels");
    w.settle();
    assert_eq!(w.state().settings.overlay.levels, Levels::Both);
    assert_ne!(w.state().collected.total, before);
    // The root holds triangles of many spaces: there is nothing to compare.
    w.harness.get_by(|n| n.role() == Role::TreeItem && n.label().is_some_and(|l| l.starts_with("node 0, depth 0"))).click();
    w.settle();
    assert!(w.state().picked.is_some() && !w.has(Role::Button, "Compare bounding volumes"));
}

#[test]
fn one_level_has_no_levels_to_choose_from() {
    let w = open("builtin:teapot?triangles=1000", "bvh");
    assert!(!w.says("Levels"));
}
