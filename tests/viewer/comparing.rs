//! The Compare workspace: the picture's error as it falls, and quality against its cost.

use std::sync::Arc;
use std::time::{Duration, Instant};

use boxwood::accel::registry;
use boxwood::render::{Mode, Picture};
use boxwood::viewer::errors::Known;
use boxwood::viewer::settings::Workspace;
use boxwood::viewer::state::State;
use boxwood::viewer::tradeoffs::Plot;
use boxwood::viewer::{ViewerOptions, format};
use eframe::egui::{Key, Modifiers, PointerButton, Role, vec2};
use egui_kittest::kittest::{NodeT, Queryable};

use crate::window::{Setup, Window};

fn open(model: &str, max_samples: u32) -> Window {
    let options = ViewerOptions { model: Some(model.to_owned()), samples: Some(max_samples), ..ViewerOptions::default() };
    let mut w = Window::new(Setup { alone: true, options, ..Setup::default() }).settled();
    w.key(Modifiers::NONE, Key::F4);
    assert_eq!(w.state().settings.workspace, Workspace::Compare);
    w
}

#[test]
fn errors_fall_with_samples_and_are_measured_against_a_reference() {
    let mut w = open("builtin:cornell-box", 4);
    assert!(w.says("Errors are those of the path traced picture."));
    w.button("Path trace");
    assert_eq!(w.state().settings.mode, Mode::Path);
    w.until("a curve", |s| s.errors.curves.first().is_some_and(|live| live.shots.len() == 3));
    w.button(registry::find("wide").expect("registered").name);
    w.until("another", |s| s.errors.curves.get(1).is_some_and(|live| live.shots.len() == 3));
    let samples: Vec<u32> = w.state().errors.curves[0].shots.iter().map(|shot| shot.samples).collect();
    assert_eq!(samples, [1, 2, 4]);
    // Without a reference, an estimate from two samples on.
    let known = |w: &Window, point| w.state().errors.known(0, point);
    assert!(known(&w, 0).is_none() && matches!(known(&w, 2), Some(Known::Noise(noise)) if noise > 0.0));

    let (spp, _) = w.state().errors.wanted_reference().expect("there are samples");
    assert_eq!(spp, 64);
    let label = w.texts().into_iter().find(|t| t.text.starts_with("Make reference")).expect("the button").text;
    w.button(&label);
    assert!(w.state().errors.making.is_some() && w.state().is_measuring());
    w.button("Cancel");
    assert!(w.state().errors.making.is_none());
    w.settle();
    let label = w.texts().into_iter().find(|t| t.text.starts_with("Make reference")).expect("the button").text;
    w.button(&label);
    w.until("the reference", |s| s.errors.reference.is_some());
    w.until("errors", |s| s.errors.curves.iter().all(|live| live.errors.iter().all(Option::is_some)));
    let rmse = |w: &Window, curve, point| match w.state().errors.known(curve, point) {
        Some(Known::Error { rmse, .. }) => rmse,
        other => panic!("{other:?}"),
    };
    assert!((0..2).all(|point| rmse(&w, 0, point) > rmse(&w, 0, point + 1)));
    // Both structures are of the same samples: the same errors to the bit.
    assert!((0..3).all(|point| rmse(&w, 0, point) == rmse(&w, 1, point)));

    w.click(Role::CheckBox, "Show as table");
    let before = w.state().picture.as_ref().expect("a picture").rgba.clone();
    w.button("BVH, 4 spp");
    w.until("its picture", |s| s.is_held());
    let size = w.state().size_px;
    let held = w.state().on_screen().expect("it").clone();
    assert!([held.width, held.height] == size && held.rgba.len() == before.len() && held.rgba != before);
    w.step();
    let describes = |w: &Window, what: &str| {
        w.harness.get_by_role(Role::Canvas).accesskit_node().description().is_some_and(|d| d.contains(what))
    };
    assert!(describes(&w, "picture of 4 spp"), "{:?}", w.harness.get_by_role(Role::Canvas).accesskit_node().description());
    w.click(Role::CheckBox, "Difference");
    w.until("the difference", |s| s.is_held());
    w.step();
    assert!(describes(&w, "difference from the reference of 4 spp") && w.says("Brightness less the reference's"));
    w.button("Back to the present picture");
    assert!(!w.state().is_held());
    // Another view begins anew.
    w.key(Modifiers::NONE, Key::P);
    w.until("a new curve", |s| s.errors.reference.is_none() && s.errors.curves.len() == 1);
}

#[test]
fn quality_is_measured_structure_by_structure_and_can_be_cancelled() {
    let mut w = open("builtin:lecture", 2);
    w.button("Model");
    assert_eq!(w.state().tradeoffs.plot, Plot::Model);
    assert!(w.says("Not measured. Press Measure."));
    w.button("Measure");
    w.until("two rows", |s| s.tradeoffs.rows.len() >= 2);
    w.step();
    let stop = Instant::now();
    w.button("Cancel");
    assert!(w.state().tradeoffs.running.is_none() && stop.elapsed() < Duration::from_millis(100), "{:?}", stop.elapsed());
    let rows = &w.state().tradeoffs.rows;
    assert_eq!(rows[0].structure, registry::ALL[0].id);
    for row in rows {
        assert!(row.error.is_none() && row.build_secs > 0.0 && row.ns.values().all(|ns| *ns > 0.0), "{row:?}");
        assert_eq!((row.tests.len(), row.boxes.len()), (3, if row.name == "bvh" { 4 } else { 0 }), "{row:?}");
        let ours = row.tests.iter().map(|test| &test.erring).chain(row.boxes.last().map(|test| &test.erring));
        ours.for_each(|erring| assert!(erring.wrong_per_million == 0.0 && erring.rays > 0 && erring.ns > 0.0, "{row:?}"));
    }
    // What is drawn has a place for what is there, and the other plot has the same rows.
    w.button("Intersection");
    assert_eq!(w.state().tradeoffs.plot, Plot::Intersection);
    assert!(!w.says("Not measured. Press Measure."));
}

#[test]
fn two_structures_trace_one_view_on_either_side_of_a_divider() {
    let mut w = Window::with_model("builtin:teapot?triangles=1000");
    w.choose("Shaded", Mode::Nodes.label());
    w.settle();
    // Three clicks: the workspace, the list, the structure.
    w.button("Compare workspace");
    w.choose("No second", "and k-d tree");
    let beside = |s: &State| s.panes.all.first().and_then(|pane| pane.picture.clone());
    w.until("two pictures", |s| s.is_split() && beside(s).is_some_and(|picture| picture.progress.done));
    w.settle();
    let state = w.state();
    let (first, second) = (state.picture.clone().expect("traced"), beside(state).expect("traced"));
    assert_eq!((first.camera, first.range, first.width), (second.camera, second.range, second.width), "one view, one range");
    assert_ne!(first.rgba, second.rgba, "different structures");
    let nodes = |picture: &Picture| picture.progress.counts.nodes as f64 / picture.progress.counted as f64;
    for (name, picture) in [("BVH", &first), ("k-d tree", &second)] {
        assert!(w.says(&format!("{name}: {} nodes", format::number(nodes(picture)))), "{name}");
    }
    // The divider is moved by hand, by keys, and by typing.
    let view = w.viewport();
    let divider = |w: &Window| w.state().settings.panes.places()[0];
    w.drag(view.center(), vec2(-0.25 * view.width(), 0.0), PointerButton::Primary, Modifiers::NONE);
    assert!((divider(&w) - 0.25).abs() < 0.02, "{}", divider(&w));
    let camera = w.state().camera;
    w.key(Modifiers::NONE, Key::ArrowRight);
    assert!((divider(&w) - 0.27).abs() < 0.02 && w.state().camera == camera);
    // Both follow the camera.
    w.drag(view.center() + vec2(60.0, 20.0), vec2(40.0, 0.0), PointerButton::Primary, Modifiers::NONE);
    assert_ne!(w.state().camera, camera);
    w.until("two pictures from there", |s| {
        let there = |picture: &Option<Arc<Picture>>| picture.as_ref().is_some_and(|p| p.camera == s.camera && p.progress.done);
        there(&s.picture) && there(&beside(s))
    });
    // Path traced they stand beside each other, too; curves against seconds are those of a picture alone.
    w.choose(Mode::Nodes.label(), Mode::Path.label());
    w.settle();
    assert!(w.state().is_split() && w.state().errors.curves.is_empty());
    w.choose(Mode::Path.label(), "Shaded");
    w.settle();
    assert!(w.state().is_split());
    w.choose("and k-d tree", "No second");
    w.step();
    assert!(!w.state().is_split());
}
