//! What stands below a list that shall keep its room: as high as it is, but never more than half of the height.

use eframe::egui::{Frame, Id, Panel, ScrollArea, Ui};

use super::focus;

/// The part of the height that it takes at most.
const MOST: f32 = 0.5;

/// Draws it at the bottom.
pub fn show(ui: &mut Ui, id: Id, content: impl FnOnce(&mut Ui)) {
    // How high the content is was found out in the last frame.
    let place = id.with("content");
    let known: Option<f32> = ui.data(|d| d.get_temp(place));
    let most = (MOST * ui.available_height()).floor();
    let height = known.unwrap_or(most).min(most);
    let panel = Panel::bottom(id).frame(Frame::NONE).resizable(false).exact_size(height);
    let drawn = panel.show(ui, |ui| {
        let scroll = ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
            content(ui);
            focus::keep_in_sight(ui);
        });
        scroll.content_size.y.ceil()
    });
    if known != Some(drawn.inner) {
        ui.data_mut(|d| d.insert_temp(place, drawn.inner));
        ui.ctx().request_repaint();
    }
}
