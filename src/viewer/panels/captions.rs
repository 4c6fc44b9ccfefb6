//! What is written over the picture, and the same for those who cannot see it.

use std::time::Instant;

use eframe::egui::{Align2, Color32, Pos2, Rect, TextStyle, Ui, pos2, vec2};

use crate::accel::cell::Layout;
use crate::render::Range;
use crate::render::colormap::{difference, viridis};
use crate::viewer::format;
use crate::viewer::settings::{BoxColor, Workspace};
use crate::viewer::state::State;
use crate::viewer::theme::{self, Palette};

/// A line over the picture.
struct Caption {
    /// The corner or edge of the view that it stands at.
    at: Align2,
    /// Above how many others it stands.
    row: u8,
    text: String,
}

impl Caption {
    const fn new(at: Align2, text: String) -> Self {
        Self { at, row: 0, text }
    }
}

/// The captions of the present view.
fn captions(state: &State) -> Vec<Caption> {
    if state.model.is_none() {
        let text = if state.loading.is_some() { "Opening…" } else { "Drop a model here, or open one from the File menu." };
        return vec![Caption::new(Align2::CENTER_CENTER, text.to_owned())];
    }
    let overlay = &state.settings.overlay;
    let showing = (state.shown.is_some() && (overlay.boxes || overlay.planes)).then(|| showing(state));
    let picked = state.picked.as_ref().map(|picked| picked.text.clone());
    let progress = state.picture.as_ref().map(|p| p.progress).filter(|p| p.step > 1);
    let coarse = progress.map(|p| format!("1/{} resolution after {}", p.step, format::duration(p.secs)));
    let change = state.change.as_ref().filter(|(_, until)| *until > Instant::now()).map(|(text, _)| text.clone());
    let check = state.settings.workspace == Workspace::Check && !state.checks.caption.is_empty();
    let marked = check.then(|| state.checks.caption.clone()).or_else(|| moment(state));
    // Their corners are taken where the picture is split.
    let (coarse, marked) = if state.is_split() { (None, None) } else { (coarse, marked) };
    let at = |at| move |text| Caption::new(at, text);
    let above = |text| Caption { row: 1, ..Caption::new(Align2::LEFT_BOTTOM, text) };
    let lines = [
        showing.map(at(Align2::LEFT_BOTTOM)),
        picked.map(above),
        coarse.map(at(Align2::RIGHT_TOP)),
        change.map(at(Align2::CENTER_TOP)),
        marked.map(at(Align2::LEFT_TOP)),
    ];
    lines.into_iter().flatten().collect()
}

/// `Showing 14 of 14 boxes`.
fn showing(state: &State) -> String {
    let c = &state.collected;
    if c.total == 0 && !c.more {
        return "No boxes at this depth".to_owned();
    }
    let beyond = if c.more { " or more" } else { "" };
    let color = state.settings.overlay.color;
    let write = |x: f32| if color == BoxColor::Triangles { format::number(x.into()) } else { format::share(x.into()) };
    let colors = c.range.map(|range| {
        let [low, high] = range.map(write);
        format!(", {}: {low} dark to {high} bright", color.name())
    });
    let (shown, total) = (format::count(c.shown as u64), format::count(c.total as u64));
    let what = if c.other_forms { "shapes" } else { "boxes" };
    format!("Showing {shown} of {total}{beyond} {what}{}", colors.unwrap_or_default())
}

/// What of a curve of errors is on the screen.
fn moment(state: &State) -> Option<String> {
    let errors = &state.errors;
    let chosen = errors.chosen.filter(|_| state.is_held())?;
    let live = errors.curves.get(chosen.curve)?;
    let [clicked, kept] = [chosen.point, chosen.kept].map(|point| format::count(live.shots[point].samples.into()));
    let instead = if clicked == kept { String::new() } else { format!(", as that of {clicked} was not kept") };
    let what = if chosen.difference { "difference from the reference" } else { "picture" };
    Some(format!("{}: {what} of {kept} spp{instead}", live.key.entry.short))
}

/// Colours from one end of a range, 0, to the other, 1.
type Colors = fn(f32) -> [f32; 3];

/// What colours stand for, if they are those of amounts: their name and range.
fn heat(state: &State) -> Option<(String, Range, Colors)> {
    if state.is_held() && state.errors.chosen.is_some_and(|chosen| chosen.difference) {
        let range = state.on_screen()?.range;
        return Some(("Brightness less the reference's".to_owned(), range, |t| difference(2.0 * t - 1.0)));
    }
    let range = state.picture.as_ref().filter(|_| state.settings.mode.is_heat())?.range;
    Some((format!("{} a ray", state.settings.mode.label()), range, viridis))
}

/// What is to be seen, in sentences.
pub fn describe(state: &State) -> String {
    let mut sentences = vec![state.model.as_ref().map_or("Nothing is open".to_owned(), |model| model.scene.name.clone())];
    if state.model.is_some() {
        let structure = state.shown.as_ref().map_or("no structure yet", |b| b.key.entry.name);
        let overlay = &state.settings.overlay;
        let depth = match state.layout() {
            Some(Layout::Flat { .. }) | None => String::new(),
            Some(_) if overlay.boxes && !overlay.leaves_only => format!(", boxes at depth {}", overlay.depth),
            Some(_) => String::new(),
        };
        let samples = state.picture.as_ref().map_or(0, |p| p.progress.samples);
        sentences.push(format!("{structure}{depth}, {samples} samples a pixel"));
    }
    sentences.extend(super::split::describe(state));
    sentences.extend(captions(state).into_iter().map(|caption| caption.text));
    sentences.extend(heat(state).map(|(name, range, _)| {
        let (min, max) = (format::number(range.min.into()), format::number(range.max.into()));
        format!("Colours show {name}, from {min} to {max}")
    }));
    sentences.iter().map(|s| s.trim_end_matches(['.', '…'])).map(|s| format!("{s}.")).collect::<Vec<_>>().join(" ")
}

/// Writes them.
pub fn show(ui: &Ui, rect: Rect, state: &State) {
    let inner = rect.shrink(theme::GUTTER);
    for Caption { at, row, text } in captions(state) {
        let above = vec2(0.0, f32::from(row) * (theme::ROW + theme::GRID));
        let pos = at.pos_in_rect(&inner) - above;
        if at == Align2::CENTER_CENTER {
            ui.painter().text(pos, at, text, TextStyle::Body.resolve(ui.style()), Palette::in_ui(ui).dim);
        } else {
            plate(ui, pos, at, text);
        }
    }
    if let Some(left) = state.change.as_ref().and_then(|(_, until)| until.checked_duration_since(Instant::now())) {
        ui.ctx().request_repaint_after(left);
    }
    if let Some(heat) = heat(state).filter(|_| state.model.is_some()) {
        legend(ui, inner, heat);
    }
}

/// Text on a plate, so that it can be read over any picture.
pub fn plate(ui: &Ui, at: Pos2, align: Align2, text: String) {
    let palette = Palette::in_ui(ui);
    let galley = ui.painter().layout_no_wrap(text, TextStyle::Body.resolve(ui.style()), palette.text);
    let plate = align.anchor_size(at, galley.size() + vec2(2.0 * theme::GUTTER, theme::GRID));
    ui.painter().rect_filled(plate, theme::GRID, theme::plate(palette));
    ui.painter().galley(plate.center() - galley.size() * 0.5, galley, palette.text);
}

/// The colours of a heat map and what they stand for.
fn legend(ui: &Ui, inner: Rect, (name, range, color): (String, Range, Colors)) {
    const STEPS: u32 = 48;
    let width = 48.0 * theme::GRID;
    let palette = Palette::in_ui(ui);
    let plate =
        Rect::from_min_max(inner.right_bottom() - vec2(width + 2.0 * theme::GUTTER, 13.0 * theme::GRID), inner.right_bottom());
    ui.painter().rect_filled(plate, theme::GRID, theme::plate(palette));
    let bar = Rect::from_min_size(plate.left_top() + vec2(theme::GUTTER, 6.0 * theme::GRID), vec2(width, 2.0 * theme::GRID));
    for i in 0..STEPS {
        let x = |i: u32| bar.left() + bar.width() * i as f32 / STEPS as f32;
        let [r, g, b] = color((i as f32 + 0.5) / STEPS as f32).map(|c| (c * 255.0) as u8);
        let step = Rect::from_min_max(pos2(x(i), bar.top()), pos2(x(i + 1), bar.bottom()));
        ui.painter().rect_filled(step, 0.0, Color32::from_rgb(r, g, b));
    }
    let text = |at: Pos2, align: Align2, text: String| {
        ui.painter().text(at, align, text, TextStyle::Small.resolve(ui.style()), palette.text);
    };
    text(bar.left_top() - vec2(0.0, theme::GRID), Align2::LEFT_BOTTOM, name);
    text(bar.left_bottom() + vec2(0.0, theme::GRID * 0.5), Align2::LEFT_TOP, format::number(range.min.into()));
    text(bar.right_bottom() + vec2(0.0, theme::GRID * 0.5), Align2::RIGHT_TOP, format::number(range.max.into()));
}
