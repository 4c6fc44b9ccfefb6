//! Beside the curves of errors: what the reference is, and the picture of the point that was clicked.

use eframe::egui::{Label, Ui};

use super::{Commands, empty, fact, heading};
use crate::lab::Metric;
use crate::viewer::command::Command;
use crate::viewer::format;
use crate::viewer::state::State;

/// Draws the panel.
pub fn show(ui: &mut Ui, state: &State, commands: &mut Commands) {
    heading(ui, "Reference");
    match &state.errors.reference {
        Some(reference) => {
            let facts = &reference.facts;
            fact(ui, "Samples", format::count(facts.spp.into()), "In each pixel, half of them of each of two seeds.");
            fact(
                ui,
                "Its own noise",
                format::error(facts.noise),
                "The root mean squared difference of its halves, divided by 2.",
            );
        }
        None => empty(ui, "None yet. Without one, errors are estimated from the spread of the samples."),
    }
    heading(ui, "Picture of a point");
    picture(ui, state, commands);
    heading(ui, "Curves");
    let last = |live: &crate::viewer::errors::Live| live.shots.last().map(|shot| (shot.samples, shot.secs));
    for live in &state.errors.curves {
        let Some((samples, secs)) = last(live) else { continue };
        let figures = format!("{} spp, {}", format::count(samples.into()), format::duration(secs));
        let built = format::duration(live.build_secs);
        fact(ui, live.key.entry.short, figures, &format!("Built in {built}; the curve begins after that."));
    }
    empty(
        ui,
        "Curves are those of the path traced picture: choose another structure to add its curve. Moving the camera begins anew.",
    );
    heading(ui, "Measures");
    empty(ui, "Of a value v and the reference's r, over all pixels and linear red, green and blue.");
    for metric in Metric::ALL.into_iter().filter(|metric| *metric != Metric::Flip) {
        ui.add(Label::new(format!("{}: {}", metric.label(), metric.formula())).wrap());
    }
}

fn picture(ui: &mut Ui, state: &State, commands: &mut Commands) {
    let errors = &state.errors;
    let Some(chosen) = errors.chosen else {
        empty(ui, "Click a point of a curve to see the picture of that moment.");
        return;
    };
    let live = &errors.curves[chosen.curve];
    let samples = |point: usize| format::count(live.shots[point].samples.into());
    fact(ui, "Point", format!("{}, {} spp", live.key.entry.short, samples(chosen.point)), "What was clicked.");
    if chosen.kept != chosen.point {
        let why = format!("The memory budget had no room for that picture: this is the one of {} spp.", samples(chosen.kept));
        empty(ui, &why);
    }
    let mut difference = chosen.difference;
    let box_ = ui.add_enabled(errors.reference.is_some(), eframe::egui::Checkbox::new(&mut difference, "Difference"));
    let help = "The picture's brightness less the reference's: blue where it is too dark, orange where it is too bright.";
    if box_.on_hover_text(help).on_disabled_hover_text("There is no reference to differ from.").changed() {
        commands.push(Command::Shot(Some((chosen.curve, chosen.point)), difference));
    }
    if ui.button("Back to the present picture").clicked() {
        commands.push(Command::Shot(None, false));
    }
}
