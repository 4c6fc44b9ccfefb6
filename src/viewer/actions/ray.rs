//! The ray that is followed, and its steps.

use super::List;
use crate::accel::registry;
use crate::viewer::command::Command;
use crate::viewer::panels::ray::name_of;
use crate::viewer::rays::{KINDS, SPEEDS};
use crate::viewer::settings::Workspace;
use crate::viewer::state::State;

/// Adds them.
pub(super) fn add(list: &mut List, state: &State) {
    let (rays, listed) = (&state.rays, &state.ray_list);
    let here = state.settings.workspace == Workspace::Ray;
    list.add("Open rays…", Command::OpenRays).if_possible(state.model.is_some());
    list.add("Put the file of rays away", Command::CloseRays).if_possible(listed.file.is_some());
    let traced = here && listed.is_traced_in(state.shown.as_ref().map(|shown| &shown.key));
    list.add("Follow the dearest ray of the file", Command::FollowListed(0)).if_possible(traced);
    for kind in KINDS {
        let name = format!("Follow: {}", name_of(kind).to_lowercase());
        list.add(name, Command::RayKind(kind)).if_possible(here && kind != rays.kind);
    }
    let shown = state.settings.entry().id;
    for entry in registry::ALL.iter().filter(|entry| entry.id != shown) {
        let beside = rays.beside.contains(&entry.id);
        let name = format!("{} the steps of {}", if beside { "Hide" } else { "Show" }, entry.name);
        let possible = here && state.shown.is_some() && (beside || !rays.is_full(shown));
        list.add(name, Command::Beside(entry.id, !beside)).if_possible(possible);
    }
    steps(list, state, here && !rays.columns.is_empty());
    let compared = state.can_compare_with_brute_force();
    list.add("Mark a rectangle to check with brute force", Command::MarkRectangle(true)).if_possible(compared);
    list.add("Check the whole view with brute force", Command::CheckByBrute(None)).if_possible(compared);
    let differs = !state.brute.unlike().is_empty();
    list.add("Follow a ray that differs from brute force", Command::FollowUnlike(state.brute.next)).if_possible(differs);
}

/// The way through the steps of the ray.
fn steps(list: &mut List, state: &State, there: bool) {
    let rays = &state.rays;
    let (at, last) = (rays.at, rays.last());
    let go = |to: usize| Command::Step(rays.lead, to);
    list.add("First step", go(0)).if_possible(there && at > 0);
    list.add("Next step", go(at + 1)).if_possible(there && at < last);
    list.add("Step before", go(at.saturating_sub(1))).if_possible(there && at > 0);
    list.add("Last step", go(last)).if_possible(there && at < last);
    for (name, forward) in [("Next leaf", true), ("Leaf before", false)] {
        let leaf = rays.columns.get(rays.lead).and_then(|lead| lead.followed.leaf(at, forward));
        list.add(name, go(leaf.unwrap_or(0))).if_possible(there && leaf.is_some());
    }
    let playing = rays.playing.is_some();
    list.add(if playing { "Pause the ray" } else { "Play the ray" }, Command::Play(!playing)).if_possible(there);
    for (name, speed) in [("Play the ray faster", rays.speed * 2.0), ("Play the ray slower", rays.speed / 2.0)] {
        let speed = speed.clamp(*SPEEDS.start(), *SPEEDS.end());
        list.add(name, Command::PlaySpeed(speed)).if_possible(there && speed != rays.speed);
    }
}
