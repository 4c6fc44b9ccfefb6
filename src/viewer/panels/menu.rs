//! The bar at the top: File, Edit, View, Window, Help.

use eframe::egui::{self, Align, Key, KeyboardShortcut, Layout, MenuBar, Modifiers, Ui};

use super::{Commands, preferences};
use crate::scene::builtin;
use crate::viewer::actions::{
    self, BOOKMARK, CAMERA_BACK, CAMERA_FORWARD, FRAME_ALL, FULL_SCREEN, LARGER, OPEN, OPEN_PATH, PALETTE, PREFERENCES, PRESENT,
    PROJECTION, QUIT, REDO, SAME_SIZE, SAVE, SMALLER, UNDO, key_of, scaled,
};
use crate::viewer::command::Command;
use crate::viewer::exports::Export;
use crate::viewer::settings::Workspace;
use crate::viewer::state::State;

/// Draws the bar.
pub fn show(ui: &mut Ui, state: &State, commands: &mut Commands) {
    MenuBar::new().ui(ui, |ui| {
        ui.menu_button("File", |ui| file(ui, state, commands));
        ui.menu_button("Edit", |ui| edit(ui, state, commands));
        ui.menu_button("View", |ui| view(ui, state, commands));
        ui.menu_button("Window", |ui| window(ui, state, commands));
        ui.menu_button("Help", |ui| {
            if item(ui, "All commands", &PALETTE) {
                commands.push(Command::Palette(true));
            }
            if ui.button("Tour").on_hover_text("Six steps through what the window is for.").clicked() {
                commands.push(Command::Tour(Some(0)));
            }
            if ui.button("Terms").clicked() {
                commands.push(Command::Terms(true));
            }
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
                let keys = actions::written(ui.ctx(), &key_of(workspace));
                if tab.on_hover_text(format!("{} ({keys})", workspace.help())).clicked() {
                    commands.push(Command::Workspace(workspace));
                }
            }
        });
    });
}

/// Does what was typed, unless a text field has the focus.
pub fn keys(ctx: &egui::Context, state: &State, commands: &mut Commands) {
    if ctx.input(|i| i.events.iter().any(|event| matches!(event, egui::Event::Key { pressed: true, .. }))) {
        let typing = ctx.text_edit_focused() || state.palette;
        let actions = actions::all(state);
        let mut keys: Vec<_> = actions.iter().flat_map(|action| action.keys.iter().map(move |key| (key, action))).collect();
        // A key without Shift is heard with it, too, unless another one has it.
        keys.sort_by_key(|(key, _)| !key.modifiers.shift);
        for (key, action) in keys {
            // A text field takes back its own typing.
            let takes_back = matches!(action.command, Command::Undo | Command::Redo);
            let heard = !typing || (key.modifiers.command && !takes_back);
            if heard && ctx.input_mut(|i| i.consume_shortcut(key)) && action.possible {
                commands.push(action.command.clone());
            }
        }
    }
    escape(ctx, state, commands);
}

/// Esc ends the innermost of what is going on.
fn escape(ctx: &egui::Context, state: &State, commands: &mut Commands) {
    let pages = [
        (state.palette, Command::Palette(false)),
        (state.help, Command::Help(false)),
        (state.terms, Command::Terms(false)),
        (state.preferences, Command::Preferences(false)),
        (state.asking.is_some(), Command::AskForPath(false)),
    ];
    let running = actions::running(state).into_iter().map(|(on, _, command)| (on, command));
    let outermost = [
        (state.folds && state.unfolded && !state.presenting, Command::Unfold(false)),
        (state.presenting, Command::Present(false)),
        // In another workspace nobody sees that it runs.
        (state.checks.running.is_some() && state.settings.workspace == Workspace::Check, Command::CancelLab),
    ];
    // An open menu or list is further in than all of these, and closes itself.
    if !egui::Popup::is_any_open(ctx)
        && let Some((_, command)) = pages.into_iter().chain(running).chain(outermost).find(|(on, _)| *on)
        && ctx.input_mut(|i| i.consume_key(Modifiers::NONE, Key::Escape))
    {
        commands.push(command);
    }
}

fn item(ui: &mut Ui, text: &str, shortcut: &KeyboardShortcut) -> bool {
    let keys = actions::written(ui.ctx(), shortcut);
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
    if item_if(ui, state.model.is_some(), "Save workspace…", &SAVE) {
        commands.push(Command::SaveWorkspace);
    }
    ui.separator();
    exports(ui, state, commands);
    ui.separator();
    if item(ui, "Quit", &QUIT) {
        commands.push(Command::Quit);
    }
}

/// What can be taken away.
fn exports(ui: &mut Ui, state: &State, commands: &mut Commands) {
    let free = state.shown.is_some() && !state.is_measuring() && !state.is_checking();
    let items = [
        (
            "Export report…",
            "Measure everything on this model and put it on one page, with its data: under a minute.",
            free,
            Export::Report { quick: true },
        ),
        (
            "Export thorough report…",
            "The same with more structures, rays and samples: some minutes.",
            free,
            Export::Report { quick: false },
        ),
        (
            "Save figure…",
            "The view, or compared ones as they stand, with boxes and rays as lines (SVG).",
            state.picture.is_some(),
            Export::Figure,
        ),
        (
            "Save picture…",
            "The traced picture alone, or compared ones as they stand (PNG).",
            state.picture.is_some(),
            Export::Picture,
        ),
    ];
    for (text, help, possible, export) in items {
        if ui.add_enabled(possible, egui::Button::new(text)).on_hover_text(help).clicked() {
            commands.push(Command::Export(export));
        }
    }
}

/// An item that may have nothing to do.
fn item_if(ui: &mut Ui, possible: bool, text: &str, shortcut: &KeyboardShortcut) -> bool {
    ui.add_enabled_ui(possible, |ui| item(ui, text, shortcut)).inner
}

fn edit(ui: &mut Ui, state: &State, commands: &mut Commands) {
    if item_if(ui, state.can_undo(), "Undo", &UNDO) {
        commands.push(Command::Undo);
    }
    if item_if(ui, state.can_redo(), "Redo", &REDO) {
        commands.push(Command::Redo);
    }
    ui.separator();
    if item(ui, "Settings…", &PREFERENCES) {
        commands.push(Command::Preferences(true));
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
    bookmarks(ui, state, commands);
    ui.menu_button("Samples a pixel", |ui| preferences::samples(ui, state, commands));
    ui.menu_button("Memory", |ui| preferences::memory(ui, state, commands));
    ui.menu_button("Mouse", |ui| preferences::mouse(ui, state, commands));
}

/// Views that were kept.
fn bookmarks(ui: &mut Ui, state: &State, commands: &mut Commands) {
    ui.menu_button("Bookmarks", |ui| {
        if item_if(ui, state.model.is_some(), "Keep this view", &BOOKMARK) {
            commands.push(Command::AddBookmark);
        }
        for (i, bookmark) in state.bookmarks.iter().enumerate() {
            ui.horizontal(|ui| {
                if ui.button(&bookmark.name).on_hover_text("Look from there again.").clicked() {
                    commands.push(Command::Bookmark(i));
                }
                let forget = ui.button("×").on_hover_text("Forget this view.");
                if forget.accessible_name(format!("Forget {}", bookmark.name)).clicked() {
                    commands.push(Command::DropBookmark(i));
                }
            });
        }
    });
}

fn window(ui: &mut Ui, state: &State, commands: &mut Commands) {
    preferences::look(ui, state, commands);
    ui.separator();
    let scale = state.settings.scale;
    if item(ui, "Larger", &LARGER) {
        commands.push(Command::Scale(scaled(scale, true)));
    }
    if item(ui, "Smaller", &SMALLER) {
        commands.push(Command::Scale(scaled(scale, false)));
    }
    if item(ui, "Normal size", &SAME_SIZE) {
        commands.push(Command::Scale(1.0));
    }
    ui.separator();
    if item(ui, "Presentation", &PRESENT) {
        commands.push(Command::Present(!state.presenting));
    }
    if item(ui, "Full screen", &FULL_SCREEN) {
        commands.push(Command::FullScreen);
    }
    if ui.button("Reset layout").clicked() {
        commands.push(Command::ResetLayout);
    }
}
