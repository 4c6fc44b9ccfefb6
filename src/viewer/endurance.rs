//! A scripted hand for seeing that a long day leaves the memory where it was: it goes back and forth between two structures
//! a thousand times, then opens fifty models.

use super::command::Command;
use super::format;
use super::panels::Commands;
use super::state::State;
use crate::scene::builtin::SCHEME;
use crate::sys;

/// Switches between structures.
const SWITCHES: u32 = 1000;
/// Models that are opened.
const MODELS: u32 = 50;
/// As many of either after which the memory is looked at first: what is held for good is there by then, and the model
/// that is open is the one that is open at the end.
const WARM: u32 = 11;
/// The structure that is switched to.
const OTHER: &str = "grid";
/// What is opened in turn.
const OPENED: [&str; 3] = ["lecture", "teapot", "sphere-flake"];

/// How far it is.
#[derive(Debug, Default)]
pub struct Endurance {
    switches: u32,
    models: u32,
    first: Option<&'static str>,
    /// The request that was the last when something was asked for.
    waiting: Option<u64>,
    /// Bytes that the process held, and bytes charged, after some switches and after all, and the same of models.
    held: Vec<(Option<u64>, u64)>,
}

impl Endurance {
    /// Once a frame: asks for the next step when the last one is answered; true when all are done.
    pub fn advance(&mut self, state: &State, commands: &mut Commands) -> bool {
        let (Some(answer), Some(shown)) = (state.answer, &state.shown) else { return state.error.is_some() };
        if self.waiting == Some(answer.request) || state.building.is_some() || state.loading.is_some() {
            return false;
        }
        let first = *self.first.get_or_insert(shown.key.entry.id);
        if self.switches < SWITCHES {
            self.look(self.switches == WARM, state);
            self.switches += 1;
            commands.push(Command::Structure(if shown.key.entry.id == OTHER { first } else { OTHER }));
        } else if self.models < MODELS {
            self.look(self.models == 0 || self.models == WARM, state);
            let name = OPENED[self.models as usize % OPENED.len()];
            self.models += 1;
            commands.push(Command::Open(format!("{SCHEME}{name}")));
        } else {
            self.look(true, state);
            return true;
        }
        self.waiting = Some(answer.request);
        false
    }

    fn look(&mut self, now: bool, state: &State) {
        if now {
            self.held.push((sys::held_memory_bytes(), state.memory().0));
        }
    }

    /// What it found, in words; empty if it was not done.
    pub fn report(&self) -> String {
        let told = |(held, charged): &(Option<u64>, u64)| {
            let held = held.map(|held| format!("{} held, ", format::bytes(held))).unwrap_or_default();
            format!("{held}{} charged", format::bytes(*charged))
        };
        let [warm, switched, opened, all] = &self.held[..] else { return String::new() };
        format!(
            "after {WARM} switches of structure {}, after {SWITCHES} {}; after {WARM} models {}, after {MODELS} {}; ",
            told(warm),
            told(switched),
            told(opened),
            told(all)
        )
    }
}
