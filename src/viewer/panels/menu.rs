//! The bar at the top: File, Edit, View, Window, Help.

use eframe::egui::{self, Align, Key, KeyboardShortcut, Layout, MenuBar, Modifiers, Ui};

use super::Commands;
use crate::scene::builtin;
use crate::viewer::command::Command;
use crate::viewer::format;
use crate::viewer::settings::{Navigation, SCALE, ThemeChoice, Workspace};
use crate::viewer::state::State;

/// Keys that work everywhere, and what they do.
pub const OPEN: KeyboardShortcut = KeyboardShortcut::new(Modifiers::COMMAND, Key::O);
/// Opens the field for a path.
pub const OPEN_PATH: KeyboardShortcut = KeyboardShortcut::new(Modifiers::COMMAND, Key::L);
/// Closes the window.
pub const QUIT: KeyboardShortcut = KeyboardShortcut::new(Modifiers::COMMAND, Key::Q);
/// Frames the whole model.
pub const FRAME_ALL: KeyboardShortcut = KeyboardShortcut::new(Modifiers::NONE, Key::Home);
/// Between perspective and orthographic.
pub const PROJECTION: KeyboardShortcut = KeyboardShortcut::new(Modifiers::NONE, Key::P);
/// Takes back the last choice.
pub const UNDO: KeyboardShortcut = KeyboardShortcut::new(Modifiers::COMMAND, Key::Z);
/// Makes it again.
pub const REDO: KeyboardShortcut = KeyboardShortcut::new(Modifiers::COMMAND.plus(Modifiers::SHIFT), Key::Z);
/// The camera's view before.
pub const CAMERA_BACK: KeyboardShortcut = KeyboardShortcut::new(Modifiers::ALT, Key::ArrowLeft);
/// And forward again.
pub const CAMERA_FORWARD: KeyboardShortcut = KeyboardShortcut::new(Modifiers::ALT, Key::ArrowRight);
/// Statistics and timings around the view.
pub const VIEW: KeyboardShortcut = KeyboardShortcut::new(Modifiers::NONE, Key::F1);
/// Curves of the picture's error around it.
pub const COMPARE: KeyboardShortcut = KeyboardShortcut::new(Modifiers::NONE, Key::F4);
/// The stability lab and the model's check around it.
pub const CHECK: KeyboardShortcut = KeyboardShortcut::new(Modifiers::NONE, Key::F5);
/// In and out of full screen.
pub const FULL_SCREEN: KeyboardShortcut = KeyboardShortcut::new(Modifiers::NONE, Key::F11);
/// Larger, smaller, as the system has it.
pub const LARGER: KeyboardShortcut = KeyboardShortcut::new(Modifiers::COMMAND, Key::Plus);
/// The same key where plus needs Shift.
const LARGER_UNSHIFTED: KeyboardShortcut = KeyboardShortcut::new(Modifiers::COMMAND, Key::Equals);
/// Smaller.
pub const SMALLER: KeyboardShortcut = KeyboardShortcut::new(Modifiers::COMMAND, Key::Minus);
/// The system's size.
pub const SAME_SIZE: KeyboardShortcut = KeyboardShortcut::new(Modifiers::COMMAND, Key::Num0);
/// One step of enlarging.
const SCALE_STEP: f32 = 0.25;

/// Draws the bar.
pub fn show(ui: &mut Ui, state: &State, commands: &mut Commands) {
    MenuBar::new().ui(ui, |ui| {
        ui.menu_button("File", |ui| file(ui, state, commands));
        ui.menu_button("Edit", |ui| edit(ui, state, commands));
        ui.menu_button("View", |ui| view(ui, state, commands));
        ui.menu_button("Window", |ui| window(ui, state, commands));
        ui.menu_button("Help", |ui| {
            if ui.button("Keys and mouse").clicked() {
                commands.push(Command::Help(true));
            }
        });
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            for workspace in Workspace::ALL.into_iter().rev() {
                let chosen = state.settings.workspace == workspace;
                let tab = ui.add(egui::Button::selectable(chosen, workspace.name()));
                // A menu has the same name.
                let tab = tab.accessible_name(format!("{} workspace", workspace.name()));
                if tab.on_hover_text(workspace.help()).clicked() {
                    commands.push(Command::Workspace(workspace));
                }
            }
        });
    });
}

/// Does what was typed, unless a text field has the focus.
pub fn keys(ctx: &egui::Context, state: &State, commands: &mut Commands) {
    let typing = ctx.text_edit_focused();
    let mut on = |shortcut: &KeyboardShortcut, command: Command| {
        if (!typing || shortcut.modifiers.command) && ctx.input_mut(|i| i.consume_shortcut(shortcut)) {
            commands.push(command);
        }
    };
    let scale = state.settings.scale;
    on(&OPEN, Command::OpenDialog);
    on(&OPEN_PATH, Command::AskForPath(true));
    on(&QUIT, Command::Quit);
    if !typing {
        // A text field takes back its own typing.
        on(&REDO, Command::Redo);
        on(&UNDO, Command::Undo);
    }
    on(&CAMERA_BACK, Command::CameraBack);
    on(&CAMERA_FORWARD, Command::CameraForward);
    on(&FRAME_ALL, Command::FrameAll);
    on(&PROJECTION, Command::ToggleProjection);
    on(&VIEW, Command::Workspace(Workspace::View));
    on(&COMPARE, Command::Workspace(Workspace::Compare));
    on(&CHECK, Command::Workspace(Workspace::Check));
    on(&FULL_SCREEN, Command::FullScreen);
    on(&LARGER, Command::Scale((scale + SCALE_STEP).min(*SCALE.end())));
    on(&LARGER_UNSHIFTED, Command::Scale((scale + SCALE_STEP).min(*SCALE.end())));
    on(&SMALLER, Command::Scale((scale - SCALE_STEP).max(*SCALE.start())));
    on(&SAME_SIZE, Command::Scale(1.0));
    on(&KeyboardShortcut::new(Modifiers::SHIFT, Key::Questionmark), Command::Help(!state.help));
    on(&KeyboardShortcut::new(Modifiers::NONE, Key::Questionmark), Command::Help(!state.help));
    escape(ctx, state, commands);
}

/// Esc ends the innermost of what is going on.
fn escape(ctx: &egui::Context, state: &State, commands: &mut Commands) {
    let innermost = [
        (state.help, Command::Help(false)),
        (state.asking.is_some(), Command::AskForPath(false)),
        (state.measuring.is_some(), Command::CancelMeasure),
        (state.building.is_some(), Command::CancelBuild),
        (state.loading.is_some(), Command::CancelLoad),
        (state.error.is_some(), Command::Dismiss),
        (state.needing.is_some(), Command::CancelNeeds),
        (state.checks.checking.is_some(), Command::CancelCheck),
        (state.errors.making.is_some(), Command::CancelReference),
        (state.tradeoffs.running.is_some(), Command::CancelTradeoffs),
        // In another workspace nobody sees that it runs.
        (state.checks.running.is_some() && state.settings.workspace == Workspace::Check, Command::CancelLab),
    ];
    // An open menu or list is further in than all of these, and closes itself.
    if !egui::Popup::is_any_open(ctx)
        && let Some((_, command)) = innermost.into_iter().find(|(on, _)| *on)
        && ctx.input_mut(|i| i.consume_key(Modifiers::NONE, Key::Escape))
    {
        commands.push(command);
    }
}

fn item(ui: &mut Ui, text: &str, shortcut: &KeyboardShortcut) -> bool {
    let keys = ui.ctx().format_shortcut(shortcut);
    ui.add(egui::Button::new(text).shortcut_text(keys)).clicked()
}

fn file(ui: &mut Ui, state: &State, commands: &mut Commands) {
    if item(ui, "Open…", &OPEN) {
        commands.push(Command::OpenDialog);
    }
    if item(ui, "Open a path…", &OPEN_PATH) {
        commands.push(Command::AskForPath(true));
    }
    ui.menu_button("Open recent", |ui| {
        if state.settings.recent.is_empty() {
            super::empty(ui, "Nothing was opened yet.");
        }
        for model in &state.settings.recent {
            if ui.button(model).clicked() {
                commands.push(Command::Open(model.clone()));
            }
        }
    });
    ui.menu_button("Built-in scenes", |ui| {
        for scene in builtin::all() {
            if ui.button(scene.id).on_hover_text(scene.about).clicked() {
                commands.push(Command::Open(format!("{}{}", builtin::SCHEME, scene.id)));
            }
        }
    });
    ui.separator();
    if item(ui, "Quit", &QUIT) {
        commands.push(Command::Quit);
    }
}

/// An item that may have nothing to do.
fn item_if(ui: &mut Ui, possible: bool, text: &str, shortcut: &KeyboardShortcut) -> bool {
    ui.add_enabled_ui(possible, |ui| item(ui, text, shortcut)).inner
}

fn edit(ui: &mut Ui, state: &State, commands: &mut Commands) {
    if item_if(ui, state.choices.has_back(), "Undo", &UNDO) {
        commands.push(Command::Undo);
    }
    if item_if(ui, state.choices.has_forward(), "Redo", &REDO) {
        commands.push(Command::Redo);
    }
}

fn view(ui: &mut Ui, state: &State, commands: &mut Commands) {
    if item(ui, "Frame all", &FRAME_ALL) {
        commands.push(Command::FrameAll);
    }
    if item(ui, "Perspective or orthographic", &PROJECTION) {
        commands.push(Command::ToggleProjection);
    }
    if item_if(ui, state.cameras.has_back(), "View before", &CAMERA_BACK) {
        commands.push(Command::CameraBack);
    }
    if item_if(ui, state.cameras.has_forward(), "View after", &CAMERA_FORWARD) {
        commands.push(Command::CameraForward);
    }
    ui.menu_button("Samples a pixel", |ui| {
        for samples in [1, 16, 64, 256, 1024, 4096] {
            if ui.radio(state.settings.max_samples == samples, samples.to_string()).clicked() {
                commands.push(Command::MaxSamples(samples));
            }
        }
    });
    ui.menu_button("Memory", |ui| memory(ui, state, commands));
    ui.menu_button("Mouse", |ui| {
        for (choice, text) in [
            (Navigation::Standard, "Left orbits, middle pans"),
            (Navigation::Blender, "Blender: middle orbits, Shift+middle pans"),
        ] {
            if ui.radio(state.settings.navigation == choice, text).clicked() {
                commands.push(Command::Navigation(choice));
            }
        }
    });
}

/// How much the work may take. Structures that are kept go first where it is less than is held.
fn memory(ui: &mut Ui, state: &State, commands: &mut Commands) {
    let (used, limit) = state.memory();
    super::empty(ui, &format!("{} of {} in use", format::bytes(used), format::bytes(limit)));
    let chosen = state.settings.memory_mib;
    if ui.radio(chosen.is_none(), "Half of the machine").clicked() {
        commands.push(Command::Memory(None));
    }
    let gibs = [1, 2, 4, 8, 16, 32, 64, 128].into_iter().filter(|gib| gib << 30 <= state.machine_bytes);
    for gib in gibs {
        if ui.radio(chosen == Some(gib << 10), format::bytes(gib << 30)).clicked() {
            commands.push(Command::Memory(Some(gib << 10)));
        }
    }
}

fn window(ui: &mut Ui, state: &State, commands: &mut Commands) {
    for (choice, text) in [(ThemeChoice::System, "As the system"), (ThemeChoice::Light, "Light"), (ThemeChoice::Dark, "Dark")] {
        if ui.radio(state.settings.theme == choice, text).clicked() {
            commands.push(Command::Theme(choice));
        }
    }
    ui.separator();
    let scale = state.settings.scale;
    if item(ui, "Larger", &LARGER) {
        commands.push(Command::Scale((scale + SCALE_STEP).min(*SCALE.end())));
    }
    if item(ui, "Smaller", &SMALLER) {
        commands.push(Command::Scale((scale - SCALE_STEP).max(*SCALE.start())));
    }
    if item(ui, "Normal size", &SAME_SIZE) {
        commands.push(Command::Scale(1.0));
    }
    ui.separator();
    if item(ui, "Full screen", &FULL_SCREEN) {
        commands.push(Command::FullScreen);
    }
    if ui.button("Reset layout").clicked() {
        commands.push(Command::ResetLayout);
    }
}
