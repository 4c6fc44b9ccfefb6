//! The card of the tour: what is to be seen, and the way on. It stands in a corner of the view, which can be used meanwhile.

use eframe::egui::{Align2, Button, Id, Label, Rect, RichText, Ui, Window, vec2};

use super::{Commands, announce};
use crate::viewer::command::Command;
use crate::viewer::state::State;
use crate::viewer::theme::{self, Palette};
use crate::viewer::tour::STEPS;

/// Draws the card over the view, if somebody is on the tour.
pub fn show(ui: &Ui, view: Rect, state: &State, commands: &mut Commands) {
    let Some(tour) = &state.tour else { return };
    let (step, at) = (tour.step(), tour.at);
    let corner = view.right_top() + vec2(-theme::GUTTER, theme::GUTTER);
    let card = Window::new("Tour").id(Id::unique("tour")).title_bar(false).resizable(false);
    card.pivot(Align2::RIGHT_TOP).fixed_pos(corner).constrain_to(view).show(ui.ctx(), |ui| {
        ui.set_width(theme::TOUR_CARD);
        let dim = Palette::in_ui(ui).dim;
        ui.label(RichText::new(step.title).heading());
        ui.label(RichText::new(format!("Step {} of {}", at + 1, STEPS.len())).small().color(dim));
        let text = ui.add(Label::new(step.text).wrap());
        announce::politely(&text);
        ui.horizontal(|ui| buttons(ui, at, commands));
    });
}

fn buttons(ui: &mut Ui, at: usize, commands: &mut Commands) {
    let mut button = |text: &str, name: &str, help: &str, to: Option<Option<usize>>| {
        let button = ui.add_enabled(to.is_some(), Button::new(text)).accessible_name(name);
        if button.on_hover_text(help).clicked() {
            commands.extend(to.map(Command::Tour));
        }
    };
    button("Back", "Back in the tour", "Show the step before.", at.checked_sub(1).map(Some));
    if at + 1 < STEPS.len() {
        button("Next", "Next in the tour", "Show the next step.", Some(Some(at + 1)));
        button("Skip", "Skip the tour", "Leave the tour (Esc). Help > Tour begins it again.", Some(None));
    } else {
        button("Done", "Done with the tour", "Leave the tour (Esc). Help > Tour begins it again.", Some(None));
    }
}
