//! Predicted against measured, in the Compare workspace: a mark for each figure at its place, told under the pointer, as a
//! table, and saved.

use std::fs;
use std::path::Path;

use boxwood::lab::prediction::{self, AXES, KINDS, Point};
use boxwood::viewer::panels::predicted::tell;
use boxwood::viewer::state::State;
use boxwood::viewer::tradeoffs::Plot;
use boxwood::viewer::{ViewerOptions, format};
use eframe::egui::{Key, Modifiers, Pos2, Rect, Role, Shape, pos2};
use egui_kittest::kittest::Queryable;

use crate::window::{Setup, Window};

const NAME: &str = "Predicted against measured";

/// The Compare workspace, whose dialogs answer with this path.
fn open(answer: &Path) -> Window {
    let options = ViewerOptions { model: Some("builtin:lecture".to_owned()), samples: Some(2), ..ViewerOptions::default() };
    let answer = Some(answer.to_path_buf());
    let mut w = Window::new(Setup { alone: true, options, answer, ..Setup::default() }).settled();
    w.key(Modifiers::NONE, Key::F4);
    w
}

fn points(state: &State) -> Vec<Point<'_>> {
    prediction::points(&state.tradeoffs.rows)
}

/// Where the middles of small shapes are that were drawn in a part of the window.
fn marks(w: &Window, within: Rect) -> Vec<Pos2> {
    fn gather(shape: &Shape, all: &mut Vec<Rect>) {
        match shape {
            Shape::Vec(shapes) => shapes.iter().for_each(|shape| gather(shape, all)),
            Shape::Circle(_) | Shape::Path(_) => all.push(shape.visual_bounding_rect()),
            _ => {}
        }
    }
    let mut all = Vec::new();
    w.harness.output().shapes.iter().for_each(|clipped| gather(&clipped.shape, &mut all));
    let small = |rect: &Rect| rect.width() > 3.0 && rect.width() < 14.0 && within.contains(rect.center());
    all.into_iter().filter(small).map(|rect| rect.center()).collect()
}

/// Where a point belongs in the plot.
fn place(plot: Rect, range: [f64; 2], point: &Point<'_>) -> Pos2 {
    let [low, high] = range.map(f64::log10);
    let part = |ns: f64| ((ns.log10() - low) / (high - low)) as f32;
    pos2(plot.left() + plot.width() * part(point.predicted), plot.bottom() - plot.height() * part(point.measured))
}

#[test]
fn every_figure_is_a_mark_at_its_place_and_told_under_the_pointer() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut w = open(&folder.path().join("predicted"));
    w.button("Prediction");
    assert_eq!(w.state().tradeoffs.plot, Plot::Prediction);
    assert!(w.says("Not measured. Press Measure.") && !w.has(Role::Image, NAME) && !w.has(Role::Button, "Save prediction"));
    w.button("Measure");
    w.step();
    assert!(w.says("The first structure is being measured."));
    w.until("two structures", |s| points(s).len() >= 2 * KINDS.len());
    w.button("Cancel");
    w.settle();

    let all = points(w.state());
    assert!(w.state().tradeoffs.rows.iter().all(|row| row.costs.is_some() && row.prediction_secs > Some(0.0)));
    assert_eq!(all.len(), KINDS.len() * w.state().tradeoffs.rows.len(), "none is left out");
    let plot = w.harness.get_by_role_and_label(Role::Image, NAME).rect();
    let range = prediction::range(&all).expect("there are some");
    let drawn = marks(&w, plot);
    assert_eq!(drawn.len(), all.len());
    for point in &all {
        let at = place(plot, range, point);
        assert!(drawn.iter().any(|mark| mark.distance(at) < 2.0), "{}: {at:?} of {drawn:?}", tell(point));
    }
    assert!(AXES.iter().all(|axis| w.says(axis)));
    let off = prediction::Agreement::of(&all).expect("there are some");
    assert!(w.says(&format!("Off by {} in the mean, for ", format::ratio(off.factor))));
    let told = all.iter().map(|point| (place(plot, range, point), tell(point))).max_by(|a, b| a.0.x.total_cmp(&b.0.x));
    let (at, told) = told.expect("there are some");
    assert!(!w.says(&told));
    w.harness.hover_at(at);
    w.harness.run_steps(4);
    assert!(w.says(&told), "{told}");
    w.harness.remove_cursor();
    w.harness.run_steps(2);
    assert!(!w.says(&told));

    // The same in rows, and in files.
    w.click(Role::CheckBox, "Show as table: predicted against measured");
    w.step();
    let row = points(w.state())[0];
    let cells = [row.row.name.clone(), format::number(row.predicted), format::number(row.measured)];
    assert!(cells.iter().all(|cell| w.says(cell)) && !w.has(Role::Image, NAME), "{cells:?}");
    let rows = points(w.state()).len();
    w.button("Save prediction");
    w.button("Table as CSV…");
    w.until("a table", |s| s.exports.said.is_some());
    let csv = fs::read_to_string(folder.path().join("predicted.csv")).expect("there");
    assert_eq!(csv.lines().count(), 1 + rows, "{csv}");
    for point in points(w.state()) {
        let begins = format!("{},{},{},{},", point.row.name, point.kind.id(), point.predicted, point.measured);
        assert!(csv.lines().any(|line| line.starts_with(&begins)), "{begins}: {csv}");
    }
    w.button("Save prediction");
    w.button("Plot as SVG…");
    w.until("a plot", |s| s.exports.said.as_ref().is_some_and(|said| said.ends_with(".svg")));
    let svg = fs::read_to_string(folder.path().join("predicted.svg")).expect("there");
    assert!(svg.starts_with("<svg") && svg.contains("builtin:lecture: predicted against measured") && !svg.contains("NaN"));
    for said in ["predicted = measured", AXES[0], AXES[1], "lines", "diffuse"] {
        assert_eq!(svg.matches(&format!("\n{said}\n")).count(), 1, "{said}");
    }
    // Two circles for each structure's random lines and one in the list; corners for the other three kinds, and the list.
    let structures = rows / KINDS.len();
    assert_eq!((svg.matches("<circle").count(), svg.matches("<polygon").count()), (2 * structures + 1, 3 * structures + 3));
}
