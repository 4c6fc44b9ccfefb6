//! The tree of cells: each with its triangles and its part of the SAH cost, opened and closed, walked by keys.

use eframe::egui::{
    Align2, Button, EventFilter, Id, Key, KeyboardShortcut, Label, Pos2, Rect, Response, RichText, Role, Sense, Shape, Stroke,
    TextStyle, Ui, WidgetInfo, pos2, vec2,
};

use super::long_list::LongList;
use super::{Commands, empty, focus, heading};
use crate::accel::outline::{Outline, Rank, Row};
use crate::viewer::actions::{self, SIBLING};
use crate::viewer::command::Command;
use crate::viewer::format;
use crate::viewer::state::State;
use crate::viewer::theme::{self, Palette};

/// The width of a column of figures.
const COLUMN: f32 = 15.0 * theme::GRID;
/// Levels that are moved in; deeper ones stand below each other.
const LEVELS: u32 = 10;

/// Draws the panel.
pub fn show(ui: &mut Ui, state: &State, commands: &mut Commands) {
    heading(ui, "Tree");
    let tree = &state.tree;
    let Some(outline) = &tree.outline else {
        waiting(ui, state);
        ui.take_available_space();
        return;
    };
    summary(ui, outline, commands);
    let visits = state.visits();
    header(ui, visits.is_some());
    let list = Id::unique("tree of cells");
    let height_of = |row: u32| tree.folding.height_of(row);
    let reveal = tree.selected.and_then(height_of).map(|height| (height, tree.moved));
    let rows = LongList { id: list, rows: tree.folding.visible(), height: theme::ROW, reveal };
    let area = ui.available_rect_before_wrap();
    let keys_go = ui.interact(area, list.with("keys"), Sense::focusable_noninteractive());
    keys_go.widget_info(|| WidgetInfo::labeled(Role::Tree, true, "Cells"));
    let mut least = None;
    let fit = rows.show(ui, |ui, height| {
        let at = tree.folding.row_at(height);
        let row = outline.row(at);
        let base = *least.get_or_insert(row.depth.saturating_sub(1));
        let indent = row.depth.saturating_sub(base).min(LEVELS);
        let (open, selected, visits) = (tree.folding.is_open(at), tree.selected == Some(at), visits.map(|v| v.a_ray(row.id)));
        let drawn = Drawn { at, row, open, selected, indent, visits };
        if drawn.show(ui, commands) {
            keys_go.request_focus();
        }
    });
    if keys_go.has_focus() {
        focus::ring(ui, area);
        keys(ui, &keys_go, state, outline, fit, commands);
    }
}

/// Why there is no tree yet, or none at all.
fn waiting(ui: &mut Ui, state: &State) {
    if let Some(why) = &state.tree.failed {
        ui.add(Label::new(RichText::new(why).color(Palette::in_ui(ui).warn)).wrap());
    } else if state.tree.outlining.is_some() {
        empty(ui, "Listing the cells…");
    } else if state.is_measuring() {
        empty(ui, "The cells are listed once measuring has ended.");
    } else {
        empty(ui, "The cells appear once a structure is built.");
    }
}

/// How many there are, and the ways to those that are worth looking at.
fn summary(ui: &mut Ui, outline: &Outline, commands: &mut Commands) {
    let cut = if outline.is_cut() { ", those below instances left out: they do not fit" } else { "" };
    empty(ui, &format!("{} cells{cut}", format::count(outline.len().into())));
    ui.horizontal_wrapped(|ui| {
        for rank in Rank::ALL {
            let Some(row) = outline.greatest(rank) else { continue };
            if ui.button(rank.name()).on_hover_text(rank.help()).clicked() {
                commands.push(Command::SelectRow(row));
            }
        }
    });
    ui.horizontal(|ui| {
        if ui.button("Open all").on_hover_text("Show every cell.").clicked() {
            commands.push(Command::OpenBelow(0));
        }
        if ui.button("Close all").on_hover_text("Show the root and its children.").clicked() {
            commands.push(Command::CloseTree);
        }
    });
}

/// What the columns hold: visits in place of triangles where boxes are coloured by them.
fn header(ui: &mut Ui, visits: bool) {
    let (rect, response) = ui.allocate_exact_size(vec2(ui.available_width(), theme::ROW), Sense::hover());
    let color = Palette::in_ui(ui).dim;
    let small = TextStyle::Small.resolve(ui.style());
    let inner = Rect::from_min_max(rect.min, pos2(rect.right() - 3.0 * theme::GRID, rect.bottom()));
    let put = |at: Pos2, align: Align2, text: &str| ui.painter().text(at, align, text, small.clone(), color);
    put(inner.left_center(), Align2::LEFT_CENTER, "Cell");
    let middle = if visits { "Visits a ray" } else { "Triangles" };
    put(inner.right_center() - vec2(COLUMN, 0.0), Align2::RIGHT_CENTER, middle);
    put(inner.right_center(), Align2::RIGHT_CENTER, "SAH share");
    response.on_hover_text("Triangles: references in the cell and below. Visits a ray: how often a camera ray of the view enters it. SAH share: the part of the structure's cost that it and what is below it make up; the bar behind a row is as long.");
}

/// A row as it is drawn.
struct Drawn {
    at: u32,
    row: Row,
    open: bool,
    selected: bool,
    indent: u32,
    /// Visits a ray, if they stand in place of triangles.
    visits: Option<f64>,
}

impl Drawn {
    fn name(&self) -> String {
        if self.row.cut {
            return format!("entry {}", self.row.id.instance - 1);
        }
        let kind = match () {
            () if !self.row.is_leaf() => "node",
            () if self.row.references == 0 => "empty",
            () => "leaf",
        };
        match self.row.id.instance {
            0 => format!("{kind} {}", self.row.id.node),
            instance => format!("{kind} {} of entry {}", self.row.id.node, instance - 1),
        }
    }

    /// The same in as few letters as say it: the entry stands in brackets.
    fn brief(&self) -> String {
        let name = self.name();
        name.split_once(" of entry ").map_or_else(|| name.clone(), |(cell, entry)| format!("{cell} ({entry})"))
    }

    /// Draws it; true if it was clicked.
    fn show(&self, ui: &mut Ui, commands: &mut Commands) -> bool {
        let palette = Palette::in_ui(ui);
        let rect = ui.max_rect();
        let response = ui.interact(rect, ui.scope_id().with("row"), Sense::CLICK);
        let (references, share) = (format::count(self.row.references.into()), format::share(self.row.share));
        response.widget_info(|| {
            let visits = self.visits.map(|visits| format!(", {} visits a ray", format::number(visits))).unwrap_or_default();
            let (name, depth) = (self.name(), self.row.depth);
            let name = format!("{name}, depth {depth}, {references} triangles{visits}, {share} of the SAH cost");
            WidgetInfo::selected(Role::TreeItem, true, self.selected, name)
        });
        let fill = match () {
            () if self.selected => Some(palette.selection),
            () if response.hovered() => Some(palette.control_hovered),
            () => None,
        };
        ui.painter().rect_filled(rect, 0.0, fill.unwrap_or(palette.panel));
        let bar = Rect::from_min_size(rect.min, vec2(rect.width() * self.row.share as f32, rect.height()));
        if fill.is_none() {
            ui.painter().rect_filled(bar, 0.0, palette.stripe);
        }
        let left = rect.left() + theme::GRID + self.indent as f32 * 2.0 * theme::GRID;
        let body = TextStyle::Body.resolve(ui.style());
        if !self.row.is_leaf() {
            self.arrow(ui, pos2(left, rect.center().y), commands);
        }
        let name = pos2(left + 4.0 * theme::GRID, rect.center().y);
        let numbers = rect.right_center() - vec2(COLUMN, 0.0);
        let room = Rect::from_min_max(rect.min, pos2(numbers.x - COLUMN, rect.bottom()));
        ui.painter_at(room).text(name, Align2::LEFT_CENTER, self.brief(), body.clone(), palette.text);
        let middle = self.visits.map_or(references, format::number);
        ui.painter().text(numbers, Align2::RIGHT_CENTER, middle, body.clone(), palette.dim);
        ui.painter().text(rect.right_center(), Align2::RIGHT_CENTER, share, body, palette.text);
        if response.clicked() {
            commands.push(Command::SelectRow(self.at));
        }
        if response.double_clicked() && !self.row.is_leaf() {
            commands.push(Command::OpenRow(self.at, !self.open));
        }
        response.clicked()
    }

    /// The sign that it can be opened or closed.
    fn arrow(&self, ui: &Ui, at: Pos2, commands: &mut Commands) {
        let palette = Palette::in_ui(ui);
        let target = Rect::from_center_size(at, vec2(4.0 * theme::GRID, theme::ROW));
        let response = ui.interact(target, ui.scope_id().with("arrow"), Sense::CLICK);
        response.widget_info(|| {
            WidgetInfo::labeled(
                Role::DisclosureTriangle,
                true,
                format!("{} {}", if self.open { "Close" } else { "Open" }, self.name()),
            )
        });
        let r = theme::GRID;
        let corners = if self.open {
            vec![at + vec2(-r, -r * 0.5), at + vec2(r, -r * 0.5), at + vec2(0.0, r)]
        } else {
            vec![at + vec2(-r * 0.5, -r), at + vec2(r, 0.0), at + vec2(-r * 0.5, r)]
        };
        let color = if response.hovered() { palette.text } else { palette.dim };
        ui.painter().add(Shape::convex_polygon(corners, color, Stroke::NONE));
        if response.clicked() {
            commands.push(Command::OpenRow(self.at, !self.open));
        }
    }
}

/// Up and down, in and out, as trees are walked everywhere.
fn keys(ui: &Ui, focus: &Response, state: &State, outline: &Outline, fit: u32, commands: &mut Commands) {
    let lock = EventFilter { horizontal_arrows: true, vertical_arrows: true, ..Default::default() };
    ui.memory_mut(|m| m.set_focus_lock_filter(focus.id, lock));
    let folding = &state.tree.folding;
    let pressed = |key| ui.input(|i| i.modifiers.is_none() && i.key_pressed(key));
    // Where the selected row is hidden, keys go on from the nearest above it that is not.
    let path = outline.path(state.tree.selected.unwrap_or(0));
    let seen = path.iter().rev().find_map(|at| Some((*at, folding.height_of(*at)?)));
    let Some((at, height)) = seen else { return };
    let last = folding.visible().saturating_sub(1);
    let go = |height: u32| Command::WalkToRow(folding.row_at(height.min(last)));
    let opens = !outline.row(at).is_leaf();
    let command = match () {
        () if pressed(Key::ArrowDown) => Some(go(height + 1)),
        () if pressed(Key::ArrowUp) => Some(go(height.saturating_sub(1))),
        () if pressed(Key::PageDown) => Some(go(height.saturating_add(fit))),
        () if pressed(Key::PageUp) => Some(go(height.saturating_sub(fit))),
        () if pressed(Key::End) => Some(go(last)),
        () if pressed(Key::ArrowRight) && opens && !folding.is_open(at) => Some(Command::OpenRow(at, true)),
        () if pressed(Key::ArrowRight) && opens => Some(Command::WalkToRow(at + 1)),
        () if pressed(Key::ArrowLeft) && opens && folding.is_open(at) => Some(Command::OpenRow(at, false)),
        () if pressed(Key::ArrowLeft) => outline.parent(at).map(Command::WalkToRow),
        () => None,
    };
    commands.extend(command);
}

/// A way from the selected cell to another.
pub struct Way {
    name: &'static str,
    help: &'static str,
    key: Option<KeyboardShortcut>,
    /// The row that it leads to, if there is one.
    pub to: Option<u32>,
}

/// The ways to the parent, the child and the sibling of the selected row.
pub fn ways(state: &State) -> [Way; 3] {
    let selected = state.tree.outline.as_ref().zip(state.tree.selected);
    let parent = selected.and_then(|(outline, at)| outline.parent(at));
    let child = selected.and_then(|(outline, at)| (!outline.row(at).is_leaf()).then_some(at + 1));
    let sibling = selected.and_then(|(outline, at)| outline.sibling(at));
    let way = |name, help, key, to| Way { name, help, key, to };
    [
        way("Parent", "Select the cell around this one. Left in the tree.", None, parent),
        way("Child", "Select the first cell in this one. Right in the tree.", None, child),
        way("Sibling", "Select the next cell in the same one.", Some(SIBLING), sibling),
    ]
}

/// The buttons for them.
pub fn steps(ui: &mut Ui, state: &State, commands: &mut Commands) {
    if state.tree.outline.is_none() || state.tree.selected.is_none() {
        return;
    }
    ui.horizontal(|ui| {
        for Way { name, help, key, to } in ways(state) {
            let key = key.map(|key| format!(" ({})", actions::written(ui.ctx(), &key))).unwrap_or_default();
            if ui.add_enabled(to.is_some(), Button::new(name)).on_hover_text(format!("{help}{key}")).clicked() {
                commands.extend(to.map(Command::SelectRow));
            }
        }
        if ui.button("Frame").on_hover_text("Bring this cell into view.").clicked() {
            commands.push(Command::FrameSelected);
        }
    });
}
