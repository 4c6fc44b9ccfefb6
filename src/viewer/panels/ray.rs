//! The ray beside its steps: which one it is, how it is played, and which structures trace it.

use eframe::egui::{Button, ComboBox, DragValue, Grid, Key, Label, RichText, Slider, TextEdit, Ui};

use super::{Commands, empty, fact, heading, running, saves, steps};
use crate::accel::Step;
use crate::accel::registry;
use crate::lab::RayKind;
use crate::lab::follow::{Followed, from_text, to_text};
use crate::viewer::command::Command;
use crate::viewer::format;
use crate::viewer::rays::{KINDS, SPEEDS};
use crate::viewer::sheets::What;
use crate::viewer::state::State;
use crate::viewer::theme::Palette;

/// Draws the panel.
pub fn show(ui: &mut Ui, state: &State, commands: &mut Commands) {
    heading(ui, "Ray");
    which(ui, state, commands);
    if !state.rays.columns.is_empty() {
        heading(ui, "Step");
        player(ui, state, commands);
        present(ui, state);
        heading(ui, "Work");
        work(ui, state);
        saves::show(ui, What::Steps, state, commands);
    }
    heading(ui, "Beside");
    beside(ui, state, commands);
}

/// The name of a kind in menus.
pub const fn name_of(kind: RayKind) -> &'static str {
    match kind {
        RayKind::Shadow => "Shadow ray from there",
        RayKind::Diffuse | RayKind::Shuffled => "Bounce from there",
        RayKind::Primary | RayKind::Lines => "The pixel's ray",
    }
}

/// Which ray is followed, and the way to another.
fn which(ui: &mut Ui, state: &State, commands: &mut Commands) {
    let rays = &state.rays;
    let combo = ComboBox::from_id_salt("ray kind").selected_text(name_of(rays.kind)).show_ui(ui, |ui| {
        for kind in KINDS {
            if ui.selectable_label(kind == rays.kind, name_of(kind)).on_hover_text(kind.help()).clicked() {
                commands.push(Command::RayKind(kind));
            }
        }
    });
    combo.response.accessible_name("Ray").on_hover_text(rays.kind.help());
    match &rays.ray {
        Some(ray) => {
            let text = to_text(ray);
            ui.add(Label::new(RichText::new(&text).small().color(Palette::in_ui(ui).dim)).wrap());
            if ui.button("Copy").on_hover_text("Copy the ray as text: origin, direction, interval of t.").clicked() {
                ui.ctx().copy_text(text);
            }
        }
        None => empty(ui, "No ray yet. Click a pixel."),
    }
    file(ui, state, commands);
    // What is typed is the field's own until it is done.
    let id = ui.scope_id().with("typed ray");
    let mut typed: String = ui.data(|d| d.get_temp(id)).unwrap_or_default();
    let field = TextEdit::singleline(&mut typed).hint_text("Paste a ray: x y z  dx dy dz").desired_width(f32::INFINITY);
    let field = ui
        .add(field)
        .accessible_name("Ray as text")
        .on_hover_text("Six numbers or eight: origin, direction, and the interval of t. Enter follows it.");
    if field.lost_focus() && ui.input(|i| i.key_pressed(Key::Enter)) {
        commands.push(Command::RayText(typed.clone()));
        // What can't be followed is left to be mended.
        if from_text(&typed).is_ok() {
            typed.clear();
        }
    }
    ui.data_mut(|d| d.insert_temp(id, typed));
    if let Some(note) = &rays.note {
        ui.add(Label::new(RichText::new(note).color(Palette::in_ui(ui).warn)).wrap());
    }
}

/// A file of rays: the way to one, and how far it is.
fn file(ui: &mut Ui, state: &State, commands: &mut Commands) {
    let list = &state.ray_list;
    if let Some(progress) = list.progress() {
        if running(ui, progress, "Rays", ("Cancel the rays", "Stop reading or tracing the rays.")) {
            commands.push(Command::CancelRays);
        }
        return;
    }
    ui.horizontal(|ui| {
        let help = "A text file with a ray a line, six or eight numbers, or an array of NumPy. All are traced and listed, the dearest first.";
        if ui.add_enabled(state.model.is_some(), Button::new("Open rays…")).on_hover_text(help).clicked() {
            commands.push(Command::OpenRays);
        }
        if list.file.is_some() && ui.button("Close rays").on_hover_text("Put the file of rays away.").clicked() {
            commands.push(Command::CloseRays);
        }
    });
}

/// Forward and back.
fn player(ui: &mut Ui, state: &State, commands: &mut Commands) {
    let rays = &state.rays;
    let Some(lead) = rays.columns.get(rays.lead) else { return };
    let (at, last) = (rays.at, rays.last());
    let go = |to: usize| Command::Step(rays.lead, to);
    ui.horizontal_wrapped(|ui| {
        let mut button = |name: &str, help: &str, command: Option<Command>| {
            if ui.add_enabled(command.is_some(), Button::new(name)).on_hover_text(help).clicked() {
                commands.extend(command);
            }
        };
        button("Start", "Before the first step.", (at > 0).then(|| go(0)));
        button("Back", "The step before.", at.checked_sub(1).map(go));
        button("Next", "The step after.", (at < last).then(|| go(at + 1)));
        button("End", "The last step.", (at < last).then(|| go(last)));
        button("Leaf before", "The last leaf that was entered.", lead.followed.leaf(at, false).map(go));
        button("Next leaf", "The next leaf that is entered.", lead.followed.leaf(at, true).map(go));
        let playing = rays.playing.is_some();
        let (name, help) = if playing { ("Pause", "Stay at this step.") } else { ("Play", "Go on by itself.") };
        button(name, help, Some(Command::Play(!playing)));
    });
    let mut step = at + 1;
    let slider = Slider::new(&mut step, 1..=last + 1).text("Step");
    if ui.add(slider).on_hover_text("Which step of the leading column is shown.").changed() {
        commands.push(go(step - 1));
    }
    let mut speed = rays.speed;
    let field = DragValue::new(&mut speed).range(SPEEDS).speed(0.1).fixed_decimals(1).suffix(" steps/s");
    if ui.add(field).accessible_name("Speed").on_hover_text("How fast it plays.").changed() {
        commands.push(Command::PlaySpeed(speed));
    }
}

/// The step that is shown.
fn present(ui: &mut Ui, state: &State) {
    let rays = &state.rays;
    let Some((lead, step)) = rays.columns.get(rays.lead).and_then(|lead| Some((lead, lead.followed.steps.get(rays.at)?))) else {
        empty(ui, "This structure has no steps: the ray meets nothing of it.");
        return;
    };
    ui.add(Label::new(steps::details(step)).wrap());
    let tests = |followed: &Followed| {
        let upto = followed.steps.iter().take(rays.at + 1);
        upto.filter(|step| matches!(step.step, Step::Tested(..))).count()
    };
    let tests = format::count(tests(&lead.followed) as u64);
    fact(ui, "Triangle tests so far", tests, "Triangles tested up to this step.");
}

/// What each structure did in all.
fn work(ui: &mut Ui, state: &State) {
    let palette = Palette::in_ui(ui);
    Grid::new("work of the ray").num_columns(4).striped(true).show(ui, |ui| {
        for name in ["", "nodes", "tests", "t"] {
            ui.label(RichText::new(name).small().color(palette.dim));
        }
        ui.end_row();
        for column in &state.rays.columns {
            let followed = &column.followed;
            ui.label(column.built.key.entry.short);
            ui.label(format::count(followed.counts.nodes));
            ui.label(format::count(followed.counts.prims));
            ui.label(format::or_missing(followed.hit, |hit| format::number(hit.t.into())));
            ui.end_row();
        }
    });
}

/// Which structures trace the ray beside the shown one.
fn beside(ui: &mut Ui, state: &State, commands: &mut Commands) {
    let (rays, shown) = (&state.rays, state.settings.entry().id);
    let full = rays.is_full(shown);
    ui.horizontal_wrapped(|ui| {
        for entry in registry::ALL.iter().filter(|entry| entry.id != shown) {
            let chosen = rays.beside.contains(&entry.id);
            let button = ui.add_enabled(chosen || !full, Button::selectable(chosen, entry.short));
            let button = button.accessible_name(format!("{} beside", entry.name));
            if button.on_hover_text(format!("Show the steps of {} too.", entry.name)).clicked() {
                commands.push(Command::Beside(entry.id, !chosen));
            }
        }
    });
}
