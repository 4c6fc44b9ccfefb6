//! Pictures beside that of the shown structure, of the same view: which there are, and how they stand. The shown one is A.

use std::collections::BTreeMap;

use super::kept::Key;
use super::settings::Settings;
use crate::accel::params::ParamValues;
use crate::accel::registry::{self, Entry};
use crate::geometry::tri::TestKind;
use crate::render::Mode;
use crate::render::progressive::Pause;

/// Pictures beside each other, that of the shown structure among them, at most.
pub const MOST: usize = 4;
/// What they are called.
pub const LETTERS: [&str; MOST] = ["A", "B", "C", "D"];

/// How pictures stand beside each other.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub enum Arrange {
    /// Strips of one view.
    #[default]
    Divider,
    /// Two whole views.
    Two,
    /// Four of them, in two rows.
    Four,
}

impl Arrange {
    /// All, in the order of menus.
    pub const ALL: [Self; 3] = [Self::Divider, Self::Two, Self::Four];

    /// The name in menus.
    pub const fn label(self) -> &'static str {
        match self {
            Self::Divider => "Divider",
            Self::Two => "Two panes",
            Self::Four => "Four panes",
        }
    }

    /// One sentence for the user.
    pub const fn help(self) -> &'static str {
        match self {
            Self::Divider => "One view in strips, a structure each, with dividers between them.",
            Self::Two => "The whole view twice, through two structures; both follow the camera.",
            Self::Four => "The whole view four times, through up to four structures; all follow the camera.",
        }
    }

    /// Pictures that it has room for.
    pub const fn most(self) -> usize {
        match self {
            Self::Two => 2,
            Self::Divider | Self::Four => MOST,
        }
    }
}

impl std::str::FromStr for Arrange {
    type Err = String;

    fn from_str(s: &str) -> Result<Self, String> {
        match s {
            "divider" => Ok(Self::Divider),
            "two" => Ok(Self::Two),
            "four" => Ok(Self::Four),
            _ => Err(format!("there is no arrangement '{s}': use divider, two or four")),
        }
    }
}

/// What a picture shows.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub enum Shows {
    /// The same as A.
    #[default]
    Same,
    /// Something else of the hits.
    Mode(Mode),
    /// What rays do more in A than here, and less, where A shows such amounts.
    Difference,
}

/// What stands in a pane beside A.
#[derive(Clone, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(default)]
pub struct PaneChoice {
    /// The structure's id.
    pub structure: String,
    /// Its parameters that differ from their defaults.
    pub params: BTreeMap<String, String>,
    /// The triangle test.
    pub test: TestKind,
    /// What is shown.
    pub shows: Shows,
}

impl PaneChoice {
    /// A structure with the parameters that are remembered of it, showing what A does.
    pub fn of(entry: &Entry, settings: &Settings) -> Self {
        let params = settings.params.get(entry.id).cloned().unwrap_or_default();
        Self { structure: entry.id.to_owned(), params, test: settings.test, shows: Shows::Same }
    }

    /// The structure, the first of all if the name is not known any more.
    pub fn entry(&self) -> &'static Entry {
        registry::find(&self.structure).unwrap_or(&registry::ALL[0])
    }

    /// What it is built from.
    pub fn key(&self) -> Key {
        let entry = self.entry();
        let mut params = entry.defaults();
        for (id, text) in &self.params {
            let _ = params.set(id, text); // a value from another version that no longer fits is forgotten
        }
        Key { entry, params, test: entry.tests().find(|test| *test == self.test).unwrap_or_default() }
    }

    /// The same with other parameters.
    pub fn with_params(&self, values: &ParamValues) -> Self {
        let set = values.changed().map(|(p, v)| (p.id.to_owned(), v.to_string()));
        Self { params: set.collect(), ..self.clone() }
    }

    /// What is traced for it, beside a picture A in some mode.
    pub fn mode(&self, first: Mode) -> Mode {
        match self.shows {
            Shows::Mode(mode) => mode,
            Shows::Same | Shows::Difference => first,
        }
    }

    /// Whether its difference from A is shown.
    pub fn differs(&self, first: Mode) -> bool {
        self.shows == Shows::Difference && first.is_heat()
    }
}

/// Which pictures stand beside A, and how.
#[derive(Clone, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(default)]
pub struct PaneSettings {
    /// How they stand.
    pub arrange: Arrange,
    /// Those beside A; some may have no room.
    pub others: Vec<PaneChoice>,
    /// Where strips begin but for the first, from 0 to 1; evenly where that was not chosen for as many.
    pub dividers: Vec<f32>,
}

impl PaneSettings {
    /// Those beside A that have room.
    pub fn on_screen(&self) -> &[PaneChoice] {
        &self.others[..self.others.len().min(self.arrange.most() - 1)]
    }

    /// Where strips begin but for the first, each at or after the one before.
    pub fn places(&self) -> Vec<f32> {
        let n = self.on_screen().len();
        if self.dividers.len() != n {
            return (1..=n).map(|i| i as f32 / (n + 1) as f32).collect();
        }
        let mut from = 0.0_f32;
        let place = |at: &f32| {
            from = if at.is_finite() { at.clamp(from, 1.0) } else { from };
            from
        };
        self.dividers.iter().map(place).collect()
    }

    /// Moves a divider, as far as its neighbours.
    pub fn move_divider(&mut self, which: usize, at: f32) {
        let mut places = self.places();
        if which >= places.len() || !at.is_finite() {
            return;
        }
        let low = which.checked_sub(1).map_or(0.0, |before| places[before]);
        let high = places.get(which + 1).copied().unwrap_or(1.0);
        places[which] = at.clamp(low, high);
        self.dividers = places;
    }

    /// Puts one in the place of another, or after the last; panes are added where there is no room.
    pub fn put(&mut self, which: usize, choice: PaneChoice) {
        if let Some(there) = self.others.get_mut(which) {
            *there = choice;
        } else if self.others.len() + 1 < MOST {
            self.others.push(choice);
            self.dividers.clear();
            if self.others.len() + 1 > self.arrange.most() {
                self.arrange = Arrange::Four;
            }
        }
    }

    /// Takes one away.
    pub fn close(&mut self, which: usize) {
        if which < self.others.len() {
            self.others.remove(which);
            self.dividers.clear();
        }
    }

    /// Leaves what can be shown, of what was read from a file.
    pub fn mend(&mut self) {
        self.others.retain(|choice| registry::find(&choice.structure).is_some());
        self.others.truncate(MOST - 1);
    }
}

/// Keeps all renderers from running.
pub struct Pauses(pub Vec<Pause>);

impl Pauses {
    /// Waits until all of them rest.
    pub fn wait(&self) {
        self.0.iter().for_each(Pause::wait);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(id: &str) -> PaneChoice {
        PaneChoice::of(registry::find(id).expect("registered"), &Settings::default())
    }

    #[test]
    fn dividers_are_even_at_first_and_stay_in_order() {
        let mut panes = PaneSettings::default();
        panes.put(0, of("kdtree"));
        assert_eq!(panes.places(), [0.5]);
        panes.move_divider(0, 0.2);
        assert_eq!(panes.places(), [0.2]);
        panes.put(1, of("grid"));
        assert_eq!(panes.places().len(), 2);
        assert!((panes.places()[0] - 1.0 / 3.0).abs() < 1e-6, "another one: even again");
        panes.move_divider(1, 0.1);
        assert_eq!(panes.places()[0], panes.places()[1], "as far as the neighbour");
        panes.move_divider(0, -3.0);
        panes.move_divider(1, f32::NAN);
        panes.move_divider(7, 0.5);
        assert_eq!(panes.places()[0], 0.0);
        panes.dividers = vec![f32::NAN, 4.0];
        assert_eq!(panes.places(), [0.0, 1.0], "what a file may hold");
    }

    #[test]
    fn there_is_room_for_four_and_two_panes_become_four() {
        let mut panes = PaneSettings { arrange: Arrange::Two, ..PaneSettings::default() };
        panes.put(0, of("kdtree"));
        panes.put(1, of("grid"));
        assert_eq!((panes.arrange, panes.on_screen().len()), (Arrange::Four, 2));
        panes.put(2, of("octree"));
        panes.put(3, of("bsp"));
        assert_eq!(panes.others.len(), MOST - 1);
        panes.arrange = Arrange::Two;
        assert_eq!(panes.on_screen().len(), 1, "the others have no room");
        panes.put(0, of("bsp"));
        panes.close(9);
        panes.close(1);
        let ids: Vec<_> = panes.others.iter().map(|choice| choice.structure.as_str()).collect();
        assert_eq!(ids, ["bsp", "octree"]);
        panes.others.push(PaneChoice { structure: "gone".to_owned(), ..PaneChoice::default() });
        panes.mend();
        assert_eq!(panes.others.len(), 2);
    }

    #[test]
    fn a_structure_stands_beside_itself_with_other_parameters() {
        let plain = of("bvh");
        let mut values = plain.key().params;
        values.set("builder", "sbvh").expect("a builder");
        let cut = plain.with_params(&values);
        assert_ne!(plain.key(), cut.key());
        assert_eq!(cut.key().params.choice("builder"), "sbvh");
        let saved = serde_json::to_string(&cut).expect("plain data");
        assert_eq!(serde_json::from_str::<PaneChoice>(&saved).expect("just written"), cut);
        let odd = PaneChoice { params: [("builder".to_owned(), "gone".to_owned())].into(), ..plain.clone() };
        assert_eq!(odd.key(), plain.key());
    }

    #[test]
    fn a_difference_is_that_of_amounts() {
        let less = PaneChoice { shows: Shows::Difference, ..of("kdtree") };
        assert!(less.differs(Mode::Nodes) && !less.differs(Mode::Shaded));
        assert_eq!((less.mode(Mode::Prims), less.mode(Mode::Shaded)), (Mode::Prims, Mode::Shaded));
        let other = PaneChoice { shows: Shows::Mode(Mode::Leaves), ..of("kdtree") };
        assert_eq!(other.mode(Mode::Nodes), Mode::Leaves);
        let light = PaneChoice { shows: Shows::Mode(Mode::Path), ..of("kdtree") };
        assert_eq!((light.mode(Mode::Shaded), other.mode(Mode::Path)), (Mode::Path, Mode::Leaves));
    }
}
