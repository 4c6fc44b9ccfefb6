//! From where and how the model is seen.

use super::{BOOKMARK, CAMERA_BACK, CAMERA_FORWARD, FRAME_ALL, FRAME_SELECTED, HIDE, ISOLATE, List, PROJECTION, SHOW_ALL};
use crate::accel::visibility::Change;
use crate::geometry::Axis;
use crate::render::sampler::SamplerKind;
use crate::render::{Curve, HeatRays, Mode, Tone};
use crate::scene::Section;
use crate::viewer::command::Command;
use crate::viewer::panels::heat;
use crate::viewer::panels::toolbar::{self, STOPS};
use crate::viewer::settings::SectionSettings;
use crate::viewer::state::State;

/// One step of moving the section.
const SECTION_STEP: f32 = 0.05;

/// Adds them.
pub(super) fn add(list: &mut List, state: &State) {
    let open = state.model.is_some();
    list.add("Frame all", Command::FrameAll).key(FRAME_ALL).if_possible(open);
    let selected = state.picked.as_ref().is_some_and(|picked| picked.selected().is_some());
    list.add("Frame the selected cell", Command::FrameSelected).key(FRAME_SELECTED).if_possible(selected);
    list.add("Perspective or orthographic", Command::ToggleProjection).key(PROJECTION).if_possible(open);
    list.add("Keep this view as a bookmark", Command::AddBookmark).key(BOOKMARK).if_possible(open);
    for (i, bookmark) in state.bookmarks.iter().enumerate() {
        list.add(format!("Go to {}", bookmark.name), Command::Bookmark(i));
        list.add(format!("Forget {}", bookmark.name), Command::DropBookmark(i));
    }
    list.add("View before", Command::CameraBack).key(CAMERA_BACK).if_possible(state.cameras.has_back());
    list.add("View after", Command::CameraForward).key(CAMERA_FORWARD).if_possible(state.cameras.has_forward());
    for mode in Mode::ALL {
        let other = mode != state.settings.mode || state.tiles.shown;
        list.add(format!("Picture: {}", mode.label()), Command::Mode(mode)).if_possible(state.offers(mode) && other);
    }
    list.add(format!("Picture: {}", toolbar::TILES), Command::ShowTiles(true)).if_possible(open && !state.tiles.shown);
    let (heat, rays_chosen) = (heat::is_shown(state), heat::has_rays(state));
    for rays in HeatRays::ALL {
        let other = rays_chosen && rays != state.settings.heat_rays;
        list.add(format!("Heat map: {}", rays.label()), Command::HeatRays(rays)).if_possible(other);
    }
    list.add("Heat map: fit the range", Command::HeatRange(None)).if_possible(heat && state.range.is_some());
    light(list, state);
    for sampler in SamplerKind::ALL {
        let path = state.follows_light() && sampler != state.settings.sampler;
        list.add(format!("Sampler: {}", sampler.label()), Command::Sampler(sampler)).if_possible(path);
    }
    for samples in [1, 16, 64, 256, 1024, 4096] {
        list.add(format!("Samples a pixel: {samples}"), Command::MaxSamples(samples));
    }
    section(list, state);
    triangles(list, state);
}

/// How light becomes colour.
fn light(list: &mut List, state: &State) {
    let (now, path) = (state.settings.tone, state.follows_light());
    for curve in Curve::ALL {
        let tone = Tone { curve, ..now };
        list.add(format!("Tone: {}", curve.label()), Command::Tone(tone)).if_possible(path && tone != now);
    }
    for (name, by) in [("Exposure: a stop more", 1.0), ("Exposure: a stop less", -1.0)] {
        let tone = Tone { exposure: (now.exposure + by).clamp(*STOPS.start(), *STOPS.end()), ..now };
        list.add(name, Command::Tone(tone)).if_possible(path && tone != now);
    }
}

fn section(list: &mut List, state: &State) {
    let (open, now) = (state.model.is_some(), state.settings.section);
    let name = if now.on { "Show the whole model, not a section" } else { "Cut the model open" };
    list.add(name, Command::Section(SectionSettings { on: !now.on, ..now })).if_possible(open);
    for axis in Axis::ALL {
        let at = SectionSettings { on: true, at: Section { axis, ..now.at } };
        list.add(format!("Section across {}", axis.name()), Command::Section(at)).if_possible(open && at != now);
    }
    let flipped = SectionSettings { at: Section { side: now.at.side.other(), ..now.at }, ..now };
    list.add("Flip the section", Command::Section(flipped)).if_possible(open && now.on);
    for (name, by) in [("Section farther along its axis", SECTION_STEP), ("Section nearer along its axis", -SECTION_STEP)] {
        let moved = SectionSettings { at: Section { place: (now.at.place + by).clamp(0.0, 1.0), ..now.at }, ..now };
        list.add(name, Command::Section(moved)).if_possible(open && now.on && moved != now);
    }
}

fn triangles(list: &mut List, state: &State) {
    let selected = state.picked.as_ref().is_some_and(|picked| picked.selected().is_some()) && !state.is_measuring();
    let isolate = Command::Hide(Change::Isolate);
    list.add("Isolate the triangles of the selected cell", isolate).key(ISOLATE).if_possible(selected);
    list.add("Hide the triangles of the selected cell", Command::Hide(Change::Hide)).key(HIDE).if_possible(selected);
    list.add("Show all triangles", Command::ShowAll).key(SHOW_ALL).if_possible(state.visible().is_some());
}
