//! What is written over the picture, and the same for those who cannot see it.

use std::time::Instant;

use eframe::egui::{Align2, Color32, Pos2, Rect, Stroke, TextStyle, Ui, Vec2, pos2, vec2};

use super::hiding;
use crate::accel::cell::Layout;
use crate::render::Range;
use crate::viewer::format;
use crate::viewer::legends::{Heat, heat};
use crate::viewer::settings::{BoxColor, Workspace};
use crate::viewer::state::State;
use crate::viewer::theme::{self, Palette};

/// The most lines that stand above each other in a corner.
pub const ROWS: f32 = 3.0;

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
    let marked = check.then(|| state.checks.caption.clone()).or_else(|| moment(state)).or_else(|| filmed(state));
    // Where pictures are compared names stand there, and the figures beneath.
    let (coarse, marked, change) = if state.is_comparing() { (None, None, None) } else { (coarse, marked, change) };
    let at = |at| move |text| Caption::new(at, text);
    let above = |text| Caption { row: 1, ..Caption::new(Align2::LEFT_BOTTOM, text) };
    let hidden = hiding::in_words(state).map(|text| Caption { row: 2, ..Caption::new(Align2::LEFT_BOTTOM, text) });
    let lines = [
        hidden,
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
    let write = |x: f32| match color {
        BoxColor::Triangles | BoxColor::Visits => format::number(x.into()),
        BoxColor::Depth | BoxColor::Cost | BoxColor::Overlap => format::share(x.into()),
    };
    let colors = c.range.map(|range| {
        let [low, high] = range.map(write);
        format!(", {}: {low} dark to {high} bright", color.name())
    });
    let (shown, total) = (format::count(c.shown as u64), format::count(c.total as u64));
    let what = if c.other_forms { "shapes" } else { "boxes" };
    format!("Showing {shown} of {total}{beyond} {what}{}", colors.unwrap_or_default())
}

/// How far the film of the build is.
fn filmed(state: &State) -> Option<String> {
    let (film, at) = state.film_on_screen()?;
    let (order, [at, last]) = (film.order_at(at), [at, film.last()].map(|event| format::count(event.into())));
    Some(format!("{order}, event {at} of {last}"))
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

/// What is to be seen, in sentences.
pub fn describe(state: &State) -> String {
    let mut sentences = vec![state.model.as_ref().map_or("Nothing is open".to_owned(), |model| model.scene.name.clone())];
    if state.model.is_some() {
        let structure = state.shown.as_ref().map_or("no structure yet", |b| b.key.entry.name);
        let overlay = &state.settings.overlay;
        let depth = match state.layout() {
            Some(Layout::Flat { .. }) | None => String::new(),
            Some(_) if overlay.boxes && !overlay.leaves_only && state.film_on_screen().is_none() => {
                format!(", boxes at depth {}", overlay.depth)
            }
            Some(_) => String::new(),
        };
        let samples = state.picture.as_ref().map_or(0, |p| p.progress.samples);
        sentences.push(format!("{structure}{depth}, {samples} samples a pixel"));
    }
    sentences.extend(super::panes::describe(state));
    sentences.extend(captions(state).into_iter().map(|caption| caption.text));
    sentences
        .extend(heat(state).map(|Heat { name, ends: [low, high], .. }| format!("Colours show {name}, from {low} to {high}")));
    let clicked = state.clicked_amount().filter(|_| !state.is_comparing());
    sentences.extend(clicked.map(|amount| format!("{} at the clicked pixel", format::number(amount.into()))));
    sentences.iter().map(|s| s.trim_end_matches(['.', '…'])).map(|s| format!("{s}.")).collect::<Vec<_>>().join(" ")
}

/// Writes them. `pointer` is where it is over the view, if it is.
pub fn show(ui: &Ui, rect: Rect, pointer: Option<Pos2>, state: &State) {
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
    if let Some(heat) = heat(state).filter(|_| state.model.is_some() && !state.is_comparing()) {
        let under = pointer.and_then(|at| amount_under(rect, at, state)).map(|amount| ("here", amount));
        let told = under.or_else(|| state.clicked_amount().map(|amount| ("clicked", amount)));
        legend(ui, inner, &heat, told);
    }
}

/// The amount under the pointer.
fn amount_under(rect: Rect, at: Pos2, state: &State) -> Option<f32> {
    let within = (at - rect.min) / rect.size();
    state.on_screen()?.amount_at(glam::Vec2::new(within.x * 2.0 - 1.0, 1.0 - within.y * 2.0))
}

/// Text on a plate, so that it can be read over any picture.
pub fn plate(ui: &Ui, at: Pos2, align: Align2, text: String) {
    let palette = Palette::in_ui(ui);
    let galley = ui.painter().layout_no_wrap(text, TextStyle::Body.resolve(ui.style()), palette.text);
    let plate = align.anchor_size(at, galley.size() + vec2(2.0 * theme::GUTTER, theme::GRID));
    ui.painter().rect_filled(plate, theme::GRID, theme::plate(palette));
    ui.painter().galley(plate.center() - galley.size() * 0.5, galley, palette.text);
}

/// The size of what [`legend`] draws.
pub const LEGEND: Vec2 = Vec2::new(52.0 * theme::GRID, 13.0 * theme::GRID);

/// The colours of a heat map and what they stand for, in the lower right corner of a part of the window, and among them an amount
/// that is told with its name.
pub fn legend(ui: &Ui, inner: Rect, heat: &Heat, told: Option<(&str, f32)>) {
    const STEPS: u32 = 48;
    let palette = Palette::in_ui(ui);
    let plate = Rect::from_min_max(inner.right_bottom() - LEGEND, inner.right_bottom());
    let width = LEGEND.x - 2.0 * theme::GUTTER;
    ui.painter().rect_filled(plate, theme::GRID, theme::plate(palette));
    let bar = Rect::from_min_size(plate.left_top() + vec2(theme::GUTTER, 6.0 * theme::GRID), vec2(width, 2.0 * theme::GRID));
    for i in 0..STEPS {
        let x = |i: u32| bar.left() + bar.width() * i as f32 / STEPS as f32;
        let [r, g, b] = (heat.colors)((i as f32 + 0.5) / STEPS as f32).map(|c| (c * 255.0) as u8);
        let step = Rect::from_min_max(pos2(x(i), bar.top()), pos2(x(i + 1), bar.bottom()));
        ui.painter().rect_filled(step, 0.0, Color32::from_rgb(r, g, b));
    }
    let text = |at: Pos2, align: Align2, text: String| {
        ui.painter().text(at, align, text, TextStyle::Small.resolve(ui.style()), palette.text);
    };
    text(bar.left_top() - vec2(0.0, theme::GRID), Align2::LEFT_BOTTOM, heat.name.clone());
    let [low, high] = heat.ends.clone();
    text(bar.left_bottom() + vec2(0.0, theme::GRID * 0.5), Align2::LEFT_TOP, low);
    text(bar.right_bottom() + vec2(0.0, theme::GRID * 0.5), Align2::RIGHT_TOP, high);
    if let Some((place, amount)) = told {
        let Range { min, max } = heat.range;
        let at = bar.left() + bar.width() * ((amount - min) / (max - min)).clamp(0.0, 1.0);
        ui.painter().vline(at, bar.y_range(), Stroke::new(theme::RAY_HALO, palette.background));
        ui.painter().vline(at, bar.y_range(), Stroke::new(1.0, palette.text));
        let middle = bar.center_bottom() + vec2(0.0, theme::GRID * 0.5);
        text(middle, Align2::CENTER_TOP, format!("{place}: {}", format::number(amount.into())));
    }
}
