//! Everything that can be done in the window, by name: what the palette searches, the keys do, and the page of keys lists.

use std::borrow::Cow;

use eframe::egui::{Context, Key, KeyboardShortcut, Modifiers};

use super::command::Command;
use super::exports::{Export, Form};
use super::panels::fitting::volume_name;
use super::panels::overlay::has_levels;
use super::panels::{self, toolbar};
use super::panes::{Arrange, LETTERS, MOST, PaneChoice, Shows};
use super::settings::{BoxColor, Levels, Navigation, OverlaySettings, SCALE, SectionSettings, ThemeChoice, Workspace};
use super::sheets::What;
use super::state::State;
use super::timings::Column;
use super::tradeoffs::Plot;
use crate::accel::outline::Rank;
use crate::accel::registry;
use crate::accel::visibility::Change;
use crate::geometry::Axis;
use crate::lab::Fairness;
use crate::render::sampler::SamplerKind;
use crate::render::{HeatRays, Mode};
use crate::scene::{Section, builtin};

/// One thing that can be done.
#[derive(Clone, Debug)]
pub struct Action {
    /// What it belongs to.
    pub group: &'static str,
    /// What it does.
    pub name: Cow<'static, str>,
    /// Keys that do it.
    pub keys: Vec<KeyboardShortcut>,
    /// What is sent for it.
    pub command: Command,
    /// Whether there is anything to do now.
    pub possible: bool,
}

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
const LARGER_UNSHIFTED: KeyboardShortcut = with(Modifiers::COMMAND, Key::Equals);
/// Smaller.
pub const SMALLER: KeyboardShortcut = with(Modifiers::COMMAND, Key::Minus);
/// The system's size.
pub const SAME_SIZE: KeyboardShortcut = with(Modifiers::COMMAND, Key::Num0);
/// Brings the focus to the next panel.
const NEXT_PANEL: KeyboardShortcut = with(Modifiers::NONE, Key::F6);
/// And to the one before.
const PANEL_BEFORE: KeyboardShortcut = with(Modifiers::SHIFT, Key::F6);
/// Opens the palette.
pub const PALETTE: KeyboardShortcut = with(Modifiers::COMMAND, Key::P);
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
const HELP: [KeyboardShortcut; 2] = [with(Modifiers::NONE, Key::Questionmark), with(Modifiers::SHIFT, Key::Questionmark)];
/// A level deeper and higher.
const DEEPER: [KeyboardShortcut; 2] = [with(Modifiers::NONE, Key::CloseBracket), with(Modifiers::NONE, Key::OpenBracket)];
/// Boxes on and off.
const BOXES: KeyboardShortcut = with(Modifiers::NONE, Key::B);

/// One step of moving the section.
const SECTION_STEP: f32 = 0.05;
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

/// Collects actions.
struct List {
    group: &'static str,
    all: Vec<Action>,
}

impl List {
    fn add(&mut self, name: impl Into<Cow<'static, str>>, command: Command) -> &mut Action {
        let action = Action { group: self.group, name: name.into(), keys: Vec::new(), command, possible: true };
        self.all.push(action);
        let last = self.all.len() - 1;
        &mut self.all[last]
    }
}

impl Action {
    fn key(&mut self, key: KeyboardShortcut) -> &mut Self {
        self.keys.push(key);
        self
    }

    fn if_possible(&mut self, possible: bool) -> &mut Self {
        self.possible = possible;
        self
    }
}

/// All of them, as things are.
pub fn all(state: &State) -> Vec<Action> {
    let mut list = List { group: "File", all: Vec::new() };
    file(&mut list, state);
    list.group = "Edit";
    list.add("Undo", Command::Undo).key(UNDO).if_possible(state.choices.has_back());
    list.add("Redo", Command::Redo).key(REDO).if_possible(state.choices.has_forward());
    list.group = "View";
    view(&mut list, state);
    section(&mut list, state);
    triangles(&mut list, state);
    list.group = "Boxes";
    boxes(&mut list, state);
    list.group = "Structure";
    structure(&mut list, state);
    list.group = "Film";
    film(&mut list, state);
    list.group = "Ray";
    ray(&mut list, state);
    list.group = "Measure";
    measure(&mut list, state);
    list.group = "Window";
    window(&mut list, state);
    list.all
}

fn file(list: &mut List, state: &State) {
    list.add("Open…", Command::OpenDialog).key(OPEN);
    list.add("Open a path…", Command::AskForPath(true)).key(OPEN_PATH);
    for model in &state.settings.recent {
        list.add(format!("Open {model}"), Command::Open(model.clone()));
    }
    for scene in builtin::all().iter() {
        let model = format!("{}{}", builtin::SCHEME, scene.id);
        if !state.settings.recent.contains(&model) {
            list.add(format!("Open {model}"), Command::Open(model));
        }
    }
    list.add("Save workspace…", Command::SaveWorkspace).key(SAVE).if_possible(state.model.is_some());
    exports(list, state);
    list.add("Quit", Command::Quit).key(QUIT);
}

/// What can be taken away.
fn exports(list: &mut List, state: &State) {
    let free = state.shown.is_some() && !state.is_measuring() && !state.is_checking();
    for (name, quick) in [("Export report…", true), ("Export thorough report…", false)] {
        list.add(name, Command::Export(Export::Report { quick })).if_possible(free);
    }
    let seen = state.picture.is_some();
    list.add("Save figure…", Command::Export(Export::Figure)).if_possible(seen);
    list.add("Save picture…", Command::Export(Export::Picture)).if_possible(seen);
    for what in What::ALL {
        let (name, there) = (what.name(), what.is_there(state));
        list.add(format!("Save table: {name}…"), Command::Export(Export::Table(what))).if_possible(there);
        for form in [Form::Svg, Form::Png].into_iter().filter(|_| what.has_plot()) {
            let ending = form.ending().to_uppercase();
            list.add(format!("Save plot as {ending}: {name}…"), Command::Export(Export::Plot(what, form))).if_possible(there);
        }
    }
}

fn view(list: &mut List, state: &State) {
    let open = state.model.is_some();
    list.add("Frame all", Command::FrameAll).key(FRAME_ALL).if_possible(open);
    let selected = state.picked.as_ref().is_some_and(|picked| picked.selected().is_some());
    list.add("Frame the selected cell", Command::FrameSelected).key(FRAME_SELECTED).if_possible(selected);
    list.add("Perspective or orthographic", Command::ToggleProjection).key(PROJECTION).if_possible(open);
    list.add("Keep this view as a bookmark", Command::AddBookmark).key(BOOKMARK).if_possible(open);
    for (i, bookmark) in state.bookmarks.iter().enumerate() {
        list.add(format!("Go to {}", bookmark.name), Command::Bookmark(i));
    }
    list.add("View before", Command::CameraBack).key(CAMERA_BACK).if_possible(state.cameras.has_back());
    list.add("View after", Command::CameraForward).key(CAMERA_FORWARD).if_possible(state.cameras.has_forward());
    for mode in Mode::ALL {
        let other = mode != state.settings.mode || state.tiles.shown;
        list.add(format!("Picture: {}", mode.label()), Command::Mode(mode)).if_possible(state.offers(mode) && other);
    }
    list.add(format!("Picture: {}", toolbar::TILES), Command::ShowTiles(true)).if_possible(open && !state.tiles.shown);
    let heat = panels::heat::is_shown(state);
    for rays in HeatRays::ALL {
        let other = heat && rays != state.settings.heat_rays;
        list.add(format!("Heat map: {}", rays.label()), Command::HeatRays(rays)).if_possible(other);
    }
    list.add("Heat map: fit the range", Command::HeatRange(None)).if_possible(heat && state.range.is_some());
    for sampler in SamplerKind::ALL {
        let path = state.settings.mode == Mode::Path && sampler != state.settings.sampler;
        list.add(format!("Sampler: {}", sampler.label()), Command::Sampler(sampler)).if_possible(path);
    }
    for samples in [1, 16, 64, 256, 1024, 4096] {
        list.add(format!("Samples a pixel: {samples}"), Command::MaxSamples(samples));
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

fn boxes(list: &mut List, state: &State) {
    let now = state.settings.overlay;
    let mut toggle = |name: &'static str, change: fn(&mut OverlaySettings)| {
        let mut overlay = now;
        change(&mut overlay);
        list.add(name, Command::Overlay(overlay)).if_possible(overlay != now && state.shown.is_some());
    };
    toggle("Leaves only, or a depth", |o| o.leaves_only = !o.leaves_only);
    toggle("Split planes on or off", |o| o.planes = !o.planes);
    toggle("Empty cells on or off", |o| o.empty_cells = !o.empty_cells);
    toggle("Hidden lines on or off", |o| o.hidden_lines = !o.hidden_lines);
    toggle("Boxes of the selected cell only, or of all", |o| o.subtree_only = !o.subtree_only);
    let mut overlay = now;
    overlay.boxes = !overlay.boxes;
    list.add("Boxes on or off", Command::Overlay(overlay)).key(BOXES).if_possible(state.shown.is_some());
    let deepest = toolbar::deepest(state);
    for (name, depth, key) in [
        ("A level deeper", now.depth.saturating_add(1).min(deepest), DEEPER[0]),
        ("A level higher", now.depth.saturating_sub(1), DEEPER[1]),
    ] {
        let single = now.from_depth == now.depth;
        let overlay = OverlaySettings { depth, from_depth: if single { depth } else { now.from_depth.min(depth) }, ..now };
        let drawn = state.shown.is_some() && state.film_on_screen().is_none();
        list.add(name, Command::Overlay(overlay)).key(key).if_possible(overlay != now && drawn);
    }
    for levels in Levels::ALL {
        let overlay = OverlaySettings { levels, ..now };
        let possible = overlay != now && has_levels(state);
        list.add(format!("Levels drawn: {}", levels.label()), Command::Overlay(overlay)).if_possible(possible);
    }
    for color in BoxColor::ALL {
        let overlay = OverlaySettings { color, ..now };
        list.add(format!("Colour boxes by {}", color.name()), Command::Overlay(overlay)).if_possible(overlay != now);
    }
}

fn structure(list: &mut List, state: &State) {
    for entry in registry::ALL {
        let other = entry.id != state.settings.entry().id && !state.is_measuring();
        list.add(format!("Show {}", entry.name), Command::Structure(entry.id)).if_possible(other);
    }
    for entry in registry::ALL {
        let here = state.settings.workspace == Workspace::Compare && state.settings.mode != Mode::Path;
        let other = entry.id != state.settings.entry().id;
        list.add(format!("Split with {}", entry.name), Command::PutBeside(Some(entry.id))).if_possible(here && other);
    }
    panes(list, state);
    let outline = state.tree.outline.as_ref();
    for rank in Rank::ALL {
        let row = outline.and_then(|outline| outline.greatest(rank));
        list.add(format!("Select: {}", rank.name()), Command::SelectRow(row.unwrap_or(0))).if_possible(row.is_some());
    }
    list.add("Open all of the tree", Command::OpenBelow(0)).if_possible(outline.is_some());
    let free = !state.is_measuring() && !state.is_checking() && state.building.is_none();
    let fits = state.fittable().is_some() && free;
    list.add("Compare bounding volumes of the selected node", Command::FitVolumes).if_possible(fits);
    for row in state.fitting().iter().flat_map(|(fitting, _)| &fitting.rows) {
        let name = format!("Draw around the node: {}", volume_name(row.id));
        list.add(name, Command::DrawVolume(Some(row.id))).if_possible(state.fits.drawn != Some(row.id));
    }
    let drawn = state.fits.drawn.is_some();
    list.add("Draw no volume around the node", Command::DrawVolume(None)).if_possible(drawn);
    let hide = !state.settings.hide_outcome;
    list.add(if hide { "Hide outcomes" } else { "Show outcomes" }, Command::HideOutcome(hide));
}

fn film(list: &mut List, state: &State) {
    let (filming, on_screen) = (&state.filming, state.film_on_screen().is_some());
    list.add("Make the film of the build", Command::MakeFilm).if_possible(state.can_make_film());
    let playing = filming.playing.is_some();
    let (name, play) = if playing { ("Film: pause", false) } else { ("Film: play", true) };
    list.add(name, Command::PlayFilm(play)).key(FILM_PLAY).if_possible(on_screen);
    let (at, last) = (filming.at, filming.last());
    let back = list.add("Film: back", Command::FilmTo(at.saturating_sub(1)));
    back.key(FILM_BACK).if_possible(on_screen && at > 0);
    let forward = list.add("Film: forward", Command::FilmTo(at.saturating_add(1)));
    forward.key(FILM_FORWARD).if_possible(on_screen && at < last);
    list.add("Film: start", Command::FilmTo(0)).if_possible(on_screen && at > 0);
    list.add("Film: end", Command::FilmTo(last)).if_possible(on_screen && at < last);
    list.add("Film: close", Command::CloseFilm).if_possible(filming.film.is_some());
}

/// Pictures beside each other.
fn panes(list: &mut List, state: &State) {
    let (panes, comparing) = (&state.settings.panes, state.is_comparing());
    list.add("One picture again", Command::PutBeside(None)).if_possible(!panes.others.is_empty());
    let next = panes.others.len();
    for entry in registry::ALL {
        let add = Command::PutPane(next, PaneChoice::of(entry, &state.settings));
        list.add(format!("Compare also with {}", entry.name), add).if_possible(comparing && next + 1 < MOST);
    }
    for (which, choice) in panes.on_screen().iter().enumerate() {
        let letter = LETTERS[which + 1];
        list.add(format!("Close pane {letter}"), Command::ClosePane(which)).if_possible(comparing);
        list.add(format!("Parameters of pane {letter}"), Command::TunePane(Some(which))).if_possible(comparing);
        let less = PaneChoice { shows: Shows::Difference, ..choice.clone() };
        let possible = comparing && state.settings.mode.is_heat() && choice.shows != Shows::Difference;
        list.add(format!("Difference: A less {letter}"), Command::PutPane(which, less)).if_possible(possible);
    }
    for arrange in Arrange::ALL {
        let other = comparing && arrange != panes.arrange;
        list.add(format!("Compare in: {}", arrange.label()), Command::Arrange(arrange)).if_possible(other);
    }
    list.add("Fit the shared range of colours", Command::FitRange).if_possible(state.shares_ranges());
}

fn ray(list: &mut List, state: &State) {
    let listed = &state.ray_list;
    list.add("Open rays…", Command::OpenRays).if_possible(state.model.is_some());
    list.add("Put the file of rays away", Command::CloseRays).if_possible(listed.file.is_some());
    list.add("Follow the dearest ray of the file", Command::FollowListed(0)).if_possible(listed.traced.is_some());
    let rays = &state.rays;
    let there = !rays.columns.is_empty() && state.settings.workspace == Workspace::Ray;
    let go = |to: usize| Command::Step(rays.lead, to);
    list.add("Next step", go(rays.at + 1)).if_possible(there && rays.at < rays.last());
    list.add("Step before", go(rays.at.saturating_sub(1))).if_possible(there && rays.at > 0);
    let leaf = rays.columns.get(rays.lead).and_then(|lead| lead.followed.leaf(rays.at, true));
    list.add("Next leaf", go(leaf.unwrap_or(0))).if_possible(there && leaf.is_some());
    let playing = rays.playing.is_some();
    let compared = state.can_compare_with_brute_force();
    list.add("Mark a rectangle to check with brute force", Command::MarkRectangle(true)).if_possible(compared);
    list.add("Check the whole view with brute force", Command::CheckByBrute(None)).if_possible(compared);
    let differs = !state.brute.unlike().is_empty();
    list.add("Follow a ray that differs from brute force", Command::FollowUnlike(state.brute.next)).if_possible(differs);
    list.add(if playing { "Pause the ray" } else { "Play the ray" }, Command::Play(!playing)).if_possible(there);
}

fn measure(list: &mut List, state: &State) {
    let free = state.shown.is_some() && state.building.is_none() && !state.is_measuring() && !state.is_checking();
    list.add("Measure all structures", Command::Measure).if_possible(free);
    list.add("Time the tiles of the view", Command::TimeTiles).if_possible(free && state.tiles.shown);
    list.add("Look for causes of slow rays", Command::FindCauses).if_possible(free);
    list.add("Measure quality against its cost", Command::MeasureTradeoffs).if_possible(free);
    list.add("Measure time against triangles", Command::MeasureScaling).if_possible(free);
    for fairness in Fairness::ALL {
        let other = fairness != state.terms_of_timings.fairness && state.measuring.is_none();
        list.add(format!("Measure: {}", fairness.name().to_lowercase()), Command::Fairness(fairness)).if_possible(other);
    }
    for column in Column::ALL {
        list.add(format!("Sort timings by {}", column.name()), Command::SortTimings(column));
    }
    list.add("Measure what leaving out saves", Command::MeasureNeeds).if_possible(free);
    list.add("Make a reference", Command::MakeReference).if_possible(free && state.settings.mode == Mode::Path);
    list.add("Check this model", Command::CheckModel).if_possible(free);
    list.add("Run the stability lab", Command::RunLab).if_possible(!state.is_measuring() && !state.is_checking());
    for plot in Plot::ALL {
        list.add(format!("Plot of errors: {}", plot.name()), Command::ErrorPlot(plot));
    }
}

fn window(list: &mut List, state: &State) {
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
    let present = if state.presenting { "End the presentation" } else { "Presentation: larger, without panels" };
    list.add(present, Command::Present(!state.presenting)).key(PRESENT);
    list.add("Terms, with formulas and sources", Command::Terms(true)).if_possible(!state.terms);
    list.add("Tour in six steps", Command::Tour(Some(0))).if_possible(state.tour.is_none());
    list.add("Full screen", Command::FullScreen).key(FULL_SCREEN);
    list.add("Next panel", Command::NextPanel(true)).key(NEXT_PANEL);
    list.add("Panel before", Command::NextPanel(false)).key(PANEL_BEFORE);
    list.add("Reset layout", Command::ResetLayout);
    list.add("All commands", Command::Palette(true)).key(PALETTE);
    let help = list.add("Keys and mouse", Command::Help(!state.help));
    help.keys.extend(HELP);
}

/// How well a name fits what was typed: less is better, `None` if its letters do not come up in that order. Letters that begin
/// words, and those that follow each other, fit best.
pub fn fit(name: &str, typed: &str) -> Option<u32> {
    let letters: Vec<char> = name.chars().flat_map(char::to_lowercase).collect();
    let (mut cost, mut at, mut last) = (0, 0, None);
    for wanted in typed.chars().flat_map(char::to_lowercase).filter(|c| !c.is_whitespace()) {
        let begins = |i: usize| i == 0 || !letters[i - 1].is_alphanumeric();
        let next = letters[at..].iter().position(|c| *c == wanted).map(|i| at + i)?;
        // The beginning of a later word is as good as what comes next.
        let word = (at..letters.len()).find(|i| letters[*i] == wanted && begins(*i));
        let follows = last.is_some_and(|last: usize| next == last + 1);
        let chosen = if follows { next } else { word.unwrap_or(next) };
        cost += if follows || begins(chosen) { 0 } else { 4 };
        cost += u32::try_from(chosen - at).unwrap_or(u32::MAX).min(8);
        (at, last) = (chosen + 1, Some(chosen));
    }
    Some(cost * 64 + u32::try_from(letters.len()).unwrap_or(63).min(63))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_fit_by_words_and_letters() {
        let best = |typed: &str, names: &[&'static str]| {
            names.iter().filter_map(|name| Some((fit(name, typed)?, *name))).min().map(|best| best.1)
        };
        let names =
            ["Open…", "Open a path…", "Show k-d tree", "Show BVH", "Measure all structures", "Check this model", "Look: dark"];
        for (typed, expected) in [
            ("open", "Open…"),
            ("path", "Open a path…"),
            ("kd", "Show k-d tree"),
            ("bvh", "Show BVH"),
            ("mas", "Measure all structures"),
            ("ctm", "Check this model"),
            ("DARK", "Look: dark"),
        ] {
            assert_eq!(best(typed, &names), Some(expected), "{typed}");
        }
        assert_eq!(best("xyz", &names), None);
        assert!(names.iter().all(|name| fit(name, "").is_some()));
    }
}
