//! The Check workspace: the lab's matrix, its cases, and the check of the open model.

use std::time::{Duration, Instant};

use boxwood::accel::registry;
use boxwood::geometry::tri::TestKind;
use boxwood::lab::stability::Verdict;
use boxwood::viewer::checks::MarkKind;
use boxwood::viewer::settings::Workspace;
use eframe::egui::{Key, Modifiers, Role};

use crate::window::{Setup, Window};

#[test]
fn the_lab_fills_its_matrix_and_a_click_opens_a_case_with_its_wrong_rays() {
    let mut w = Window::new(Setup { alone: true, ..Setup::default() }).settled();
    w.key(Modifiers::NONE, Key::F5);
    assert_eq!(w.state().settings.workspace, Workspace::Check);
    w.button("Run the lab");
    w.until("the case of shared edges", |s| s.checks.cases.iter().any(|case| case.id == "shared-edges"));
    let stop = Instant::now();
    w.button("Cancel");
    assert!(w.state().checks.running.is_none() && stop.elapsed() < Duration::from_millis(100), "{:?}", stop.elapsed());
    let cases = &w.state().checks.cases;
    let pairs = registry::ALL.iter().map(|entry| entry.tests().count()).sum::<usize>();
    assert!(cases.iter().all(|case| case.structures.len() == pairs));
    assert!(cases.iter().flat_map(|case| &case.structures).all(|row| row.verdict != Verdict::Fail));

    w.button("shared-edges, brute, fast: rays slip through");
    w.until("the case", |s| s.model.as_ref().is_some_and(|m| m.scene.name == "case:shared-edges"));
    w.settle();
    let (shown, test) = (w.shown(), w.state().settings.test);
    assert_eq!((shown, test), (Some("brute"), TestKind::Fast));
    let marks = &w.state().checks.marks;
    assert!(!marks.is_empty() && marks.iter().all(|mark| mark.kind == MarkKind::Wrong));
    assert!(w.says("shared-edges") && w.says("rays slip through"));
    assert!(w.state().settings.recent.iter().all(|model| !model.starts_with("case:")));

    // Where nothing is wrong, some rays show what the case is about; the model stays.
    w.button("shared-edges, bvh, exact: pass");
    w.settle();
    assert_eq!(w.shown(), Some("bvh"));
    let marks = &w.state().checks.marks;
    assert!(!marks.is_empty() && marks.iter().all(|mark| mark.kind == MarkKind::Plain));
    // Another model takes them away.
    w.open_path("builtin:lecture");
    w.until("the model", |s| s.model.as_ref().is_some_and(|m| m.scene.name == "builtin:lecture"));
    assert!(w.state().checks.marks.is_empty());
}

#[test]
fn a_test_that_stands_in_brute_alone_is_left_with_it() {
    let mut w = Window::new(Setup { alone: true, ..Setup::default() }).settled();
    w.key(Modifiers::NONE, Key::F5);
    w.button("Run the lab");
    w.until("a case", |s| !s.checks.cases.is_empty());
    w.button("Cancel");
    w.button("zero-directions, brute, double: pass");
    w.until("the case", |s| s.shown.as_ref().is_some_and(|b| b.key.test == TestKind::Double));
    w.settle();
    w.button("k-d tree");
    w.settle();
    assert_eq!(w.state().shown.as_ref().map(|b| (b.key.entry.id, b.key.test)), Some(("kdtree", TestKind::Watertight)));
    assert!(w.state().error.is_none());
}

#[test]
fn the_open_model_is_checked_and_what_differs_is_marked() {
    let mut w = Window::with_model("builtin:teapot?triangles=1000");
    w.button("Check workspace");
    w.button("Check this model");
    w.until("the check", |s| s.checks.checking.is_none() && s.checks.model.is_some());
    w.settle();
    let check = w.state().checks.model.as_ref().expect("checked");
    assert_eq!(check.structures.len(), registry::ALL.len());
    assert!(check.mesh.boundary_edges > 0 && !check.mesh.is_closed(), "the teapot is open: {:?}", check.mesh);
    assert!(check.structures.iter().all(|row| row.wrong == 0 && row.rays > 0));
    assert!(w.says("Open edges") && w.says("0 wrong"));
    // The matrix is not run for that.
    assert!(w.state().checks.cases.is_empty());

    let row = w.state().checks.model.as_ref().and_then(|check| check.structures.first().cloned()).expect("a row");
    let name = format!("{}: {} wrong, {} rounded", row.id, row.wrong, row.rounded);
    w.button(&name);
    assert_eq!(w.state().checks.marked, Some(0));
    assert_eq!(w.state().checks.marks.len(), row.differing.len());
    w.button(&name);
    assert!(w.state().checks.marked.is_none() && w.state().checks.marks.is_empty());
    w.key(Modifiers::NONE, Key::F1);
    assert!(w.has(Role::Button, "Measure"));
}

#[test]
fn what_was_left_out_and_what_takes_memory_stand_in_the_check_workspace_too() {
    let mut setup = Setup { size: eframe::egui::vec2(1280.0, 800.0), ..Setup::default() };
    setup.options.model = Some("builtin:teapot?triangles=1000".to_owned());
    let mut w = Window::new(setup).settled();
    w.button("k-d tree");
    w.settle();
    w.key(Modifiers::NONE, Key::F5);
    let needs = w.state().model.as_ref().expect("open").needs.clone();
    w.click(Role::DisclosureTriangle, &format!("Left out ({})", needs.iter().filter(|finding| !finding.used).count()));
    w.settle();
    assert!(w.says(&needs.iter().find(|finding| !finding.used).expect("something").why));
    w.click(Role::DisclosureTriangle, &format!("Left out ({})", needs.iter().filter(|finding| !finding.used).count()));
    w.settle();
    w.click(Role::DisclosureTriangle, "Memory");
    w.settle();
    let kept: Vec<&str> = w.state().kept_structures().map(|built| built.key.entry.name).collect();
    assert_eq!(kept, ["k-d tree", "BVH"]);
    assert!(w.says("In use") && w.says("Bytes by part"));
}
