//! The selected cell: those around and beside it, and how it is divided.

use super::{List, SIBLING};
use crate::geometry::Axis;
use crate::viewer::command::Command;
use crate::viewer::panels::fitting::volume_name;
use crate::viewer::panels::{node, tree};
use crate::viewer::settings::Workspace;
use crate::viewer::state::State;

/// Adds them.
pub(super) fn add(list: &mut List, state: &State) {
    let [parent, child, sibling] = tree::ways(state).map(|way| way.to);
    // Outside the tree the cells that hold what was clicked are known.
    let picked = state.picked.as_ref();
    let level = |by: isize| {
        let level = picked?.level.checked_add_signed(by).filter(|level| picked.is_some_and(|p| *level < p.path.len()))?;
        Some(Command::SelectLevel(level))
    };
    let around = parent.map(Command::SelectRow).or_else(|| level(-1));
    let within = child.map(Command::SelectRow).or_else(|| level(1));
    for (name, way) in [("Select the cell around this one", around), ("Select the cell in this one", within)] {
        let possible = way.is_some();
        list.add(name, way.unwrap_or(Command::SelectLevel(0))).if_possible(possible);
    }
    let next = list.add("Select the next sibling", Command::SelectRow(sibling.unwrap_or(0)));
    next.key(SIBLING).if_possible(sibling.is_some());
    volumes(list, state);
    let hide = !state.settings.hide_outcome;
    list.add(if hide { "Hide outcomes" } else { "Show outcomes" }, Command::HideOutcome(hide));
    planes(list, state);
}

/// Bounding volumes around the selected node.
fn volumes(list: &mut List, state: &State) {
    let free = !state.is_measuring() && !state.is_checking() && state.building.is_none();
    let fits = state.fittable().is_some() && free;
    list.add("Compare bounding volumes of the selected node", Command::FitVolumes).if_possible(fits);
    for row in state.fitting().iter().flat_map(|(fitting, _)| &fitting.rows) {
        let name = format!("Draw around the node: {}", volume_name(row.id));
        list.add(name, Command::DrawVolume(Some(row.id))).if_possible(state.fits.drawn != Some(row.id));
    }
    let drawn = state.fits.drawn.is_some();
    list.add("Draw no volume around the node", Command::DrawVolume(None)).if_possible(drawn);
}

/// Planes that the selected node is divided by, or would be.
fn planes(list: &mut List, state: &State) {
    let here = state.settings.workspace == Workspace::Structure;
    let curves = state.curves.as_ref().and_then(|(_, curves)| curves.as_ref()).filter(|_| here);
    let (tried, hidden) = (state.tree.tried, node::hidden(state));
    list.add("Reveal how the node is divided", Command::Reveal).if_possible(curves.is_some() && hidden);
    for axis in Axis::ALL {
        let plane = Some((axis, 0.5));
        let name = format!("Try the middle plane across {}", axis.name());
        list.add(name, Command::TryPlane(plane)).if_possible(curves.is_some() && tried != plane);
    }
    for other in curves.filter(|_| !hidden).iter().flat_map(|curves| &curves.others) {
        let plane = other.division.map(|division| division.plane);
        let possible = plane.is_some() && tried != plane;
        list.add(format!("Try the plane of: {}", other.name), Command::TryPlane(plane)).if_possible(possible);
    }
    list.add("Put the tried plane away", Command::TryPlane(None)).if_possible(here && tried.is_some());
}
