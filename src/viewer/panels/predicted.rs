//! Predicted against measured: a mark for each structure and kind of ray, beside the line on which both are equal.

use eframe::egui::{Label, RichText, Role, ScrollArea, Tooltip, Ui, WidgetInfo};
use egui_plot::{Line, MarkerShape, PlotBounds, PlotPoint, PlotPoints, PlotUi, Points};

use super::axes::log_log;
use super::{as_table, empty, not_there};
use crate::accel::registry::{self, Family};
use crate::lab::plot::Mark;
use crate::lab::prediction::plot::mark;
use crate::lab::prediction::{self, AXES, Agreement, EQUAL, KINDS, Point};
use crate::viewer::format;
use crate::viewer::marks;
use crate::viewer::state::State;
use crate::viewer::theme::{self, Palette};

/// What it is called by screen readers.
const NAME: &str = "predicted against measured";
/// What marks stand for.
const HELP: &str = "Predicted from the areas of cells and fitted costs of nodes and tests. Circles are random lines, squares primary, \
                    diamonds shadow, triangles diffuse rays; point at a mark for its figures.";
/// What is predicted, and how.
const PREDICTOR: &str = "Predicted is one time for all kinds of rays: the nodes and tests that a random line through the model is \
                         expected to meet, by the areas of the cells, times what a node and a test cost, and what any ray does. \
                         These costs are fitted by least squares, none below 0, to blocks of random lines, primary, shadow and \
                         diffuse rays of this view that were timed and counted in the same structure. Nothing cuts a random line \
                         short: rays that end early take less. Measured is the time of all threads together, times their number, \
                         over the rays; costs are fitted to one thread while the others idle. Where threads share cores, or the \
                         machine has other work, all marks may lie above the line for that alone. Marks on the line are \
                         predicted right. All variants that were measured are drawn, brute force too.";
/// Marks told under the pointer, at most.
const TOLD: usize = 6;

/// By how much predictions are off, in one figure and what finding them out took; by kind of ray under the pointer.
pub fn agreement(ui: &mut Ui, state: &State) {
    let rows = &state.tradeoffs.rows;
    let points = prediction::points(rows);
    let Some(all) = Agreement::of(&points) else { return };
    let cost = format::or_missing(prediction::cost(rows), format::duration);
    let said = format!("Off by {} in the mean, for {cost} a structure", format::ratio(all.factor));
    let kind = |kind| {
        let of = Agreement::of(points.iter().filter(|point| point.kind == kind))?;
        Some(format!("{} {}", kind.id(), format::ratio(of.factor)))
    };
    let kinds: Vec<String> = KINDS.into_iter().filter_map(kind).collect();
    let help = format!(
        "The factor between predicted and measured, whichever is more, in the geometric mean of {} marks; by kind of ray: {}. \
         The correlation of their logarithms is {}. Predicting took {cost} a structure in the mean: a walk over its cells, and \
         timing and counting rays for the fit.",
        format::count(all.points as u64),
        kinds.join(", "),
        format::number(all.correlation),
    );
    ui.label(RichText::new(said).small().color(Palette::in_ui(ui).dim)).on_hover_text(help);
}

/// Draws the plot, or its table.
pub fn show(ui: &mut Ui, state: &State) {
    let trade = &state.tradeoffs;
    let points = prediction::points(&trade.rows);
    let missing = prediction::missing(&trade.rows);
    let Some(range) = prediction::range(&points) else {
        return match (trade.running.is_some(), missing.is_empty()) {
            (true, true) => empty(ui, "The first structure is being measured."),
            (false, true) => empty(ui, "Not measured. Press Measure."),
            (_, false) => {
                empty(ui, "Of no structure are both a prediction and a measurement known.");
                not_there(ui, missing);
            }
        };
    };
    let chosen = ui.horizontal(|ui| {
        let chosen = as_table::choice(ui, NAME);
        ui.add(Label::new(RichText::new(HELP).small().color(Palette::in_ui(ui).dim)).wrap()).on_hover_text(PREDICTOR);
        chosen
    });
    not_there(ui, missing);
    if chosen.inner { table(ui, &points) } else { plot(ui, &points, range) }
}

/// The same points as rows, with the fit behind each prediction.
fn table(ui: &mut Ui, points: &[Point<'_>]) {
    let heads = ["Variant", "Rays", AXES[0], AXES[1], "Off", "C_trav, ns", "C_isect, ns", "C_0, ns", "R², fit"];
    let row = |point: &Point<'_>| {
        let costs = point.row.costs.as_ref();
        let [trav, isect, any, explained] = [
            costs.map(|costs| costs.c_trav_ns),
            costs.map(|costs| costs.c_isect_ns),
            costs.map(|costs| costs.c0_ns),
            costs.map(|costs| costs.r_squared),
        ]
        .map(|cost| format::or_missing(cost, format::number));
        let [predicted, measured] = [point.predicted, point.measured].map(format::number);
        let (name, kind) = (point.row.name.clone(), point.kind.id().to_owned());
        [name, kind, predicted, measured, format::signed_percent(point.off()), trav, isect, any, explained]
    };
    ScrollArea::vertical().show(ui, |ui| as_table::show(ui, NAME, heads, points.iter().map(row)));
}

/// What a point is drawn as.
const fn shape(mark: Mark) -> MarkerShape {
    match mark {
        Mark::Circle => MarkerShape::Circle,
        Mark::Square => MarkerShape::Square,
        Mark::Diamond => MarkerShape::Diamond,
        Mark::Triangle => MarkerShape::Up,
    }
}

fn plot(ui: &mut Ui, points: &[Point<'_>], range: [f64; 2]) {
    let (dim, height) = (Palette::in_ui(ui).dim, ui.available_height() - theme::GRID);
    let colors: Vec<_> = points.iter().map(|point| marks::color(ui, family(point))).collect();
    let [low, high] = range.map(f64::log10);
    let shown = log_log("prediction", AXES).height(height).show(ui, |plot| {
        // Both axes as far as each other, whatever is between.
        plot.set_plot_bounds(PlotBounds::from_min_max([low; 2], [high; 2]));
        plot.line(Line::new(EQUAL, PlotPoints::from(vec![[low; 2], [high; 2]])).color(dim).width(1.0));
        for (point, color) in points.iter().zip(colors) {
            let mark = Points::new(String::new(), vec![logs(point)]).color(color).shape(shape(mark(point.kind)));
            plot.points(mark.radius(theme::GRID));
        }
        under_pointer(plot, points)
    });
    let response = shown.response;
    response.widget_info(|| WidgetInfo::labeled(Role::Image, true, format::capital(NAME)));
    let told = shown.inner;
    if response.hovered() && !told.is_empty() {
        Tooltip::for_widget(&response).at_pointer().gap(theme::GUTTER).show(|ui| {
            told.iter().take(TOLD).for_each(|line| drop(ui.label(line)));
            if told.len() > TOLD {
                ui.label(format!("and {} more", told.len() - TOLD));
            }
        });
    }
}

fn family(point: &Point<'_>) -> Family {
    registry::find(&point.row.structure).map_or(Family::Brute, |entry| entry.family)
}

fn logs(point: &Point<'_>) -> [f64; 2] {
    [point.predicted.log10(), point.measured.log10()]
}

/// The points near the pointer, the nearest first, in words.
fn under_pointer(plot: &PlotUi<'_>, points: &[Point<'_>]) -> Vec<String> {
    let Some(pointer) = plot.pointer_coordinate() else { return Vec::new() };
    let pointer = plot.screen_from_plot(pointer);
    let far = |point: &Point<'_>| plot.screen_from_plot(PlotPoint::from(logs(point))).distance(pointer);
    let mut near: Vec<(f32, &Point<'_>)> = points.iter().map(|point| (far(point), point)).collect();
    near.retain(|(far, _)| *far < theme::ROW * 0.5);
    near.sort_by(|a, b| a.0.total_cmp(&b.0));
    near.into_iter().map(|(_, point)| tell(point)).collect()
}

/// `bvh sweep, primary: 120 ns predicted, 100 ns measured, off by +20 %`.
pub fn tell(point: &Point<'_>) -> String {
    let [predicted, measured] = [point.predicted, point.measured].map(format::number);
    let (name, kind, off) = (&point.row.name, point.kind.id(), format::signed_percent(point.off()));
    format!("{name}, {kind}: {predicted} ns predicted, {measured} ns measured, off by {off}")
}
