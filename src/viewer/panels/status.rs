//! The bar at the bottom: samples, pace, the window's own time, what is going on.

use eframe::egui::{Align, Label, Layout, RichText, Ui};

use super::{Commands, announce};
use crate::task::Progress;
use crate::viewer::command::Command;
use crate::viewer::format;
use crate::viewer::state::State;
use crate::viewer::theme::Palette;

/// Draws the bar. `ui_secs` is what the last frame took of the window's thread.
pub fn show(ui: &mut Ui, state: &State, ui_secs: Option<f64>, commands: &mut Commands) {
    ui.horizontal(|ui| {
        let dim = Palette::in_ui(ui).dim;
        if let Some(p) = state.picture.as_ref().map(|p| p.progress) {
            let samples = if p.step > 1 { format!("1/{} resolution", p.step) } else { format!("{} spp", p.samples) };
            ui.label(samples).on_hover_text("Samples in each pixel; a coarse picture comes first.");
            ui.separator();
            ui.label(format::rate(p.rays_per_sec)).on_hover_text("Rays a second in the last pass, shading included.");
            ui.separator();
            let doing = if p.done { "done".to_owned() } else { format!("tracing {}", format::percent(p.share)) };
            let help = "The share of the picture that still gets samples: the rest cannot see the scene, or has converged.";
            ui.label(RichText::new(doing).color(dim)).on_hover_text(help);
            ui.separator();
        }
        if let Some(secs) = ui_secs {
            ui.label(format!("UI {}", format::duration(secs)))
                .on_hover_text("Time the last frame took on the window's own thread.");
        }
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            if state.exports.report.is_some() && ui.button("Cancel the report").clicked() {
                commands.push(Command::CancelReport);
            }
            let now = doing(state);
            announce::progress(ui, state, now.as_ref().map(|now| now.0.as_str()));
            if let Some((what, fraction)) = now {
                let share = fraction.map(|f| format!(" {}", format::percent(f.into()))).unwrap_or_default();
                ui.label(format!("{what}{share}"));
            } else if let Some(said) = &state.exports.said {
                ui.add(Label::new(said.as_str()).truncate()).on_hover_text(said.as_str());
            }
        });
    });
}

/// What is going on, in a few words, and how much of it is done.
fn doing(state: &State) -> Option<(String, Option<f32>)> {
    let of = |what: &str, progress: &Progress| Some((what.to_owned(), progress.snapshot().fraction));
    if let Some(job) = &state.exports.report {
        return of("Making the report", &job.progress);
    }
    if let Some(job) = &state.measuring {
        return of("Measuring", &job.progress);
    }
    if let Some(building) = &state.building {
        return of(&format!("Building {}", building.key.entry.name), &building.job.progress);
    }
    if let Some((_, building)) = state.pane_in_building() {
        return of(&format!("Building {} beside", building.key.entry.name), &building.job.progress);
    }
    if let Some(progress) = state.ray_list.progress() {
        return of("Reading and tracing rays", progress);
    }
    if let Some((_, job)) = &state.tiles.running {
        return of("Timing the tiles", &job.progress);
    }
    if let Some(job) = &state.rays.following {
        return of("Following the ray", &job.progress);
    }
    if let Some((_, job)) = &state.loading {
        return of("Loading", &job.progress);
    }
    if let Some((job, _)) = &state.brute.running {
        return of("Comparing with brute force", &job.progress);
    }
    if state.tree.outlining.is_some() {
        return Some(("Listing the cells".to_owned(), None));
    }
    measured(state).and_then(|(what, progress)| of(what, progress))
}

/// What is measured, found out or checked.
fn measured(state: &State) -> Option<(&'static str, &Progress)> {
    let jobs = [
        state.needing.as_ref().map(|job| ("Measuring what is left out", &job.progress)),
        state.causes.running.as_ref().map(|job| ("Looking for causes", &job.progress)),
        state.errors.making.as_ref().map(|(_, job)| ("Making a reference", &job.progress)),
        state.tradeoffs.running.as_ref().map(|(job, _)| ("Measuring quality", &job.progress)),
        state.checks.checking.as_ref().map(|job| ("Checking the model", &job.progress)),
        state.checks.running.as_ref().map(|(job, _)| ("Running the stability lab", &job.progress)),
        state.filming.making.as_ref().map(|job| ("Making the film", &job.progress)),
        state.fits.running.as_ref().map(|job| ("Comparing volumes", &job.progress)),
        state.tradeoffs.growing.as_ref().map(|job| ("Measuring time against triangles", &job.progress)),
    ];
    jobs.into_iter().flatten().next()
}
