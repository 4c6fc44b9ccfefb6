//! Quality against its cost: a point for each variant, or for each test of triangles or boxes in it; those that no other beats at both are
//! joined by a line.

use eframe::egui::{Align, Align2, Button, Color32, ComboBox, Label, Layout, ProgressBar, RichText, ScrollArea, Ui};
use egui_plot::{Line, MarkerShape, PlotPoint, PlotPoints, PlotUi, Points, Text};

use super::axes::log_log;
use super::{Commands, as_table, empty, not_there, predicted};
use crate::accel::registry::{self, Family};
use crate::geometry::tri::TestKind;
use crate::lab::tradeoffs::front;
use crate::viewer::command::Command;
use crate::viewer::format;
use crate::viewer::marks;
use crate::viewer::state::State;
use crate::viewer::theme::{self, Palette};
pub use crate::viewer::tradeoffs::Plot;
use crate::viewer::tradeoffs::{Goodness, Miss};

/// What is chosen, or how far predictions are off, and the button, in the row above.
pub fn controls(ui: &mut Ui, state: &State, commands: &mut Commands) {
    let trade = &state.tradeoffs;
    if trade.plot == Plot::Prediction {
        predicted::agreement(ui, state);
    } else if trade.plot == Plot::Intersection {
        let combo = ComboBox::from_id_salt("miss").selected_text(trade.miss.name()).show_ui(ui, |ui| {
            for miss in Miss::ALL {
                if ui.selectable_label(miss == trade.miss, miss.name()).clicked() {
                    commands.push(Command::Miss(miss));
                }
            }
        });
        combo.response.accessible_name("Error of intersections");
    } else {
        let combo = ComboBox::from_id_salt("goodness")
            .width(48.0 * theme::GRID)
            .height(theme::LONG_MENU)
            .selected_text(trade.goodness.name());
        let combo = combo.show_ui(ui, |ui| {
            for goodness in Goodness::ALL {
                if ui.selectable_label(goodness == trade.goodness, goodness.name()).clicked() {
                    commands.push(Command::Goodness(goodness));
                }
            }
        });
        combo.response.accessible_name("Quality of structures");
    }
    ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
        if let Some((job, _)) = &trade.running {
            if ui.button("Cancel").on_hover_text("Stop measuring; what is drawn stays.").clicked() {
                commands.push(Command::CancelTradeoffs);
            }
            let now = job.progress.snapshot();
            let text = format!("Measuring: {}", now.phase);
            ui.add(ProgressBar::new(now.fraction.unwrap_or(0.0)).desired_width(ui.available_width().min(40.0 * theme::GRID)).text(text));
            return;
        }
        let possible = state.can_measure();
        let help = "Build every structure, and the BVH by every builder, with each triangle test, and time them on rays of this view: some seconds each. Rendering rests meanwhile.";
        if ui.add_enabled(possible, Button::new("Measure")).on_hover_text(help).clicked() {
            commands.push(Command::MeasureTradeoffs);
        }
    });
}

/// A point, with what it is called.
pub struct Spot {
    /// The id of its structure.
    pub structure: &'static str,
    /// What it is called.
    pub name: String,
    /// Where it is.
    pub at: (f64, f64),
    family: Family,
    marker: MarkerShape,
}

/// Names written beside the pointer, at most.
const NAMES: usize = 4;
/// Where nothing is wrong there is no logarithm: drawn below the least that is.
const NONE: f64 = 1.0;

/// The points of a plot.
pub fn spots(state: &State, plot: Plot) -> Vec<Spot> {
    let trade = &state.tradeoffs;
    let mut spots = Vec::new();
    for row in &trade.rows {
        let Some(entry) = registry::find(&row.structure) else { continue };
        let (family, structure) = (entry.family, entry.id);
        if plot == Plot::Intersection {
            for test in &row.tests {
                let marker = match test.test {
                    TestKind::Fast => MarkerShape::Cross,
                    TestKind::Exact => MarkerShape::Diamond,
                    _ => MarkerShape::Circle,
                };
                let (name, error) = (format!("{} {}", row.name, test.test.id()), trade.miss.of(&test.erring).max(NONE));
                spots.push(Spot { structure, family, name, marker, at: (test.erring.ns, error) });
            }
            for test in &row.boxes {
                let (name, error) = (format!("boxes {}", test.test.id()), trade.miss.of(&test.erring).max(NONE));
                spots.push(Spot { structure, family, name, marker: MarkerShape::Square, at: (test.erring.ns, error) });
            }
        } else if let Some(goodness) = trade.goodness.of(row).filter(|_| family != Family::Brute) {
            let marker = marker_of(family);
            spots.push(Spot { structure, family, name: row.name.clone(), marker, at: (row.build_secs, goodness) });
        }
    }
    spots.retain(|spot| spot.at.0 > 0.0 && spot.at.1 > 0.0 && spot.at.0.is_finite() && spot.at.1.is_finite());
    spots
}

/// What is along the axes of a plot.
pub const fn axes(state: &State, plot: Plot) -> [&'static str; 2] {
    let trade = &state.tradeoffs;
    match plot {
        Plot::Intersection => ["ns a hard ray", trade.miss.name()],
        _ => ["seconds of the build", trade.goodness.name()],
    }
}

/// The family's mark, as near as plots have it.
const fn marker_of(family: Family) -> MarkerShape {
    match family {
        Family::Bvh | Family::Brute => MarkerShape::Circle,
        Family::KdTree => MarkerShape::Diamond,
        Family::Grid => MarkerShape::Square,
        Family::Octree => MarkerShape::Up,
        Family::Bsp => MarkerShape::Cross,
    }
}

/// The same points as rows.
fn table(ui: &mut Ui, spots: &[Spot], best: &[bool], [x, y]: [&str; 2]) {
    let row = |(spot, best): (&Spot, &bool)| {
        let beaten = if *best { "by nobody" } else { "at both" };
        [spot.name.clone(), format::number(spot.at.0), format::number(spot.at.1), beaten.to_owned()]
    };
    ScrollArea::vertical().show(ui, |ui| {
        as_table::show(ui, "quality against its cost", ["Variant", x, y, "Beaten"], spots.iter().zip(best).map(row));
    });
}

/// Draws the plot.
pub fn show(ui: &mut Ui, state: &State) {
    let trade = &state.tradeoffs;
    let spots = spots(state, trade.plot);
    if spots.is_empty() {
        empty(
            ui,
            if trade.running.is_some() { "The first structure is being measured." } else { "Not measured. Press Measure." },
        );
        return;
    }
    let palette = Palette::in_ui(ui);
    let colors: Vec<Color32> = spots.iter().map(|spot| marks::color(ui, spot.family)).collect();
    let logs = |spot: &Spot| [spot.at.0.log10(), spot.at.1.log10()];
    let best = front(&spots.iter().map(|spot| spot.at).collect::<Vec<_>>());
    let help = if trade.plot == Plot::Intersection {
        "Circles are watertight, crosses fast, diamonds exact tests of triangles. Squares are tests of boxes, in a plain tree of the \
         boxes of bvh with the watertight test. Nothing wrong is drawn at 1. Joined are those that nobody beats at both; point at a mark for its name."
    } else {
        "Filled points, joined by a line, are beaten by nobody at both; point at another for its name. Brute force, far above all others, is not drawn."
    };
    let as_table = ui.horizontal(|ui| {
        let chosen = as_table::choice(ui, "quality against its cost");
        ui.add(Label::new(RichText::new(help).small().color(palette.dim)).wrap());
        chosen
    });
    not_there(ui, trade.rows.iter().filter_map(|row| Some(format!("{}: {}", row.name, row.error.as_ref()?))));
    if as_table.inner {
        return table(ui, &spots, &best, axes(state, trade.plot));
    }
    let id = if trade.plot == Plot::Intersection { "intersection" } else { "model" };
    let height = ui.available_height() - theme::GRID;
    log_log(id, axes(state, trade.plot)).height(height).show(ui, |plot| {
        let mut joined: Vec<[f64; 2]> = spots.iter().zip(&best).filter(|(_, best)| **best).map(|(spot, _)| logs(spot)).collect();
        joined.sort_by(|a, b| a[0].total_cmp(&b[0]));
        plot.line(Line::new("nobody is better at both", PlotPoints::from(joined)).color(palette.dim).width(1.0));
        for ((spot, color), best) in spots.iter().zip(&colors).zip(&best) {
            let points = Points::new(String::new(), vec![logs(spot)]).color(*color).shape(spot.marker);
            plot.points(points.radius(theme::GRID + f32::from(u8::from(*best))).filled(*best));
        }
        let label = |plot: &mut PlotUi<'_>, [x, y]: [f64; 2], name: &str, color| {
            let text = RichText::new(format!("  {name}")).small().color(color);
            plot.text(Text::new(String::new(), PlotPoint::new(x, y), text).anchor(Align2::LEFT_CENTER));
        };
        // Names of all would lie over each other.
        for (spot, _) in spots.iter().zip(&best).filter(|(_, best)| **best) {
            label(plot, logs(spot), &spot.name, palette.text);
        }
        if let Some(pointer) = plot.pointer_coordinate() {
            let place = |[x, y]: [f64; 2]| plot.screen_from_plot(PlotPoint::new(x, y));
            let near = |spot: &&Spot| place(logs(spot)).distance(place([pointer.x, pointer.y])) < theme::ROW * 0.5;
            let names: Vec<&str> = spots.iter().filter(near).map(|spot| &spot.name[..]).take(NAMES).collect();
            label(plot, [pointer.x, pointer.y], &names.join(", "), palette.accent_text);
        }
    });
}
