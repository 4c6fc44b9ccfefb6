//! What the open model uses and what is left out for it, why, and what that saves.

use eframe::egui::{CollapsingHeader, ProgressBar, RichText, Ui};

use super::{Commands, fact, saves};
use crate::lab::needs::FeatureRow;
use crate::scene::Finding;
use crate::viewer::command::Command;
use crate::viewer::format;
use crate::viewer::sheets::What;
use crate::viewer::state::State;
use crate::viewer::theme::Palette;

/// Draws the panel.
pub fn show(ui: &mut Ui, state: &State, commands: &mut Commands) {
    let Some(model) = &state.model else { return };
    for (title, used) in [("Left out", false), ("Used", true)] {
        let findings: Vec<&Finding> = model.needs.iter().filter(|finding| finding.used == used).collect();
        CollapsingHeader::new(format!("{title} ({})", findings.len())).id_salt(title).show(ui, |ui| {
            for finding in findings {
                row(ui, state, finding);
            }
            if !used {
                measure(ui, state, commands);
                saves::show(ui, What::Needs, state, commands);
            }
        });
    }
}

fn row(ui: &mut Ui, state: &State, finding: &Finding) {
    let id = finding.feature.id();
    let measured = state.needs.as_ref().and_then(|report| report.features.iter().find(|row| row.id == id));
    let help = "Bytes less than if everything in the model were kept, and nanoseconds less for a camera ray.";
    fact(ui, finding.feature.name(), measured.map(saved).unwrap_or_default(), help);
    ui.label(RichText::new(&finding.why).small().color(Palette::in_ui(ui).dim));
}

/// `2.1 MiB, 3.2 ns/ray`.
fn saved(row: &FeatureRow) -> String {
    let told = row.ns_per_ray_saved.abs() > row.ns_spread;
    let parts = [
        (row.bytes_saved != 0).then(|| format::signed_bytes(row.bytes_saved)),
        told.then(|| format!("{} ns/ray", format::number(row.ns_per_ray_saved))),
    ];
    parts.into_iter().flatten().collect::<Vec<_>>().join(", ")
}

fn measure(ui: &mut Ui, state: &State, commands: &mut Commands) {
    if let Some(job) = &state.needing {
        let now = job.progress.snapshot();
        let bar = now.fraction.map_or_else(|| ProgressBar::new(0.0).animate(true), ProgressBar::new);
        ui.add(bar.text(now.phase));
        if ui.button("Cancel measuring what is left out").clicked() {
            commands.push(Command::CancelNeeds);
        }
        return;
    }
    if let Some(report) = &state.needs {
        let saved = report.forced_bytes.saturating_sub(report.total_bytes);
        let help = "Bytes of model, triangles, structure and textures less than if everything were kept.";
        fact(ui, "Saved in all", format!("{} of {}", format::bytes(saved), format::bytes(report.forced_bytes)), help);
    }
    let idle = state.can_measure();
    let button = ui.add_enabled(idle, eframe::egui::Button::new("Measure what is left out"));
    let help = "Loads the model once more with everything, builds the structure over it, and times rays with each thing. Nothing else runs meanwhile.";
    if button.on_hover_text(help).clicked() {
        commands.push(Command::MeasureNeeds);
    }
}
