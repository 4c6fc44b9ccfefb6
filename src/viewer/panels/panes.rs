//! Compared pictures: what stands above and beneath each, and what their colours stand for.

use eframe::egui::{Align, Align2, Button, ComboBox, Label, Layout, Rect, RichText, ScrollArea, Ui, UiBuilder, Window, vec2};

use super::captions::{self, Heat};
use super::split::Place;
use super::{Commands, empty, structure};
use crate::accel::registry;
use crate::render::colormap::{difference, viridis};
use crate::render::{HeatRays, Mode, Picture};
use crate::viewer::command::Command;
use crate::viewer::kept::Key;
use crate::viewer::panes::{Arrange, LETTERS, PaneChoice, Shows};
use crate::viewer::state::State;
use crate::viewer::theme;
use crate::viewer::{format, marks};

/// Strips narrower than this have no name.
const NAMED: f32 = 24.0 * theme::GRID;
/// The least width of a list above a picture.
const LIST: f32 = 16.0 * theme::GRID;

/// Draws what stands around pictures and over them; nothing where there is only one.
pub fn show(ui: &mut Ui, places: &[Place], state: &State, commands: &mut Commands) {
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

/// What pictures are of, A first: the structure, and what tells it from the same structure in another place.
pub fn names(state: &State) -> Vec<String> {
    let first = state.shown.as_ref().map_or_else(|| state.wanted_key(), |shown| shown.key.clone());
    let others = state.settings.panes.on_screen().iter().map(PaneChoice::key);
    let keys: Vec<Key> = std::iter::once(first).chain(others).collect();
    keys.iter().map(|key| name(key, &keys)).collect()
}

fn name(key: &Key, all: &[Key]) -> String {
    let mut name = key.entry.name.to_owned();
    if all.iter().any(|other| other.entry.id == key.entry.id && other != key) {
        for (param, value) in key.params.changed() {
            name.push_str(&format!(" {}={value}", param.id));
        }
        if all.iter().any(|other| other.entry.id == key.entry.id && other.test != key.test) {
            name.push_str(&format!(" {}", key.test.id()));
        }
    }
    name
}

/// The figures beneath a picture.
fn facts(state: &State, which: usize, names: &[String]) -> String {
    let name = &names[which];
    let (built, picture) = match which.checked_sub(1) {
        None => (state.shown.as_ref(), state.picture.as_deref()),
        Some(other) => {
            let Some(pane) = state.panes.all.get(other) else { return format!("{name}: waits") };
            if let Some(building) = &pane.building {
                let share = building.job.progress.snapshot().fraction.map(|share| format!(" {}", format::percent(share.into())));
                return format!("{name}: building{}", share.unwrap_or_default());
            }
            (pane.built.as_ref(), pane.picture.as_deref())
        }
    };
    let Some(built) = built else { return format!("{name}: waits to be built") };
    let mut parts: Vec<String> = picture.map(work).into_iter().flatten().collect();
    parts.push(format!("built in {}", format::duration(built.build_secs)));
    parts.push(format::bytes(built.bytes()));
    format!("{name}: {}", parts.join(", "))
}

/// What rays did in a structure, and how many there were.
fn work(picture: &Picture) -> Vec<String> {
    let progress = &picture.progress;
    let over = |n: u64| format::number(n as f64 / progress.counted as f64);
    let counted = (progress.counted > 0).then(|| {
        let counts = &progress.counts;
        format!("{} nodes, {} tests a ray", over(counts.nodes), over(counts.prims))
    });
    let samples = if progress.step > 1 { format!("1/{} resolution", progress.step) } else { format!("{} spp", progress.samples) };
    counted.into_iter().chain([samples]).collect()
}

/// The names of strips, on them.
fn plates(ui: &Ui, places: &[Place], state: &State) {
    let first = state.shown.as_ref().map_or_else(|| state.settings.entry(), |shown| shown.key.entry);
    let others = state.settings.panes.on_screen().iter().map(PaneChoice::entry);
    for ((entry, place), letter) in std::iter::once(first).chain(others).zip(places).zip(LETTERS) {
        if place.seen.width() >= NAMED {
            let inner = place.seen.shrink(theme::GUTTER);
            captions::plate(ui, inner.left_top(), Align2::LEFT_TOP, format!("{letter}: {}", entry.short));
        }
    }
}

/// What the colours of pictures stand for, each kind once, with the last picture that shows it.
fn heats(state: &State) -> Vec<(usize, Heat)> {
    let (first, mut all) = (state.settings.mode, Vec::<(usize, Mode, Heat)>::new());
    let each = each(state);
    let mut differences = Vec::new();
    let mut add = |which: usize, mode: Mode, picture: &Picture| {
        all.retain(|(_, known, _)| *known != mode);
        all.push((which, mode, Heat::new(format!("{} {each}", mode.label()), picture.range, viridis)));
    };
    if let Some(picture) = state.picture.as_ref().filter(|_| first.is_heat()) {
        add(0, first, picture);
    }
    for (i, (pane, choice)) in state.panes.all.iter().zip(state.settings.panes.on_screen()).enumerate() {
        let (mode, differs) = (choice.mode(first), choice.differs(first));
        match pane.on_screen(differs) {
            Some(picture) if differs => differences.push((i + 1, less(state, i, picture))),
            Some(picture) if mode.is_heat() => add(i + 1, mode, picture),
            Some(_) | None => {}
        }
    }
    all.into_iter().map(|(which, _, heat)| (which, heat)).chain(differences).collect()
}

/// Of what amounts are told: only where A is a heat map itself its rays may be others than the camera's.
fn each(state: &State) -> &'static str {
    if state.settings.mode.is_heat() { state.settings.heat_rays.each() } else { HeatRays::default().each() }
}

/// What the colours of a difference stand for.
fn less(state: &State, which: usize, picture: &Picture) -> Heat {
    let first = state.shown.as_ref().map_or_else(|| state.settings.entry(), |shown| shown.key.entry);
    let (a, b) = (first.short, state.settings.panes.others[which].entry().short);
    let letter = LETTERS[which + 1];
    let [a, b] = if a == b { [LETTERS[0], letter] } else { [a, b] };
    let size = format::number(picture.range.max.into());
    let name = format!("{} {}, A less {letter}", state.settings.mode.label(), each(state));
    let colors = |t: f32| difference(2.0 * t - 1.0);
    Heat { ends: [format!("{size} more in {b}"), format!("{size} more in {a}")], ..Heat::new(name, picture.range, colors) }
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

/// What is compared, for those who cannot see it.
pub fn describe(state: &State) -> Vec<String> {
    if !state.is_comparing() {
        return Vec::new();
    }
    let names = names(state);
    let arranged = format!("Compared in: {}", state.settings.panes.arrange.label());
    let pictures = (0..names.len()).map(|which| format!("{}, {}", LETTERS[which], facts(state, which, &names)));
    let others =
        heats(state).into_iter().filter(|(which, heat)| *which > 0 && captions::heat(state).is_none_or(|a| a.name != heat.name));
    let colors = others.map(|(which, heat)| {
        let [low, high] = heat.ends;
        format!("Colours of {} show {}, from {low} to {high}", LETTERS[which], heat.name)
    });
    std::iter::once(arranged).chain(pictures).chain(colors).collect()
}
