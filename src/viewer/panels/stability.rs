//! The matrix of the stability lab: a row a case, a column each structure and triangle test. A click on a cell opens its case.

use eframe::egui::{
    self, Align, Align2, Layout, ProgressBar, Rect, RichText, Role, ScrollArea, Sense, Stroke, TextStyle, Ui, WidgetInfo,
};
use eframe::egui::{Painter, Vec2, pos2, vec2};

use super::{Commands, empty, heading, saves};
use crate::accel::registry::{self, Entry};
use crate::geometry::tri::TestKind;
use crate::lab::stability::cases::{self, Case};
use crate::lab::stability::{Row, Verdict};
use crate::viewer::checks::Cell;
use crate::viewer::command::Command;
use crate::viewer::format;
use crate::viewer::sheets::What;
use crate::viewer::state::State;
use crate::viewer::theme::{self, Marker, Palette};

/// Draws the panel.
pub fn show(ui: &mut Ui, state: &State, commands: &mut Commands) {
    ui.horizontal(|ui| {
        heading(ui, "Stability");
        if !state.checks.cases.is_empty() {
            ui.label(RichText::new(said(state)).small().color(Palette::in_ui(ui).dim));
            saves::show(ui, What::Stability, state, commands);
        }
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| button(ui, state, commands));
    });
    if state.checks.cases.is_empty() && state.checks.running.is_none() {
        // As high as the matrix will be.
        ui.set_min_height(ui.available_height());
        empty(ui, "Scenes and rays that are known to break ray tracers, through every structure with every triangle test,");
        empty(ui, "each answer held against arithmetic that does not round. It takes a minute or two.");
        return;
    }
    matrix(ui, state, commands);
}

/// How it stands, in a few words.
fn said(state: &State) -> String {
    let rows = || state.checks.cases.iter().flat_map(|case| &case.structures);
    let of = |verdict| rows().filter(|row| row.verdict == verdict).count() as u64;
    format!(
        "{} pass, {} warn, {} fail",
        format::count(of(Verdict::Pass)),
        format::count(of(Verdict::Warn)),
        format::count(of(Verdict::Fail))
    )
}

fn button(ui: &mut Ui, state: &State, commands: &mut Commands) {
    let Some((job, _)) = &state.checks.running else {
        let help = "Run every case in the background. Nanoseconds are measured beside whatever else runs.";
        let run = ui.add_enabled(!state.is_measuring(), egui::Button::new("Run the lab"));
        if run.on_hover_text(help).clicked() {
            commands.push(Command::RunLab);
        }
        return;
    };
    if ui.button("Cancel").on_hover_text("Stop; cases that are through stay.").clicked() {
        commands.push(Command::CancelLab);
    }
    let done = state.checks.cases.len();
    let now = job.progress.snapshot();
    let next = cases::ALL.get(done).map_or("", |case| case.id);
    ui.add(
        ProgressBar::new(now.fraction.unwrap_or(0.0))
            .desired_width(40.0 * theme::GRID)
            .text(format!("{done} of {}: {next}", cases::ALL.len())),
    );
}

/// Structures and tests, from left to right.
fn columns() -> impl Iterator<Item = (&'static Entry, TestKind)> {
    registry::ALL.iter().flat_map(|entry| entry.tests().map(move |test| (entry, test)))
}

/// The letter of a test.
const fn letter(test: TestKind) -> &'static str {
    match test {
        TestKind::Watertight => "W",
        TestKind::Fast => "F",
        TestKind::Exact => "E",
        TestKind::Double => "D",
        TestKind::BaldwinWeber => "B",
    }
}

/// Rows of the head: structures, and letters of tests.
const HEAD: f32 = 2.0 * theme::ROW;

/// The part of the matrix that is in sight. Its head and the names of the cases stay where they are.
fn matrix(ui: &mut Ui, state: &State, commands: &mut Commands) {
    let columns: Vec<(&Entry, TestKind)> = columns().collect();
    let cell = Vec2::splat(theme::ROW);
    let size = vec2(theme::CASE_NAME + columns.len() as f32 * cell.x, HEAD + cases::ALL.len() as f32 * cell.y);
    ScrollArea::both().auto_shrink(false).show(ui, |ui| {
        let (rect, _) = ui.allocate_exact_size(size, Sense::hover());
        let clip = ui.clip_rect();
        let body = Rect::from_min_max(clip.min + vec2(theme::CASE_NAME, HEAD), clip.max);
        let origin = rect.min + vec2(theme::CASE_NAME, HEAD);
        let place = |column: usize, row: usize| Rect::from_min_size(origin + cell * vec2(column as f32, row as f32), cell);
        head(&ui.painter_at(clip), ui, &columns, place(0, 0), body);
        for (row, case) in cases::ALL.iter().enumerate() {
            let line = place(0, row);
            if !body.y_range().intersects(line.y_range()) || !body.y_range().contains(line.center().y) {
                continue;
            }
            name(ui, state, case, Rect::from_min_max(pos2(clip.left(), line.top()), pos2(body.left(), line.bottom())));
            for (column, (entry, test)) in columns.iter().enumerate() {
                let place = place(column, row);
                // What is half out of sight is not drawn: a mark that is cut off says something else.
                if body.x_range().contains(place.left()) && body.x_range().contains(place.right() - 1.0) {
                    let at = Cell { case: case.id, structure: entry.id, test: *test };
                    one(ui, state, at, place, commands);
                }
            }
        }
    });
}

/// The names of the structures over the letters of their tests.
fn head(painter: &Painter, ui: &Ui, columns: &[(&Entry, TestKind)], first: Rect, body: Rect) {
    let palette = Palette::in_ui(ui);
    let font = TextStyle::Small.resolve(ui.style());
    let top = body.top() - HEAD;
    for (column, (entry, test)) in columns.iter().enumerate() {
        let left = first.left() + column as f32 * first.width();
        let whole = |width: f32| body.left() <= left && left + width <= body.right() + 1.0;
        if whole(first.width()) {
            let at = pos2(left + 0.5 * first.width(), top + 1.5 * theme::ROW);
            painter.text(at, Align2::CENTER_CENTER, letter(*test), font.clone(), palette.dim);
        }
        let width = entry.tests().count() as f32 * first.width();
        if *test == TestKind::default() && whole(width) {
            let at = pos2(left + 0.5 * width, top + 0.5 * theme::ROW);
            painter.text(at, Align2::CENTER_CENTER, entry.short, font.clone(), palette.text);
            painter.vline(left, top..=body.bottom(), Stroke::new(1.0, palette.line));
        }
    }
}

fn name(ui: &Ui, state: &State, case: &Case, rect: Rect) {
    let palette = Palette::in_ui(ui);
    let through = state.checks.cases.iter().any(|row| row.id == case.id);
    let color = if through { palette.text } else { palette.dim };
    ui.painter().text(rect.left_center(), Align2::LEFT_CENTER, case.id, TextStyle::Small.resolve(ui.style()), color);
    let response = ui.interact(rect, ui.scope_id().with(("case", case.id)), Sense::hover());
    response.on_hover_text(format!("{}\n\n{}\n\n{}", case.what, case.bites, case.remedy));
}

/// One cell: a quiet dot where all is right.
fn one(ui: &mut Ui, state: &State, at: Cell, rect: Rect, commands: &mut Commands) {
    let Some((_, row)) = state.checks.row(at) else { return };
    let palette = Palette::in_ui(ui);
    let response = ui.interact(rect, ui.scope_id().with((at.case, at.structure, at.test)), Sense::click());
    let verdict = verdict(row);
    let label = format!("{}, {}, {}: {verdict}", at.case, at.structure, at.test.id());
    response.widget_info(|| WidgetInfo::labeled(Role::Button, true, &label));
    let painter = ui.painter();
    if response.hovered() || response.has_focus() || state.checks.selected == Some(at) {
        let color = if state.checks.selected == Some(at) { palette.accent_text } else { palette.dim };
        painter.rect_stroke(rect.shrink(1.0), 2.0, Stroke::new(1.0, color), egui::StrokeKind::Inside);
    }
    let (marker, size, color) = match (row.verdict, &row.error) {
        (Verdict::Fail, _) => (Marker::Cross, theme::MARK + theme::GRID, palette.fail),
        (Verdict::Warn, _) => (Marker::Cross, theme::MARK, palette.warn),
        (Verdict::Pass, Some(_)) => (Marker::Ring, 0.6 * theme::MARK, palette.dim),
        (Verdict::Pass, None) => (Marker::Circle, 0.5 * theme::MARK, palette.dim),
    };
    marker.paint(painter, rect.center(), size, color);
    let response = response.on_hover_text(format!("{label}\n{}", figures(row)));
    if response.clicked() {
        commands.push(Command::OpenCase(at));
    }
}

/// What is thought of a row, in a word.
pub fn verdict(row: &Row) -> &'static str {
    match (row.verdict, &row.error) {
        (Verdict::Fail, _) => "fails",
        (Verdict::Warn, _) => "rays slip through",
        (Verdict::Pass, Some(_)) => "refused, as it may",
        (Verdict::Pass, None) => "pass",
    }
}

fn figures(row: &Row) -> String {
    if let Some(error) = &row.error {
        return error.clone();
    }
    format!(
        "{} rays, {} near; {} wrong where rounding decides nothing, {} elsewhere; at most {} ulps; {} ns a ray",
        format::count(row.rays as u64),
        format::count(row.near as u64),
        format::count(row.clear_wrong as u64),
        format::count(row.boundary_wrong as u64),
        format::number(row.max_ulps),
        format::number(row.ns_per_ray),
    )
}
