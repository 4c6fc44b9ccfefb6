//! What the areas of the cells predict of the shown structure, beside what was counted.

use eframe::egui::{CollapsingHeader, Ui};

use super::{Commands, fact};
use crate::accel::params::{C_ISECT, C_TRAV, Kind, ParamValues};
use crate::lab::{Costs, Quality};
use crate::viewer::command::Command;
use crate::viewer::format;
use crate::viewer::kept::Built;
use crate::viewer::state::State;

/// Draws the section.
pub fn show(ui: &mut Ui, state: &State, built: &Built, commands: &mut Commands) {
    CollapsingHeader::new("Prediction").id_salt("prediction").show(ui, |ui| {
        match &built.quality {
            Some(quality) => {
                lines(ui, quality);
                overlap(ui, quality);
                end_points(ui, quality);
            }
            None => {
                ui.spinner().on_hover_text("Working out what is predicted.");
                // Nobody has looked at it before.
                if state.awaits_prediction(built) && !state.is_measuring() {
                    commands.push(Command::Predict);
                }
            }
        }
        if let Some(costs) = state.timings.costs(&built.key) {
            measured(ui, costs, &built.key.params, commands);
        }
    });
}

fn lines(ui: &mut Ui, quality: &Quality) {
    let help = "Nodes or cells that a random line through the root enters if no hit ends it: the sum of A/A_root over them.";
    fact(ui, "Nodes/line", format::number(quality.expected_nodes), help);
    let help = "Triangles that the same line is tested against: the sum over leaves of n A/A_root.";
    fact(ui, "Tests/line", format::number(quality.expected_tests), help);
    let Some(counted) = quality.lines.filter(|lines| lines.lines > 0) else { return };
    let with_error = |mean: f64, error: f64| format!("{} ±{}", format::number(mean), format::number(error));
    let help = "The same, counted for random lines; ± is the standard error. Where cells nest, the two agree.";
    fact(ui, "Nodes/line, counted", with_error(counted.nodes, counted.nodes_error), help);
    fact(ui, "Tests/line, counted", with_error(counted.tests, counted.tests_error), help);
}

fn overlap(ui: &mut Ui, quality: &Quality) {
    if let Some(overlap) = quality.overlap {
        let help =
            "Area of the boxes that two siblings share, over the areas of their parents: what is entered twice for nothing.";
        fact(ui, "Sibling overlap", format::number(overlap), help);
    }
    if let Some(empty) = quality.empty_volume {
        let help = "The share of the root's volume that no leaf with triangles claims; at least so much where leaves overlap.";
        fact(ui, "Empty space", crate::lab::format::percent(empty), help);
    }
}

fn end_points(ui: &mut Ui, quality: &Quality) {
    let Some(epo) = quality.epo else { return };
    let error = if epo.error > 0.0 { format!(" ±{}", format::number(epo.error)) } else { String::new() };
    let help = "End-point overlap: the mean cost, over all points on triangles, of nodes that hold the point but not its triangle (Aila, Karras and Laine 2013).";
    fact(ui, "EPO", format::number(epo.value) + &error, help);
    if let Some(blend) = quality.blend {
        let name = format!("SAH and EPO, alpha {}", format::number(quality.alpha));
        fact(ui, &name, format::number(blend), "(1 - alpha) SAH + alpha EPO.");
    }
}

/// What a step and a test cost here, and the way to build with that.
fn measured(ui: &mut Ui, costs: &Costs, params: &ParamValues, commands: &mut Commands) {
    let ns = |x: f64| format!("{} ns", format::number(x));
    let help = format!(
        "Fitted to the measured rays: time = C_trav nodes + C_isect tests + {}; R² is {}.",
        ns(costs.c0_ns),
        format::number(costs.r_squared)
    );
    fact(ui, "C_trav, measured", ns(costs.c_trav_ns), &help);
    fact(ui, "C_isect, measured", ns(costs.c_isect_ns), &help);
    let Some(params) = with_costs(params, costs) else { return };
    let help = "Build this structure again with C_trav 1 and C_isect as many times as much as was measured on this machine.";
    if ui.button("Use measured costs").on_hover_text(help).clicked() {
        commands.push(Command::Params(params));
    }
}

/// The parameters with the measured ratio, within their ranges; `None` if the structure has no such
/// parameters, or no ratio is known.
fn with_costs(params: &ParamValues, costs: &Costs) -> Option<ParamValues> {
    let mut params = params.clone();
    for (of, value) in [(C_TRAV, 1.0), (C_ISECT, costs.ratio()?)] {
        let (param, _) = params.iter().find(|(param, _)| param.id == of.id)?;
        let Kind::Float { min, max, .. } = param.kind else { return None };
        params.set(of.id, &format!("{:.2}", value.clamp(min, max))).ok()?;
    }
    Some(params)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accel::registry;

    #[test]
    fn measured_costs_become_parameters_within_their_ranges() {
        let bvh = registry::find("bvh").expect("registered").defaults();
        let costs = |c_trav_ns, c_isect_ns| Costs { c_trav_ns, c_isect_ns, ..Costs::default() };
        let set = with_costs(&bvh, &costs(4.0, 10.0)).expect("it has both");
        assert_eq!((set.float("c_trav"), set.float("c_isect")), (1.0, 2.5));
        let far = with_costs(&bvh, &costs(0.001, 10.0)).expect("it has both");
        assert_eq!(far.float("c_isect"), 100.0);
        assert!(with_costs(&bvh, &costs(0.0, 10.0)).is_none() && with_costs(&bvh, &costs(4.0, 0.0)).is_none());
        let brute = registry::find("brute").expect("registered").defaults();
        assert!(with_costs(&brute, &costs(4.0, 10.0)).is_none());
    }
}
