//! Bounding volumes of the selected node side by side.

use eframe::egui::{Button, Grid, RichText, Ui};

use super::{Commands, empty, heading, running, saves};
use crate::lab::{FitRow, Fitting};
use crate::viewer::command::Command;
use crate::viewer::format;
use crate::viewer::sheets::What;
use crate::viewer::state::State;
use crate::viewer::theme::Palette;

/// What a kind of volume is called in tables and lists.
pub fn volume_name(id: &str) -> &str {
    match id {
        "aabb" => "Box",
        "sphere" => "Sphere",
        "obb" => "Oriented box",
        "kdop8" => "8-DOP",
        "kdop14" => "14-DOP",
        "kdop18" => "18-DOP",
        "kdop26" => "26-DOP",
        "hull" => "Convex hull",
        other => other,
    }
}

/// What a kind of volume is, in a sentence.
fn help(id: &str) -> &'static str {
    match id {
        "aabb" => "The box with faces parallel to the axes.",
        "sphere" => "The smallest ball.",
        "obb" => "A small box of any orientation.",
        "kdop8" => "Slabs along the four diagonals of a cube.",
        "kdop14" => "The box with its corners cut off.",
        "kdop18" => "The box with its edges cut off.",
        "kdop26" => "The box with edges and corners cut off.",
        _ => "The smallest convex volume there is.",
    }
}

/// Draws the section.
pub fn show(ui: &mut Ui, state: &State, commands: &mut Commands) {
    heading(ui, "Bounding volumes");
    if let Some(job) = &state.fits.running {
        if running(ui, &job.progress, "Comparing", ("Cancel comparing volumes", "Stop comparing volumes.")) {
            commands.push(Command::CancelFitVolumes);
        }
        return;
    }
    let made = state.fitting();
    if let Some((fitting, old)) = made {
        table(ui, state, fitting, commands);
        empty(ui, &said(fitting));
        if old {
            empty(ui, "Of an earlier view.");
        }
        saves::show(ui, What::Volumes, state, commands);
    }
    if let Some(note) = state.no_fitting() {
        empty(ui, note);
    }
    if made.is_none_or(|(_, old)| old) {
        let possible = state.can_measure();
        let help = "Put a volume of each kind around the triangles of the node and try them with rays of this view: some seconds \
                    at most. Rendering rests meanwhile.";
        if ui.add_enabled(possible, Button::new("Compare bounding volumes")).on_hover_text(help).clicked() {
            commands.push(Command::FitVolumes);
        }
    }
}

/// The columns after the name, with what they mean.
const COLUMNS: [(&str, &str); 3] = [
    ("area", "Its area, as a multiple of the convex hull's: how often a random line meets it."),
    ("in vain", "Of this view's rays that it lets in, those that hit none of the node's triangles."),
    ("ns", "Nanoseconds of one test, plain code on one thread, with rays that meet some of the volumes."),
];

fn table(ui: &mut Ui, state: &State, fitting: &Fitting, commands: &mut Commands) {
    let dim = Palette::in_ui(ui).dim;
    let hull = fitting.rows.iter().find(|row| row.id == "hull").map_or(f64::NAN, |row| row.area);
    Grid::new("bounding volumes").num_columns(1 + COLUMNS.len()).striped(true).show(ui, |ui| {
        ui.label(RichText::new("volume").small().color(dim)).on_hover_text("Click a name to draw it around the node.");
        for (name, help) in COLUMNS {
            ui.label(RichText::new(name).small().color(dim)).on_hover_text(help);
        }
        ui.end_row();
        for row in &fitting.rows {
            one(ui, state, row, hull, commands);
            ui.end_row();
        }
    });
}

fn one(ui: &mut Ui, state: &State, row: &FitRow, hull: f64, commands: &mut Commands) {
    let (name, drawn) = (volume_name(row.id), state.fits.drawn == Some(row.id));
    let loose = if row.loose { " Too many faces: the largest, and those of a 26-DOP." } else { "" };
    let button =
        ui.selectable_label(drawn, name).on_hover_text(format!("{}{loose} Click to draw it around the node.", help(row.id)));
    if button.clicked() {
        commands.push(Command::DrawVolume((!drawn).then_some(row.id)));
    }
    let ratio = if hull > 0.0 { format!("{}x", format::number(row.area / hull)) } else { "–".to_owned() };
    ui.label(ratio).on_hover_text(format!("{} in units in which the scene is about 1 long.", format::number(row.area)));
    let (met, vain) = (format::count(row.met as u64), format::count(row.in_vain as u64));
    let share = if row.met > 0 { format::percent(row.false_positives()) } else { "–".to_owned() };
    ui.label(share).on_hover_text(format!("{vain} of {met} rays that it lets in."));
    let (ns, help) = if row.test_ns.is_finite() {
        (format::number(row.test_ns), format!("±{} ns", format::number(row.spread_ns)))
    } else {
        ("–".to_owned(), "No ray of this view comes near.".to_owned())
    };
    ui.label(ns).on_hover_text(help);
}

/// What was done, in a sentence.
fn said(fitting: &Fitting) -> String {
    let count = |n: usize| format::count(n as u64);
    let part = if fitting.taken < fitting.triangles { format!("{} of ", count(fitting.taken)) } else { String::new() };
    let (triangles, followed, rays) = (count(fitting.triangles), count(fitting.followed), count(fitting.rays));
    format!("Around {part}{triangles} triangles; {followed} rays that come near, of {rays} primary and bounced ones.")
}
