//! The Measure button.

use std::time::{Duration, Instant};

use boxwood::accel::registry;
use eframe::egui::{PointerButton, Role, vec2};
use egui_kittest::kittest::{NodeT, Queryable};

use crate::window::{Setup, Window};

/// Measuring is alone on the machine, as it promises to its users.
fn quiet() -> Window {
    Window::new(Setup { alone: true, ..Setup::default() }).settled()
}

#[test]
fn measuring_fills_every_row_and_says_of_which_view() {
    // Wide enough for every column.
    let mut w = Window::new(Setup { alone: true, size: vec2(1400.0, 720.0), ..Setup::default() }).settled();
    w.button("Measure");
    assert!(w.state().measuring.is_some());
    let view = (w.state().camera, w.state().size_px);
    // Whoever looks around meanwhile does not change what was measured.
    w.drag(w.viewport().center(), vec2(80.0, 0.0), PointerButton::Middle, Default::default());
    assert_ne!(w.state().camera, view.0);
    w.until("timings", |s| s.measuring.is_none() && s.timings.view.is_some());
    w.settle();
    assert_eq!(w.state().timings.view, Some(view));
    assert!(w.says("measured on another view"));

    let rows: Vec<_> = w.state().timings.rows().collect();
    assert_eq!(rows.len(), registry::ALL.len());
    for (entry, row) in rows {
        let timing = row.timing.as_ref().unwrap_or_else(|| panic!("{}: {:?}", entry.id, row.failed));
        assert!(row.build_secs.is_some() && row.bytes.is_some() && row.failed.is_none(), "{}", entry.id);
        assert!(timing.mrays_per_sec > 0.0 && timing.rounds >= 5 && timing.rays > 0, "{}", entry.id);
        assert!(timing.nodes_per_ray + timing.prims_per_ray > 0.0, "{}", entry.id);
    }
    // The table is longer than its panel: every row comes into view.
    let mut names: Vec<String> = w.texts().into_iter().map(|t| t.text).collect();
    let table = w.texts().into_iter().find(|t| t.text.contains(registry::ALL[0].name)).expect("the first row").rect.center();
    w.wheel(table, -40);
    names.extend(w.texts().into_iter().map(|t| t.text));
    for entry in registry::ALL {
        assert!(names.iter().any(|name| name.contains(entry.name)), "{} is in no row", entry.name);
    }
    let raster = w.state().timings.raster.as_ref().expect("measured, too");
    assert!(raster.rounds >= 5 && raster.covered >= raster.hits && raster.differing.other == 0, "{raster:?}");
    // Every cell of the table is filled, but for what only structures have.
    assert!(w.says("Raster"));
    let missing = w.texts().iter().filter(|t| t.text == "–").count();
    assert_eq!(missing, 4);
}

#[test]
fn measuring_can_be_cancelled_and_rendering_goes_on() {
    let mut w = quiet();
    w.button("Measure");
    w.until("progress", |s| s.measuring.as_ref().is_some_and(|m| m.progress.snapshot().phase == "measure"));
    assert!(w.harness.get_by_role_and_label(Role::Button, "BVH").accesskit_node().is_disabled());
    let stop = Instant::now();
    w.click(Role::Button, "Cancel");
    let answered = stop.elapsed();
    assert!(w.state().measuring.is_none() && answered < Duration::from_millis(100), "{answered:?}");
    assert!(w.state().timings.view.is_none() && w.state().timings.raster.is_none());
    assert!(w.state().timings.rows().all(|(_, row)| row.timing.is_none()));
    assert!(w.has(Role::Button, "Measure"));
    // The renderer rests until the measurement has really ended.
    w.drag(w.viewport().center(), vec2(80.0, 0.0), PointerButton::Middle, Default::default());
    let (there, start) = (w.state().camera, Instant::now());
    w.until("a picture", |s| s.picture.as_ref().is_some_and(|p| p.camera == there));
    assert!(start.elapsed() < Duration::from_secs(2), "{:?}", start.elapsed());
}

#[test]
fn rows_are_of_the_structure_that_is_shown() {
    let mut w = Window::lecture();
    let bytes = |w: &Window| {
        let rows = w.state().timings.rows().find(|(entry, _)| entry.id == "bvh");
        rows.and_then(|(_, row)| row.bytes).expect("built")
    };
    let fine = bytes(&w);
    w.set_parameter("Maximum depth", "1");
    w.settle();
    let coarse = bytes(&w);
    assert!(coarse < fine, "{coarse} {fine}");
    w.button("Defaults");
    w.settle();
    assert_eq!(bytes(&w), fine, "a kept structure's row is its own");
}
