//! Files of rays in the Ray workspace: read, traced, listed by what they cost, and followed.

use std::path::PathBuf;
use std::sync::Arc;

use boxwood::accel::stats::SahWeights;
use boxwood::geometry::Ray;
use boxwood::lab::follow::to_text;
use boxwood::viewer::settings::Workspace;
use eframe::egui::{Key, Modifiers, Role, vec2};
use egui_kittest::kittest::{NodeT, Queryable};
use glam::Vec3;

use crate::files::Files;
use crate::opening::Dropped;
use crate::window::{Setup, Window};

fn open(answer: Option<PathBuf>) -> Window {
    let mut setup = Setup { size: vec2(1280.0, 800.0), answer, ..Setup::default() };
    setup.options.model = Some("builtin:teapot?triangles=1000".to_owned());
    Window::new(setup).settled()
}

/// Rays straight down through a model, side by side; the first and the last miss it.
fn rays(w: &Window) -> Vec<Ray> {
    let bounds = w.state().model.as_ref().expect("open").bounds();
    let (middle, size) = (bounds.centre(), bounds.size());
    let ray = |i: u8| {
        let aside = Vec3::X * size.x * 1.2 * (f32::from(i) / 40.0 - 0.5);
        Ray::new(middle + aside + Vec3::Z * 2.0 * size.max_element(), Vec3::NEG_Z)
    };
    (0..=40).map(ray).collect()
}

fn text(rays: &[Ray]) -> String {
    let lines: String = rays.iter().map(|ray| format!("{}\n", to_text(ray))).collect();
    format!("# straight down\n{lines}")
}

/// A window in the Ray workspace with a file of rays that were traced, and the rays.
fn listed() -> (Window, Files, Vec<Ray>) {
    let files = Files::new();
    let mut w = open(Some(files.missing("down.rays")));
    let rays = rays(&w);
    files.write("down.rays", text(&rays));
    w.button("Ray workspace");
    w.button("Open rays…");
    w.until("the list", |s| s.ray_list.traced.is_some());
    w.settle();
    (w, files, rays)
}

#[test]
fn a_file_is_listed_by_cost_and_its_rays_are_followed() {
    let (mut w, _files, rays) = listed();
    let traced = w.state().ray_list.traced.as_ref().expect("traced");
    let weights = SahWeights::of(&traced.of.params);
    let costs: Vec<f64> = traced.order.iter().map(|i| traced.work[*i as usize].cost(weights)).collect();
    assert_eq!(costs.len(), rays.len());
    assert!(costs.windows(2).all(|w| w[0] >= w[1]) && costs[0] > costs[40], "{costs:?}");
    assert!(w.says("down.rays: 41 rays"));
    // The second row, then the next by a key.
    let (number, ray, work) = w.state().ray_list.row(1).expect("a row");
    assert_eq!(ray, rays[number as usize]);
    let row = w.harness.get_by(|n| n.label().is_some_and(|l| l.starts_with(&format!("Ray {}: ", number + 1)))).rect();
    w.press_in_one_frame(row.center());
    w.until("its steps", |s| !s.rays.columns.is_empty());
    w.settle();
    let followed = &w.state().rays.columns[0].followed;
    assert_eq!((w.state().rays.ray, followed.counts.nodes), (Some(ray), u64::from(work.nodes)));
    w.key(Modifiers::NONE, Key::ArrowDown);
    w.settle();
    assert_eq!(w.state().ray_list.chosen, Some(2));
    assert_eq!(w.state().rays.ray, w.state().ray_list.row(2).map(|row| row.1));
    // Another structure does other work for them.
    w.button("k-d tree");
    w.until("its work", |s| {
        s.ray_list.traced.as_ref().is_some_and(|traced| s.shown.as_ref().is_some_and(|b| b.key == traced.of))
    });
    w.settle();
    w.button("Close rays");
    assert!(w.state().ray_list.file.is_none());
}

#[test]
fn the_list_is_saved_the_dearest_ray_first() {
    let (mut w, files, rays) = listed();
    w.button("Save rays");
    w.button("Table as CSV…");
    w.until("a file", |s| s.exports.said.is_some() || s.error.is_some());
    assert_eq!(w.state().error, None);
    let saved = std::fs::read_to_string(files.missing("down.rays.csv")).expect("with its ending");
    let lines: Vec<&str> = saved.lines().collect();
    assert_eq!(lines.len(), 1 + rays.len());
    let (number, _, work) = w.state().ray_list.row(0).expect("a row");
    assert!(lines[1].starts_with(&format!("{},bvh,{},{},", number + 1, work.nodes, work.tests)), "{}", lines[1]);
}

#[test]
fn a_file_is_dropped_and_what_is_wrong_with_one_is_told() {
    let files = Files::new();
    let mut w = open(None);
    let path = files.write("some.txt", text(&rays(&w)));
    w.harness.input_mut().dropped_files.push(Arc::new(Dropped(path)));
    w.until("the list", |s| s.ray_list.traced.is_some());
    assert_eq!(w.state().settings.workspace, Workspace::Ray);
    assert!(w.state().model.as_ref().is_some_and(|model| model.scene.name.starts_with("builtin:teapot")));
    let broken = files.write("broken.rays", "0 0 1  0 0 -1\n0 0 1  0 0\n");
    w.open_path(&broken.to_string_lossy());
    w.until("a message", |s| s.error.is_some());
    let error = w.state().error.clone().expect("told");
    assert!(error.contains("broken.rays") && error.contains("line 2: a ray is six or eight numbers"), "{error}");
    assert!(w.state().ray_list.file.is_some(), "the list stays");
}

#[test]
fn rows_are_one_stop_of_tab() {
    let (mut w, _files, _) = listed();
    w.harness.get_by_role_and_label(Role::List, "Rays of the file").focus();
    w.step();
    w.key(Modifiers::NONE, Key::ArrowDown);
    w.settle();
    assert_eq!(w.state().ray_list.chosen, Some(0));
    w.key(Modifiers::NONE, Key::Tab);
    let focused = w.harness.query_by(|n| n.is_focused() && n.role() == Role::ListItem);
    assert!(focused.is_none(), "{:?}", focused.and_then(|n| n.accesskit_node().label()));
}
