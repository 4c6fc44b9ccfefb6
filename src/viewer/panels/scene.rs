//! What is open: name, size, what was left out, warnings.

use eframe::egui::{Checkbox, CollapsingHeader, ProgressBar, RichText, Ui};

use super::{Commands, empty, fact, heading};
use crate::scene::Feature;
use crate::viewer::command::Command;
use crate::viewer::format;
use crate::viewer::model::Instances;
use crate::viewer::state::State;
use crate::viewer::theme::Palette;

/// Draws the panel.
pub fn show(ui: &mut Ui, state: &State, commands: &mut Commands) {
    heading(ui, "Scene");
    if let Some((name, job)) = &state.loading {
        let now = job.progress.snapshot();
        ui.label(format!("Opening {}", short(name)));
        let bar = now.fraction.map_or_else(|| ProgressBar::new(0.0).animate(true), ProgressBar::new);
        ui.add(bar.text(now.phase));
        if ui.button("Cancel").on_hover_text("Stop loading; what is open stays open.").clicked() {
            commands.push(Command::CancelLoad);
        }
    }
    let Some(model) = &state.model else {
        if state.loading.is_none() {
            empty(ui, "Nothing is open.");
            if ui.button("Open…").clicked() {
                commands.push(Command::OpenDialog);
            }
        }
        return;
    };
    let (scene, counts) = (&model.scene, model.geometry.counts());
    ui.label(RichText::new(short(&scene.name)).strong()).on_hover_text(&scene.name);
    fact(ui, "Triangles", format::count(counts.triangles), "Triangles of all instances, as they are in the file.");
    if scene.instances.len() > 1 {
        let help = "How many times meshes are placed, and how many different meshes there are.";
        fact(ui, "Instances of meshes", format!("{} of {}", scene.instances.len(), scene.meshes.len()), help);
        instances(ui, state, commands);
    }
    let size = model.bounds().size();
    let extent =
        format!("{} × {} × {}", format::number(size.x.into()), format::number(size.y.into()), format::number(size.z.into()));
    fact(ui, "Extent", extent, "Width, height and depth of the box around everything, in the file's units.");
    let help = "Triangles with a corner that is not a finite number: they are left out everywhere.";
    left_out(ui, "Dropped", counts.dropped, help);
    left_out(ui, "Zero area", counts.degenerate, "Triangles without area: no ray can hit them, so structures do not hold them.");
    fact(
        ui,
        "Loaded in",
        format::duration(model.load_secs),
        "Seconds from the click to the triangles: reading, parsing, placing.",
    );
    let textures = model.looks.textures();
    if textures.bytes() > 0 {
        fact(ui, "Textures", format::bytes(textures.bytes()), "Images as they are kept in memory: only those that are seen.");
    }
    let all: Vec<&String> = scene.warnings.iter().chain(textures.warnings()).collect();
    warnings(ui, &all);
}

/// Whether instances are triangles of their own; `None` where no mesh stands in several places.
pub fn flattened(state: &State) -> Option<bool> {
    let model = state.model.as_ref()?;
    let repeats = model.needs.iter().any(|finding| finding.feature == Feature::Instancing && finding.used);
    repeats.then(|| model.geometry.placed().is_none())
}

/// Whether meshes that stand in several places are kept once: only where there are some.
fn instances(ui: &mut Ui, state: &State, commands: &mut Commands) {
    let Some(mut flat) = flattened(state) else { return };
    let help = "Make every instance triangles of its own, in one structure, instead of one structure for each mesh and a level above. The model is opened anew.";
    if ui.add_enabled(state.loading.is_none(), Checkbox::new(&mut flat, "Flatten instances")).on_hover_text(help).clicked() {
        commands.push(Command::Instances(if flat { Instances::Flattened } else { Instances::Kept }));
    }
}

fn left_out(ui: &mut Ui, name: &str, count: u64, help: &str) {
    if count > 0 {
        fact(ui, name, format::count(count), help);
    }
}

fn warnings(ui: &mut Ui, warnings: &[&String]) {
    if warnings.is_empty() {
        return;
    }
    let title = if warnings.len() == 1 { "1 warning".to_owned() } else { format!("{} warnings", warnings.len()) };
    let color = Palette::in_ui(ui).warn;
    CollapsingHeader::new(RichText::new(format!("! {title}")).color(color)).id_salt("warnings").show(ui, |ui| {
        for warning in warnings {
            ui.label(RichText::new(*warning).small());
        }
    });
}

/// The last part of a path; a built-in scene's whole name.
fn short(name: &str) -> &str {
    name.rsplit(['/', '\\']).next().filter(|part| !part.is_empty()).unwrap_or(name)
}
