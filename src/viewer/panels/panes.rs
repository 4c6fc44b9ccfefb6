//! Compared pictures: what stands above and beneath each, and what their colours stand for.

use eframe::egui::{Align, Align2, Button, ComboBox, Label, Layout, Rect, RichText, ScrollArea, Ui, UiBuilder, Window, vec2};

use super::split::Place;
use super::{Commands, captions, empty, structure};
use crate::accel::registry;
use crate::render::Mode;
use crate::viewer::command::Command;
use crate::viewer::compared::{Told, entries, facts, heats, names, told_at, told_of_click};
use crate::viewer::legends;
use crate::viewer::marks;
use crate::viewer::panes::{Arrange, LETTERS, PaneChoice, Shows};
use crate::viewer::state::State;
use crate::viewer::theme;
use glam::Vec2;

/// Strips narrower than this have no name.
const NAMED: f32 = 24.0 * theme::GRID;
/// The least width of a list above a picture.
const LIST: f32 = 16.0 * theme::GRID;

/// Draws what stands around pictures and over them; nothing where there is only one. `pointer` is the view that it is over, and
/// where in it, as [`told_at`] takes it.
pub fn show(ui: &mut Ui, places: &[Place], pointer: Option<(Rect, Vec2)>, state: &State, commands: &mut Commands) {
    if !state.is_comparing() {
        return;
    }
    let names = names(state);
    for (which, place) in places.iter().enumerate() {
        for part in [place.head, place.foot] {
            ui.painter().rect_filled(part, 0.0, ui.visuals().panel_fill);
        }
        within(ui, place.head, ("head", which), |ui| match (names.get(which), which.checked_sub(1)) {
            (None, _) => {}
            (Some(name), None) => first(ui, name, state),
            (Some(_), Some(other)) => head(ui, other, state, commands),
        });
        let sentence = if which < names.len() { facts(state, which, &names) } else { String::new() };
        within(ui, place.foot, ("foot", which), |ui| drop(ui.add(Label::new(RichText::new(sentence).small()).wrap())));
        if which >= names.len() {
            let inner = place.view.shrink(theme::GUTTER);
            within(ui, inner, ("view", which), |ui| empty(ui, "No structure here yet. Add one in the bar above."));
        }
    }
    if state.settings.panes.arrange == Arrange::Divider {
        plates(ui, places, state);
    }
    legends(ui, places, state);
    amounts(ui, places, pointer, state);
    tune(ui, places, state, commands);
}

/// Adds something in a part of the view.
fn within(ui: &mut Ui, rect: Rect, salt: (&str, usize), add: impl FnOnce(&mut Ui)) {
    let inner = rect.shrink2(vec2(theme::GRID, 0.5 * theme::GRID));
    if !inner.is_positive() {
        return;
    }
    let mut child = ui.new_child(UiBuilder::new().id_salt(salt).max_rect(inner).layout(Layout::top_down(Align::Min)));
    child.shrink_clip_rect(rect);
    add(&mut child);
}

/// Above A: what it is of is chosen in the bar above.
fn first(ui: &mut Ui, name: &str, state: &State) {
    ui.horizontal(|ui| {
        ui.label(RichText::new(LETTERS[0]).strong());
        marks::dot(ui, state.settings.entry().family);
        let help = "The shown structure: it is chosen in the bar above, and its parameters at the left.";
        ui.add(Label::new(name).truncate()).on_hover_text(help);
    });
}

/// Above another: its structure, what is shown of it, its parameters, and the way out.
fn head(ui: &mut Ui, which: usize, state: &State, commands: &mut Commands) {
    let Some(choice) = state.settings.panes.on_screen().get(which) else { return };
    let letter = LETTERS[which + 1];
    ScrollArea::horizontal().id_salt(("controls", which)).show(ui, |ui| {
        ui.horizontal(|ui| {
            ui.spacing_mut().item_spacing.x = theme::GRID;
            marks::dot(ui, choice.entry().family);
            ui.add_enabled_ui(!state.is_measuring(), |ui| {
                chosen_structure(ui, (which, letter), choice, state, commands);
                chosen_picture(ui, (which, letter), choice, state, commands);
            });
            let open = state.panes.tuned == Some(which);
            let button = ui.add(Button::selectable(open, "…")).accessible_name(format!("Parameters of {letter}"));
            if button.on_hover_text("Its own parameters and triangle test.").clicked() {
                commands.push(Command::TunePane((!open).then_some(which)));
            }
            let close = ui.button("×").accessible_name(format!("Close {letter}"));
            if close.on_hover_text("Take this picture away.").clicked() {
                commands.push(Command::ClosePane(which));
            }
        });
    });
}

fn chosen_structure(ui: &mut Ui, (which, letter): (usize, &str), choice: &PaneChoice, state: &State, commands: &mut Commands) {
    let now = choice.entry();
    let combo = ComboBox::from_id_salt(("structure", which)).width(LIST).height(theme::LONG_MENU);
    let combo = combo.selected_text(format!("{letter}: {}", now.short)).show_ui(ui, |ui| {
        for entry in registry::ALL {
            let option = ui.selectable_label(entry.id == now.id, format!("{letter}: {}", entry.name));
            if option.on_hover_text(entry.help).clicked() && entry.id != now.id {
                let other = PaneChoice { shows: choice.shows, ..PaneChoice::of(entry, &state.settings) };
                commands.push(Command::PutPane(which, other));
            }
        }
    });
    combo.response.accessible_name(format!("Structure of {letter}")).on_hover_text(now.help);
}

fn chosen_picture(ui: &mut Ui, (which, letter): (usize, &str), choice: &PaneChoice, state: &State, commands: &mut Commands) {
    let less = format!("{} less {letter}", LETTERS[0]);
    let text = |shows: Shows| match shows {
        Shows::Same => "As A".to_owned(),
        Shows::Mode(mode) => mode.label().to_owned(),
        Shows::Difference => less.clone(),
    };
    let combo = ComboBox::from_id_salt(("picture", which)).width(LIST).height(theme::LONG_MENU);
    // Without amounts there is no difference of them.
    let plain = choice.shows == Shows::Difference && !state.settings.mode.is_heat();
    let combo = combo.selected_text(text(if plain { Shows::Same } else { choice.shows })).show_ui(ui, |ui| {
        let offered = |mode: &Mode| *mode != Mode::Stack || has_stack(state, choice);
        let modes = Mode::ALL.into_iter().filter(offered).map(Shows::Mode);
        let differs = state.settings.mode.is_heat().then_some(Shows::Difference);
        for shows in std::iter::once(Shows::Same).chain(differs).chain(modes) {
            let help = match shows {
                Shows::Same => "Whatever the first picture shows.",
                Shows::Mode(mode) => mode.help(),
                Shows::Difference => "What each ray does more in the first structure, orange, and more in this one, blue.",
            };
            if ui.selectable_label(shows == choice.shows, text(shows)).on_hover_text(help).clicked() {
                commands.push(Command::PutPane(which, PaneChoice { shows, ..choice.clone() }));
            }
        }
    });
    combo.response.accessible_name(format!("Picture of {letter}")).on_hover_text("What is shown of its hits.");
}

/// Whether rays keep a stack in what a pane shows: in two levels they do whatever the structure is.
fn has_stack(state: &State, choice: &PaneChoice) -> bool {
    let levels = state.shown.as_ref().is_some_and(|shown| shown.accel.levels().is_some());
    levels || choice.entry().family.has_stack()
}

/// The parameters of a pane, if they are open.
fn tune(ui: &Ui, places: &[Place], state: &State, commands: &mut Commands) {
    let Some(which) = state.panes.tuned else { return };
    let (Some(choice), Some(place)) = (state.settings.panes.on_screen().get(which), places.get(which + 1)) else { return };
    let (letter, key) = (LETTERS[which + 1], choice.key());
    let mut open = true;
    let window = Window::new(format!("{letter}: {}", key.entry.name)).open(&mut open).collapsible(false).resizable(false);
    let window = window.id(ui.scope_id().with("parameters of a pane"));
    window.default_pos(place.head.left_bottom()).default_width(theme::LEFT_PANEL).show(ui.ctx(), |ui| {
        ui.add_enabled_ui(!state.is_measuring(), |ui| {
            if let Some(test) = structure::test(ui, key.test) {
                commands.push(Command::PutPane(which, PaneChoice { test, ..choice.clone() }));
            }
            if key.entry.params.is_empty() {
                return empty(ui, "This structure has no parameters.");
            }
            if let Some(values) = structure::parameters(ui, key.entry, &key.params, &format!("Defaults of {letter}")) {
                commands.push(Command::PutPane(which, choice.with_params(&values)));
            }
        });
    });
    if !open {
        commands.push(Command::TunePane(None));
    }
}

/// The names of strips, on them.
fn plates(ui: &Ui, places: &[Place], state: &State) {
    for ((entry, place), letter) in entries(state).zip(places).zip(LETTERS) {
        if place.seen.width() >= NAMED {
            let inner = place.seen.shrink(theme::GUTTER);
            captions::plate(ui, inner.left_top(), Align2::LEFT_TOP, format!("{letter}: {}", entry.short));
        }
    }
}

fn legends(ui: &Ui, places: &[Place], state: &State) {
    let strips = state.settings.panes.arrange == Arrange::Divider;
    for (i, (which, heat)) in heats(state).into_iter().enumerate() {
        let Some(place) = places.get(which) else { continue };
        // Strips share the corner of the view. In a narrow A other captions stand beside.
        let narrow = which == 0 && place.view.width() < 3.0 * captions::LEGEND.x;
        let up = match strips {
            true => i as f32 * (captions::LEGEND.y + theme::GRID),
            false if narrow => captions::ROWS * (theme::ROW + theme::GRID),
            false => 0.0,
        };
        let inner = place.view.shrink(theme::GUTTER).translate(vec2(0.0, -up));
        if inner.bottom() - captions::LEGEND.y > place.view.top() {
            captions::legend(ui, inner, &heat, None);
        }
    }
}

/// What pictures show under the pointer, or where one was clicked.
fn amounts(ui: &Ui, places: &[Place], pointer: Option<(Rect, Vec2)>, state: &State) {
    let Some(first) = places.first() else { return };
    let (view, what, told) = match pointer {
        Some((view, at)) => (view, "Here", told_at(state, at)),
        None => (first.view, "Clicked", told_of_click(state)),
    };
    if told.is_empty() || (pointer.is_none() && told.iter().all(|told| told.amount.is_none())) {
        return;
    }
    let lines = told.iter().map(|told| format!("{}: {}", told.of, told.written()));
    let text: Vec<String> = std::iter::once(what.to_owned()).chain(lines).collect();
    // Beneath the names of strips.
    let down = if state.settings.panes.arrange == Arrange::Divider { theme::ROW + theme::GRID } else { 0.0 };
    let corner = view.shrink(theme::GUTTER).right_top() + vec2(0.0, down);
    captions::plate(ui, corner, Align2::RIGHT_TOP, text.join("\n"));
}

/// What is compared, for those who cannot see it.
pub fn describe(state: &State) -> Vec<String> {
    if !state.is_comparing() {
        return Vec::new();
    }
    let names = names(state);
    let arranged = format!("Compared in: {}", state.settings.panes.arrange.label());
    let pictures = (0..names.len()).map(|which| format!("{}, {}", LETTERS[which], facts(state, which, &names)));
    let others =
        heats(state).into_iter().filter(|(which, heat)| *which > 0 && legends::heat(state).is_none_or(|a| a.name != heat.name));
    let colors = others.map(|(which, heat)| {
        let [low, high] = heat.ends;
        format!("Colours of {} show {}, from {low} to {high}", LETTERS[which], heat.name)
    });
    let clicked = told_of_click(state).into_iter().filter(|told| told.amount.is_some());
    let clicked = clicked.map(|told: Told| format!("{}: {} at the clicked pixel", told.of, told.written()));
    std::iter::once(arranged).chain(pictures).chain(colors).chain(clicked).collect()
}
