//! Everything that can be done in the window, by name: what the palette searches, the keys do, and the page of keys lists.

mod boxes;
mod compare;
mod file;
mod keys;
mod measure;
mod node;
mod ray;
mod running;
mod structure;
mod view;
mod window;

pub use keys::*;
pub use running::running;

use std::borrow::Cow;

use eframe::egui::KeyboardShortcut;

use super::command::Command;
use super::state::State;

/// One thing that can be done.
#[derive(Clone, Debug)]
pub struct Action {
    /// What it belongs to.
    pub group: &'static str,
    /// What it does.
    pub name: Cow<'static, str>,
    /// Keys that do it.
    pub keys: Vec<KeyboardShortcut>,
    /// What is sent for it.
    pub command: Command,
    /// Whether there is anything to do now.
    pub possible: bool,
}

/// Collects actions.
struct List {
    group: &'static str,
    all: Vec<Action>,
}

impl List {
    fn add(&mut self, name: impl Into<Cow<'static, str>>, command: Command) -> &mut Action {
        let action = Action { group: self.group, name: name.into(), keys: Vec::new(), command, possible: true };
        self.all.push(action);
        let last = self.all.len() - 1;
        &mut self.all[last]
    }
}

impl Action {
    fn key(&mut self, key: KeyboardShortcut) -> &mut Self {
        self.keys.push(key);
        self
    }

    fn if_possible(&mut self, possible: bool) -> &mut Self {
        self.possible = possible;
        self
    }
}

/// Adds the actions of a group.
type Adds = fn(&mut List, &State);

/// All of them, as things are.
pub fn all(state: &State) -> Vec<Action> {
    let mut list = List { group: "File", all: Vec::new() };
    file::add(&mut list, state);
    list.group = "Edit";
    list.add("Undo", Command::Undo).key(UNDO).if_possible(state.can_undo());
    list.add("Redo", Command::Redo).key(REDO).if_possible(state.can_redo());
    let groups: [(&'static str, Adds); 9] = [
        ("View", view::add),
        ("Boxes", boxes::add),
        ("Structure", structure::add),
        ("Film", structure::film),
        ("Cell", node::add),
        ("Ray", ray::add),
        ("Compare", compare::add),
        ("Measure", measure::add),
        ("Window", window::add),
    ];
    for (group, add) in groups {
        list.group = group;
        add(&mut list, state);
    }
    list.group = "Stop";
    for (on, name, command) in running(state) {
        list.add(name, command).if_possible(on);
    }
    let lab = state.checks.running.is_some();
    list.add("Stop the stability lab", Command::CancelLab).if_possible(lab);
    list.all
}

/// How well a name fits what was typed: less is better, `None` if its letters do not come up in that order. Letters that begin
/// words, and those that follow each other, fit best.
pub fn fit(name: &str, typed: &str) -> Option<u32> {
    let letters: Vec<char> = name.chars().flat_map(char::to_lowercase).collect();
    let (mut cost, mut at, mut last) = (0, 0, None);
    for wanted in typed.chars().flat_map(char::to_lowercase).filter(|c| !c.is_whitespace()) {
        let begins = |i: usize| i == 0 || !letters[i - 1].is_alphanumeric();
        let next = letters[at..].iter().position(|c| *c == wanted).map(|i| at + i)?;
        // The beginning of a later word is as good as what comes next.
        let word = (at..letters.len()).find(|i| letters[*i] == wanted && begins(*i));
        let follows = last.is_some_and(|last: usize| next == last + 1);
        let chosen = if follows { next } else { word.unwrap_or(next) };
        cost += if follows || begins(chosen) { 0 } else { 4 };
        cost += u32::try_from(chosen - at).unwrap_or(u32::MAX).min(8);
        (at, last) = (chosen + 1, Some(chosen));
    }
    Some(cost * 64 + u32::try_from(letters.len()).unwrap_or(63).min(63))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_fit_by_words_and_letters() {
        let best = |typed: &str, names: &[&'static str]| {
            names.iter().filter_map(|name| Some((fit(name, typed)?, *name))).min().map(|best| best.1)
        };
        let names =
            ["Open…", "Open a path…", "Show k-d tree", "Show BVH", "Measure all structures", "Check this model", "Look: dark"];
        for (typed, expected) in [
            ("open", "Open…"),
            ("path", "Open a path…"),
            ("kd", "Show k-d tree"),
            ("bvh", "Show BVH"),
            ("mas", "Measure all structures"),
            ("ctm", "Check this model"),
            ("DARK", "Look: dark"),
        ] {
            assert_eq!(best(typed, &names), Some(expected), "{typed}");
        }
        assert_eq!(best("xyz", &names), None);
        assert!(names.iter().all(|name| fit(name, "").is_some()));
    }
}
