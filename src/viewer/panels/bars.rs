//! A small histogram: bars, with the figures in the tooltip and for screen readers.

use eframe::egui::{Color32, Rect, Role, Sense, Ui, WidgetInfo, pos2, vec2};

use crate::viewer::format;
use crate::viewer::theme::{self, Palette};

/// Draws counts as bars, `name`d for those who cannot see them. `label` names the `i`-th bar.
pub fn show(ui: &mut Ui, name: &str, counts: &[u64], color: Color32, label: impl Fn(usize) -> String) {
    let size = vec2(ui.available_width(), 2.0 * theme::ROW);
    let (rect, response) = ui.allocate_exact_size(size, Sense::hover());
    response.widget_info(|| WidgetInfo::labeled(Role::Image, true, name));
    let most = counts.iter().copied().max().unwrap_or(0).max(1);
    let width = rect.width() / counts.len().max(1) as f32;
    let bar = |i: usize| {
        let x = rect.left() + i as f32 * width;
        let height = (counts[i] as f64 / most as f64) as f32 * rect.height();
        // A count other than zero is never invisible.
        let height = if counts[i] > 0 { height.max(1.0) } else { 0.0 };
        Rect::from_min_max(pos2(x + 0.5, rect.bottom() - height), pos2(x + width.max(1.5) - 0.5, rect.bottom()))
    };
    let painter = ui.painter();
    painter.hline(rect.x_range(), rect.bottom(), (1.0, Palette::in_ui(ui).line));
    for i in (0..counts.len()).filter(|i| counts[*i] > 0) {
        painter.rect_filled(bar(i), 0.0, color);
    }
    let under = response.hover_pos().map(|p| ((p.x - rect.left()) / width).max(0.0) as usize);
    if let Some(i) = under.filter(|i| *i < counts.len()) {
        let text = format!("{}: {}", label(i), format::count(counts[i]));
        response.on_hover_text_at_pointer(text);
    }
}
