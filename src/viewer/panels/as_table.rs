//! Plots as tables, for those who read figures rather than marks.

use eframe::egui::{Grid, Id, RichText, ScrollArea, Ui};

use crate::viewer::theme::Palette;

/// The box that chooses between a plot and its table; `name` is what is plotted. The choice lasts as long as the window.
pub fn choice(ui: &mut Ui, name: &str) -> bool {
    let id = Id::unique(("as table", name));
    let mut chosen = ui.data(|d| d.get_temp(id)).unwrap_or(false);
    let help = "Figures in rows instead of marks.";
    let changed = ui.checkbox(&mut chosen, "Show as table").accessible_name(format!("Show as table: {name}")).on_hover_text(help);
    if changed.changed() {
        ui.data_mut(|d| d.insert_temp(id, chosen));
    }
    chosen
}

/// The table: what columns hold, and the rows.
pub fn show<const N: usize>(ui: &mut Ui, name: &str, heads: [&str; N], rows: impl IntoIterator<Item = [String; N]>) {
    let dim = Palette::in_ui(ui).dim;
    ScrollArea::horizontal().id_salt(("table", name)).show(ui, |ui| {
        Grid::new(("table", name)).num_columns(N).striped(true).show(ui, |ui| {
            for head in heads {
                ui.label(RichText::new(head).small().color(dim));
            }
            ui.end_row();
            for row in rows {
                for text in row {
                    ui.label(text);
                }
                ui.end_row();
            }
        });
    });
}
