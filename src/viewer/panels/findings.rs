//! Why rays of this view are slow, in a few sentences, and what each mesh and each material costs.

use eframe::egui::{Button, CollapsingHeader, Grid, Label, RichText, Ui};

use super::{Commands, empty, heading, running, saves};
use crate::lab::findings::{Finding, Findings, LooseTriangle, PartCost};
use crate::viewer::command::Command;
use crate::viewer::format;
use crate::viewer::sheets::What;
use crate::viewer::state::State;
use crate::viewer::theme::Palette;

/// Meshes or materials that are listed.
const PARTS: usize = 12;

/// Draws the section.
pub fn show(ui: &mut Ui, state: &State, commands: &mut Commands) {
    heading(ui, "Findings");
    if let Some(job) = &state.causes.running {
        if running(ui, &job.progress, "Looking", ("Cancel", "Stop looking.")) {
            commands.push(Command::CancelCauses);
        }
        return;
    }
    if let Some(found) = &state.causes.found {
        list(ui, found, commands);
        if state.causes_are_old() {
            empty(ui, "Of an earlier view.");
        }
        saves::show(ui, What::Findings, state, commands);
    }
    if state.causes.found.is_none() || state.causes_are_old() {
        let possible = state.can_measure();
        let help = "Follow some of this view's rays and say what makes them slow: about two seconds. Rendering rests meanwhile.";
        if ui.add_enabled(possible, Button::new("Look for causes")).on_hover_text(help).clicked() {
            commands.push(Command::FindCauses);
        }
    }
}

fn list(ui: &mut Ui, found: &Findings, commands: &mut Commands) {
    if found.list.is_empty() {
        let (nodes, tests) = (format::number(found.nodes), format::number(found.tests));
        empty(ui, &format!("Nothing stands out: a ray enters {nodes} nodes and is tested against {tests} triangles."));
    }
    for (i, finding) in found.list.iter().enumerate() {
        one(ui, i, finding, commands);
    }
    for (what, parts) in [("mesh", &found.meshes), ("material", &found.materials)] {
        if parts.len() > 1 {
            CollapsingHeader::new(format!("Cost by {what}")).show(ui, |ui| table(ui, what, parts));
        }
    }
    if !found.loosest.is_empty() {
        CollapsingHeader::new("Loosest triangles").show(ui, |ui| loosest(ui, &found.loosest, commands));
    }
}

fn one(ui: &mut Ui, i: usize, finding: &Finding, commands: &mut Commands) {
    let palette = Palette::in_ui(ui);
    ui.add(Label::new(format!("{}. {}", i + 1, finding.text)).wrap());
    ui.horizontal(|ui| {
        let ns = if finding.ns.is_finite() { format!("{} ns a ray, ", format::number(finding.ns)) } else { String::new() };
        let text = format!("{ns}{} of its work", format::percent(finding.share));
        let help = "Estimated: steps and tests times what each takes here, as fitted to timed rays.";
        ui.label(RichText::new(text).small().color(palette.dim)).on_hover_text(help);
        if let Some(row) = finding.row {
            let button = ui.button("Show").on_hover_text("Select the cell where it is seen best, in the Structure workspace.");
            if button.accessible_name(format!("Show finding {}", i + 1)).clicked() {
                commands.push(Command::ShowCause(row));
            }
        }
    });
}

fn table(ui: &mut Ui, what: &'static str, parts: &[PartCost]) {
    let palette = Palette::in_ui(ui);
    Grid::new(("cost by", what)).num_columns(3).striped(true).show(ui, |ui| {
        for (name, help) in [
            (what, "As the file calls it."),
            ("tests", "Its part of the triangle tests."),
            ("triangles", "Its part of the triangles."),
        ] {
            ui.label(RichText::new(name).small().color(palette.dim)).on_hover_text(help);
        }
        ui.end_row();
        for part in parts.iter().take(PARTS) {
            ui.add(Label::new(&part.name).truncate())
                .on_hover_text(format!("{} of its tests are hits.", format::percent(part.hits)));
            ui.label(format::percent(part.tests));
            ui.label(format::percent(part.triangles));
            ui.end_row();
        }
    });
}

/// Triangles by how badly their boxes fit; a click shows where they are.
fn loosest(ui: &mut Ui, triangles: &[LooseTriangle], commands: &mut Commands) {
    let palette = Palette::in_ui(ui);
    Grid::new("loosest triangles").num_columns(3).striped(true).show(ui, |ui| {
        for (name, help) in [
            ("triangle", "Its number, and its mesh."),
            ("misfit", "The area of its box over that of the box around as large a triangle across two axes."),
            ("tests", "How often this view's rays were tested against it."),
        ] {
            ui.label(RichText::new(name).small().color(palette.dim)).on_hover_text(help);
        }
        ui.end_row();
        for triangle in triangles {
            let help = format!("{} of its tests were hits. Click to select the leaf.", format::count(triangle.hits));
            let link = ui.add_enabled(triangle.row.is_some(), Button::new(&triangle.name).truncate().frame(false));
            if let Some(row) = triangle.row.filter(|_| link.on_hover_text(help).clicked()) {
                commands.push(Command::ShowCause(row));
            }
            ui.label(format::number(triangle.misfit));
            ui.label(format::count(triangle.tests));
            ui.end_row();
        }
    });
}
