//! A scripted hand for measuring how soon the window answers: it turns the camera, then goes back
//! and forth between two structures that are kept. Each step begins once the one before is answered. In the Structure
//! workspace each turn also selects a cell somewhere in the tree, in the Ray workspace it goes on to another step.

use super::command::Command;
use super::navigation;
use super::pace::Pace;
use super::panels::Commands;
use super::settings::Workspace;
use super::state::State;
use glam::Vec2;

/// Turns of the camera, each by this many points in a view 600 points high.
const TURNS: u32 = 16;
const TURN: Vec2 = Vec2::new(40.0, 6.0);
/// Switches between the two structures once both are built.
const SWITCHES: u32 = 6;
/// The structure that is switched to; builds quickly.
const OTHER: &str = "grid";

/// How far it is.
#[derive(Debug, Default)]
pub struct Rehearsal {
    turns: u32,
    switches: u32,
    /// The structure it began with.
    first: Option<&'static str>,
    /// What was asked for last: the request before it, and whether it was a turn.
    waiting: Option<(u64, Step)>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Step {
    Turn,
    Build,
    Switch,
}

impl Rehearsal {
    /// Once a frame: asks for the next step when the last one is answered; true when all are done.
    pub fn advance(&mut self, state: &State, pace: &mut Pace, commands: &mut Commands) -> bool {
        let (Some(answer), Some(shown)) = (state.answer, &state.shown) else { return state.error.is_some() };
        if let Some((before, step)) = self.waiting {
            if answer.request == before || state.building.is_some() {
                return false;
            }
            match step {
                Step::Turn => pace.turned(answer),
                Step::Switch => pace.switched(answer),
                Step::Build => {}
            }
            self.waiting = None;
        }
        let id = shown.key.entry.id;
        let first = *self.first.get_or_insert(id);
        let (step, command) = if self.turns < TURNS {
            self.turns += 1;
            commands.extend(also(state, self.turns));
            (Step::Turn, Command::Camera(navigation::orbit(&state.camera, TURN, 600.0)))
        } else if self.switches == 0 {
            self.switches += 1;
            (Step::Build, Command::Structure(OTHER))
        } else if self.switches <= SWITCHES && first != OTHER {
            self.switches += 1;
            (Step::Switch, Command::Structure(if id == OTHER { first } else { OTHER }))
        } else {
            return true;
        };
        commands.push(command);
        self.waiting = Some((answer.request, step));
        false
    }
}

/// What the workspace has to do besides, on a turn.
fn also(state: &State, turn: u32) -> Option<Command> {
    match state.settings.workspace {
        Workspace::Structure => {
            let rows = state.tree.outline.as_ref()?.len();
            Some(Command::SelectRow(u32::try_from(u64::from(rows) * u64::from(turn) / u64::from(TURNS + 1)).unwrap_or(0)))
        }
        Workspace::Ray => Some(Command::Step(state.rays.lead, state.rays.last() * turn as usize / TURNS as usize)),
        Workspace::View | Workspace::Compare | Workspace::Check => None,
    }
}
