//! What takes how much memory: the parts of a structure, and all that is held.

use eframe::egui::{CollapsingHeader, Ui};

use super::{Commands, fact, saves};
use crate::accel::stats::Stats;
use crate::viewer::format;
use crate::viewer::sheets::What;
use crate::viewer::state::State;

/// The bytes of a structure, and of each of its parts.
pub fn of_structure(ui: &mut Ui, stats: &Stats, triangles: usize) {
    let per_triangle = stats.bytes() as f64 / triangles.max(1) as f64;
    fact(ui, "Bytes", format::bytes(stats.bytes()), "Memory of this structure alone; the triangles themselves are shared.");
    CollapsingHeader::new("Bytes by part").id_salt("bytes").show(ui, |ui| {
        for part in &stats.memory {
            fact(ui, part.name, format::bytes(part.bytes), "A part of the structure's memory.");
        }
        fact(
            ui,
            "per triangle",
            format!("{} B", format::number(per_triangle)),
            "The structure's bytes over the triangles it holds.",
        );
    });
}

/// What is held of the budget, and what holds it.
pub fn show(ui: &mut Ui, state: &State, commands: &mut Commands) {
    CollapsingHeader::new("Memory").id_salt("memory").show(ui, |ui| {
        let (used, limit) = state.memory();
        let help = "What models, structures and lists hold of the memory budget, which View > Memory sets.";
        fact(ui, "In use", format!("{} of {}", format::bytes(used), format::bytes(limit)), help);
        if let Some(model) = &state.model {
            fact(ui, "Triangles", format::bytes(model.geometry.bytes()), "The triangles, which all structures share.");
            let textures = model.looks.textures().bytes();
            if textures > 0 {
                fact(ui, "Textures", format::bytes(textures), "Images as they are kept in memory: only those that are seen.");
            }
        }
        for built in state.kept_structures() {
            fact(
                ui,
                built.key.entry.name,
                format::bytes(built.bytes()),
                "A structure that is kept, so that going back to it costs nothing.",
            );
        }
        if let Some(stats) = state.shown.as_ref().and_then(|shown| shown.stats.as_ref()) {
            of_structure(ui, stats, state.model.as_ref().map_or(0, |model| model.geometry.stored_live()));
        }
        saves::show(ui, What::Memory, state, commands);
    });
}
