//! The film of the build: where it stands, how it is played, and the SAH cost along it.

use eframe::egui::{
    Align2, Button, DragValue, Label, Pos2, Rect, RichText, Role, ScrollArea, Sense, Slider, Stroke, TextStyle, Ui, UiBuilder,
    WidgetInfo, vec2,
};

use super::{Commands, as_table, running, saves};
use crate::lab::film::{Film, Order, Seen, Subject, is_reinserted};
use crate::viewer::actions;
use crate::viewer::command::Command;
use crate::viewer::filming::SPEEDS;
use crate::viewer::format;
use crate::viewer::kept::Built;
use crate::viewer::sheets::What;
use crate::viewer::state::State;
use crate::viewer::theme::{self, Palette};

/// What the button for a film does.
const OFFER: &str =
    "Replay how the structure was built, from what it is at last: cell by cell, or level by level if they are many.";
/// What it does where reinsertion moved nodes.
const AGAIN: &str = "To see which nodes reinsertion moved, the tree is built once more.";
/// The part of the panel that the plot takes.
const PLOT: f32 = 0.4;
/// What stands beside the slider: its value and its name.
const BESIDE: f32 = 30.0 * theme::GRID;
/// Parts of the film between the rows of its table.
const PARTS: u32 = 10;

/// Draws the panel.
pub fn show(ui: &mut Ui, state: &State, commands: &mut Commands) {
    let Some((film, at)) = state.film_on_screen() else { return offer(ui, state, commands) };
    let area = ui.available_rect_before_wrap();
    let (left, right) = area.split_left_right_at_fraction(1.0 - PLOT);
    ui.allocate_rect(area, Sense::hover());
    let left = left.with_max_x(left.right() - theme::GUTTER);
    let mut hands = ui.new_child(UiBuilder::new().id_salt("film").max_rect(left));
    ScrollArea::vertical().auto_shrink(false).show(&mut hands, |ui| {
        let as_table = title(ui, state, (film, at), commands);
        player(ui, state, commands);
        ui.add(Label::new(film.tell(at)).wrap());
        if let Some(text) = about_moves(state, film, at) {
            ui.add(Label::new(RichText::new(text).small().color(Palette::in_ui(ui).dim)).wrap());
        }
        if as_table {
            costs(ui, film);
        }
    });
    plot(ui, right, film, at, commands);
}

/// What a film of the shown structure is of.
fn subject(shown: &Built) -> Subject<'_> {
    Subject { id: shown.key.entry.id, accel: shown.accel.as_ref(), params: &shown.key.params }
}

/// What is to be known of nodes that are moved once the tree is built.
fn about_moves(state: &State, film: &Film, at: u32) -> Option<&'static str> {
    let shown = state.shown.as_ref().filter(|shown| is_reinserted(&shown.key.params))?;
    let subject = subject(shown);
    Some(match film.seen(at) {
        Seen::Moves(..) => "White: what was moved. Orange: its parent before, which is gone. Blue: its parent since.",
        _ if film.has_moves() => {
            "The tree was built once more, with one triangle in a leaf, to see which nodes reinsertion moves then."
        }
        _ if !subject.has_moves() => "Then reinsertion moved nodes: it can be seen of the BVH of a model in one level.",
        _ => "Then reinsertion moved nothing that gained.",
    })
}

/// The way to a film.
fn offer(ui: &mut Ui, state: &State, commands: &mut Commands) {
    ui.horizontal_wrapped(|ui| {
        label(ui);
        if let Some(job) = &state.filming.making {
            if running(ui, &job.progress, "Making", ("Cancel the film", "Stop making the film.")) {
                commands.push(Command::CloseFilm);
            }
            return;
        }
        let moved = state.shown.as_ref().is_some_and(|shown| subject(shown).has_moves());
        let help = if moved { format!("{OFFER} {AGAIN}") } else { OFFER.to_owned() };
        if ui.add_enabled(state.can_make_film(), Button::new("Make the film")).on_hover_text(help).clicked() {
            commands.push(Command::MakeFilm);
        }
        match &state.filming.failed {
            Some(why) => {
                drop(ui.add(Label::new(RichText::new(why).color(Palette::in_ui(ui).warn)).truncate()).on_hover_text(why))
            }
            None => {
                let text = RichText::new("The build, in reconstructed order.").color(Palette::in_ui(ui).dim);
                ui.add(Label::new(text).extend());
            }
        }
    });
    ui.take_available_space();
}

/// The heading, in a row with what follows.
fn label(ui: &mut Ui) {
    ui.label(RichText::new("FILM").small().strong().color(Palette::in_ui(ui).dim));
}

const fn help(film: &Film) -> &'static str {
    match film.order() {
        _ if film.has_moves() => {
            "The tree before nodes were moved, built once more, in an order that is reconstructed; then the moves, as they were made."
        }
        Order::Splits => {
            "Replayed from the finished structure: cells are divided breadth first, as if the order had been kept, which it was not."
        }
        Order::Merges => {
            "Replayed from the finished structure: a cell is merged in the first round in which it can have been, if not later."
        }
    }
}

/// The order, the way out, and whether costs are wanted in rows.
fn title(ui: &mut Ui, state: &State, (film, at): (&Film, u32), commands: &mut Commands) -> bool {
    let row = ui.horizontal_wrapped(|ui| {
        label(ui);
        ui.add(Label::new(film.order_at(at)).extend()).on_hover_text(help(film));
        if ui.button("Close").on_hover_text("Put the film away.").accessible_name("Close the film").clicked() {
            commands.push(Command::CloseFilm);
        }
        saves::show(ui, What::Film, state, commands);
        as_table::choice(ui, "SAH cost over the film")
    });
    row.inner
}

/// Events that are told in rows, evenly over a film, its start and end among them.
fn told(last: u32) -> Vec<u32> {
    let mut events: Vec<u32> = (0..=PARTS).map(|i| (u64::from(i) * u64::from(last) / u64::from(PARTS)) as u32).collect();
    events.dedup();
    events
}

/// The costs at a few events, in rows.
fn costs(ui: &mut Ui, film: &Film) {
    let row = |event: u32| [format::count(event.into()), format::number(film.cost(event))];
    as_table::show(ui, "SAH cost over the film", ["Event", "SAH cost"], told(film.last()).into_iter().map(row));
}

/// Forward and back.
fn player(ui: &mut Ui, state: &State, commands: &mut Commands) {
    let (filming, at, last) = (&state.filming, state.filming.at, state.filming.last());
    ui.horizontal_wrapped(|ui| {
        let ctx = ui.ctx().clone();
        let written = |key| actions::written(&ctx, key);
        let mut button = |name: &str, help: &str, command: Option<Command>| {
            if ui.add_enabled(command.is_some(), Button::new(name)).on_hover_text(help).clicked() {
                commands.extend(command);
            }
        };
        button("Start", "Before the first event.", (at > 0).then_some(Command::FilmTo(0)));
        let back = format!("The event before ({}).", written(&actions::FILM_BACK));
        button("Back", &back, at.checked_sub(1).map(Command::FilmTo));
        let (name, help) = if filming.playing.is_some() { ("Pause", "Stay here") } else { ("Play", "Go on by itself") };
        let help = format!("{help} ({}).", written(&actions::FILM_PLAY));
        button(name, &help, Some(Command::PlayFilm(filming.playing.is_none())));
        let forward = format!("The event after ({}).", written(&actions::FILM_FORWARD));
        button("Forward", &forward, (at < last).then(|| Command::FilmTo(at + 1)));
        button("End", "The finished structure.", (at < last).then_some(Command::FilmTo(last)));
        let mut speed = filming.speed;
        let field = DragValue::new(&mut speed).range(SPEEDS).speed(0.02 * filming.speed).max_decimals(1).suffix(" events/s");
        if ui.add(field).accessible_name("Speed of the film").on_hover_text("How fast it plays.").changed() {
            commands.push(Command::FilmSpeed(speed));
        }
    });
    let mut to = at;
    ui.spacing_mut().slider_width = (ui.available_width() - BESIDE).max(theme::SHORT_SLIDER);
    let slider = Slider::new(&mut to, 0..=last).text("Event");
    if ui.add(slider).on_hover_text("How many events have happened.").changed() {
        commands.push(Command::FilmTo(to));
    }
}

/// The SAH cost over the events, on a logarithmic scale, and where the film stands.
fn plot(ui: &mut Ui, rect: Rect, film: &Film, at: u32, commands: &mut Commands) {
    let palette = Palette::in_ui(ui);
    // Its place is chosen by the slider as well, so that it needs no focus.
    let response = ui.interact(rect, ui.scope_id().with("film cost"), Sense::CLICK | Sense::DRAG);
    response.widget_info(|| WidgetInfo::labeled(Role::Image, true, "SAH cost over the film"));
    let painter = ui.painter_at(rect);
    painter.rect_filled(rect, 0.0, palette.background);
    let scale = Scale::new(film, rect.shrink(theme::GRID));
    painter.line(scale.curve(film), Stroke::new(theme::CURVE, palette.accent_text));
    let here = scale.at(at, film.cost(at));
    painter.vline(here.x, rect.y_range(), Stroke::new(1.0, palette.text));
    painter.circle_filled(here, theme::GRID, palette.text);
    let style = TextStyle::Small.resolve(ui.style());
    for (align, cost) in [(Align2::RIGHT_TOP, scale.most), (Align2::RIGHT_BOTTOM, scale.least)] {
        painter.text(align.pos_in_rect(&scale.rect), align, format::number(cost), style.clone(), palette.dim);
    }
    if (response.clicked() || response.dragged())
        && let Some(pointer) = response.interact_pointer_pos()
    {
        commands.push(Command::FilmTo(scale.event(pointer.x)));
    }
    let text = match film.order() {
        Order::Splits => {
            "The SAH cost of the tree so far, on a logarithmic scale: cells that are yet to be divided count as leaves, with the references that they hold at last. Click to go there."
        }
        Order::Merges => "The SAH cost of leaves and merged cells so far, on a logarithmic scale. Click to go there.",
    };
    response.on_hover_text(text);
}

/// From events and costs to points.
struct Scale {
    rect: Rect,
    last: u32,
    least: f64,
    most: f64,
}

impl Scale {
    fn new(film: &Film, rect: Rect) -> Self {
        let costs = film.costs().iter().copied();
        let (least, most) = costs.fold((f64::INFINITY, 0.0), |(a, b), cost| (cost.min(a), cost.max(b)));
        Self { rect, last: film.last(), least, most }
    }

    fn at(&self, event: u32, cost: f64) -> Pos2 {
        let along = event as f32 / self.last.max(1) as f32;
        let span = (self.most / self.least).ln();
        let up = if span > 0.0 && span.is_finite() { ((cost / self.least).ln() / span) as f32 } else { 0.5 };
        self.rect.left_bottom() + vec2(along * self.rect.width(), -up.clamp(0.0, 1.0) * self.rect.height())
    }

    /// One point for each of the screen, or each event if there are fewer.
    fn curve(&self, film: &Film) -> Vec<Pos2> {
        let points = (self.rect.width().max(1.0) as u32).min(self.last).max(1);
        let event = |i: u32| (u64::from(i) * u64::from(self.last) / u64::from(points)) as u32;
        (0..=points).map(event).map(|event| self.at(event, film.cost(event))).collect()
    }

    /// The event at a place.
    fn event(&self, x: f32) -> u32 {
        let along = ((x - self.rect.left()) / self.rect.width().max(1.0)).clamp(0.0, 1.0);
        (along * self.last as f32).round() as u32
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use eframe::egui::pos2;

    #[test]
    fn about_ten_events_are_told_from_the_start_to_the_end() {
        assert_eq!(told(0), [0]);
        assert_eq!(told(3), [0, 1, 2, 3]);
        assert_eq!(told(50), [0, 5, 10, 15, 20, 25, 30, 35, 40, 45, 50]);
        assert_eq!((told(u32::MAX).len(), told(u32::MAX).last()), (11, Some(&u32::MAX)));
    }

    #[test]
    fn places_and_events_go_both_ways() {
        let rect = Rect::from_min_size(pos2(10.0, 20.0), vec2(300.0, 60.0));
        let scale = Scale { rect, last: 800, least: 10.0, most: 1000.0 };
        for event in [0, 1, 37, 799, 800] {
            assert_eq!(scale.event(scale.at(event, 10.0).x), event);
        }
        assert_eq!((scale.at(0, 1000.0), scale.at(800, 10.0)), (rect.left_top(), rect.right_bottom()));
        assert!((scale.at(400, 100.0) - rect.center()).length() < 1e-3);
        let flat = Scale { rect, last: 0, least: 5.0, most: 5.0 };
        assert_eq!((flat.at(0, 5.0), flat.event(1e9)), (rect.left_center(), 0));
    }
}
