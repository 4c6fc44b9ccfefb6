//! No text is cut off, hidden or written over, in windows small and large.

use boxwood::lab::RayKind;
use boxwood::viewer::theme;
use eframe::egui::{self, Modifiers, PointerButton, Rect, Vec2, vec2};
use egui_kittest::kittest::{NodeT, Queryable};

use crate::files::{self, Files};
use crate::window::{Painted, Setup, Window};

/// A window as it is tried, and how.
struct Case {
    name: &'static str,
    /// In points, as the system counts them.
    size: Vec2,
    pixels_per_point: f32,
    /// The user's own enlargement.
    scale: f32,
}

const fn case(name: &'static str, width: f32, height: f32, pixels_per_point: f32, scale: f32) -> Case {
    Case { name, size: Vec2::new(width, height), pixels_per_point, scale }
}

const CASES: [Case; 6] = [
    case("960x600", 960.0, 600.0, 1.0, 1.0),
    case("1280x800", 1280.0, 800.0, 1.0, 1.0),
    case("3840x2160 at 2", 1920.0, 1080.0, 2.0, 1.0),
    case("960x600, all smaller", 960.0, 600.0, 1.0, 0.75),
    case("1280x800, all larger", 1280.0, 800.0, 1.0, 1.25),
    case("3840x2160 at 2, all twice as large", 1920.0, 1080.0, 2.0, 2.0),
];

/// Letters may reach this far over an edge: the space beside them does.
const SLACK: f32 = 1.0;

/// Text that is never scrolled away.
const ALWAYS: [&str; 12] =
    ["File", "View", "Window", "Help", "SCENE", "TIMINGS", "Measure", "BVH", "k-d", "Grid", "Brute", "Shaded"];

/// What stands beside the bar because it belongs to the panel there.
const BESIDE: [&str; 13] = [
    "Statistics",
    "This model",
    "Check this model",
    "Selected cell",
    "Ray",
    "Parent",
    "Child",
    "Sibling",
    "Frame",
    "Copy",
    "Open rays…",
    "Close rays",
    "Save statistics",
];

fn open(case: &Case, options: impl FnOnce(&mut Setup)) -> Window {
    let mut setup = Setup { size: case.size, pixels_per_point: case.pixels_per_point, ..Setup::default() };
    options(&mut setup);
    let mut w = Window::new(setup);
    w.scale(case.scale);
    w.ready();
    w
}

/// What is wrong with the text of the last frame.
fn complaints(w: &Window) -> Vec<String> {
    let screen = w.harness.ctx.content_rect();
    let texts = w.texts();
    let visible: Vec<(&Painted, Rect)> =
        texts.iter().map(|t| (t, t.rect.intersect(t.clip).intersect(screen))).filter(|(_, r)| r.is_positive()).collect();
    let mut wrong = Vec::new();
    for t in texts.iter().filter(|t| !t.text.is_empty()) {
        let beside = t.rect.y_range().intersection(t.clip.y_range()).span() > SLACK && !t.rect.intersect(t.clip).is_positive();
        if beside {
            wrong.push(format!("out of sight at a side: {:?}", t.text));
        }
    }
    for (t, seen) in &visible {
        if t.elided {
            wrong.push(format!("shortened: {:?}", t.text));
        }
        // Downwards a list may go on where it is scrolled to; sideways nothing is cut.
        if seen.width() + SLACK < t.rect.width() {
            wrong.push(format!("cut off at a side: {:?}, {:.0} of {:.0} points", t.text, seen.width(), t.rect.width()));
        }
    }
    for (i, (a, ra)) in visible.iter().enumerate() {
        for (b, rb) in &visible[..i] {
            let both = ra.intersect(*rb);
            if both.width() > SLACK && both.height() > SLACK {
                wrong.push(format!("over each other: {:?} and {:?}", a.text, b.text));
            }
        }
    }
    // What is beside the visible part of the bar is not even drawn.
    let view = w.viewport();
    for node in w.harness.query_all_by(|n| n.label().is_some() && n.raw_bounds().is_some()) {
        let rect = node.rect();
        let beside = node.accesskit_node().label().is_some_and(|label| BESIDE.contains(&label.as_str()));
        let in_bar = !beside && rect.center().y < view.top() && rect.center().y > theme::TOP_BAR && rect.left() >= view.left();
        if in_bar && rect.right() > view.right() + SLACK && rect.left() < view.right() + 400.0 {
            wrong.push(format!("beside the bar: {:?}", node.accesskit_node().label()));
        }
    }
    for name in ALWAYS {
        let whole = |(t, seen): &(&Painted, Rect)| t.text == name && seen.height() + SLACK >= t.rect.height();
        if !visible.iter().any(whole) {
            wrong.push(format!("not to be seen: {name:?}"));
        }
    }
    wrong
}

#[track_caller]
fn check(w: &mut Window, case: &Case, what: &str, wrong: &mut Vec<String>) {
    w.harness.remove_cursor();
    w.step();
    w.harness.run_steps(2);
    wrong.extend(complaints(w).into_iter().map(|c| format!("{}, {what}: {c}", case.name)));
}

#[track_caller]
fn report(mut wrong: Vec<String>) {
    wrong.dedup();
    assert!(wrong.is_empty(), "{} complaints:\n{}", wrong.len(), wrong.join("\n"));
}

#[test]
fn no_text_is_cut_off_or_written_over() {
    let mut wrong = Vec::new();
    for case in &CASES {
        let mut w = open(case, |_| {});
        check(&mut w, case, "as it opens", &mut wrong);
        for button in ["k-d tree", "Grid"] {
            w.button(button);
            w.ready();
            check(&mut w, case, button, &mut wrong);
        }
        w.choose("Shaded", "Primitives tested");
        w.until("a heat map", |s| s.picture.as_ref().is_some_and(|p| p.range.max > 1.0));
        // The label in the bar is another now.
        let mut heat = Vec::new();
        check(&mut w, case, "heat map", &mut heat);
        wrong.extend(heat.into_iter().filter(|c| !c.ends_with("\"Shaded\"")));
    }
    report(wrong);
}

#[test]
fn no_text_is_cut_off_with_everything_open() {
    let files = Files::new();
    let long = "a name as long as people give them, with a date and a version, 2024-06-01 final v3.ply";
    let path = files.write(long, files::ply());
    let mut wrong = Vec::new();
    for case in &CASES {
        let mut w = open(case, |s| s.options.model = Some("builtin:teapot?triangles=1000".into()));
        w.click(egui::Role::DisclosureTriangle, "Parameters");
        w.click(egui::Role::CheckBox, "Range of depths");
        w.step();
        check(&mut w, case, "parameters", &mut wrong);
        w.drag(w.viewport().center(), Vec2::ZERO, PointerButton::Primary, Modifiers::NONE);
        w.until("what was clicked", |s| s.picked.is_some());
        check(&mut w, case, "a click", &mut wrong);
        w.open_path(&files.missing("a model that is not where it was, in a folder of a long name.gltf").to_string_lossy());
        w.until("an error", |s| s.error.is_some());
        check(&mut w, case, "an error", &mut wrong);
        w.open_path(&path.to_string_lossy());
        w.until("the file", |s| s.model.as_ref().is_some_and(|m| m.geometry.triangle_count() == 2));
        w.ready();
        check(&mut w, case, "a long name", &mut wrong);
    }
    report(wrong);
}

#[test]
fn no_text_is_cut_off_in_a_full_table() {
    let case = &CASES[0];
    let mut w = open(case, |s| s.alone = true);
    let mut wrong = Vec::new();
    w.button("Measure");
    w.step();
    let mut busy = Vec::new();
    check(&mut w, case, "measuring", &mut busy);
    wrong.extend(busy.into_iter().filter(|c| !c.ends_with("\"Measure\"")));
    w.until("timings", |s| s.measuring.is_none() && s.timings.view.is_some());
    w.settle();
    check(&mut w, case, "measured", &mut wrong);
    w.drag(w.viewport().center(), vec2(60.0, 0.0), PointerButton::Middle, Modifiers::NONE);
    w.settle();
    check(&mut w, case, "measured on another view", &mut wrong);
    report(wrong);
}

#[test]
fn no_text_is_cut_off_in_the_check_workspace() {
    let mut wrong = Vec::new();
    for (i, case) in CASES.iter().enumerate() {
        let mut w = open(case, |s| s.options.model = Some("builtin:teapot?triangles=1000".into()));
        w.key(Modifiers::NONE, egui::Key::F5);
        check(&mut w, case, "the Check workspace", &mut wrong);
        // What a run takes is too long for all.
        if i < 2 {
            w.button("Run the lab");
            w.until("a case", |s| !s.checks.cases.is_empty());
            check(&mut w, case, "the lab runs", &mut wrong);
            w.button("Cancel");
            w.button("zero-directions, bvh, fast: pass");
            w.until("the case", |s| s.model.as_ref().is_some_and(|m| m.scene.name.starts_with("case:")));
            w.ready();
            check(&mut w, case, "a cell", &mut wrong);
        }
        if w.has(egui::Role::Button, "Check this model") {
            w.button("Check this model");
            w.until("the check", |s| s.checks.model.is_some());
            check(&mut w, case, "a check", &mut wrong);
        }
    }
    // Timings stand in another workspace.
    wrong.retain(|c| !["\"TIMINGS\"", "\"Measure\""].iter().any(|name| c.ends_with(name)));
    report(wrong);
}

#[test]
fn no_text_is_cut_off_around_a_tree_and_a_ray() {
    let mut wrong = Vec::new();
    for case in &CASES {
        let mut w = open(case, |s| s.options.model = Some("builtin:teapot?triangles=1000".into()));
        w.key(Modifiers::NONE, egui::Key::F2);
        w.until("the tree", |s| s.tree.outline.is_some());
        check(&mut w, case, "a tree", &mut wrong);
        w.button("Deepest leaf");
        w.settle();
        check(&mut w, case, "a leaf of the tree", &mut wrong);
        w.button("Make the film");
        w.until("the film", |s| s.filming.film.is_some());
        w.key(Modifiers::NONE, egui::Key::Period);
        w.settle();
        check(&mut w, case, "a film", &mut wrong);
        w.key(Modifiers::NONE, egui::Key::F3);
        check(&mut w, case, "no ray", &mut wrong);
        let at = w.viewport().center();
        w.press_in_one_frame(at);
        w.until("steps", |s| !s.rays.columns.is_empty());
        check(&mut w, case, "a ray", &mut wrong);
        if w.has(egui::Role::Button, "k-d tree beside") {
            w.button("k-d tree beside");
            w.settle();
            w.button("Grid beside");
            w.settle();
            check(&mut w, case, "a ray in three structures", &mut wrong);
        }
    }
    // Timings stand in another workspace, and so does the scene beside the tree.
    wrong.retain(|c| !["\"TIMINGS\"", "\"Measure\"", "\"SCENE\""].iter().any(|name| c.ends_with(name)));
    report(wrong);
}

#[test]
fn pages_fit_small_windows() {
    let mut wrong = Vec::new();
    for case in &CASES[..2] {
        let mut w = open(case, |_| {});
        w.key(Modifiers::NONE, egui::Key::Questionmark);
        w.step();
        let page = w.harness.get_by_role_and_label(egui::Role::Window, "Keys and mouse").rect();
        if !w.harness.ctx.content_rect().contains_rect(page) {
            wrong.push(format!("{}: the page of keys is too large: {page}", case.name));
        }
        w.key(Modifiers::NONE, egui::Key::Escape);
        w.key(Modifiers::COMMAND, egui::Key::Comma);
        w.step();
        let page = w.harness.get_by_role_and_label(egui::Role::Window, "Settings").rect();
        let most = w.harness.get_by_role_and_label(egui::Role::RadioButton, "4096").rect();
        if most.height() > 1.5 * theme::ROW || most.width() < 1.5 * theme::ROW {
            wrong.push(format!("{}: words of the page of settings are broken: {most}", case.name));
        }
        if !w.harness.ctx.content_rect().contains_rect(page) {
            wrong.push(format!("{}: the page of settings is too large: {page}", case.name));
        }
    }
    report(wrong);
}

#[test]
fn a_narrow_window_folds_the_statistics() {
    let mut w = open(&CASES[0], |_| {});
    assert!(w.harness.ctx.content_rect().width() < theme::FOLD_BELOW);
    assert!(!w.says("SAH cost"));
    w.button("Statistics");
    w.step();
    assert!(w.says("SAH cost"));
}

#[test]
fn the_folded_panel_is_worked_in_and_stays_open() {
    let mut w = open(&case("narrow", 1000.0, 1100.0, 1.0, 1.0), |_| {});
    w.button("Statistics");
    w.step();
    w.click(egui::Role::DisclosureTriangle, "Prediction");
    w.harness.run_steps(2);
    assert!(w.state().unfolded && w.says("SAH cost"));
    // Another workspace has another panel there; a list in it opens over it.
    w.key(Modifiers::NONE, egui::Key::F3);
    w.choose("The pixel's ray", "Shadow ray from there");
    assert_eq!(w.state().rays.kind, RayKind::Shadow);
    w.click(egui::Role::TextInput, "Ray as text");
    w.harness.event(egui::Event::Text("0 0 5  0 0 -1".to_owned()));
    w.step();
    w.key(Modifiers::NONE, egui::Key::Enter);
    w.until("the ray", |s| !s.rays.columns.is_empty());
    w.step();
    assert!(w.state().unfolded && w.has(egui::Role::TextInput, "Ray as text"));
    // It is as high as the window leaves room for, and closed by its button or Esc.
    w.button("Ray");
    w.step();
    assert!(!w.state().unfolded && !w.has(egui::Role::TextInput, "Ray as text"));
    w.button("Ray");
    w.key(Modifiers::NONE, egui::Key::Escape);
    w.step();
    assert!(!w.state().unfolded);
}

#[test]
fn the_tree_keeps_half_of_the_height() {
    for case in &CASES {
        let mut w = open(case, |s| s.options.model = Some("builtin:teapot?triangles=1000".into()));
        w.key(Modifiers::NONE, egui::Key::F2);
        w.until("the tree", |s| s.tree.outline.is_some());
        w.harness.run_steps(3);
        let tree = w.harness.get_by_role_and_label(egui::Role::Tree, "Cells").rect();
        // Its heading and its buttons are above.
        let room = w.harness.ctx.content_rect().height() - theme::TOP_BAR - theme::ROW;
        assert!(tree.height() >= 0.5 * room - 8.0 * theme::ROW, "{}: {tree} of {room}", case.name);
    }
}
