//! What is left out, instances, and the memory that it is all about.

use boxwood::scene::Feature;
use boxwood::viewer::model::Instances;
use eframe::egui::{Role, vec2};

use crate::window::{Setup, Window};

fn tall(model: &str, alone: bool) -> Window {
    let mut setup = Setup { alone, size: vec2(1400.0, 1600.0), ..Setup::default() };
    setup.options.model = Some(model.to_owned());
    Window::new(setup).settled()
}

#[test]
fn the_panel_says_what_is_left_out_and_why_and_measures_it() {
    let mut w = tall("builtin:teapot", true);
    let (left_out, used): (Vec<_>, Vec<_>) =
        w.state().model.as_ref().expect("open").needs.iter().cloned().partition(|finding| !finding.used);
    assert!(used.iter().any(|finding| finding.feature == Feature::Normals));
    w.click(Role::DisclosureTriangle, &format!("Left out ({})", left_out.len()));
    w.settle();
    for finding in &left_out {
        assert!(w.says(finding.feature.name()) && w.says(&finding.why), "{finding:?}");
    }
    assert!(!w.says(&used[0].why));
    w.button("Measure what is left out");
    assert!(w.state().needing.is_some() && w.has(Role::Button, "Cancel measuring what is left out"));
    w.until("savings", |s| s.needs.is_some());
    w.settle();
    assert!(w.says("Saved in all"));
    let report = w.state().needs.clone().expect("measured");
    let corners = report.features.iter().find(|row| row.id == Feature::Corners.id()).expect("a row");
    assert!(corners.bytes_saved > 0 && w.says(&boxwood::viewer::format::signed_bytes(corners.bytes_saved)));
    // Another model has not been measured.
    w.open_path("builtin:lecture");
    w.until("another model", |s| s.model.as_ref().is_some_and(|m| m.scene.name == "builtin:lecture"));
    assert!(w.state().needs.is_none());
}

#[test]
fn measuring_what_is_left_out_can_be_cancelled() {
    let mut w = tall("builtin:terrain?triangles=200000", true);
    let count = w.state().model.as_ref().expect("open").needs.iter().filter(|finding| !finding.used).count();
    w.click(Role::DisclosureTriangle, &format!("Left out ({count})"));
    w.settle();
    w.button("Measure what is left out");
    w.button("Cancel measuring what is left out");
    assert!(w.state().needing.is_none() && w.state().needs.is_none() && w.state().error.is_none());
}

#[test]
fn instances_can_be_flattened_and_kept_again_in_the_same_view() {
    let mut w = tall("builtin:sphere-flake?triangles=400000", false);
    let placed = |w: &Window| w.state().model.as_ref().is_some_and(|m| m.geometry.placed().is_some());
    assert!(placed(&w));
    w.wheel(w.viewport().center(), 2);
    w.settle();
    let (camera, triangles) = (w.state().camera, w.state().model.as_ref().expect("open").geometry.counts().triangles);
    w.click(Role::CheckBox, "Flatten instances");
    w.until("flattened", |s| s.loading.is_none() && s.model.as_ref().is_some_and(|m| m.geometry.placed().is_none()));
    w.settle();
    assert_eq!((w.state().camera, w.state().instances), (camera, Instances::Flattened));
    assert_eq!(w.state().model.as_ref().expect("open").geometry.counts().triangles, triangles);
    w.click(Role::CheckBox, "Flatten instances");
    w.until("kept", |s| s.loading.is_none() && s.model.as_ref().is_some_and(|m| m.geometry.placed().is_some()));
    assert_eq!(w.state().camera, camera);
}

#[test]
fn a_scene_without_repeats_offers_nothing_to_flatten() {
    let w = Window::lecture();
    assert!(!w.has(Role::CheckBox, "Flatten instances"));
}

#[test]
fn the_memory_budget_is_a_setting() {
    let mut w = Window::lecture();
    assert!(w.state().machine_bytes >= 1 << 30, "the tests need a GiB");
    let (used, half) = w.state().memory();
    assert!(used > 0 && used < half);
    w.button("View");
    w.button_that_contains("Memory");
    w.click(Role::RadioButton, "1.00\u{2009}GiB");
    assert_eq!((w.state().memory(), w.state().settings.memory_mib), ((used, 1 << 30), Some(1 << 10)));
}

#[test]
fn switching_and_opening_leaves_what_is_charged_where_it_was() {
    let mut w = Window::lecture();
    let switch = |w: &mut Window, id: &'static str, name: &str| {
        w.button(name);
        w.until(name, |s| s.shown.as_ref().is_some_and(|b| b.key.entry.id == id));
    };
    switch(&mut w, "grid", "Grid");
    switch(&mut w, "bvh", "BVH");
    w.settle();
    let charged = w.state().memory().0;
    for _ in 0..20 {
        switch(&mut w, "grid", "Grid");
        switch(&mut w, "bvh", "BVH");
    }
    w.settle();
    assert_eq!(w.state().memory().0, charged);
    let mut after = Vec::new();
    for _ in 0..3 {
        for model in ["builtin:teapot", "builtin:lecture"] {
            w.open_path(model);
            w.until(model, |s| s.loading.is_none() && s.model.as_ref().is_some_and(|m| m.scene.name == model));
            w.settle();
        }
        after.push(w.state().memory().0);
    }
    assert!(after[0] <= charged && after.iter().all(|bytes| *bytes == after[0]), "{after:?}, and {charged} before");
}
