//! The bar at the bottom: samples, pace, the window's own time, what is going on.

use eframe::egui::{Align, Layout, RichText, Ui};

use super::Commands;
use crate::viewer::format;
use crate::viewer::state::State;
use crate::viewer::theme::Palette;

/// Draws the bar. `ui_secs` is what the last frame took of the window's thread.
pub fn show(ui: &mut Ui, state: &State, ui_secs: Option<f64>, _: &mut Commands) {
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
            if let Some(doing) = doing(state) {
                ui.label(doing);
            }
        });
    });
}

/// What is going on, in a few words.
fn doing(state: &State) -> Option<String> {
    let share = |fraction: Option<f32>| fraction.map(|f| format!(" {}", format::percent(f.into()))).unwrap_or_default();
    if let Some(job) = &state.measuring {
        let now = job.progress.snapshot();
        return Some(format!("Measuring{}", share(now.fraction)));
    }
    if let Some(building) = &state.building {
        let now = building.job.progress.snapshot();
        return Some(format!("Building {}{}", building.key.entry.name, share(now.fraction)));
    }
    if let Some((_, building)) = state.pane_in_building() {
        let now = building.job.progress.snapshot();
        return Some(format!("Building {} beside{}", building.key.entry.name, share(now.fraction)));
    }
    if let Some(job) = &state.rays.following {
        return Some(format!("Following the ray{}", share(job.progress.snapshot().fraction)));
    }
    if state.tree.outlining.is_some() {
        return Some("Listing the cells".to_owned());
    }
    state.loading.as_ref().map(|(_, job)| format!("Loading{}", share(job.progress.snapshot().fraction)))
}
