//! How the selected node is divided: what every plane would cost on three axes, beside the cost of a leaf, what was chosen,
//! what other rules would have chosen, and a plane of the user's own.

use eframe::egui::{
    Align2, Button, Color32, DragValue, EventFilter, Grid, Key, Pos2, Rect, Response, RichText, Role, Sense, Shape, Stroke,
    TextStyle, Ui, WidgetInfo, pos2, vec2,
};

use super::node::hidden;
use super::{Commands, as_table, fact, saves};
use crate::geometry::Axis;
use crate::lab::{Division, SahCurves};
use crate::viewer::command::Command;
use crate::viewer::format;
use crate::viewer::sheets::What;
use crate::viewer::state::State;
use crate::viewer::theme::{self, Palette};

/// What an arrow key moves the plane, from 0 to 1; with Shift ten times as much.
const KEY_STEP: f64 = 0.005;
/// Places in the table, less one.
const PLACES: u32 = 10;
/// Decimals of a place between 0 and 1.
const DECIMALS: usize = 3;

/// Draws it all.
pub fn show(ui: &mut Ui, state: &State, curves: &SahCurves, commands: &mut Commands) {
    let (axis, tried) = tried(state, curves);
    let hidden = hidden(state);
    let response = plot(ui, curves, hidden, (axis, tried)).on_hover_text("Click or drag to try a plane; arrow keys move it.");
    if !hidden && as_table::choice(ui, "SAH cost") {
        costs(ui, curves);
    }
    hands(ui, &response, axis, tried, commands);
    own_plane(ui, curves, axis, tried, commands);
    if hidden {
        if ui.button("Reveal").on_hover_text("Show how the node was divided, and what each plane costs.").clicked() {
            commands.push(Command::Reveal);
        }
        return;
    }
    outcome(ui, curves);
    others(ui, curves, commands);
    saves::show(ui, What::Division, state, commands);
}

/// The costs of planes at a few places, in rows.
fn costs(ui: &mut Ui, curves: &SahCurves) {
    let places = (0..=PLACES).map(|i| f64::from(i) / f64::from(PLACES));
    let row = |place: f64| {
        let [x, y, z] = Axis::ALL.map(|axis| format::number(curves.at(axis, place).cost));
        [format!("{place:.1}"), x, y, z]
    };
    as_table::show(ui, "SAH cost", ["Place", "x", "y", "z"], places.map(row));
}

/// The plane that is tried, or the axis that one would be tried on.
fn tried(state: &State, curves: &SahCurves) -> (Axis, Option<f64>) {
    if let Some((axis, place)) = state.tree.tried {
        return (axis, Some(place));
    }
    let longest = || {
        let spans = Axis::ALL.map(|axis| (axis, curves.position(axis, 1.0) - curves.position(axis, 0.0)));
        spans.into_iter().fold((Axis::X, 0.0), |a, b| if b.1 > a.1 { b } else { a }).0
    };
    let chosen = curves.chosen.filter(|_| !hidden(state)).and_then(|chosen| chosen.plane);
    (chosen.map_or_else(longest, |plane| plane.0), None)
}

/// The colour of an axis.
pub fn axis_mark(palette: &Palette, axis: Axis) -> Color32 {
    [palette.bvh, palette.kd, palette.grid][axis.index()].color
}

/// The costs of all candidate planes, of a leaf, of the division that was chosen, and of a plane that is tried.
pub fn plot(ui: &mut Ui, curves: &SahCurves, hidden: bool, (axis, tried): (Axis, Option<f64>)) -> Response {
    let palette = Palette::in_ui(ui);
    let own = tried.map(|place| curves.at(axis, place));
    let (rect, response) = ui.allocate_exact_size(vec2(ui.available_width(), 6.0 * theme::ROW), Sense::click_and_drag());
    response.widget_info(|| {
        let what = if hidden { "Place of a plane, the costs hidden" } else { "SAH cost over candidate planes" };
        WidgetInfo::labeled(Role::Image, true, what)
    });
    let painter = ui.painter_at(rect);
    painter.rect_filled(rect, 0.0, palette.background);
    let scale = Scale::new(curves, own.filter(|_| !hidden), rect.shrink(theme::GRID));
    if !hidden {
        let bar = |(place, cost): &(f64, f64)| [scale.at(*place, *cost), scale.floor(*place)];
        let buckets = &curves.buckets[axis.index()];
        // With a gap between them, however many there are.
        let width = (0.6 * rect.width() / buckets.len().max(1) as f32).min(theme::GRID);
        let bars = Stroke::new(width, axis_mark(palette, axis).gamma_multiply(theme::FAINT));
        painter.extend(buckets.iter().map(|bucket| Shape::line_segment(bar(bucket), bars)));
        for (axis, curve) in Axis::ALL.into_iter().zip(&curves.axes) {
            let points: Vec<Pos2> = curve.iter().map(|(place, cost)| scale.at(*place, *cost)).collect();
            painter.line(points, Stroke::new(theme::CURVE, axis_mark(palette, axis)));
        }
        if let Some(chosen) = &curves.chosen {
            let place = chosen.plane.map_or(0.5, |p| p.1);
            let color = chosen.plane.map_or(palette.text, |p| axis_mark(palette, p.0));
            painter.circle_stroke(scale.at(place, chosen.cost), theme::GRID, Stroke::new(theme::CURVE, color));
        }
    }
    let leaf = [scale.at(0.0, curves.leaf), scale.at(1.0, curves.leaf)];
    painter.extend(Shape::dashed_line(&leaf, Stroke::new(1.0, palette.dim), theme::GRID, theme::GRID));
    if let (Some(place), Some(own)) = (tried, own) {
        let x = scale.floor(place).x;
        painter.vline(x, rect.y_range(), Stroke::new(1.0, palette.text));
        if !hidden {
            painter.circle_filled(scale.at(place, own.cost), theme::GRID, palette.text);
        }
    }
    for (k, axis) in Axis::ALL.into_iter().enumerate() {
        let at = scale.rect.right_top() - vec2((2 - k) as f32 * theme::GUTTER * 1.5, 0.0);
        painter.text(at, Align2::RIGHT_TOP, axis.name(), TextStyle::Small.resolve(ui.style()), axis_mark(palette, axis));
    }
    if response.has_focus() {
        let stroke = Stroke::new(1.0, palette.accent_text);
        painter.rect_stroke(rect, 0.0, stroke, eframe::egui::StrokeKind::Inside);
    }
    response.on_hover_text("The expected cost of a line through this cell if it were divided at a place along x, y or z: C_trav + C_isect (A_l n_l + A_r n_r) / A. Dashed: a leaf. Ring: what was chosen. Bars: the planes that a builder with buckets looks at.")
}

/// From costs to points.
struct Scale {
    rect: Rect,
    least: f64,
    span: f64,
}

impl Scale {
    fn new(curves: &SahCurves, own: Option<Division>, rect: Rect) -> Self {
        let costs = curves.axes.iter().flatten().map(|c| c.1).chain(curves.chosen.map(|c| c.cost)).chain(own.map(|own| own.cost));
        let (least, most) = costs.fold((curves.leaf, curves.leaf), |(a, b), c| (a.min(c), b.max(c)));
        Self { rect, least, span: (most - least).max(f64::MIN_POSITIVE) }
    }

    fn at(&self, place: f64, cost: f64) -> Pos2 {
        let up = ((cost - self.least) / self.span) as f32;
        pos2(self.rect.left() + self.rect.width() * place as f32, self.rect.bottom() - self.rect.height() * up)
    }

    fn floor(&self, place: f64) -> Pos2 {
        pos2(self.rect.left() + self.rect.width() * place as f32, self.rect.bottom())
    }
}

/// Moves the plane by hand: a click or a drag puts it there, arrows move it.
fn hands(ui: &Ui, response: &Response, axis: Axis, tried: Option<f64>, commands: &mut Commands) {
    let inner = response.rect.shrink(theme::GRID);
    if response.clicked() || response.dragged() {
        response.request_focus();
        if let Some(at) = response.interact_pointer_pos() {
            let place = f64::from((at.x - inner.left()) / inner.width());
            commands.push(Command::TryPlane(Some((axis, place))));
        }
    }
    if !response.has_focus() {
        return;
    }
    let lock = EventFilter { horizontal_arrows: true, vertical_arrows: true, ..Default::default() };
    ui.memory_mut(|m| m.set_focus_lock_filter(response.id, lock));
    let (pressed, step) = ui.input(|i| {
        let pressed = |key| i32::from(i.num_presses(key) > 0);
        let steps = pressed(Key::ArrowRight) - pressed(Key::ArrowLeft);
        let axes = pressed(Key::ArrowDown) - pressed(Key::ArrowUp);
        ((steps, axes), if i.modifiers.shift { 10.0 * KEY_STEP } else { KEY_STEP })
    });
    if pressed != (0, 0) {
        let index = (axis.index() as i32 + pressed.1).rem_euclid(3);
        let place = tried.unwrap_or(0.5) + f64::from(pressed.0) * step;
        commands.push(Command::TryPlane(Some((Axis::ALL[index as usize], place))));
    }
}

/// The plane of the user's own, typed, and what it comes to.
fn own_plane(ui: &mut Ui, curves: &SahCurves, axis: Axis, tried: Option<f64>, commands: &mut Commands) {
    let palette = Palette::in_ui(ui);
    ui.horizontal(|ui| {
        ui.label(RichText::new("Try").color(palette.dim));
        for other in Axis::ALL {
            let button = Button::selectable(tried.is_some() && other == axis, other.name());
            let button = ui.add(button).on_hover_text("Try a plane across this axis.");
            if button.clicked() {
                commands.push(Command::TryPlane(Some((other, tried.unwrap_or(0.5)))));
            }
        }
        let mut place = tried.unwrap_or(0.5);
        let field = DragValue::new(&mut place).range(0.0..=1.0).speed(KEY_STEP).fixed_decimals(DECIMALS);
        let field = ui
            .add(field)
            .accessible_name("Place of the plane")
            .on_hover_text("Where the plane crosses the cell: 0 is its least side, 1 its greatest.");
        if field.changed() {
            commands.push(Command::TryPlane(Some((axis, place))));
        }
        if tried.is_some() && ui.button("×").on_hover_text("Put the plane away.").clicked() {
            commands.push(Command::TryPlane(None));
        }
    });
    let own = tried.map(|place| curves.at(axis, place));
    let cost = own.map_or_else(|| format::MISSING.to_owned(), |own| format::number(own.cost));
    fact(ui, "Its cost", cost, "What a line through this cell would cost, were it divided by the plane that is tried.");
    let sides = own.map_or_else(
        || format::MISSING.to_owned(),
        |own| {
            let [left, right] = [own.left, own.right].map(|side| format::count(side.references as u64));
            format!("{left} | {right}")
        },
    );
    fact(ui, "Its sides", sides, "Triangles on either side of it.");
}

/// What was chosen.
pub fn outcome(ui: &mut Ui, curves: &SahCurves) {
    fact(ui, "Cost of a leaf", format::number(curves.leaf), "What testing all triangles would cost a line through this cell.");
    if let Some(chosen) = &curves.chosen {
        let along = chosen.plane.map(|p| format!(", across {}", p.0.name())).unwrap_or_default();
        let cost = format!("{}{along}", format::number(chosen.cost));
        fact(ui, "Chosen", cost, "What the division that was chosen costs by the same measure.");
    }
}

/// What other rules would have chosen; a click tries it.
fn others(ui: &mut Ui, curves: &SahCurves, commands: &mut Commands) {
    let palette = Palette::in_ui(ui);
    Grid::new("other divisions").num_columns(3).striped(true).show(ui, |ui| {
        for other in &curves.others {
            let name = ui.add_enabled(other.division.is_some(), Button::new(other.name)).on_hover_text(other.help);
            if name.clicked() {
                commands.push(Command::TryPlane(other.division.map(|division| division.plane)));
            }
            let Some(division) = other.division else {
                ui.label(format::MISSING).on_hover_text("It can't divide this node.");
                ui.end_row();
                continue;
            };
            let (axis, place) = division.plane;
            ui.label(RichText::new(format!("{} {place:.DECIMALS$}", axis.name())).color(palette.dim));
            ui.label(format::number(division.cost)).on_hover_text("The expected cost of a line through this cell.");
            ui.end_row();
        }
    });
}
