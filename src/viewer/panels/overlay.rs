//! Which boxes and planes are drawn over the picture.

use eframe::egui::{Checkbox, ComboBox, DragValue, Slider, Ui};

use super::{Commands, heading};
use crate::accel::cell::Layout;
use crate::viewer::command::Command;
use crate::viewer::settings::{BoxColor, Levels, OverlaySettings};
use crate::viewer::state::State;

/// Draws the panel.
pub fn show(ui: &mut Ui, state: &State, commands: &mut Commands) {
    heading(ui, "Overlay");
    let Some(layout) = state.layout() else {
        super::empty(ui, "Boxes appear once a structure is built.");
        return;
    };
    let before = state.settings.overlay;
    let mut s = before;
    // A film of the build says which cells are drawn.
    let chosen = state.film_on_screen().is_none();
    match layout {
        Layout::Flat { resolution: [x, y, z], .. } => {
            ui.checkbox(&mut s.boxes, "Cells").on_hover_text("Boxes of the cells that hold triangles.");
            ui.checkbox(&mut s.empty_cells, "Empty cells too")
                .on_hover_text("Cells without triangles: a ray steps through them all the same.");
            ui.label(format!("{x} × {y} × {z} cells")).on_hover_text("Cells along x, y and z. A grid has no depth.");
        }
        Layout::Hierarchy | Layout::SplitHierarchy | Layout::Partition | Layout::Nested { .. } => {
            let boxes = if layout.nests() { "Node boxes" } else { "Cells" };
            ui.checkbox(&mut s.boxes, boxes).on_hover_text("The box, or the volume, of each node at the chosen depth.");
            let leaves_only = Checkbox::new(&mut s.leaves_only, "Leaves only");
            ui.add_enabled(chosen, leaves_only).on_hover_text("The boxes that hold triangles, at any depth.");
            if has_split_planes(state) {
                ui.checkbox(&mut s.planes, "Split planes").on_hover_text("The planes that divide the cells at the chosen depth.");
            }
            if has_empty_cells(state) {
                ui.checkbox(&mut s.empty_cells, "Empty cells too").on_hover_text("Leaves without triangles.");
            }
            let deepest = super::toolbar::deepest(state);
            let mut range = s.from_depth < s.depth;
            let depths = ui.add_enabled(chosen, Checkbox::new(&mut range, "Range of depths"));
            if depths.on_hover_text("Every level from the first to the chosen one.").changed() {
                s = ranged(s, range, deepest);
            }
            if range {
                ui.add_enabled(chosen, Slider::new(&mut s.from_depth, 0..=s.depth).text("from"));
            }
        }
    }
    if has_levels(state) {
        ui.horizontal(|ui| {
            let label = ui.label("Levels");
            let combo = ComboBox::from_id_salt("levels").selected_text(s.levels.label()).show_ui(ui, |ui| {
                for levels in Levels::ALL {
                    ui.selectable_value(&mut s.levels, levels, levels.label());
                }
            });
            let help = "Meshes that stand in several places have a tree each, below an upper one: which are drawn, and from which \
                        root the depth counts.";
            combo.response.labelled_by(label.id).on_hover_text(help);
        });
    }
    let subtree_only = Checkbox::new(&mut s.subtree_only, "Selected cell only");
    ui.add_enabled(chosen, subtree_only).on_hover_text("Draw the boxes in the selected cell alone.");
    ui.horizontal(|ui| {
        let label = ui.label("Colour");
        let combo = ComboBox::from_id_salt("box color").selected_text(s.color.label()).show_ui(ui, |ui| {
            for color in BoxColor::ALL {
                ui.selectable_value(&mut s.color, color, color.label());
            }
        });
        combo.response.labelled_by(label.id).on_hover_text("What the colours of boxes stand for.");
    });
    ui.checkbox(&mut s.hidden_lines, "Hidden lines").on_hover_text("Lines behind the surface, thin and dashed.");
    ui.horizontal(|ui| {
        let label = ui.label("Drawn from");
        let help = "Where boxes begin, from the left side of the view: what is before that is the picture alone, to hold it against the boxes.";
        let begin = DragValue::new(&mut s.begin).range(0..=99).suffix(" %");
        ui.add_enabled(!state.is_comparing(), begin).labelled_by(label.id).on_hover_text(help);
    });
    if s != before {
        commands.push(Command::Overlay(s));
    }
}

/// Whether the scene has two levels.
pub fn has_levels(state: &State) -> bool {
    state.shown.as_ref().is_some_and(|b| b.accel.levels().is_some())
}

/// A range of depths that ends at the one that is drawn, or that one alone.
pub fn ranged(now: OverlaySettings, range: bool, deepest: u32) -> OverlaySettings {
    match (range, now.depth) {
        (false, depth) => OverlaySettings { from_depth: depth, ..now },
        (true, 0) => OverlaySettings { from_depth: 0, depth: deepest.min(1), ..now },
        (true, depth) => OverlaySettings { from_depth: depth - 1, ..now },
    }
}

/// Whether cells are divided by one plane each, which can be drawn: an octree's are not. A tree that
/// is one leaf does not say how it would divide.
pub fn has_split_planes(state: &State) -> bool {
    let root = state.shown.as_ref().filter(|b| b.accel.layout() == Layout::Partition).map(|b| b.accel.root());
    root.is_some_and(|root| root.is_leaf() || root.split.is_some())
}

/// Whether there may be cells without triangles: where cells divide space.
pub fn has_empty_cells(state: &State) -> bool {
    state.layout().is_some_and(|layout| !layout.nests())
}
