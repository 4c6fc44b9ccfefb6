//! What a heat map shows: how its amounts are spread, the range of its colours, and the times of tiles.

use eframe::egui::{
    Button, CursorIcon, DragValue, EventFilter, Id, Key, Rect, Role, Sense, Shape, Stroke, Ui, WidgetInfo, pos2, vec2,
};

use super::{Commands, as_table, empty, fact, heading, running, saves};
use crate::accel::registry::Entry;
use crate::lab::tile_times::{REPEATS, TILE};
use crate::render::{Histogram, Mode, Range};
use crate::viewer::command::Command;
use crate::viewer::compared::{self, Spread};
use crate::viewer::panes::LETTERS;
use crate::viewer::sheets::What;
use crate::viewer::state::{LEAST_SPAN, State};
use crate::viewer::theme::{self, Palette};
use crate::viewer::tiles::TERMS;
use crate::viewer::{format, legends};

/// What an arrow key moves an end of the range, in bins, with Shift held and without.
const KEY_STEPS: [f32; 2] = [8.0, 1.0];

/// Whether there is anything to show.
pub fn is_shown(state: &State) -> bool {
    state.model.is_some() && (state.heat_kind().is_some() || state.tiles.shown)
}

/// Whether it is chosen whose work is shown: beside a picture that shows none, heat maps are those of the camera's rays.
pub fn has_rays(state: &State) -> bool {
    is_shown(state) && (state.settings.mode.is_heat() || state.tiles.shown)
}

/// Heat maps that are on the screen and share a range.
pub struct Shown {
    /// What structures they are of.
    pub of: Vec<&'static Entry>,
    /// What they are amounts of.
    pub name: String,
    /// How those are spread, and what the ends of the colours stand for.
    pub spread: Spread,
}

/// The heat maps on the screen, if there are any.
pub fn on_screen(state: &State) -> Option<Shown> {
    // Until tiles are timed the picture is another one.
    let other = !is_shown(state) || (state.tiles.shown && !state.shows_tiles());
    let spread = compared::spread(state).filter(|_| !other)?;
    let name = legends::heat(state).map(|heat| heat.name).or_else(|| compared::amount(state))?;
    let of =
        compared::entries(state).zip(LETTERS).filter(|(_, letter)| spread.of.contains(letter)).map(|(entry, _)| entry).collect();
    Some(Shown { of, name, spread: Spread { range: state.range.unwrap_or(spread.range), ..spread } })
}

/// Draws the section, if there is one.
pub fn show(ui: &mut Ui, state: &State, commands: &mut Commands) {
    if !is_shown(state) {
        return;
    }
    heading(ui, "Heat map");
    if state.tiles.shown {
        tiles(ui, state, commands);
    }
    if let Some(why) = state.why_no_stack().filter(|_| state.settings.mode == Mode::Stack && !state.tiles.shown) {
        empty(ui, why);
    }
    if let Some(shown) = on_screen(state) {
        spread_of(ui, state, &shown.spread, commands);
        clicked(ui, state);
    }
    ui.separator();
}

/// How amounts are spread, and the range of their colours.
fn spread_of(ui: &mut Ui, state: &State, spread: &Spread, commands: &mut Commands) {
    if let [others @ .., last] = &spread.of[..]
        && !others.is_empty()
    {
        empty(ui, &format!("Pixels of {} and {last} together: they share the range.", others.join(", ")));
    }
    ends(ui, spread.range, &spread.histogram, commands);
    let as_table = ui.horizontal_wrapped(|ui| {
        let chosen = as_table::choice(ui, "heat map");
        saves::show(ui, What::Heat, state, commands);
        chosen
    });
    if as_table.inner {
        bins(ui, &spread.histogram);
    }
    typed(ui, state, spread.range, spread.histogram.width, commands);
}

/// The amount of the pixel that was last clicked, of each picture.
fn clicked(ui: &mut Ui, state: &State) {
    let help = "The amount of the pixel that was last clicked. Under the pointer it is told over the picture.";
    if !state.is_comparing() {
        let amount = format::or_missing(state.clicked_amount(), |x| format::number(x.into()));
        return fact(ui, "Clicked pixel", amount, help);
    }
    let told = compared::told_of_click(state);
    if told.is_empty() {
        return fact(ui, "Clicked pixel", format::or_missing(None::<f32>, |_| String::new()), help);
    }
    empty(ui, "Clicked pixel");
    told.iter().for_each(|told| fact(ui, &told.of, told.written(), help));
}

/// The times of tiles: how to get them, and what they come to.
fn tiles(ui: &mut Ui, state: &State, commands: &mut Commands) {
    if let Some((_, job)) = &state.tiles.running {
        if running(ui, &job.progress, "Timing", ("Cancel timing the tiles", "Stop timing.")) {
            commands.push(Command::CancelTiles);
        }
        return;
    }
    let old = state.tiles_are_old();
    match &state.tiles.found {
        Some((_, times)) => {
            if old {
                empty(ui, "Timed of an earlier view.");
            }
            if let Some(shortfall) = times.shortfall() {
                empty(ui, &shortfall);
            }
            let (mean, rays) = (format::number(times.mean_ns()), format::count(times.rays));
            fact(ui, "Mean", format!("{mean} ns a ray"), "Of all rays of the view, the least time of each tile.");
            fact(ui, "All tiles", format!("{} for {rays} rays", format::duration(times.secs)), "The least times of all tiles.");
        }
        None => empty(ui, "Not timed."),
    }
    if old || state.tiles.found.is_none() {
        let possible = state.can_measure();
        let help = format!(
            "Time the rays of each tile of {TILE} by {TILE} pixels on one thread, the least of {REPEATS} times or as many as some seconds allow, {}. Rendering rests meanwhile.",
            TERMS.label()
        );
        if ui.add_enabled(possible, Button::new("Time the tiles")).on_hover_text(help).clicked() {
            commands.push(Command::TimeTiles);
        }
    }
}

/// From amounts to places across the histogram.
#[derive(Clone, Copy)]
struct Scale {
    rect: Rect,
    end: f32,
}

impl Scale {
    fn x(&self, amount: f32) -> f32 {
        self.rect.left() + self.rect.width() * (amount / self.end).clamp(0.0, 1.0)
    }

    fn amount(&self, x: f32) -> f32 {
        ((x - self.rect.left()) / self.rect.width()).clamp(0.0, 1.0) * self.end
    }
}

/// The histogram, and the ends of the range that are dragged over it.
fn ends(ui: &mut Ui, range: Range, histogram: &Histogram, commands: &mut Commands) {
    let palette = Palette::in_ui(ui);
    let size = vec2(ui.available_width(), theme::HISTOGRAM);
    let (rect, response) = ui.allocate_exact_size(size, Sense::hover());
    response.widget_info(|| WidgetInfo::labeled(Role::Image, true, "Histogram of the heat map"));
    // Room for the handles at either side; a range that was typed may lie beyond all amounts.
    let scale = Scale { rect: rect.shrink(theme::HANDLE), end: histogram.end().max(range.max) };
    ui.painter().rect_filled(rect, 0.0, palette.background);
    bars(ui, scale, histogram, range);
    let help = "How many pixels have how much. Heights are square roots, so that few are seen beside many. Drag the ends of the colours, or move them with the arrow keys.";
    let response = response.on_hover_text(help);
    let id = response.id;
    let low = handle(ui, id.with("low"), "Dark end of the colours", scale, range.min, histogram.width);
    let high = handle(ui, id.with("high"), "Bright end of the colours", scale, range.max, histogram.width);
    if low.is_some() || high.is_some() {
        // An end that is moved stops at the other one.
        let min = low.map_or(range.min, |low| low.min(range.max - LEAST_SPAN));
        let max = high.map_or(range.max, |high| high.max(range.min + LEAST_SPAN));
        commands.push(Command::HeatRange(Some(Range { min, max })));
    }
}

/// The bins in which there are pixels, in rows.
fn bins(ui: &mut Ui, histogram: &Histogram) {
    let row = |(i, pixels): (usize, &u32)| {
        let [from, to] = [i, i + 1].map(|i| format::number(i as f64 * f64::from(histogram.width)));
        [from, to, format::count(u64::from(*pixels))]
    };
    let filled = histogram.counts.iter().enumerate().filter(|(_, pixels)| **pixels > 0);
    as_table::show(ui, "heat map", ["From", "to below", "Pixels"], filled.map(row));
}

/// A bar for each bin, in the colour that its amounts have.
fn bars(ui: &Ui, scale: Scale, histogram: &Histogram, range: Range) {
    let rect = scale.rect;
    let most = histogram.counts.iter().copied().max().unwrap_or(0).max(1) as f32;
    for (i, count) in histogram.counts.iter().enumerate().filter(|(_, count)| **count > 0) {
        let (from, to) = (i as f32 * histogram.width, (i + 1) as f32 * histogram.width);
        // What is there is never invisible.
        let height = ((*count as f32 / most).sqrt() * rect.height()).max(1.0);
        let right = scale.x(to).max(scale.x(from) + 1.0);
        let bar = Rect::from_min_max(pos2(scale.x(from), rect.bottom() - height), pos2(right, rect.bottom()));
        // A bin of counts holds the least of them.
        let t = (from - range.min) / (range.max - range.min);
        ui.painter().rect_filled(bar, 0.0, theme::heat_color(t));
    }
}

/// An end of the range; where it is moved to, if it is.
fn handle(ui: &Ui, id: Id, name: &str, scale: Scale, amount: f32, step: f32) -> Option<f32> {
    let palette = Palette::in_ui(ui);
    let (x, rect) = (scale.x(amount), scale.rect);
    let grip = Rect::from_center_size(pos2(x, rect.center().y), vec2(theme::ROW, rect.height() + 2.0 * theme::HANDLE));
    let response = ui.interact(grip, id, Sense::click_and_drag());
    response.widget_info(|| WidgetInfo::slider(true, f64::from(amount), name));
    let response = response.on_hover_text(format!("{name}: drag it, or use the arrow keys."));
    let response = response.on_hover_cursor(CursorIcon::ResizeHorizontal);
    let strong = response.hovered() || response.dragged() || response.has_focus();
    let color = if strong { palette.accent_text } else { palette.text };
    ui.painter().vline(x, rect.y_range(), Stroke::new(1.0, color));
    let top = grip.top();
    let points = vec![pos2(x - theme::HANDLE, top), pos2(x + theme::HANDLE, top), pos2(x, top + 1.5 * theme::HANDLE)];
    ui.painter().add(Shape::convex_polygon(points, color, Stroke::NONE));
    if response.clicked() || response.drag_started() {
        response.request_focus();
    }
    if let Some(at) = response.interact_pointer_pos().filter(|_| response.dragged()) {
        return Some(scale.amount(at.x));
    }
    if !response.has_focus() {
        return None;
    }
    let lock = EventFilter { horizontal_arrows: true, ..Default::default() };
    ui.memory_mut(|m| m.set_focus_lock_filter(response.id, lock));
    let (steps, shift) = ui.input(|i| {
        let pressed = |key| i32::from(i.key_pressed(key));
        (pressed(Key::ArrowRight) - pressed(Key::ArrowLeft), i.modifiers.shift)
    });
    let step = step * if shift { KEY_STEPS[0] } else { KEY_STEPS[1] };
    (steps != 0).then(|| (amount + steps as f32 * step).max(0.0))
}

/// The ends as numbers, and the range that fits.
fn typed(ui: &mut Ui, state: &State, Range { mut min, mut max }: Range, width: f32, commands: &mut Commands) {
    ui.horizontal_wrapped(|ui| {
        let speed = f64::from(0.25 * width);
        let mut field = |value: &mut f32, prefix: &str, name: &str, help: &str| {
            let field = DragValue::new(value).range(0.0..=f32::MAX).speed(speed).max_decimals(1).prefix(prefix);
            ui.add(field).accessible_name(name).on_hover_text(help).changed()
        };
        let low = field(&mut min, "from ", "Least amount", "The amount of the dark end. Drag, or click to type.");
        let high = field(&mut max, "to ", "Greatest amount", "The amount of the bright end. Drag, or click to type.");
        if low || high {
            // What is typed is taken; the other end gives way.
            let range = if low { Range { min, max: max.max(min) } } else { Range { min: min.min(max), max } };
            commands.push(Command::HeatRange(Some(range)));
        }
        // Pictures that share a range have the button above them.
        if state.shares_ranges() {
            return;
        }
        let fit = ui.add_enabled(state.range.is_some(), Button::new("Auto-fit"));
        if fit.on_hover_text("From 0 to what one pixel in two hundred exceeds.").clicked() {
            commands.push(Command::HeatRange(None));
        }
    });
}
