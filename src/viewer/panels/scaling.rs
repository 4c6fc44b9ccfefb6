//! Time against the number of triangles: builds and rays, a curve for each structure.

use eframe::egui::{Align, Button, Layout, ProgressBar, ScrollArea, Ui, vec2};
use egui_plot::{Legend, Line, LineStyle, MarkerShape, PlotPoints, Points};

use super::axes::log_log;
use super::{Commands, as_table, empty, not_there};
use crate::accel::registry;
use crate::lab::scaling::{Exponent, Point, Scaling};
use crate::viewer::command::Command;
use crate::viewer::state::State;
use crate::viewer::theme;
use crate::viewer::{format, marks};

/// The button, in the row above.
pub fn controls(ui: &mut Ui, state: &State, commands: &mut Commands) {
    ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
        if let Some(job) = &state.tradeoffs.growing {
            if ui.button("Cancel").on_hover_text("Stop measuring; what is drawn stays.").clicked() {
                commands.push(Command::CancelScaling);
            }
            let now = job.progress.snapshot();
            let text = format!("Measuring: {}", now.phase);
            ui.add(ProgressBar::new(now.fraction.unwrap_or(0.0)).desired_width(ui.available_width().min(40.0 * theme::GRID)).text(text));
            return;
        }
        let possible = state.can_measure();
        let help = "Make the model in growing sizes (a built-in scene in each, another one cut finer), build structures over each, and time them on random lines. Rendering rests meanwhile.";
        if ui.add_enabled(possible, Button::new("Measure")).on_hover_text(help).clicked() {
            commands.push(Command::MeasureScaling);
        }
    });
}

/// Draws both plots, or their table.
pub fn show(ui: &mut Ui, state: &State) {
    let trade = &state.tradeoffs;
    if trade.scaling.is_empty() {
        let measured = trade.growing.is_some();
        return empty(ui, if measured { "The model is made in growing sizes." } else { "Not measured. Press Measure." });
    }
    not_there(ui, trade.scaling.iter().filter_map(|row| Some(format!("{}: {}", row.id, row.error.as_ref()?))));
    if as_table::choice(ui, "time against triangles") {
        return table(ui, state);
    }
    let size = vec2((ui.available_width() - theme::GUTTER) * 0.5, ui.available_height() - theme::GRID);
    ui.horizontal_top(|ui| {
        ui.allocate_ui(size, |ui| plot(ui, state, ("builds", "seconds of a build"), |p| p.build_secs, |row| row.build));
        ui.allocate_ui(size, |ui| plot(ui, state, ("rays", "ns a random line"), |p| p.ray_secs * 1e9, |row| row.ray));
    });
}

/// The same points as rows.
fn table(ui: &mut Ui, state: &State) {
    let heads = ["Structure", "Triangles", "Build", "Spread", "ns a random line", "Spread of that"];
    let rows = state.tradeoffs.scaling.iter().flat_map(|row| {
        let name = registry::find(&row.id).map_or(&row.id[..], |entry| entry.short);
        row.points.iter().map(move |p| {
            let [build, build_spread] = [p.build_secs, p.build_spread].map(format::duration);
            let [ray, ray_spread] = [p.ray_secs, p.ray_spread].map(|secs| format::number(secs * 1e9));
            [name.to_owned(), format::count(p.triangles), build, build_spread, ray, ray_spread]
        })
    });
    ScrollArea::vertical().show(ui, |ui| as_table::show(ui, "time against triangles", heads, rows));
}

fn plot(ui: &mut Ui, state: &State, (id, y): (&str, &str), of: fn(&Point) -> f64, law: fn(&Scaling) -> Option<Exponent>) {
    let height = ui.available_height();
    let mut seen = Vec::new();
    let mut curves = Vec::new();
    for row in &state.tradeoffs.scaling {
        let Some(entry) = registry::find(&row.id) else { continue };
        let points = row.points.iter().map(|p| (p.triangles as f64, of(p))).filter(|(n, v)| *n > 0.0 && *v > 0.0);
        let points: Vec<(f64, f64)> = points.collect();
        let exponent = law(row).map(|e| format!(", N^{}", format::number(e.value)));
        // Members of a family have one colour.
        let before = seen.iter().filter(|family| **family == entry.family).count();
        seen.push(entry.family);
        let style = match before {
            0 => LineStyle::Solid,
            1 => LineStyle::dashed_loose(),
            _ => LineStyle::dotted_dense(),
        };
        let name = format!("{}{}", entry.short, exponent.unwrap_or_default());
        let logs: Vec<[f64; 2]> = points.iter().map(|(n, v)| [n.log10(), v.log10()]).collect();
        curves.push((name, style, marks::color(ui, entry.family), logs));
    }
    log_log(id, ["triangles", y]).legend(Legend::default()).height(height).show(ui, |plot| {
        for (name, style, color, logs) in curves {
            let line = Line::new(name.clone(), PlotPoints::from(logs.clone())).color(color).width(theme::CURVE);
            plot.line(line.style(style));
            let points = Points::new(name, PlotPoints::from(logs)).color(color).radius(theme::GRID);
            plot.points(points.shape(MarkerShape::Circle));
        }
    });
}
