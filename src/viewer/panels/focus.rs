//! Where keys go: it is seen, and it is moved from panel to panel.

use eframe::egui::accesskit::{Action, ActionRequest, TreeId};
use eframe::egui::{self, Context, Event, EventFilter, Id, Key, LayerId, Order, Rect, Response, Sense, StrokeKind, Ui};

use crate::viewer::theme::{self, Palette};

/// The ring around something that takes keys.
pub fn ring(ui: &Ui, rect: Rect) {
    ui.painter().rect_stroke(rect, 0.0, theme::focus_ring(Palette::in_ui(ui)), StrokeKind::Inside);
}

/// What had the focus, and whether keys or the program brought it there: what was pressed needs no ring.
#[derive(Clone, Copy, Default)]
struct Last {
    focused: Option<Id>,
    by_keys: bool,
    /// They have done so in the last frame.
    fresh: bool,
}

/// Where that is remembered.
fn place() -> Id {
    Id::unique("where keys go")
}

/// Draws the ring around whatever keys have brought the focus to. Comes after everything else.
pub fn show(ui: &Ui) {
    let (ctx, id) = (ui.ctx(), place());
    let focused = ctx.memory(egui::Memory::focused);
    let pressed = ctx.input(|i| i.pointer.any_down() || i.pointer.any_released());
    let mut last: Last = ui.data(|d| d.get_temp(id)).unwrap_or_default();
    last.fresh = focused != last.focused && !pressed;
    last.by_keys = (last.by_keys || last.fresh) && !pressed;
    last.focused = focused;
    if last.fresh {
        ctx.request_repaint(); // what is out of sight is scrolled to in the next frame
    }
    ui.data_mut(|d| d.insert_temp(id, last));
    let Some(widget) = focused.filter(|_| last.by_keys).and_then(|focused| ctx.read_response(focused)) else { return };
    if !widget.interact_rect.is_positive() {
        return; // scrolled out of sight
    }
    let painter = ctx.layer_painter(LayerId::new(Order::Tooltip, id));
    painter.rect_stroke(widget.interact_rect, theme::GRID, theme::focus_ring(Palette::in_ui(ui)), StrokeKind::Middle);
}

/// Scrolls to what keys have just brought the focus to, if it is in this part of the window; called inside what is scrolled,
/// after all that is in it.
pub fn keep_in_sight(ui: &Ui) {
    let last: Last = ui.data(|d| d.get_temp(place())).unwrap_or_default();
    let widget = last.focused.filter(|_| last.fresh).and_then(|focused| ui.ctx().read_response(focused));
    let here = widget.filter(|w| w.layer_id == ui.layer_id() && ui.min_rect().contains(w.rect.center()));
    if let Some(widget) = here.filter(|widget| !ui.clip_rect().contains_rect(widget.rect)) {
        ui.scroll_to_rect(widget.rect, None);
    }
}

/// Brings the focus to the first thing of the next panel that takes keys, or of the one before.
pub fn go(ctx: &Context, panels: &[(LayerId, Rect)], forward: bool) {
    let focused = ctx.memory(egui::Memory::focused).and_then(|id| ctx.read_response(id));
    let holds =
        |(layer, panel): &(LayerId, Rect), widget: &Response| *layer == widget.layer_id && panel.contains(widget.rect.center());
    let now = focused.and_then(|widget| panels.iter().position(|panel| holds(panel, &widget)));
    let first = around(now, panels.len(), forward).find_map(|panel| first_in(ctx, panels[panel]));
    if let Some(first) = first {
        ctx.memory_mut(|m| m.request_focus(first));
    }
}

/// All of so many from the one after the present one on, or backwards.
fn around(now: Option<usize>, n: usize, forward: bool) -> impl Iterator<Item = usize> {
    (0..n).map(move |k| match (now, forward) {
        (Some(at), true) => (at + 1 + k) % n,
        (Some(at), false) => (at + 2 * n - 1 - k) % n,
        (None, true) => k,
        (None, false) => n - 1 - k,
    })
}

/// The first thing in a panel that takes keys, as it was last drawn.
fn first_in(ctx: &Context, (layer, panel): (LayerId, Rect)) -> Option<Id> {
    let grab = grab(ctx);
    ctx.viewport(|viewport| {
        let mut widgets = viewport.prev_pass.widgets.get_layer(layer);
        let takes_keys = |widget: &&egui::WidgetRect| {
            let seen = widget.interact_rect.is_positive() && panel.contains(widget.interact_rect.center());
            seen && widget.enabled && widget.sense.is_focusable() && !is_divider(widget.rect, widget.sense, grab)
        };
        widgets.find(takes_keys).map(|widget| widget.id)
    })
}

/// Whether something is the edge of a panel: egui does not say which are, but nothing else that is dragged is so thin.
fn is_divider(rect: Rect, sense: Sense, grab: f32) -> bool {
    let (thin, long) = (rect.width().min(rect.height()), rect.width().max(rect.height()));
    sense.senses_drag() && thin <= 2.0 * grab + 1.0 && long >= 4.0 * theme::ROW
}

/// How far from an edge it can be grabbed, in points.
fn grab(ctx: &Context) -> f32 {
    ctx.global_style().interaction.resize_grab_radius_side
}

/// Arrow keys move the edge of a panel that has the focus, as assistive technologies do. Comes before the panels.
pub fn dividers(ctx: &Context) {
    let Some(id) = ctx.memory(egui::Memory::focused) else { return };
    let Some(edge) = ctx.read_response(id).filter(|edge| is_divider(edge.rect, edge.sense, grab(ctx))) else { return };
    let lock = EventFilter { horizontal_arrows: true, vertical_arrows: true, ..Default::default() };
    ctx.memory_mut(|m| m.set_focus_lock_filter(id, lock));
    let (middle, upright) = (ctx.content_rect().center(), edge.rect.height() > edge.rect.width());
    let [grow, shrink] = match (upright, edge.rect.center().x < middle.x) {
        (true, true) => [Key::ArrowRight, Key::ArrowLeft],
        (true, false) => [Key::ArrowLeft, Key::ArrowRight],
        (false, _) => [Key::ArrowUp, Key::ArrowDown],
    };
    let ask = |action| {
        let request = ActionRequest { action, target_tree: TreeId::ROOT, target_node: id.accesskit_id(), data: None };
        Event::AccessKitActionRequest(request)
    };
    ctx.input_mut(|i| {
        let asked =
            [(grow, Action::Increment), (shrink, Action::Decrement)].map(|(key, action)| i.key_pressed(key).then(|| ask(action)));
        i.events.extend(asked.into_iter().flatten());
    });
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn panels_are_gone_around_either_way() {
        let order = |now, forward| around(now, 4, forward).collect::<Vec<_>>();
        assert_eq!(order(None, true), [0, 1, 2, 3]);
        assert_eq!(order(None, false), [3, 2, 1, 0]);
        assert_eq!(order(Some(1), true), [2, 3, 0, 1]);
        assert_eq!(order(Some(1), false), [0, 3, 2, 1]);
        assert_eq!(around(None, 0, true).count(), 0);
    }
}
