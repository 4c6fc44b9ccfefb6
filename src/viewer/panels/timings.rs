//! The table of timings, one row a structure, on the same rays, and the same view rasterised. A click on a column sorts.

use eframe::egui::{self, Align, Button, ComboBox, Layout, ProgressBar, Rect, RichText, ScrollArea, Ui, pos2};
use egui_extras::{Column, TableBuilder, TableRow};

use super::{Commands, heading, saves};
use crate::accel::registry::{Entry, Family};
use crate::lab::{Fairness, RasterRow, Timing};
use crate::viewer::command::Command;
use crate::viewer::format;
use crate::viewer::marks;
use crate::viewer::sheets::What;
use crate::viewer::state::State;
use crate::viewer::theme::{self, Palette};
use crate::viewer::timings::{Column as By, Row, secs_of_sample};

/// Draws the panel.
pub fn show(ui: &mut Ui, state: &State, commands: &mut Commands) {
    ui.horizontal(|ui| {
        heading(ui, "Timings");
        terms(ui, state, commands);
        saves::show(ui, What::Timings, state, commands);
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| button(ui, state, commands));
    });
    ScrollArea::horizontal().show(ui, |ui| table(ui, state, commands));
}

/// On which terms structures are timed.
fn terms(ui: &mut Ui, state: &State, commands: &mut Commands) {
    let now = state.terms_of_timings.fairness;
    ui.add_enabled_ui(state.measuring.is_none(), |ui| {
        let combo = ComboBox::from_id_salt("terms").selected_text(now.name()).show_ui(ui, |ui| {
            for fairness in Fairness::ALL {
                if ui.selectable_label(fairness == now, fairness.name()).on_hover_text(fairness.help()).clicked() {
                    commands.push(Command::Fairness(fairness));
                }
            }
        });
        let help = format!("{} CPU timings; counts carry over to a GPU only for the same tree and traversal.", now.help());
        combo.response.accessible_name("Terms of the comparison").on_hover_text(help);
    });
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
    let measure = ui.add_enabled(state.can_measure(), egui::Button::new("Measure"));
    let help = "Build every structure and time all of them on the rays of this view, in turn, at least five rounds and a second each. Rendering rests meanwhile.";
    if measure.on_hover_text(help).clicked() {
        commands.push(Command::Measure);
    }
    if state.timings.view.is_some_and(|(camera, size)| camera != state.camera || size != state.size_px) {
        ui.label(RichText::new("measured on another view").small().color(Palette::in_ui(ui).warn));
    } else if state.timings.view.is_some() && state.timings.fairness != state.terms_of_timings.fairness {
        let said = format!("measured: {}", state.timings.fairness.name().to_lowercase());
        ui.label(RichText::new(said).small().color(Palette::in_ui(ui).warn));
    }
}

fn table(ui: &mut Ui, state: &State, commands: &mut Commands) {
    let mut table = TableBuilder::new(ui).striped(true).vscroll(true).cell_layout(Layout::right_to_left(Align::Center));
    table = table.column(Column::exact(28.0 * theme::GRID));
    for _ in 1..By::ALL.len() {
        table = table.column(Column::remainder().at_least(20.0 * theme::GRID));
    }
    let raster = state.timings.raster.as_ref().map(|raster| raster.mrays_per_sec);
    let most = state.timings.fastest().map(|t| t.mrays_per_sec).into_iter().chain(raster).fold(0.0, f64::max);
    table
        .header(theme::ROW, |mut header| {
            for column in By::ALL {
                header.col(|ui| {
                    let layout = if column == By::Structure { Layout::left_to_right } else { Layout::right_to_left };
                    ui.with_layout(layout(Align::Center), |ui| head(ui, state, column, commands));
                });
            }
        })
        .body(|mut body| {
            for (entry, row) in state.timings.sorted(&state.terms_of_timings) {
                body.row(theme::ROW, |mut cells| cells_of(&mut cells, state, (entry, row), most));
            }
            body.row(theme::ROW, |mut cells| raster_row(&mut cells, state.timings.raster.as_ref(), most));
        });
}

/// The name of a column, which sorts by it.
fn head(ui: &mut Ui, state: &State, column: By, commands: &mut Commands) {
    let terms = &state.terms_of_timings;
    let (sign, order) = match (terms.column == column, terms.grows()) {
        (false, _) => ("", ""),
        (true, true) => (" ^", ", ascending"),
        (true, false) => (" v", ", descending"),
    };
    let text = RichText::new(format!("{}{sign}", column.name())).small();
    // In the order in which they are listed, rows are not said to be sorted.
    let plain = column == By::Structure && !terms.reversed;
    let (text, order) = if plain { (RichText::new(column.name()).small(), "") } else { (text, order) };
    let button = ui.add(Button::new(text).frame(false)).on_hover_text(format!("{} Click to sort by it.", column.help()));
    if button.accessible_name(format!("Sort by {}{order}", column.name())).clicked() {
        commands.push(Command::SortTimings(column));
    }
}

fn cells_of(cells: &mut TableRow<'_, '_>, state: &State, (entry, row): (&Entry, &Row), most: f64) {
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
    value(cells, timing.map(|t| format::duration(secs_of_sample(t))), why);
    cells.col(|ui| {
        let Some(t) = timing else { return missing(ui, why) };
        bar(ui, t, most, entry.family);
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

/// Rays a second and their spread.
fn rate(t: &Timing) -> String {
    format!("{} ±{}", format::number(t.mrays_per_sec), format::number(t.mrays_spread()))
}

/// A bar at the foot of a cell: rays a second as a share of the most, with their spread at its end.
fn bar(ui: &Ui, t: &Timing, most: f64, family: Family) {
    let cell = ui.max_rect();
    let at = |rate: f64| cell.left() + cell.width() * (rate / most.max(f64::MIN_POSITIVE)).clamp(0.0, 1.0) as f32;
    let rect = Rect::from_min_max(pos2(cell.left(), cell.bottom() - theme::BAR), pos2(at(t.mrays_per_sec), cell.bottom()));
    let (painter, spread) = (ui.painter(), t.mrays_spread());
    painter.rect_filled(rect, 0.0, marks::color(ui, family));
    let ends = at(t.mrays_per_sec - spread)..=at(t.mrays_per_sec + spread);
    let text = Palette::in_ui(ui).text;
    painter.hline(ends.clone(), rect.center().y, (1.0, text));
    for end in [*ends.start(), *ends.end()] {
        painter.vline(end, rect.y_range(), (1.0, text));
    }
}

/// The row of the rasteriser, which builds nothing and visits no nodes.
fn raster_row(cells: &mut TableRow<'_, '_>, row: Option<&RasterRow>, most: f64) {
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
    value(cells, timing.as_ref().map(|t| format::duration(secs_of_sample(t))), "Not measured. Press Measure.");
    cells.col(|ui| {
        let Some(t) = &timing else { return missing(ui, "Not measured. Press Measure.") };
        bar(ui, t, most, Family::Brute);
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
