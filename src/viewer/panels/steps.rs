//! The steps of a ray, in a column for each structure: the one that is played is marked, and the others stand where the ray
//! has come as far.

use eframe::egui::{
    Align2, EventFilter, Id, Key, Rect, Response, RichText, Role, Sense, TextStyle, Ui, UiBuilder, WidgetInfo, pos2, vec2,
};

use super::long_list::LongList;
use super::{Commands, empty, focus, ray_list};
use crate::accel::{Prune, Step};
use crate::lab::follow::FollowedStep;
use crate::viewer::command::Command;
use crate::viewer::format;
use crate::viewer::marks;
use crate::viewer::rays::Column;
use crate::viewer::state::State;
use crate::viewer::theme::{self, Palette};

/// The least width at which a step is a sentence, with its figures beside it.
const WIDE: f32 = 110.0 * theme::GRID;
/// The width of such a figure.
const FIGURE: f32 = 15.0 * theme::GRID;

/// Draws the panel.
pub fn show(ui: &mut Ui, state: &State, commands: &mut Commands) {
    let Some(file) = &state.ray_list.file else { return columns(ui, state, commands) };
    let (area, top) = (ui.available_rect_before_wrap(), ui.available_rect_before_wrap().left_top());
    ui.allocate_rect(area, Sense::hover());
    let list = Rect::from_min_size(top, vec2(theme::RAY_LIST.min(area.width() / 2.0), area.height()));
    let rest = Rect::from_min_max(pos2(list.right() + theme::GUTTER, area.top()), area.max);
    let mut part = |name: &str, rect: Rect| {
        let mut part = ui.new_child(UiBuilder::new().id_salt(name).max_rect(rect));
        part.set_clip_rect(rect.intersect(ui.clip_rect()));
        part
    };
    ray_list::show(&mut part("rays", list), state, file, commands);
    columns(&mut part("steps", rest), state, commands);
}

/// A column for each structure.
fn columns(ui: &mut Ui, state: &State, commands: &mut Commands) {
    let rays = &state.rays;
    if rays.columns.is_empty() {
        let text = match (&rays.note, &rays.following) {
            (Some(note), _) => note,
            (None, Some(_)) => "Following the ray…",
            (None, None) => "No ray yet. Click a pixel.",
        };
        empty(ui, text);
        ui.take_available_space();
        return;
    }
    let area = ui.available_rect_before_wrap();
    ui.allocate_rect(area, Sense::hover());
    let n = rays.columns.len() as f32;
    let width = (area.width() - (n - 1.0) * theme::GUTTER) / n;
    for (i, column) in rays.columns.iter().enumerate() {
        let left = area.left() + i as f32 * (width + theme::GUTTER);
        let rect = Rect::from_min_size(pos2(left, area.top()), vec2(width, area.height()));
        let mut part = ui.new_child(UiBuilder::new().id_salt(("column", i)).max_rect(rect));
        part.set_clip_rect(rect.intersect(ui.clip_rect()));
        one(&mut part, state, (i, column), commands);
    }
}

/// One column.
fn one(ui: &mut Ui, state: &State, (i, column): (usize, &Column), commands: &mut Commands) {
    let (rays, palette) = (&state.rays, Palette::in_ui(ui));
    let (followed, at) = (&column.followed, rays.position(i));
    ui.horizontal(|ui| {
        marks::dot(ui, column.built.key.entry.family);
        let name = RichText::new(column.built.key.entry.name);
        ui.label(if i == rays.lead { name.strong() } else { name });
        let more = if followed.more { " and more" } else { "" };
        let place = format!("step {} of {}{more}", format::count(at as u64 + 1), format::count(followed.steps.len() as u64));
        ui.label(RichText::new(place).small().color(palette.dim));
    });
    let list = Id::unique(("steps", i));
    let area = ui.available_rect_before_wrap();
    let keys_go = ui.interact(area, list.with("keys"), Sense::focusable_noninteractive());
    keys_go.widget_info(|| WidgetInfo::labeled(Role::List, true, format!("Steps of {}", column.built.key.entry.name)));
    let rows = u32::try_from(followed.steps.len()).unwrap_or(u32::MAX);
    let reveal = Some((u32::try_from(at).unwrap_or(0), at as u64 + 1));
    LongList { id: list, rows, height: theme::ROW, reveal }.show(ui, |ui, row| {
        let step = &followed.steps[row as usize];
        if step_row(ui, step, row as usize, row as usize == at) {
            commands.push(Command::Step(i, row as usize));
            keys_go.request_focus();
        }
    });
    if keys_go.has_focus() {
        focus::ring(ui, area);
        keys(ui, &keys_go, (i, column), at, commands);
    }
}

/// A step; true if it was clicked.
fn step_row(ui: &mut Ui, step: &FollowedStep, number: usize, chosen: bool) -> bool {
    let palette = Palette::in_ui(ui);
    let rect = ui.max_rect();
    let response = ui.interact(rect, ui.scope_id().with("step"), Sense::CLICK);
    let text = sentence(&step.step);
    response.widget_info(|| WidgetInfo::selected(Role::ListItem, true, chosen, format!("{}: {text}", number + 1)));
    let fill = match () {
        () if chosen => palette.selection,
        () if response.hovered() => palette.control_hovered,
        () => palette.panel,
    };
    ui.painter().rect_filled(rect, 0.0, fill);
    let (small, body) = (TextStyle::Small.resolve(ui.style()), TextStyle::Body.resolve(ui.style()));
    let color = match step.step {
        Step::Entered(_) | Step::Tested(_, Some(_)) => palette.text,
        Step::Pruned(..) | Step::Tested(_, None) | Step::OutsideCell | Step::Level(_) => palette.dim,
    };
    let wide = rect.width() >= WIDE;
    if wide {
        let end = rect.right_center() - vec2(theme::GRID, 0.0);
        if let Some([a, b]) = step.interval {
            let interval = format!("{} – {}", format::number(a.into()), format::number(b.into()));
            ui.painter().text(end, Align2::RIGHT_CENTER, interval, small.clone(), palette.dim);
        }
    }
    let left = rect.left_center();
    ui.painter().text(left + vec2(theme::GRID, 0.0), Align2::LEFT_CENTER, (number + 1).to_string(), small, palette.dim);
    // In a narrow column there is no room for a sentence.
    let shown = if wide { text } else { brief(&step.step) };
    ui.painter().text(left + vec2(0.6 * FIGURE, 0.0), Align2::LEFT_CENTER, shown, body, color);
    response.on_hover_text(details(step)).clicked()
}

/// Everything that is known of a step.
pub fn details(step: &FollowedStep) -> String {
    let mut text = format!("{}. ", format::capital(&sentence(&step.step)));
    if let Some([a, b]) = step.interval {
        text += &format!("In its box from t = {} to {}. ", format::number(a.into()), format::number(b.into()));
    }
    text += &if step.best.is_finite() {
        format!("Best hit so far: t = {}. ", format::number(step.best.into()))
    } else {
        "No hit so far. ".to_owned()
    };
    text + &format!("{} waiting.", step.waiting)
}

/// Up and down by steps, left and right by leaves.
fn keys(ui: &Ui, focus: &Response, (i, column): (usize, &Column), at: usize, commands: &mut Commands) {
    let lock = EventFilter { horizontal_arrows: true, vertical_arrows: true, ..Default::default() };
    ui.memory_mut(|m| m.set_focus_lock_filter(focus.id, lock));
    let pressed = |key| ui.input(|i| i.modifiers.is_none() && i.key_pressed(key));
    let last = column.followed.steps.len().saturating_sub(1);
    let to = match () {
        () if pressed(Key::ArrowDown) => Some((at + 1).min(last)),
        () if pressed(Key::ArrowUp) => Some(at.saturating_sub(1)),
        () if pressed(Key::ArrowRight) => column.followed.leaf(at, true),
        () if pressed(Key::ArrowLeft) => column.followed.leaf(at, false),
        () if pressed(Key::End) => Some(last),
        () => None,
    };
    commands.extend(to.map(|to| Command::Step(i, to)));
}

/// What is done in a step, in as few letters as say it.
fn brief(step: &Step) -> String {
    match step {
        Step::Level(0) => "upper level".to_owned(),
        Step::Level(instance) => format!("below entry {}", instance - 1),
        Step::Entered(node) => format!("in {node}"),
        Step::Pruned(node, Prune::Missed) => format!("out {node}: missed"),
        Step::Pruned(node, Prune::Outside) => format!("out {node}: beyond"),
        Step::Pruned(node, Prune::BehindHit) => format!("out {node}: behind"),
        Step::OutsideCell => "hit outside".to_owned(),
        Step::Tested(prim, None) => format!("tri {prim}: no hit"),
        Step::Tested(prim, Some(t)) => format!("tri {prim}: {}", format::number(f64::from(*t))),
    }
}

/// What is done in a step, in words.
fn sentence(step: &Step) -> String {
    match step {
        Step::Level(0) => "is back in the upper level".to_owned(),
        Step::Level(instance) => format!("goes below entry {}", instance - 1),
        Step::Entered(node) => format!("enters {node}"),
        Step::Pruned(node, Prune::Missed) => format!("leaves {node} out: the ray misses it"),
        Step::Pruned(node, Prune::Outside) => format!("leaves {node} out: beyond the ray's interval"),
        Step::Pruned(node, Prune::BehindHit) => format!("leaves {node} out: behind the best hit"),
        Step::OutsideCell => "hit outside this cell: kept, not returned".to_owned(),
        Step::Tested(prim, None) => format!("tests triangle {prim}: no hit before the best one"),
        Step::Tested(prim, Some(t)) => format!("tests triangle {prim}: hit at t = {}", format::number(f64::from(*t))),
    }
}
