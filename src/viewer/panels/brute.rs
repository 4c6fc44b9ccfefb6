//! A part of the picture compared with brute force: which, how far that is, and what it found.

use eframe::egui::{Button, DragValue, Label, ProgressBar, RichText, Ui};

use super::{Commands, empty, heading};
use crate::lab::{BruteCheck, PixelRect};
use crate::viewer::brute::SECS;
use crate::viewer::command::Command;
use crate::viewer::format;
use crate::viewer::state::State;
use crate::viewer::theme::Palette;

/// What is compared.
const HELP: &str = "Trace the rays through the middles of pixels through the shown structure and by brute force, against every \
                    triangle, and compare the hits to the bit.";

/// Draws the panel, where the shown structure is another one than brute force.
pub fn show(ui: &mut Ui, state: &State, commands: &mut Commands) {
    let brute = &state.brute;
    if !state.can_compare_with_brute_force() && brute.running.is_none() && brute.found.is_none() {
        return;
    }
    ui.separator();
    heading(ui, "Check with brute force");
    if let Some((job, start)) = &brute.running {
        let fraction = job.progress.snapshot().fraction.unwrap_or(0.0);
        ui.add(ProgressBar::new(fraction).text(running(fraction, start.elapsed().as_secs_f64())));
        if ui.button("Stop comparing").on_hover_text("Stop tracing by brute force.").clicked() {
            commands.push(Command::CancelBrute);
        }
        return;
    }
    ui.add_enabled_ui(state.can_compare_with_brute_force(), |ui| {
        ui.horizontal_wrapped(|ui| {
            let button = ui.add(Button::selectable(brute.marking, "Mark a rectangle"));
            if button.on_hover_text(format!("{HELP} Drag the rectangle in the view.")).clicked() {
                commands.push(Command::MarkRectangle(!brute.marking));
            }
            let help = format!("{HELP} All pixels of the view, or as many as fit into {SECS} s, spread over it.");
            if ui.button("Check the whole view").on_hover_text(help).clicked() {
                commands.push(Command::CheckByBrute(None));
            }
        });
    });
    match &brute.found {
        _ if brute.marking => empty(ui, "Drag a rectangle in the view. Esc ends it."),
        Some(found) => result(ui, found, brute.next, commands),
        None => empty(ui, "Nothing compared in this view."),
    }
    ui.add_enabled_ui(state.can_compare_with_brute_force(), |ui| typed(ui, state.size_px, commands));
}

/// A rectangle of a view of that size by its numbers, and the button that compares it.
fn typed(ui: &mut Ui, [width, height]: [u32; 2], commands: &mut Commands) {
    let id = ui.scope_id().with("typed rectangle");
    let middle = [width / 4, height / 4, width / 2, height / 2];
    // Until something is typed it is the middle of the view, however large that is.
    let before: [u32; 4] = ui.data(|d| d.get_temp(id)).unwrap_or(middle);
    let [mut x, mut y, mut across, mut down] = before;
    ui.horizontal_wrapped(|ui| {
        let mut field = |value: &mut u32, (least, most): (u32, u32), prefix: &str, name: &str, help: &str| {
            // What was typed for a larger view ends with this one.
            *value = (*value).min(most).max(least);
            let field = ui.add(DragValue::new(value).range(least..=most.max(least)).prefix(prefix));
            field.accessible_name(name).on_hover_text(help);
        };
        field(&mut x, (0, width.saturating_sub(1)), "x ", "Left of the rectangle", "Its first column of pixels, from 0.");
        field(&mut y, (0, height.saturating_sub(1)), "y ", "Top of the rectangle", "Its first row of pixels, from 0 at the top.");
        let (columns, rows) = (width.saturating_sub(x), height.saturating_sub(y));
        field(&mut across, (1, columns), "w ", "Width of the rectangle", "Columns of pixels.");
        field(&mut down, (1, rows), "h ", "Height of the rectangle", "Rows of pixels.");
        if ui.button("Check these pixels").on_hover_text(HELP).clicked() {
            commands.push(Command::CheckByBrute(Some(PixelRect { at: [x, y], size: [across, down] })));
        }
    });
    let now = [x, y, across, down];
    if now != before {
        ui.data_mut(|d| d.insert_temp(id, now));
    }
}

/// How far it is, and how long all would take.
fn running(fraction: f32, secs: f64) -> String {
    // At the start nothing can be said.
    if fraction <= 0.0 || secs < 0.5 {
        return "Comparing".to_owned();
    }
    let all = secs / f64::from(fraction);
    let ends = if all > SECS { format!(", ends after {SECS} s") } else { String::new() };
    format!("{} of about {}{ends}", format::percent(fraction.into()), format::duration(all))
}

fn result(ui: &mut Ui, found: &BruteCheck, next: usize, commands: &mut Commands) {
    let palette = Palette::in_ui(ui);
    let color = if found.unlike > found.rounded { palette.fail } else { palette.text };
    ui.add(Label::new(RichText::new(in_words(found)).color(color)).wrap());
    if found.examples.is_empty() {
        return;
    }
    let which = format!("Follow ray {} of {}", next + 1, found.examples.len());
    let help = "Show the ray of the next pixel that differs step by step, with brute force beside it. A click on a marked pixel \
                does the same.";
    if ui.button(which).on_hover_text(help).clicked() {
        commands.push(Command::FollowUnlike(next));
    }
}

/// `1 204 pixels: all hits equal`.
pub fn in_words(found: &BruteCheck) -> String {
    let done = match found.pixels == found.all {
        true => format!("{} pixels", format::count(found.pixels)),
        false => {
            let (pixels, all) = (format::count(found.pixels), format::count(found.all));
            format!("{pixels} of {all} pixels done in {}", format::duration(found.secs))
        }
    };
    if found.unlike == 0 {
        return format!("{done}: all hits equal");
    }
    let mut parts = vec![format!("{} differ", format::count(found.unlike))];
    if found.unlike > found.one_sided {
        parts.push(format!("in t by {} at most", format::error(found.largest.into())));
    }
    if found.one_sided > 0 {
        parts.push(format!("{} are hit in one alone", format::count(found.one_sided)));
    }
    if found.rounded > 0 {
        parts.push(format!("rounding explains {}", format::count(found.rounded)));
    }
    format!("{done}: {}", parts.join(", "))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn results_are_said_in_words() {
        let found = BruteCheck { pixels: 1204, all: 1204, ..BruteCheck::default() };
        assert_eq!(in_words(&found), format!("{} pixels: all hits equal", format::count(1204)));
        let found = BruteCheck { all: 4000, secs: 20.0, unlike: 3, rounded: 2, one_sided: 1, largest: 0.25, ..found };
        let words = in_words(&found);
        assert!(words.starts_with(&format!("{} of {} pixels done in ", format::count(1204), format::count(4000))), "{words}");
        assert!(
            words.contains(": 3 differ, in t by ") && words.ends_with(", 1 are hit in one alone, rounding explains 2"),
            "{words}"
        );
        assert!(running(0.5, 2.0).contains("of about 4.00"));
        assert!(running(0.01, 1.0).ends_with("ends after 20 s"));
    }
}
