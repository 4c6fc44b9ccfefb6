//! Switching structures, and building them.

use std::sync::Arc;
use std::time::{Duration, Instant};

use boxwood::accel::registry;
use eframe::egui::Role;

use crate::window::{PATIENCE, Setup, Window};

#[test]
fn every_structure_can_be_shown() {
    let mut w = Window::lecture();
    for (button, id) in registry::ALL.iter().map(|entry| (entry.name, entry.id)) {
        w.button(button);
        w.until(button, |s| s.shown.as_ref().is_some_and(|b| b.key.entry.id == id));
        w.settle();
        assert_eq!(w.state().settings.structure, id);
        assert!(w.state().shown.as_ref().is_some_and(|b| b.stats.is_some()));
    }
}

#[test]
fn a_kept_structure_is_not_built_again() {
    let mut w = Window::lecture();
    let first = Arc::clone(&w.state().shown.as_ref().expect("shown").accel);
    w.button("k-d tree");
    w.until("k-d tree", |s| s.shown.as_ref().is_some_and(|b| b.key.entry.id == "kdtree"));
    w.settle();
    w.button("BVH");
    assert!(w.state().building.is_none());
    assert!(w.state().shown.as_ref().is_some_and(|b| Arc::ptr_eq(&b.accel, &first)));
}

#[test]
fn a_switch_says_what_changed_for_three_seconds() {
    let mut w = Window::lecture();
    w.button("k-d tree");
    w.until("the change is known", |s| s.change.is_some());
    let start = Instant::now();
    w.step();
    let (text, _) = w.state().change.clone().expect("just seen");
    assert!(text.starts_with("k-d tree: ") && text.contains(" nodes/ray (BVH: ") && text.ends_with(')'), "{text}");
    assert!(w.says(&text));
    while w.says(&text) {
        assert!(start.elapsed() < PATIENCE, "it never goes");
        std::thread::sleep(Duration::from_millis(20));
        w.step();
    }
    let shown = start.elapsed().as_secs_f64();
    assert!((2.0..6.0).contains(&shown), "{shown} s");
}

#[test]
fn a_change_is_never_told_of_a_structure_that_was_not_seen() {
    let mut w = Window::lecture();
    // Both are kept, so that each is shown in the frame of its click.
    for button in ["k-d tree", "Brute force", "BVH"] {
        w.button(button);
        w.settle();
    }
    let nodes = |w: &Window| {
        let progress = w.state().picture.as_ref().expect("a picture").progress;
        progress.counts.nodes as f64 / progress.counted as f64
    };
    let of_bvh = nodes(&w);
    // No picture of the k-d tree comes in between.
    let centre = |w: &Window, name| {
        egui_kittest::kittest::Queryable::get_by_role_and_label(&w.harness, Role::Button, name).rect().center()
    };
    let (kdtree, brute) = (centre(&w, "k-d tree"), centre(&w, "Brute force"));
    w.press_in_one_frame(kdtree);
    w.press_in_one_frame(brute);
    w.until("brute force", |s| s.shown.as_ref().is_some_and(|b| b.key.entry.id == "brute"));
    w.settle();
    if let Some((text, _)) = &w.state().change {
        let wrong = format!("(k-d tree: {})", boxwood::viewer::format::number(of_bvh));
        assert!(!text.contains(&wrong), "{text}: that is the BVH's figure");
    }
}

#[test]
fn depths_survive_a_structure_that_has_none() {
    let mut w = Window::lecture();
    assert_eq!(w.state().settings.overlay.depth, 3);
    for button in ["Brute force", "BVH"] {
        w.button(button);
        w.settle();
    }
    assert_eq!((w.shown(), w.state().settings.overlay.depth), (Some("bvh"), 3));
}

#[test]
fn a_build_can_be_cancelled_and_what_was_there_stays() {
    let mut setup = Setup { alone: true, ..Setup::default() };
    setup.options.model = Some("builtin:terrain?triangles=300000".into());
    let mut w = Window::new(setup).settled();
    let before = Arc::clone(&w.state().shown.as_ref().expect("shown").accel);
    w.button("k-d tree");
    assert!(w.state().building.is_some());
    assert_eq!(w.shown(), Some("bvh"), "the last one is shown meanwhile");
    w.until("progress", |s| s.building.as_ref().is_some_and(|b| b.job.progress.snapshot().fraction.is_some()));
    assert!(w.says("Building k-d tree"));
    let stop = Instant::now();
    w.click(Role::Button, "Cancel");
    assert!(w.state().building.is_none() && stop.elapsed() < Duration::from_millis(500));
    assert_eq!(w.state().settings.structure, "bvh");
    w.settle();
    assert!(w.state().shown.as_ref().is_some_and(|b| Arc::ptr_eq(&b.accel, &before)));
    assert!(w.state().error.is_none() && !w.says("Building k-d tree"));
}

#[test]
fn another_click_does_not_start_a_build_over() {
    let mut setup = Setup::default();
    setup.options.model = Some("builtin:terrain?triangles=100000".into());
    let mut w = Window::new(setup).settled();
    w.button("k-d tree");
    let progress = |w: &Window| w.state().building.as_ref().map(|b| b.job.progress.clone());
    let first = progress(&w).expect("building");
    w.button("k-d tree");
    // Progress is shared with the build: a second build would have one of its own.
    match progress(&w) {
        Some(second) => {
            second.start("marked by the test", 0);
            assert_eq!(first.snapshot().phase, second.snapshot().phase);
        }
        None => assert_eq!(w.shown(), Some("kdtree"), "it is already there"),
    }
}

#[test]
fn what_is_predicted_is_worked_out_once_somebody_looks_at_it() {
    let quality = |w: &Window| w.state().shown.as_ref().is_some_and(|b| b.quality.is_some());
    let mut w = Window::lecture();
    assert!(!quality(&w) && !w.says("Nodes/line"));
    w.click(Role::DisclosureTriangle, "Prediction");
    w.until("predictions", |s| s.shown.as_ref().is_some_and(|b| b.quality.is_some()));
    w.settle();
    assert!(w.says("Nodes/line"));
    // The section stays open, so the next structure's are worked out at once; those of the first are kept.
    w.button("Grid");
    w.until("those of the grid", |s| s.shown.as_ref().is_some_and(|b| b.key.entry.id == "grid" && b.quality.is_some()));
    w.button("BVH");
    assert!(quality(&w));
}
