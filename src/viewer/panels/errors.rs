//! The plots of the Compare workspace. Here that of the path traced picture's error, against samples and against seconds: a
//! curve for each structure that has shown the present view, as a plot or as a table.

use eframe::egui::{Align, Color32, Layout, ProgressBar, RichText, ScrollArea, Ui, vec2};
use egui_extras::{Column, TableBuilder};
use egui_plot::{Legend, Line, LineStyle, MarkerShape, PlotPoint, PlotPoints, Points};

use super::axes::log_log;
use super::{Commands, empty, predicted, saves, scaling, tradeoffs};
use crate::render::Mode;
use crate::viewer::command::Command;
use crate::viewer::errors::{Errors, Known, Live};
use crate::viewer::format;
use crate::viewer::marks;
use crate::viewer::sheets::What;
use crate::viewer::state::State;
use crate::viewer::theme::{self, Palette};

/// The least width at which controls stand in one row with the tabs.
const WIDE: f32 = 222.0 * theme::GRID;

/// Draws the panel.
pub fn show(ui: &mut Ui, state: &State, commands: &mut Commands) {
    // The panel is as high as it was made, whatever is in it: the view above must not change its size with it.
    ui.take_available_space();
    let plot = state.tradeoffs.plot;
    if ui.available_width() >= WIDE {
        ui.horizontal(|ui| {
            tabs(ui, state, commands);
            controls(ui, state, commands);
        });
    } else {
        ui.horizontal_wrapped(|ui| tabs(ui, state, commands));
        ui.horizontal(|ui| controls(ui, state, commands));
    }
    if plot == tradeoffs::Plot::Scaling {
        scaling::show(ui, state);
    } else if plot == tradeoffs::Plot::Prediction {
        predicted::show(ui, state);
    } else if plot != tradeoffs::Plot::Image {
        tradeoffs::show(ui, state);
    } else if state.settings.mode != Mode::Path {
        ui.horizontal(|ui| {
            empty(ui, "Errors are those of the path traced picture.");
            if ui.button("Path trace").clicked() {
                commands.push(Command::Mode(Mode::Path));
            }
        });
    } else if state.is_comparing() {
        ui.horizontal(|ui| {
            empty(ui, "Errors are those of one picture, which has all threads to itself.");
            if ui.button("One picture again").on_hover_text("Take the pictures beside away.").clicked() {
                commands.push(Command::PutBeside(None));
            }
        });
    } else if state.errors.curves.is_empty() {
        empty(ui, "The first samples are on their way.");
    } else if state.errors.as_table {
        table(ui, state, commands);
    } else {
        plots(ui, state, commands);
    }
}

/// Which plot is shown, and the menu that saves it.
fn tabs(ui: &mut Ui, state: &State, commands: &mut Commands) {
    let plot = state.tradeoffs.plot;
    for other in tradeoffs::Plot::ALL {
        if ui.selectable_label(other == plot, other.name()).on_hover_text(other.help()).clicked() {
            commands.push(Command::ErrorPlot(other));
        }
    }
    saves::show(ui, What::of_plot(plot), state, commands);
}

/// What the curves are: an error, or an estimate.
fn measure_of(ui: &mut Ui, state: &State) {
    let errors = &state.errors;
    let said = if errors.reference.is_some() { "RMSE against the reference" } else { "Estimated noise: no reference yet" };
    ui.label(RichText::new(said).small().color(Palette::in_ui(ui).dim)).on_hover_text(if errors.reference.is_some() {
        "Root mean squared difference of linear red, green and blue; hollow points are below 4 times the reference's own noise."
    } else {
        "Root mean square of the standard errors of linear red, green and blue, from the samples' own variance."
    });
}

/// What is chosen of the shown plot, and its button.
fn controls(ui: &mut Ui, state: &State, commands: &mut Commands) {
    match state.tradeoffs.plot {
        tradeoffs::Plot::Image => {
            measure_of(ui, state);
            ui.with_layout(Layout::right_to_left(Align::Center), |ui| reference(ui, state, commands));
        }
        tradeoffs::Plot::Scaling => scaling::controls(ui, state, commands),
        tradeoffs::Plot::Intersection | tradeoffs::Plot::Model | tradeoffs::Plot::Prediction => {
            tradeoffs::controls(ui, state, commands);
        }
    }
}

/// Plots or a table, and the button that makes a reference.
fn reference(ui: &mut Ui, state: &State, commands: &mut Commands) {
    let errors = &state.errors;
    let mut as_table = errors.as_table;
    if ui.checkbox(&mut as_table, "Show as table").changed() {
        commands.push(Command::ErrorsAsTable(as_table));
    }
    if let Some((spp, making)) = &errors.making {
        if ui.button("Cancel").on_hover_text("Stop making the reference.").clicked() {
            commands.push(Command::CancelReference);
        }
        let share = making.progress.snapshot().fraction.unwrap_or(0.0);
        let text = format!("Reference of {} spp", format::count(u64::from(*spp)));
        ui.add(ProgressBar::new(share).desired_width(48.0 * theme::GRID).text(text));
        return;
    }
    let wanted = errors.wanted_reference().filter(|_| state.has_curves());
    let possible = wanted.is_some() && !state.is_measuring() && !state.is_checking();
    let about = wanted.map(|(_, secs)| format!(", about {}", format::duration(secs))).unwrap_or_default();
    let button = ui.add_enabled(possible, eframe::egui::Button::new(format!("Make reference{about}")));
    let spp = wanted.map_or(String::new(), |(spp, _)| format!("{} samples a pixel, ", format::count(u64::from(spp))));
    let help = format!("{spp}16 times as many as any curve has, of other random numbers. The picture rests meanwhile.");
    if button.on_hover_text(help).clicked() {
        commands.push(Command::MakeReference);
    }
}

/// A place of a curve on logarithmic axes.
struct Place {
    curve: usize,
    point: usize,
    at: [f64; 2],
    hollow: bool,
}

fn places(errors: &Errors, of_secs: bool) -> Vec<Place> {
    let mut places = Vec::new();
    for (curve, live) in errors.curves.iter().enumerate() {
        for (point, shot) in live.shots.iter().enumerate() {
            let Some(known) = errors.known(curve, point).filter(|known| known.value() > 0.0) else { continue };
            let x = if of_secs { shot.secs } else { f64::from(shot.samples) };
            let hollow = matches!(known, Known::Error { hollow: true, .. });
            places.push(Place { curve, point, at: [x.log10(), known.value().log10()], hollow });
        }
    }
    places
}

fn plots(ui: &mut Ui, state: &State, commands: &mut Commands) {
    let size = vec2((ui.available_width() - theme::GUTTER) * 0.5, ui.available_height() - theme::GRID);
    ui.horizontal_top(|ui| {
        for (id, of_secs, name) in
            [("against samples", false, "samples a pixel"), ("against seconds", true, "seconds of rendering")]
        {
            ui.allocate_ui(size, |ui| plot(ui, state, (id, of_secs, name), commands));
        }
    });
}

/// How near to a point a click has to be, in points of the screen.
const NEAR: f32 = 14.0;

fn plot(ui: &mut Ui, state: &State, (id, of_secs, name): (&str, bool, &str), commands: &mut Commands) {
    let errors = &state.errors;
    let (places, palette) = (places(errors, of_secs), Palette::in_ui(ui));
    let colors: Vec<Color32> = errors.curves.iter().map(|live| marks::color(ui, live.key.entry.family)).collect();
    let height = ui.available_height();
    let plot = log_log(id, [name, if errors.reference.is_some() { "RMSE" } else { "estimated noise" }])
        .legend(Legend::default())
        .height(height);
    let shown = plot.show(ui, |plot| {
        if let Some(first) = places.first() {
            // Where independent samples would lead from the first point.
            let end = places.iter().map(|p| p.at[0]).fold(first.at[0], f64::max);
            let guide = vec![first.at, [end, first.at[1] - 0.5 * (end - first.at[0])]];
            let line = Line::new("slope -1/2", PlotPoints::from(guide)).color(palette.dim).width(1.0);
            plot.line(line.style(LineStyle::dashed_dense()));
        }
        for (curve, live) in errors.curves.iter().enumerate() {
            let of: Vec<&Place> = places.iter().filter(|p| p.curve == curve).collect();
            let at = |of: &[&Place]| PlotPoints::from(of.iter().map(|p| p.at).collect::<Vec<_>>());
            let (name, color) = (live.key.entry.short, colors[curve]);
            // Members of a family have one colour.
            let family = |live: &&Live| live.key.entry.family == errors.curves[curve].key.entry.family;
            let style = match errors.curves[..curve].iter().filter(family).count() {
                0 => LineStyle::Solid,
                1 => LineStyle::dashed_loose(),
                _ => LineStyle::dotted_dense(),
            };
            plot.line(Line::new(name, at(&of)).color(color).width(theme::CURVE).style(style));
            for hollow in [false, true] {
                let some: Vec<&Place> = of.iter().copied().filter(|p| p.hollow == hollow).collect();
                let points = Points::new(name, at(&some)).color(color).radius(theme::GRID).filled(!hollow);
                plot.points(points.shape(MarkerShape::Circle));
            }
        }
        let chosen = errors.chosen.and_then(|c| places.iter().find(|p| (p.curve, p.point) == (c.curve, c.point)));
        if let Some(chosen) = chosen {
            let ring = Points::new("chosen", vec![chosen.at]).color(palette.text).radius(theme::GUTTER).filled(false);
            plot.points(ring.allow_hover(false));
        }
    });
    let response = shown.response.on_hover_text_at_pointer("Click a point to see its picture.");
    let Some(at) = response.interact_pointer_pos().filter(|_| response.clicked()) else { return };
    let far = |p: &&Place| shown.transform.position_from_point(&PlotPoint::from(p.at)).distance(at);
    let nearest = places.iter().min_by(|a, b| far(a).total_cmp(&far(b))).filter(|p| far(p) <= NEAR);
    commands.push(Command::Shot(nearest.map(|p| (p.curve, p.point)), errors.chosen.is_some_and(|c| c.difference)));
}

/// The same as rows: a click on one shows its picture.
fn table(ui: &mut Ui, state: &State, commands: &mut Commands) {
    let errors = &state.errors;
    let columns = ["Samples", "Seconds", "Estimated noise", "RMSE", "relMSE", "MAE", "SMAPE"];
    let rows: Vec<(usize, usize)> =
        errors.curves.iter().enumerate().flat_map(|(c, live)| (0..live.shots.len()).map(move |p| (c, p))).collect();
    ScrollArea::horizontal().show(ui, |ui| {
        let mut table = TableBuilder::new(ui).striped(true).cell_layout(Layout::right_to_left(Align::Center));
        table = table.column(Column::exact(28.0 * theme::GRID));
        for _ in columns {
            table = table.column(Column::remainder().at_least(20.0 * theme::GRID));
        }
        let header = table.header(theme::ROW, |mut header| {
            header.col(|ui| {
                ui.with_layout(Layout::left_to_right(Align::Center), |ui| ui.label(RichText::new("Structure").small()));
            });
            for name in columns {
                header.col(|ui| drop(ui.label(RichText::new(name).small())));
            }
        });
        header.body(|body| {
            body.rows(theme::ROW, rows.len(), |mut row| {
                let (curve, point) = rows[row.index()];
                let live = &errors.curves[curve];
                row.col(|ui| {
                    ui.with_layout(Layout::left_to_right(Align::Center), |ui| {
                        marks::dot(ui, live.key.entry.family);
                        let chosen = errors.chosen.is_some_and(|c| (c.curve, c.point) == (curve, point));
                        let named = format!("{}, {} spp", live.key.entry.short, live.shots[point].samples);
                        let label = ui.selectable_label(chosen, live.key.entry.short).accessible_name(named);
                        if label.on_hover_text("Show its picture.").clicked() {
                            let difference = errors.chosen.is_some_and(|c| c.difference);
                            commands.push(Command::Shot((!chosen).then_some((curve, point)), difference));
                        }
                    });
                });
                for text in figures(live, point) {
                    row.col(|ui| drop(ui.label(text)));
                }
            });
        });
    });
}

fn figures(live: &Live, point: usize) -> [String; 7] {
    let shot = &live.shots[point];
    let errors = live.errors.get(point).copied().flatten();
    let of = |x: Option<f64>| format::or_missing(x, format::error);
    [
        format::count(u64::from(shot.samples)),
        format::duration(shot.secs),
        of(shot.noise),
        of(errors.map(|e| e.rmse)),
        of(errors.map(|e| e.relmse)),
        of(errors.map(|e| e.mae)),
        of(errors.map(|e| e.smape)),
    ]
}
