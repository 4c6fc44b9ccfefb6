//! The row above the viewport: structure, what is shown, depth.

use eframe::egui::{Button, ComboBox, DragValue, RichText, Slider, Ui};

use super::{Commands, heat};
use crate::accel::cell::Layout;
use crate::accel::registry::{self, Entry};
use crate::geometry::Axis;
use crate::render::sampler::SamplerKind;
use crate::render::{Curve, HeatRays, Mode};
use crate::viewer::command::Command;
use crate::viewer::panes::{Arrange, LETTERS, PaneChoice};
use crate::viewer::state::State;
use crate::viewer::theme::{self, Palette};

/// Draws the row.
pub fn show(ui: &mut Ui, state: &State, commands: &mut Commands) {
    ui.spacing_mut().slider_width = theme::SHORT_SLIDER;
    let look = |ui: &mut Ui, commands: &mut Commands| {
        mode(ui, state, commands);
        if heat::has_rays(state) {
            heat_rays(ui, state, commands);
        }
        if state.settings.mode == Mode::Path && !state.tiles.shown {
            light(ui, state, commands);
        }
        depth(ui, state, commands);
    };
    if ui.available_width() >= theme::ONE_ROW {
        ui.horizontal(|ui| {
            structure(ui, state, commands);
            look(ui, commands);
        });
    } else {
        ui.horizontal(|ui| structure(ui, state, commands));
        ui.add_space(theme::GRID);
        ui.horizontal(|ui| look(ui, commands));
    }
    if state.offers_panes() {
        ui.add_space(theme::GRID);
        ui.horizontal(|ui| {
            compared(ui, state, commands);
            // Where the first picture is path traced they stand beside what it shows.
            if state.settings.mode != Mode::Path && state.follows_light() {
                light(ui, state, commands);
            }
        });
    }
}

fn structure(ui: &mut Ui, state: &State, commands: &mut Commands) {
    let chosen = state.settings.entry();
    for entry in registry::ALL {
        let tab = ui.add_enabled(!state.is_measuring(), Button::selectable(entry.id == chosen.id, entry.short));
        let tab = tab.accessible_name(entry.name);
        if tab.on_hover_text(format!("{}. {}", entry.name, entry.help)).clicked() {
            commands.push(Command::Structure(entry.id));
        }
    }
}

fn mode(ui: &mut Ui, state: &State, commands: &mut Commands) {
    let (chosen, tiles) = (state.settings.mode, state.tiles.shown);
    let (text, help) = if tiles { (TILES, TILES_HELP) } else { (chosen.label(), chosen.help()) };
    let combo = ComboBox::from_id_salt("mode").height(theme::LONG_MENU).selected_text(text).show_ui(ui, |ui| {
        for mode in Mode::ALL.into_iter().filter(|mode| state.offers(*mode)) {
            let this = mode == chosen && !tiles;
            if ui.selectable_label(this, mode.label()).on_hover_text(mode.help()).clicked() {
                commands.push(Command::Mode(mode));
            }
        }
        if ui.selectable_label(tiles, TILES).on_hover_text(TILES_HELP).clicked() {
            commands.push(Command::ShowTiles(true));
        }
        if let Some(why) = state.why_no_stack() {
            ui.label(RichText::new(why).small().color(Palette::in_ui(ui).dim));
        }
    });
    combo.response.accessible_name("Picture").on_hover_text(help);
}

/// What is timed in place of a picture.
pub const TILES: &str = "Nanoseconds by tile";
const TILES_HELP: &str = "How long the rays of each tile of 8 by 8 pixels take, measured on one thread once it is asked for.";

/// Whose work a heat map shows.
fn heat_rays(ui: &mut Ui, state: &State, commands: &mut Commands) {
    let chosen = state.settings.heat_rays;
    let combo = ComboBox::from_id_salt("heat rays").selected_text(chosen.label()).show_ui(ui, |ui| {
        for rays in HeatRays::ALL {
            if ui.selectable_label(rays == chosen, rays.label()).on_hover_text(rays.help()).clicked() {
                commands.push(Command::HeatRays(rays));
            }
        }
    });
    combo.response.accessible_name("Rays of the heat map").on_hover_text(chosen.help());
}

/// Exposures, in stops.
pub const STOPS: std::ops::RangeInclusive<f32> = -16.0..=16.0;

/// How light becomes colour, and the numbers that paths are made of.
fn light(ui: &mut Ui, state: &State, commands: &mut Commands) {
    let mut tone = state.settings.tone;
    let stops = DragValue::new(&mut tone.exposure).range(STOPS).speed(0.05).fixed_decimals(1).suffix(" EV");
    ui.add(stops).on_hover_text("Exposure in stops: each doubles the light. Drag, or click to type.");
    let fitting = state.fitting_exposure();
    let auto = ui.add_enabled(fitting.is_some(), Button::new("Auto"));
    if auto.on_hover_text("Expose what is seen to a middle grey.").clicked() {
        tone.exposure = fitting.map_or(tone.exposure, |stops| (stops * 10.0).round() / 10.0).clamp(*STOPS.start(), *STOPS.end());
    }
    let combo = ComboBox::from_id_salt("tone").width(16.0 * theme::GRID).selected_text(tone.curve.label());
    let combo = combo.show_ui(ui, |ui| {
        for curve in Curve::ALL {
            ui.selectable_value(&mut tone.curve, curve, curve.label());
        }
    });
    combo
        .response
        .accessible_name("Tone")
        .on_hover_text("What becomes of light that is too bright: white, or bent as film does.");
    if tone != state.settings.tone {
        commands.push(Command::Tone(tone));
    }
    let chosen = state.settings.sampler;
    let combo = ComboBox::from_id_salt("sampler").selected_text(chosen.label()).show_ui(ui, |ui| {
        for kind in SamplerKind::ALL {
            if ui.selectable_label(kind == chosen, kind.label()).clicked() {
                commands.push(Command::Sampler(kind));
            }
        }
    });
    combo.response.accessible_name("Sampler").on_hover_text("The numbers that samples are made of. All structures get the same.");
}

/// What the picture is compared with, and how.
fn compared(ui: &mut Ui, state: &State, commands: &mut Commands) {
    second(ui, state, commands);
    if !state.is_comparing() {
        return;
    }
    let panes = &state.settings.panes;
    let combo = ComboBox::from_id_salt("arrange").width(20.0 * theme::GRID).selected_text(panes.arrange.label());
    let combo = combo.show_ui(ui, |ui| {
        for arrange in Arrange::ALL {
            if ui.selectable_label(arrange == panes.arrange, arrange.label()).on_hover_text(arrange.help()).clicked() {
                commands.push(Command::Arrange(arrange));
            }
        }
    });
    combo.response.accessible_name("Arrangement").on_hover_text(panes.arrange.help());
    let next = panes.others.len();
    if next + 1 < panes.arrange.most() {
        let letter = LETTERS[next + 1];
        let combo = ComboBox::from_id_salt("add").width(16.0 * theme::GRID).height(theme::LONG_MENU);
        let combo = combo.selected_text(format!("Add {letter}")).show_ui(ui, |ui| {
            for entry in registry::ALL {
                if ui.selectable_label(false, format!("{letter}: {}", entry.name)).on_hover_text(entry.help).clicked() {
                    commands.push(Command::PutPane(next, PaneChoice::of(entry, &state.settings)));
                }
            }
        });
        combo.response.accessible_name("One more structure").on_hover_text("Compare with one more structure.");
    }
    if state.shares_ranges() {
        let help = "Find the range that the colours of these pictures share anew, from what they show now.";
        if ui.button("Auto-fit").on_hover_text(help).clicked() {
            commands.push(Command::FitRange);
        }
    }
    if panes.arrange == Arrange::Divider {
        for (which, at) in panes.places().into_iter().enumerate() {
            let mut percent = 100.0 * at;
            let field = DragValue::new(&mut percent).range(0.0..=100.0).fixed_decimals(0).suffix(" %");
            let field = ui.add(field).accessible_name(format!("Place of divider {}", which + 1));
            if field.on_hover_text("Where the next strip begins.").changed() {
                commands.push(Command::Divider(which, percent / 100.0));
            }
        }
    }
}

/// The structure beside the shown one.
fn second(ui: &mut Ui, state: &State, commands: &mut Commands) {
    let chosen = state.settings.panes.others.first().map(PaneChoice::entry);
    let combo = ComboBox::from_id_salt("beside").width(26.0 * theme::GRID).height(theme::LONG_MENU);
    let name = |entry: &Entry| format!("and {}", entry.name);
    let combo = combo.selected_text(chosen.map_or("No second".to_owned(), name)).show_ui(ui, |ui| {
        if ui.selectable_label(chosen.is_none(), "No second").clicked() {
            commands.push(Command::PutBeside(None));
        }
        for entry in registry::ALL {
            if ui.selectable_label(chosen.is_some_and(|chosen| chosen.id == entry.id), name(entry)).clicked() {
                commands.push(Command::PutBeside(Some(entry.id)));
            }
        }
    });
    let help = "Compare with this structure on the same view.";
    combo.response.accessible_name("Second structure").on_hover_text(help);
}

/// A grid has no depth: its cells are looked at in layers.
fn slice(ui: &mut Ui, state: &State, resolution: [u32; 3], commands: &mut Commands) {
    let before = state.settings.overlay;
    let mut overlay = before;
    let axis = overlay.slice_axis.min(2);
    let slider = Slider::new(&mut overlay.slice, 0..=resolution[axis]).text("Slice");
    ui.add(slider).on_hover_text("One layer of cells; 0 shows all of them.");
    let list = ComboBox::from_id_salt("axis").width(theme::ROW).selected_text(Axis::ALL[axis].name());
    let list = list.show_ui(ui, |ui| {
        for (i, axis) in Axis::ALL.into_iter().enumerate() {
            if ui.selectable_label(overlay.slice_axis == i, axis.name()).clicked() {
                (overlay.slice_axis, overlay.slice) = (i, overlay.slice.min(resolution[i]));
            }
        }
    });
    list.response.accessible_name("Axis").on_hover_text("The axis that layers are counted along.");
    let occupancy = DragValue::new(&mut overlay.occupancy).speed(0.1).prefix("Occupancy ");
    let help = "Draw only cells that hold at least so many triangles. Drag, or click to type.";
    ui.add(occupancy).accessible_name("Occupancy").on_hover_text(help);
    if overlay != before {
        commands.push(Command::Overlay(overlay));
    }
}

/// The structure whose nodes have eight children.
const WIDE: &str = "wide";
/// What the slider is called, and its help.
const DEPTH: (&str, &str) = ("Depth", "The level of the tree that is drawn: 0 is the root.");
const WIDE_DEPTH: (&str, &str) = (
    "Depth, 8-wide",
    "The level of the tree that is drawn: 0 is the root. A node has up to eight children, so that a level is about three of a binary tree.",
);

fn depth(ui: &mut Ui, state: &State, commands: &mut Commands) {
    match state.layout() {
        Some(Layout::Hierarchy | Layout::SplitHierarchy | Layout::Partition | Layout::Nested { .. }) => {}
        Some(Layout::Flat { resolution, .. }) => return slice(ui, state, resolution, commands),
        None => return,
    }
    let mut overlay = state.settings.overlay;
    let deepest = deepest(state);
    let single = overlay.from_depth == overlay.depth;
    let wide = state.shown.as_ref().is_some_and(|shown| shown.key.entry.id == WIDE);
    let (name, help) = if wide { WIDE_DEPTH } else { DEPTH };
    let slider = Slider::new(&mut overlay.depth, 0..=deepest).text(name);
    let slider = ui.add_enabled(!overlay.leaves_only && state.film_on_screen().is_none(), slider).on_hover_text(help);
    if slider.changed() {
        overlay.from_depth = if single { overlay.depth } else { overlay.from_depth.min(overlay.depth) };
        commands.push(Command::Overlay(overlay));
    }
}

/// The deepest level of the shown structure; a guess until its figures are there.
pub fn deepest(state: &State) -> u32 {
    const UNTIL_KNOWN: u32 = 20;
    state.shown.as_ref().and_then(|b| b.stats.as_ref()).map_or(UNTIL_KNOWN, |stats| stats.max_depth)
}
