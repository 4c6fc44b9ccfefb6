//! What is selected: the cells that hold the point that was clicked, what dividing the selected one
//! would have cost, and the steps of the ray.

use eframe::egui::{
    self, Align2, CollapsingHeader, Color32, Pos2, RichText, Role, ScrollArea, Sense, Stroke, Ui, WidgetInfo, pos2, vec2,
};

use super::{Commands, fact, heading};
use crate::accel::cell::{Cell, CellKind};
use crate::accel::{Prune, Step};
use crate::geometry::Axis;
use crate::lab::SahCurves;
use crate::viewer::command::Command;
use crate::viewer::format;
use crate::viewer::pick::Picked;
use crate::viewer::state::State;
use crate::viewer::theme::{self, Palette};

/// Draws the panel, if anything is selected.
pub fn show(ui: &mut Ui, state: &State, commands: &mut Commands) {
    let Some(picked) = &state.picked else { return };
    ui.separator();
    heading(ui, "Selection");
    if let Some(cell) = picked.selected() {
        levels(ui, picked, cell, commands);
        match &state.curves {
            Some((id, Some(curves))) if *id == cell.id => plot(ui, curves),
            Some((id, None)) if *id == cell.id => super::empty(ui, "No division to weigh: fewer than two triangles."),
            _ => drop(ui.spinner().on_hover_text("Working out what each division would cost.")),
        }
    }
    steps(ui, picked);
}

/// Which cell of the path is selected, and the way to its parent and child.
fn levels(ui: &mut Ui, picked: &Picked, cell: &Cell, commands: &mut Commands) {
    ui.horizontal(|ui| {
        let deepest = picked.path.len() - 1;
        let step = |ui: &mut Ui, possible: bool, name: &str, help: &str| {
            ui.add_enabled(possible, egui::Button::new(name)).on_hover_text(help).clicked()
        };
        if step(ui, picked.level > 0, "Parent", "Select the cell around this one.") {
            commands.push(Command::SelectLevel(picked.level - 1));
        }
        if step(ui, picked.level < deepest, "Child", "Select the next cell towards the point that was clicked.") {
            commands.push(Command::SelectLevel(picked.level + 1));
        }
    });
    let kind = match cell.kind {
        CellKind::Inner => "node".to_owned(),
        CellKind::Void => "empty space".to_owned(),
        CellKind::Leaf { prims } => format!("leaf of {}", format::count(prims.into())),
    };
    fact(
        ui,
        "Cell",
        format!("{kind} {} at depth {}", cell.id.node, cell.depth),
        "The cell that is selected, by its number and depth.",
    );
}

/// The colour and the letter of an axis.
fn axis_mark(palette: &Palette, axis: Axis) -> Color32 {
    [palette.bvh, palette.kd, palette.grid][axis.index()].color
}

/// The costs of all candidate planes, of a leaf, and of the division that was chosen.
fn plot(ui: &mut Ui, curves: &SahCurves) {
    let palette = Palette::in_ui(ui);
    let help = "The expected cost of a line through this cell if it were divided at a place along x, y or z: C_trav + C_isect (A_l n_l + A_r n_r) / A. The dashed line is the cost of a leaf; the ring is the division that was chosen.";
    let chosen = curves.chosen.map(|c| c.cost);
    let costs = || curves.axes.iter().flatten().map(|c| c.1).chain(chosen);
    let least = costs().fold(f64::INFINITY, f64::min).min(curves.leaf);
    let most = costs().fold(0.0, f64::max).max(curves.leaf);
    let (rect, response) = ui.allocate_exact_size(vec2(ui.available_width(), 5.0 * theme::ROW), Sense::hover());
    response.widget_info(|| WidgetInfo::labeled(Role::Image, true, "SAH cost over candidate planes"));
    response.on_hover_text(help);
    let painter = ui.painter_at(rect);
    painter.rect_filled(rect, 0.0, palette.background);
    let span = (most - least).max(f64::MIN_POSITIVE);
    let inner = rect.shrink(theme::GRID);
    let at = |place: f64, cost: f64| -> Pos2 {
        let y = ((cost - least) / span) as f32;
        pos2(inner.left() + inner.width() * place as f32, inner.bottom() - inner.height() * y)
    };
    for (axis, curve) in Axis::ALL.into_iter().zip(&curves.axes) {
        let points: Vec<Pos2> = curve.iter().map(|(place, cost)| at(*place, *cost)).collect();
        painter.line(points, Stroke::new(theme::CURVE, axis_mark(palette, axis)));
    }
    let leaf = [at(0.0, curves.leaf), at(1.0, curves.leaf)];
    painter.extend(egui::Shape::dashed_line(&leaf, Stroke::new(1.0, palette.dim), theme::GRID, theme::GRID));
    if let Some(chosen) = &curves.chosen {
        let place = chosen.plane.map_or(0.5, |p| p.1);
        let color = chosen.plane.map_or(palette.text, |p| axis_mark(palette, p.0));
        painter.circle_stroke(at(place, chosen.cost), theme::GRID, Stroke::new(theme::CURVE, color));
    }
    for (k, axis) in Axis::ALL.into_iter().enumerate() {
        let at = inner.right_top() - vec2((2 - k) as f32 * theme::GUTTER * 1.5, 0.0);
        painter.text(at, Align2::RIGHT_TOP, axis.name(), egui::TextStyle::Small.resolve(ui.style()), axis_mark(palette, axis));
    }
    fact(ui, "Triangles", format::count(curves.triangles as u64), "Triangles below this cell, each counted once.");
    fact(ui, "Cost of a leaf", format::number(curves.leaf), "What testing all of them would cost a line through this cell.");
    if let Some(chosen) = &curves.chosen {
        let along = chosen.plane.map(|p| format!(", across {}", p.0.name())).unwrap_or_default();
        fact(
            ui,
            "Chosen",
            format!("{}{along}", format::number(chosen.cost)),
            "What the division that was chosen costs by the same measure.",
        );
    }
    let best = costs().fold(f64::INFINITY, f64::min);
    if best.is_finite() {
        fact(ui, "Cheapest", format::number(best), "The least cost of all candidates on the three axes.");
    }
}

/// What the ray of the click did, with the reason for each cell that it left out.
fn steps(ui: &mut Ui, picked: &Picked) {
    if picked.steps.is_empty() {
        return;
    }
    let count = format::count(picked.steps.len() as u64);
    let title = format!("Steps of this ray ({count}{})", if picked.more_steps { " and more" } else { "" });
    CollapsingHeader::new(title).id_salt("steps").show(ui, |ui| {
        let height = ui.text_style_height(&egui::TextStyle::Small) + ui.spacing().item_spacing.y;
        let area = ScrollArea::vertical().id_salt("step list").max_height(10.0 * theme::ROW).auto_shrink([false, true]);
        area.show_rows(ui, height, picked.steps.len(), |ui, rows| {
            for (i, step) in rows.clone().zip(&picked.steps[rows]) {
                let text = RichText::new(format!("{}  {}", i + 1, sentence(step))).small();
                ui.add(egui::Label::new(text).truncate());
            }
        });
    });
}

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
