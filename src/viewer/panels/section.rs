//! The plane that cuts the model open for the camera.

use eframe::egui::{CollapsingHeader, Slider, Ui};

use super::Commands;
use crate::geometry::Axis;
use crate::viewer::command::Command;
use crate::viewer::state::State;
use crate::viewer::theme;

/// What is cut and what is not.
const HELP: &str = "Cut away what is on one side of a plane, for rays of the camera and the preview; boxes that lie wholly there are \
                    not drawn. Rays that leave what they meet, for shadows, openness and light, see the whole model, and so do \
                    the rays that are measured.";

/// The width of the slider.
const SLIDER: f32 = 18.0 * theme::GRID;

/// Draws the panel, where there is a model.
pub fn show(ui: &mut Ui, state: &State, commands: &mut Commands) {
    if state.model.is_none() {
        return;
    }
    let before = state.settings.section;
    let mut s = before;
    CollapsingHeader::new("Section").id_salt("section").default_open(before.on).show(ui, |ui| {
        ui.checkbox(&mut s.on, "Cut the model open").on_hover_text(HELP);
        ui.add_enabled_ui(s.on, |ui| {
            ui.horizontal_wrapped(|ui| {
                ui.label("Across");
                for axis in Axis::ALL {
                    ui.radio_value(&mut s.at.axis, axis, axis.name())
                        .on_hover_text(format!("The plane is perpendicular to {}.", axis.name()));
                }
                let help = "Leave the side that is cut away now, and cut away the other.";
                if ui.button("Flip").on_hover_text(help).clicked() {
                    s.at.side = s.at.side.other();
                }
            });
            ui.spacing_mut().slider_width = SLIDER;
            let slider = Slider::new(&mut s.at.place, 0.0..=1.0).fixed_decimals(3).text("place");
            ui.add(slider).on_hover_text("Where the plane is, from 0 to 1 of the model's bounds.");
        });
    });
    if s != before {
        commands.push(Command::Section(s));
    }
}
