//! Which boxes and planes are drawn over the picture.

use super::{BOXES, DEEPER, List};
use crate::accel::cell::Layout;
use crate::geometry::Axis;
use crate::viewer::command::Command;
use crate::viewer::panels::overlay::{self, has_empty_cells, has_levels, has_split_planes};
use crate::viewer::panels::toolbar;
use crate::viewer::settings::{BoxColor, Levels, OverlaySettings};
use crate::viewer::state::State;

/// Adds them.
pub(super) fn add(list: &mut List, state: &State) {
    let (now, shown) = (state.settings.overlay, state.shown.is_some());
    let resolution = match state.layout() {
        Some(Layout::Flat { resolution, .. }) => Some(resolution),
        _ => None,
    };
    // A film of the build says which cells are drawn.
    let chosen = shown && state.film_on_screen().is_none();
    let mut toggle = |name: &'static str, possible: bool, change: fn(&mut OverlaySettings)| {
        let mut overlay = now;
        change(&mut overlay);
        list.add(name, Command::Overlay(overlay)).if_possible(possible);
    };
    toggle("Leaves only, or a depth", chosen && resolution.is_none(), |o| o.leaves_only = !o.leaves_only);
    toggle("Split planes on or off", has_split_planes(state), |o| o.planes = !o.planes);
    toggle("Empty cells on or off", has_empty_cells(state), |o| o.empty_cells = !o.empty_cells);
    toggle("Hidden lines on or off", shown, |o| o.hidden_lines = !o.hidden_lines);
    toggle("Boxes over half of the view, or all of it", shown && !state.is_comparing(), |o| {
        o.begin = if o.begin == 0 { 50 } else { 0 }
    });
    toggle("Boxes of the selected cell only, or of all", chosen, |o| o.subtree_only = !o.subtree_only);
    let overlay = OverlaySettings { boxes: !now.boxes, ..now };
    list.add("Boxes on or off", Command::Overlay(overlay)).key(BOXES).if_possible(shown);
    depths(list, state, chosen && resolution.is_none());
    if let Some(resolution) = resolution {
        slices(list, now, resolution);
    }
    for levels in Levels::ALL {
        let overlay = OverlaySettings { levels, ..now };
        let possible = overlay != now && has_levels(state);
        list.add(format!("Levels drawn: {}", levels.label()), Command::Overlay(overlay)).if_possible(possible);
    }
    for color in BoxColor::ALL {
        let overlay = OverlaySettings { color, ..now };
        list.add(format!("Colour boxes by {}", color.name()), Command::Overlay(overlay)).if_possible(overlay != now && shown);
    }
}

/// The level that is drawn, or those from one on.
fn depths(list: &mut List, state: &State, possible: bool) {
    let (now, deepest) = (state.settings.overlay, toolbar::deepest(state));
    let single = now.from_depth == now.depth;
    for (name, depth, key) in [
        ("A level deeper", now.depth.saturating_add(1).min(deepest), DEEPER[0]),
        ("A level higher", now.depth.saturating_sub(1), DEEPER[1]),
    ] {
        let overlay = OverlaySettings { depth, from_depth: if single { depth } else { now.from_depth.min(depth) }, ..now };
        list.add(name, Command::Overlay(overlay)).key(key).if_possible(overlay != now && possible);
    }
    let range = overlay::ranged(now, single, deepest);
    list.add("One depth, or a range of depths", Command::Overlay(range)).if_possible(range != now && possible);
}

/// Of a grid: the layer that is drawn, and how full its cells are.
fn slices(list: &mut List, now: OverlaySettings, resolution: [u32; 3]) {
    let layers = resolution[now.slice_axis.min(2)];
    let mut add = |name: &'static str, overlay: OverlaySettings| {
        list.add(name, Command::Overlay(overlay)).if_possible(overlay != now);
    };
    add("Slice: the next layer", OverlaySettings { slice: now.slice.saturating_add(1).min(layers), ..now });
    add("Slice: the layer before", OverlaySettings { slice: now.slice.saturating_sub(1), ..now });
    add("Slice: all layers", OverlaySettings { slice: 0, ..now });
    add("Occupancy: fuller cells alone", OverlaySettings { occupancy: now.occupancy.saturating_add(1), ..now });
    add("Occupancy: emptier cells too", OverlaySettings { occupancy: now.occupancy.saturating_sub(1), ..now });
    for (i, axis) in Axis::ALL.into_iter().enumerate() {
        let overlay = OverlaySettings { slice_axis: i, slice: now.slice.min(resolution[i]), ..now };
        list.add(format!("Slices across {}", axis.name()), Command::Overlay(overlay)).if_possible(overlay != now);
    }
}
