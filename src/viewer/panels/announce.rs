//! What screen readers say by themselves when it changes.

use eframe::egui::accesskit::Live;
use eframe::egui::{Id, Rect, Response, Role, Sense, Ui, WidgetInfo, vec2};

use crate::viewer::state::State;

/// Said once nothing else is being said.
pub fn politely(response: &Response) {
    set(response, Live::Polite);
}

/// Said at once.
pub fn at_once(response: &Response) {
    set(response, Live::Assertive);
}

fn set(response: &Response, live: Live) {
    response.ctx.accesskit_node_builder(response.id, |node| node.set_live(live));
}

/// What was going on, and what was said of it.
#[derive(Clone, Default)]
struct Said {
    doing: Option<String>,
    /// The message that stood there already when it began.
    before: Option<String>,
    text: String,
}

/// Says what begins, what has ended and what has failed, not how far it is; `doing` is what is going on.
pub fn progress(ui: &mut Ui, state: &State, doing: Option<&str>) {
    let id = Id::unique("what is going on");
    let mut said: Said = ui.data(|d| d.get_temp(id)).unwrap_or_default();
    if said.doing.as_deref() != doing {
        let failed = state.error.as_deref().filter(|error| said.before.as_deref() != Some(error));
        said.text = sentence(said.doing.as_deref(), doing, failed);
        said.doing = doing.map(str::to_owned);
        said.before.clone_from(&state.error);
        ui.data_mut(|d| d.insert_temp(id, said.clone()));
    }
    if said.text.is_empty() {
        return;
    }
    // It is heard, not seen.
    let response = ui.interact(Rect::from_min_size(ui.max_rect().min, vec2(1.0, 1.0)), id, Sense::hover());
    response.widget_info(|| WidgetInfo::labeled(Role::Status, true, &said.text));
    politely(&response);
}

fn sentence(before: Option<&str>, now: Option<&str>, error: Option<&str>) -> String {
    let failed = error.map(|error| error.trim_end_matches('.'));
    match (before, now, failed) {
        (_, Some(now), _) => now.to_owned(),
        (Some(before), None, Some(why)) => format!("{before} has failed: {why}"),
        (Some(before), None, None) => format!("{before} has ended"),
        (None, None, _) => String::new(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn starts_ends_and_failures_are_said() {
        assert_eq!(sentence(None, Some("Loading"), None), "Loading");
        assert_eq!(sentence(Some("Loading"), Some("Building BVH"), None), "Building BVH");
        assert_eq!(sentence(Some("Building BVH"), None, None), "Building BVH has ended");
        assert_eq!(sentence(Some("Loading"), None, Some("Can't open x.")), "Loading has failed: Can't open x");
    }
}
