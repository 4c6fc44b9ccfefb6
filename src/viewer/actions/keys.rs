//! The keys of the window.

use eframe::egui::{Context, Key, KeyboardShortcut, Modifiers};

use crate::viewer::settings::{SCALE, Workspace};

const fn with(modifiers: Modifiers, key: Key) -> KeyboardShortcut {
    KeyboardShortcut::new(modifiers, key)
}

/// Opens a file.
pub const OPEN: KeyboardShortcut = with(Modifiers::COMMAND, Key::O);
/// Opens the field for a path.
pub const OPEN_PATH: KeyboardShortcut = with(Modifiers::COMMAND, Key::L);
/// Saves the whole state of the window.
pub const SAVE: KeyboardShortcut = with(Modifiers::COMMAND, Key::S);
/// Closes the window.
pub const QUIT: KeyboardShortcut = with(Modifiers::COMMAND, Key::Q);
/// Frames the whole model.
pub const FRAME_ALL: KeyboardShortcut = with(Modifiers::NONE, Key::Home);
/// Frames the selected cell.
pub const FRAME_SELECTED: KeyboardShortcut = with(Modifiers::NONE, Key::F);
/// Between perspective and orthographic.
pub const PROJECTION: KeyboardShortcut = with(Modifiers::NONE, Key::P);
/// Takes back the last choice.
pub const UNDO: KeyboardShortcut = with(Modifiers::COMMAND, Key::Z);
/// Makes it again.
pub const REDO: KeyboardShortcut = with(Modifiers::COMMAND.plus(Modifiers::SHIFT), Key::Z);
/// The camera's view before.
pub const CAMERA_BACK: KeyboardShortcut = with(Modifiers::ALT, Key::ArrowLeft);
/// And forward again.
pub const CAMERA_FORWARD: KeyboardShortcut = with(Modifiers::ALT, Key::ArrowRight);
/// In and out of full screen.
pub const FULL_SCREEN: KeyboardShortcut = with(Modifiers::NONE, Key::F11);
/// Larger.
pub const LARGER: KeyboardShortcut = with(Modifiers::COMMAND, Key::Plus);
/// The same key where plus needs Shift.
pub(super) const LARGER_UNSHIFTED: KeyboardShortcut = with(Modifiers::COMMAND, Key::Equals);
/// Smaller.
pub const SMALLER: KeyboardShortcut = with(Modifiers::COMMAND, Key::Minus);
/// The system's size.
pub const SAME_SIZE: KeyboardShortcut = with(Modifiers::COMMAND, Key::Num0);
/// Brings the focus to the next panel.
pub(super) const NEXT_PANEL: KeyboardShortcut = with(Modifiers::NONE, Key::F6);
/// And to the one before.
pub(super) const PANEL_BEFORE: KeyboardShortcut = with(Modifiers::SHIFT, Key::F6);
/// Opens the palette.
pub const PALETTE: KeyboardShortcut = with(Modifiers::COMMAND, Key::P);
/// Opens the page of settings.
pub const PREFERENCES: KeyboardShortcut = with(Modifiers::COMMAND, Key::Comma);
/// For an audience.
pub const PRESENT: KeyboardShortcut = with(Modifiers::NONE, Key::F10);
/// Shows the triangles of the selected cell alone.
pub const ISOLATE: KeyboardShortcut = with(Modifiers::NONE, Key::I);
/// Hides them.
pub const HIDE: KeyboardShortcut = with(Modifiers::NONE, Key::H);
/// Shows all triangles again.
pub const SHOW_ALL: KeyboardShortcut = with(Modifiers::SHIFT, Key::H);
/// Keeps the view.
pub const BOOKMARK: KeyboardShortcut = with(Modifiers::COMMAND, Key::D);
/// The page of keys, on keyboards where it needs Shift and others.
pub(super) const HELP: [KeyboardShortcut; 2] =
    [with(Modifiers::NONE, Key::Questionmark), with(Modifiers::SHIFT, Key::Questionmark)];
/// A level deeper and higher.
pub(super) const DEEPER: [KeyboardShortcut; 2] =
    [with(Modifiers::NONE, Key::CloseBracket), with(Modifiers::NONE, Key::OpenBracket)];
/// Boxes on and off.
pub(super) const BOXES: KeyboardShortcut = with(Modifiers::NONE, Key::B);

/// Selects the next cell in the same one.
pub const SIBLING: KeyboardShortcut = with(Modifiers::NONE, Key::N);
/// The film of the build: an event back.
pub const FILM_BACK: KeyboardShortcut = with(Modifiers::NONE, Key::Comma);
/// An event forward.
pub const FILM_FORWARD: KeyboardShortcut = with(Modifiers::NONE, Key::Period);
/// Plays it, and pauses.
pub const FILM_PLAY: KeyboardShortcut = with(Modifiers::NONE, Key::K);

/// One step of enlarging.
const SCALE_STEP: f32 = 0.25;

/// The key of a workspace.
pub const fn key_of(workspace: Workspace) -> KeyboardShortcut {
    let key = match workspace {
        Workspace::View => Key::F1,
        Workspace::Structure => Key::F2,
        Workspace::Ray => Key::F3,
        Workspace::Compare => Key::F4,
        Workspace::Check => Key::F5,
    };
    with(Modifiers::NONE, key)
}

/// A key as it is written on the keyboard.
pub fn written(ctx: &Context, key: &KeyboardShortcut) -> String {
    let signs = [
        ("OpenBracket", "["),
        ("CloseBracket", "]"),
        ("Questionmark", "?"),
        ("Plus", "+"),
        ("Minus", "-"),
        ("Comma", ","),
        ("Period", "."),
    ];
    signs.into_iter().fold(ctx.format_shortcut(key), |text, (name, sign)| text.replace(name, sign))
}

/// How large everything is after one step.
pub fn scaled(scale: f32, up: bool) -> f32 {
    if up { (scale + SCALE_STEP).min(*SCALE.end()) } else { (scale - SCALE_STEP).max(*SCALE.start()) }
}
