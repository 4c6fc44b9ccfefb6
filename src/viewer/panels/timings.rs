//! The table of timings, one row a structure, on the same rays, and the same view rasterised.

use eframe::egui::{self, Align, Layout, ProgressBar, RichText, ScrollArea, Ui};
use egui_extras::{Column, TableBuilder, TableRow};

use super::{Commands, heading};
use crate::accel::registry::{Entry, Family};
use crate::lab::{RasterRow, Timing};
use crate::viewer::command::Command;
use crate::viewer::format;
use crate::viewer::marks;
use crate::viewer::state::State;
use crate::viewer::theme::{self, Palette};
use crate::viewer::timings::Row;

/// The columns, with their units and what they mean.
const COLUMNS: [(&str, &str); 6] = [
    ("Build", "Wall-clock time of the build."),
    ("Bytes", "Memory of the structure alone."),
    ("1 spp", "Time to trace one camera ray for each pixel of this view: the median of the rounds."),
    ("Mrays/s", "Millions of camera rays a second, all on the same rays; ± is half the interquartile range."),
    ("Nodes/ray", "Nodes or cells that a ray visits, on average."),
    ("Tests/ray", "Triangles that a ray is tested against, on average."),
];

/// Draws the panel.
pub fn show(ui: &mut Ui, state: &State, commands: &mut Commands) {
    ui.horizontal(|ui| {
        heading(ui, "Timings");
        ui.label(
            RichText::new("Like for like: plain code, one ray at a time, the same triangle test")
                .small()
                .color(Palette::in_ui(ui).dim),
        )
        .on_hover_text("CPU timings; counts carry over to a GPU only for the same tree and traversal.");
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| button(ui, state, commands));
    });
    ScrollArea::horizontal().show(ui, |ui| table(ui, state));
}

fn button(ui: &mut Ui, state: &State, commands: &mut Commands) {
    if let Some(job) = &state.measuring {
        if ui.button("Cancel").on_hover_text("Stop measuring; the table stays as it was.").clicked() {
            commands.push(Command::CancelMeasure);
        }
        let now = job.progress.snapshot();
        ui.add(
            ProgressBar::new(now.fraction.unwrap_or(0.0))
                .desired_width(40.0 * theme::GRID)
                .text(format!("Measuring: {}", now.phase)),
        );
        return;
    }
    let measure = ui.add_enabled(
        state.shown.is_some() && state.building.is_none() && !state.is_checking() && state.needing.is_none(),
        egui::Button::new("Measure"),
    );
    let help = "Build every structure and time all of them on the rays of this view, in turn, at least five rounds and a second each. Rendering rests meanwhile.";
    if measure.on_hover_text(help).clicked() {
        commands.push(Command::Measure);
    }
    if state.timings.view.is_some_and(|(camera, size)| camera != state.camera || size != state.size_px) {
        ui.label(RichText::new("measured on another view").small().color(Palette::in_ui(ui).warn));
    }
}

fn table(ui: &mut Ui, state: &State) {
    let mut table = TableBuilder::new(ui).striped(true).vscroll(true).cell_layout(Layout::right_to_left(Align::Center));
    table = table.column(Column::exact(28.0 * theme::GRID));
    for _ in COLUMNS {
        table = table.column(Column::remainder().at_least(20.0 * theme::GRID));
    }
    table
        .header(theme::ROW, |mut header| {
            header.col(|ui| {
                ui.with_layout(Layout::left_to_right(Align::Center), |ui| ui.label(RichText::new("Structure").small()));
            });
            for (name, help) in COLUMNS {
                header.col(|ui| {
                    ui.label(RichText::new(name).small()).on_hover_text(help);
                });
            }
        })
        .body(|mut body| {
            for (entry, row) in state.timings.rows() {
                body.row(theme::ROW, |mut cells| cells_of(&mut cells, state, entry, &row));
            }
            body.row(theme::ROW, |mut cells| raster(&mut cells, state.timings.raster.as_ref()));
        });
}

fn cells_of(cells: &mut TableRow<'_, '_>, state: &State, entry: &Entry, row: &Row) {
    cells.col(|ui| {
        ui.with_layout(Layout::left_to_right(Align::Center), |ui| {
            marks::dot(ui, entry.family);
            let shown = state.shown.as_ref().is_some_and(|b| b.key.entry.id == entry.id);
            let name = RichText::new(entry.name);
            ui.label(if shown { name.strong() } else { name }).on_hover_text(entry.help);
        });
    });
    let why = row.failed.as_deref().unwrap_or("Not measured. Press Measure.");
    let not_built = row.failed.as_deref().unwrap_or("Not built yet.");
    value(cells, row.build_secs.map(format::duration), not_built);
    value(cells, row.bytes.map(format::bytes), not_built);
    let timing = row.timing.as_ref();
    value(cells, timing.map(one_sample), why);
    cells.col(|ui| {
        let Some(t) = timing else { return missing(ui, why) };
        let fastest = state.timings.is_fastest(t);
        let tie = fastest && state.timings.fastest().is_some_and(|f| f.id != t.id);
        let text = format!("{}{}", rate(t), if tie { " tie" } else { "" });
        let text = if fastest { RichText::new(text).strong() } else { RichText::new(text) };
        let note = t.capped.as_deref().map(|c| format!(" {c}")).unwrap_or_default();
        ui.label(text).on_hover_text(format!("{} rounds of {} rays.{note}", t.rounds, format::count(t.rays as u64)));
    });
    value(cells, timing.map(|t| format::number(t.nodes_per_ray)), why);
    value(cells, timing.map(|t| format::number(t.prims_per_ray)), why);
}

/// The time of one sample for each pixel. A capped structure traced a part of the rays: scaled up to
/// all of them.
fn one_sample(t: &Timing) -> String {
    format::duration(t.secs_median * t.of as f64 / t.rays.max(1) as f64)
}

/// Rays a second and their spread.
fn rate(t: &Timing) -> String {
    let spread = t.mrays_per_sec * t.secs_half_iqr / t.secs_median.max(f64::MIN_POSITIVE);
    format!("{} ±{}", format::number(t.mrays_per_sec), format::number(spread))
}

/// The row of the rasteriser, which builds nothing and visits no nodes.
fn raster(cells: &mut TableRow<'_, '_>, row: Option<&RasterRow>) {
    let drawn = row.map(|row| {
        let (covered, overdraw) = (format::count(row.covered), format::number(row.overdraw));
        let edge = format::count(row.differing.edge);
        format!(": {covered} pixels covered, overdraw {overdraw}, {edge} edge pixels differ")
    });
    let help = format!("Time to rasterise the same view with a z-buffer{}.", drawn.unwrap_or_default());
    cells.col(|ui| {
        ui.with_layout(Layout::left_to_right(Align::Center), |ui| {
            marks::dot(ui, Family::Brute);
            ui.label("Raster").on_hover_text(&help);
        });
    });
    let (none, timing) = ("A rasteriser has no structure.", row.map(RasterRow::timing));
    value(cells, None, none);
    value(cells, None, none);
    value(cells, timing.as_ref().map(one_sample), "Not measured. Press Measure.");
    cells.col(|ui| {
        let Some(t) = &timing else { return missing(ui, "Not measured. Press Measure.") };
        ui.label(rate(t)).on_hover_text(&help);
    });
    value(cells, None, none);
    value(cells, None, none);
}

fn value(cells: &mut TableRow<'_, '_>, text: Option<String>, why_missing: &str) {
    cells.col(|ui| match text {
        Some(text) => {
            ui.label(text);
        }
        None => missing(ui, why_missing),
    });
}

fn missing(ui: &mut Ui, why: &str) {
    ui.label(RichText::new("–").color(Palette::in_ui(ui).dim)).on_hover_text(why);
}
