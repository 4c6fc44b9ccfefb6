//! What can be taken back: the camera's moves, and the choices of structure, parameters, selection
//! and visibility. The two histories know nothing of each other (Alt+Left/Right, Ctrl+Z).

use std::sync::Arc;
use std::time::{Duration, Instant};

use super::command::Command;
use super::panes::PaneSettings;
use super::pick::Picked;
use super::settings::{OverlaySettings, SectionSettings, Settings};
use crate::accel::Visibility;
use crate::geometry::tri::TestKind;

/// The most steps that are remembered.
const LIMIT: usize = 200;
/// Changes of one kind that follow each other faster are one step: a drag is taken back whole.
const TOGETHER: Duration = Duration::from_millis(600);

/// States that were left, and states that were gone back from.
#[derive(Debug)]
pub struct History<T> {
    behind: Vec<T>,
    ahead: Vec<T>,
    /// What kind of change was last made, and when.
    last: Option<(Kind, Instant)>,
}

/// Changes of the same kind in quick succession belong together.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// By dragging, the wheel or held keys.
    Hand,
    /// By one command, always a step of its own.
    Single,
    /// Moving a slider of a parameter.
    Params,
    /// Moving a slider of the overlay.
    Overlay,
    /// Moving the section.
    Section,
    /// Walking over rows with the arrow keys, however slowly.
    Walk,
}

impl<T> Default for History<T> {
    fn default() -> Self {
        Self { behind: Vec::new(), ahead: Vec::new(), last: None }
    }
}

impl<T> History<T> {
    /// Remembers the present state, which is about to be left by a change of some kind at `now`.
    pub fn leave(&mut self, present: T, kind: Kind, now: Instant) {
        let in_time = |at| kind == Kind::Walk || now.duration_since(at) < TOGETHER;
        let together = self.last.is_some_and(|(last, at)| last == kind && in_time(at));
        self.last = (kind != Kind::Single).then_some((kind, now));
        self.ahead.clear();
        if !together {
            if self.behind.len() == LIMIT {
                self.behind.remove(0);
            }
            self.behind.push(present);
        }
    }

    /// The state before, the present one being kept ahead.
    pub fn back(&mut self, present: T) -> Option<T> {
        let before = self.behind.pop()?;
        self.ahead.push(present);
        self.last = None;
        Some(before)
    }

    /// The state that was gone back from.
    pub fn forward(&mut self, present: T) -> Option<T> {
        let after = self.ahead.pop()?;
        self.behind.push(present);
        self.last = None;
        Some(after)
    }

    /// All of them.
    pub fn all_mut(&mut self) -> impl Iterator<Item = &mut T> {
        self.behind.iter_mut().chain(&mut self.ahead)
    }

    /// Whether there is a state before.
    pub const fn has_back(&self) -> bool {
        !self.behind.is_empty()
    }

    /// Whether there is a state ahead.
    pub const fn has_forward(&self) -> bool {
        !self.ahead.is_empty()
    }
}

/// What Ctrl+Z brings back.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Choices {
    structure: String,
    params: std::collections::BTreeMap<String, std::collections::BTreeMap<String, String>>,
    test: TestKind,
    overlay: OverlaySettings,
    #[serde(default)]
    section: SectionSettings,
    /// Pictures beside the first.
    #[serde(skip)]
    panes: PaneSettings,
    /// Which triangles are seen, if not all.
    #[serde(skip)]
    pub visible: Option<Arc<Visibility>>,
    /// The number of a set of hidden triangles of a workspace file, until that is read: then it is what is hidden.
    #[serde(skip)]
    pub hidden: Option<usize>,
    /// What is selected.
    #[serde(skip)]
    pub picked: Option<Picked>,
}

impl Choices {
    /// As they are.
    pub fn of(settings: &Settings, picked: Option<&Picked>) -> Self {
        Self {
            structure: settings.structure.clone(),
            params: settings.params.clone(),
            test: settings.test,
            overlay: settings.overlay,
            section: settings.section,
            panes: settings.panes.clone(),
            visible: settings.visible.clone(),
            hidden: None,
            picked: picked.cloned(),
        }
    }

    /// Back into the settings; the selection is the caller's.
    pub fn restore(&self, settings: &mut Settings) {
        settings.structure.clone_from(&self.structure);
        settings.params.clone_from(&self.params);
        settings.test = self.test;
        settings.overlay = self.overlay;
        settings.section = self.section;
        settings.visible.clone_from(&self.visible);
        // Dividers that were moved since stay where they are.
        let dividers = std::mem::take(&mut settings.panes.dividers);
        settings.panes = self.panes.clone();
        if settings.panes.on_screen().len() == dividers.len() {
            settings.panes.dividers = dividers;
        }
    }

    /// Takes in its set of hidden triangles, if it awaits one: those that could be read are there.
    pub fn take_hidden(&mut self, sets: &[Option<Arc<Visibility>>]) {
        if let Some(set) = self.hidden.take() {
            self.visible = sets.get(set).cloned().flatten();
        }
    }

    /// The same, with what is compared now.
    pub fn beside(self, settings: &Settings) -> Self {
        Self { panes: settings.panes.clone(), ..self }
    }

    /// The kind of change that a command makes to them, if it makes one at once.
    pub const fn changed_by(command: &Command) -> Option<Kind> {
        match command {
            Command::Structure(_) | Command::Test(_) | Command::OpenCase(_) | Command::ShowAll => Some(Kind::Single),
            Command::PutBeside(_) | Command::PutPane(..) | Command::ClosePane(_) | Command::Arrange(_) => Some(Kind::Single),
            Command::Params(_) => Some(Kind::Params),
            Command::Overlay(_) => Some(Kind::Overlay),
            Command::Section(_) => Some(Kind::Section),
            _ => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_drag_is_one_step_and_a_new_change_forgets_what_was_ahead() {
        let start = Instant::now();
        let at = |ms| start + Duration::from_millis(ms);
        let mut history = History::default();
        history.leave(0, Kind::Hand, at(0));
        history.leave(1, Kind::Hand, at(16));
        history.leave(2, Kind::Hand, at(2000));
        assert_eq!((history.back(3), history.back(2), history.back(0)), (Some(2), Some(0), None));
        assert_eq!((history.forward(0), history.forward(2)), (Some(2), Some(3)));
        assert_eq!(history.back(3), Some(2));
        history.leave(2, Kind::Single, at(2001));
        assert!(!history.has_forward() && history.has_back());
    }

    #[test]
    fn a_walk_is_one_step_at_any_pace_until_something_else_is_done() {
        let start = Instant::now();
        let at = |secs| start + Duration::from_secs(secs);
        let mut history = History::default();
        history.leave(0, Kind::Walk, at(0));
        history.leave(1, Kind::Walk, at(30));
        history.leave(2, Kind::Single, at(31));
        history.leave(3, Kind::Walk, at(32));
        assert_eq!((history.back(4), history.back(3), history.back(2), history.back(0)), (Some(3), Some(2), Some(0), None));
    }

    #[test]
    fn it_forgets_the_oldest_first() {
        let mut history = History::default();
        (0..=LIMIT).for_each(|i| history.leave(i, Kind::Single, Instant::now()));
        let oldest = std::iter::from_fn(|| history.back(0)).last();
        assert_eq!(oldest, Some(1));
    }
}
