//! The window itself.

use super::{
    FULL_SCREEN, HELP, LARGER, LARGER_UNSHIFTED, List, NEXT_PANEL, PALETTE, PANEL_BEFORE, PREFERENCES, PRESENT, SAME_SIZE,
    SMALLER, key_of, scaled,
};
use crate::viewer::command::Command;
use crate::viewer::format;
use crate::viewer::panels::preferences::memory_sizes;
use crate::viewer::settings::{Navigation, ThemeChoice, Workspace};
use crate::viewer::state::State;

/// Adds them.
pub(super) fn add(list: &mut List, state: &State) {
    for workspace in Workspace::ALL {
        let other = workspace != state.settings.workspace;
        let name = format!("{} workspace", workspace.name());
        list.add(name, Command::Workspace(workspace)).key(key_of(workspace)).if_possible(other);
    }
    for (theme, name) in
        [(ThemeChoice::System, "Look: as the system"), (ThemeChoice::Light, "Look: light"), (ThemeChoice::Dark, "Look: dark")]
    {
        list.add(name, Command::Theme(theme)).if_possible(theme != state.settings.theme);
    }
    for (choice, name) in
        [(Navigation::Standard, "Mouse: left orbits, middle pans"), (Navigation::Blender, "Mouse: middle orbits, as in Blender")]
    {
        list.add(name, Command::Navigation(choice)).if_possible(choice != state.settings.navigation);
    }
    let scale = state.settings.scale;
    let [up, down] = [true, false].map(|up| scaled(scale, up));
    list.add("Larger", Command::Scale(up)).key(LARGER).key(LARGER_UNSHIFTED).if_possible(up != scale);
    list.add("Smaller", Command::Scale(down)).key(SMALLER).if_possible(down != scale);
    list.add("Normal size", Command::Scale(1.0)).key(SAME_SIZE).if_possible(scale != 1.0);
    memory(list, state);
    let present = if state.presenting { "End the presentation" } else { "Presentation: larger, without panels" };
    list.add(present, Command::Present(!state.presenting)).key(PRESENT);
    list.add("Terms, with formulas and sources", Command::Terms(true)).if_possible(!state.terms);
    list.add("Tour in six steps", Command::Tour(Some(0))).if_possible(state.tour.is_none());
    list.add("Full screen", Command::FullScreen).key(FULL_SCREEN);
    list.add("Next panel", Command::NextPanel(true)).key(NEXT_PANEL);
    list.add("Panel before", Command::NextPanel(false)).key(PANEL_BEFORE);
    let fold = if state.unfolded { "Fold the panel at the right" } else { "Unfold the panel at the right" };
    list.add(fold, Command::Unfold(!state.unfolded)).if_possible(state.folds && !state.presenting);
    list.add("Reset layout", Command::ResetLayout);
    list.add("Settings", Command::Preferences(!state.preferences)).key(PREFERENCES);
    list.add("All commands", Command::Palette(true)).key(PALETTE);
    let help = list.add("Keys and mouse", Command::Help(!state.help));
    help.keys.extend(HELP);
}

/// How much the work may take.
fn memory(list: &mut List, state: &State) {
    let chosen = state.settings.memory_mib;
    list.add("Memory: half of the machine", Command::Memory(None)).if_possible(chosen.is_some());
    for gib in memory_sizes(state) {
        let mib = Some(gib << 10);
        list.add(format!("Memory: {}", format::bytes(gib << 30)), Command::Memory(mib)).if_possible(chosen != mib);
    }
}
