//! What people come for, each in a few clicks from a fresh window.

use boxwood::viewer::settings::Workspace;
use boxwood::viewer::theme;
use eframe::egui::{Modifiers, PointerButton, Pos2, Role, Vec2, pos2, vec2};
use egui_kittest::kittest::Queryable;

use crate::files::{self, Files};
use crate::window::{Setup, Window};

/// A fresh window, and how often it was clicked.
struct Clicks {
    w: Window,
    made: u32,
}

impl Clicks {
    fn fresh(options: impl FnOnce(&mut Setup)) -> Self {
        let mut setup = Setup { size: vec2(1280.0, 800.0), ..Setup::default() };
        setup.options.model = Some("builtin:teapot?triangles=1000".to_owned());
        options(&mut setup);
        Self { w: Window::new(setup).settled(), made: 0 }
    }

    fn on(&mut self, role: Role, name: &str) {
        self.w.click(role, name);
        self.made += 1;
    }

    fn at(&mut self, at: Pos2) {
        self.w.press_in_one_frame(at);
        self.made += 1;
    }

    #[track_caller]
    fn within(&self, budget: u32) {
        assert!(self.made <= budget, "{} clicks where {budget} are allowed", self.made);
    }
}

#[test]
fn a_model_is_opened_in_two() {
    let files = Files::new();
    let path = files.write("quad.ply", files::ply());
    let mut c = Clicks::fresh(|s| s.answer = Some(path));
    c.on(Role::Button, "File");
    c.w.button_that_contains("Open…");
    c.made += 1;
    c.w.until("the file", |s| s.model.as_ref().is_some_and(|m| m.geometry.triangle_count() == 2));
    c.within(2);
}

#[test]
fn boxes_are_at_depth_six_in_one() {
    let mut c = Clicks::fresh(|_| {});
    let deepest = c.w.state().shown.as_ref().and_then(|shown| shown.stats.as_ref()).expect("counted").max_depth;
    assert!(deepest > 7);
    let slider = c.w.harness.get_by_role_and_label(Role::Slider, "Depth").rect();
    // The handle's middle goes from one end of the rail to the other, less its own radius.
    let radius = slider.height() / 2.5;
    let way = theme::SHORT_SLIDER - 2.0 * radius;
    let at = pos2(slider.left() + radius + way * 6.0 / deepest as f32, slider.center().y);
    // A press that holds for a moment, as a hand's does.
    c.w.drag(at, Vec2::ZERO, PointerButton::Primary, Modifiers::NONE);
    c.made += 1;
    c.w.settle();
    assert_eq!(c.w.state().settings.overlay.depth, 6);
    c.within(1);
}

#[test]
fn the_deepest_leaf_and_the_dearest_cell_are_found_in_three() {
    for name in ["Deepest leaf", "Dearest cell"] {
        let mut c = Clicks::fresh(|_| {});
        c.on(Role::Button, "Structure workspace");
        c.w.until("the tree", |s| s.tree.outline.is_some());
        c.on(Role::Button, name);
        c.w.settle();
        assert!(c.w.state().picked.is_some(), "{name}");
        c.within(3);
    }
}

#[test]
fn why_a_node_was_divided_so_is_told_in_four() {
    let mut c = Clicks::fresh(|_| {});
    c.on(Role::Button, "Structure workspace");
    c.w.until("the tree", |s| s.tree.outline.is_some());
    c.w.step();
    let row = c.w.harness.get_by(|n| n.role() == Role::TreeItem && n.label().is_some_and(|l| l.starts_with("node 0, "))).rect();
    c.at(row.center());
    c.w.settle();
    assert!(c.w.says("Chosen") && c.w.has(Role::Image, "SAH cost over candidate planes"));
    c.within(4);
}

#[test]
fn why_a_pixel_is_slow_is_told_in_three() {
    let mut c = Clicks::fresh(|_| {});
    c.on(Role::Button, "Ray workspace");
    let at = c.w.viewport().center();
    c.at(at);
    c.w.until("its steps", |s| s.rays.columns.first().is_some_and(|column| column.followed.steps.len() > 3));
    c.within(3);
}

#[test]
fn two_structures_are_compared_on_this_view_in_three() {
    let mut c = Clicks::fresh(|_| {});
    c.on(Role::Button, "Compare workspace");
    c.w.choose("No second", "and k-d tree");
    c.made += 2;
    c.w.until("two pictures", boxwood::viewer::state::State::is_split);
    c.within(3);
}

#[test]
fn all_structures_are_measured_in_two() {
    let mut c = Clicks::fresh(|s| s.alone = true);
    c.on(Role::Button, "Measure");
    c.w.until("timings", |s| s.measuring.is_none() && s.timings.view.is_some());
    assert_eq!(c.w.state().settings.workspace, Workspace::View);
    c.within(2);
}

#[test]
fn what_was_left_out_is_told_in_two() {
    // As tall as the panel: scrolling is no click.
    let mut c = Clicks::fresh(|s| s.size = vec2(1400.0, 1600.0));
    let left_out = c.w.state().model.as_ref().expect("open").needs.iter().filter(|finding| !finding.used).count();
    c.on(Role::DisclosureTriangle, &format!("Left out ({left_out})"));
    c.w.settle();
    let first =
        c.w.state().model.as_ref().and_then(|model| model.needs.iter().find(|finding| !finding.used).cloned()).expect("one");
    assert!(c.w.says(&first.why));
    c.within(2);
}

#[test]
fn the_report_is_exported_in_three() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().to_path_buf();
    let mut c = Clicks::fresh(|s| (s.answer, s.alone) = (Some(path), true));
    c.on(Role::Button, "File");
    c.on(Role::Button, "Export report…");
    c.w.until("its start", |s| s.exports.report.is_some());
    // It takes longer than anything else here.
    let start = std::time::Instant::now();
    while c.w.state().exports.report.is_some() && start.elapsed().as_secs() < 300 {
        c.w.step();
        std::thread::sleep(std::time::Duration::from_millis(20));
    }
    assert_eq!(c.w.state().error, None);
    assert!(c.w.state().exports.said.as_ref().is_some_and(|said| said.starts_with("Report written to ")));
    let report = folder.path().join("teapot report");
    let page = std::fs::read_to_string(report.join("index.html")).expect("the page");
    assert!(page.contains("builtin:teapot?triangles=1000") && page.contains("<svg") && page.trim_end().ends_with("</html>"));
    for name in ["report.json", "structures.csv", "convergence.csv", "reference.exr"] {
        assert!(report.join(name).is_file(), "{name}");
    }
    c.within(3);
}
