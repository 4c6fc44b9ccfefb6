//! The tour of the first start: six steps through what the window is for, each shown by doing it with the commands that the
//! person has as well.

use glam::Vec2;

use super::command::Command;
use super::gpu::View;
use super::pick::Picked;
use super::settings::{OverlaySettings, Workspace};
use super::state::State;
use crate::render::Mode;

/// What the tour is shown on.
pub const LECTURE: &str = "builtin:lecture";
/// What its last step opens.
pub const STADIUM: &str = "builtin:teapot-in-stadium";
/// The structure of all steps but the last.
const TREE: &str = "bvh";
/// The structure of the last.
const GRID: &str = "grid";
/// Where the plane is tried, from 0 to 1.
const TRIED: f64 = 0.4;

/// How far somebody is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Tour {
    /// The step, from 0.
    pub at: usize,
    /// How much of what the step shows is done.
    done: usize,
}

/// A step of it.
pub struct Step {
    /// What it is about.
    pub title: &'static str,
    /// What is to be seen, in plain words.
    pub text: &'static str,
    /// What brings it there, in order.
    acts: &'static [fn(&State) -> Act],
}

/// What is next.
#[derive(Debug, PartialEq)]
pub enum Act {
    /// Something has to come about first.
    Wait,
    /// It is so already.
    Pass,
    /// This.
    Do(Command),
}

/// All of it.
pub const STEPS: [Step; 6] = [
    Step {
        title: "Boxes around boxes",
        text: "Sixteen triangles in a bounding volume hierarchy: a tree of boxes. Drawn are the boxes one step below the root. A ray that misses a box misses everything in it, so most triangles are never looked at. The depth above the view leads further down.",
        acts: &[lecture, tree_structure, shaded, |state| workspace(state, Workspace::View), boxes],
    },
    Step {
        title: "The tree",
        text: "The same boxes as a tree, at the left. Its root, the box around everything, is selected: click another row, or walk with the arrow keys. At the right stand the triangles in it and its part of the SAH cost, which is what a random ray is expected to cost.",
        acts: &[lecture, tree_structure, shaded, |state| workspace(state, Workspace::Structure), root],
    },
    Step {
        title: "Why it is divided there",
        text: "The curves at the right are the cost of dividing the root at any place along x, y or z; the ring is what was chosen. The white line is a plane of your own: drag it in the plot, or press the arrow keys there, and look for a cheaper one.",
        acts: &[lecture, tree_structure, shaded, |state| workspace(state, Workspace::Structure), root, plane],
    },
    Step {
        title: "What one ray does",
        text: "The ray of one pixel. Below stands all that it does: which boxes it enters, which it leaves out and why, and which triangles it tests. Go on with the buttons at the right, or click any other pixel.",
        acts: &[lecture, tree_structure, shaded, |state| workspace(state, Workspace::Ray), ray, first_leaf],
    },
    Step {
        title: "Which structure is the fastest",
        text: "All structures are built and timed on this view, in turns, while nothing else runs: some seconds. Their times stand below. With sixteen triangles all of them are quick; large models tell them apart.",
        acts: &[lecture, tree_structure, shaded, |state| workspace(state, Workspace::View), measure],
    },
    Step {
        title: "Where a grid fails",
        text: "A teapot in a stadium, in a grid. Bright pixels are rays that test many triangles: all cells are of one size, and the whole teapot is in a few of them. Choose the two-level grid or the BVH above the view, and see it go dark.",
        acts: &[stadium, grid_structure, tests, |state| workspace(state, Workspace::View), no_boxes],
    },
];

impl Tour {
    /// The beginning of a step, the last one at most.
    pub const fn at(step: usize) -> Self {
        Self { at: if step < STEPS.len() { step } else { STEPS.len() - 1 }, done: 0 }
    }

    /// The present step.
    pub const fn step(&self) -> &'static Step {
        &STEPS[self.at]
    }

    /// What is to be done next for the present step; nothing once all of it is done.
    pub fn next(&self, state: &State) -> Option<Act> {
        self.step().acts.get(self.done).map(|act| act(state))
    }

    /// That was done, or is not needed.
    pub const fn advance(&mut self) {
        self.done += 1;
    }

    /// Whether something of the step is still to be done.
    pub const fn is_acting(&self) -> bool {
        self.done < self.step().acts.len()
    }
}

/// Does a command unless things are so already.
fn unless(so: bool, command: Command) -> Act {
    if so { Act::Pass } else { Act::Do(command) }
}

fn open(state: &State, name: &str) -> Act {
    if state.loading.is_some() {
        return Act::Wait;
    }
    unless(state.model.as_ref().is_some_and(|model| model.scene.name == name), Command::Open(name.to_owned()))
}

fn lecture(state: &State) -> Act {
    open(state, LECTURE)
}

fn stadium(state: &State) -> Act {
    open(state, STADIUM)
}

fn structure(state: &State, id: &'static str) -> Act {
    // What is timed shall not be disturbed by a build.
    if state.loading.is_some() || state.is_measuring() {
        return Act::Wait;
    }
    unless(state.settings.structure == id, Command::Structure(id))
}

fn tree_structure(state: &State) -> Act {
    structure(state, TREE)
}

fn grid_structure(state: &State) -> Act {
    structure(state, GRID)
}

fn mode(state: &State, mode: Mode) -> Act {
    unless(state.settings.mode == mode, Command::Mode(mode))
}

fn shaded(state: &State) -> Act {
    mode(state, Mode::Shaded)
}

fn tests(state: &State) -> Act {
    mode(state, Mode::Prims)
}

fn workspace(state: &State, workspace: Workspace) -> Act {
    unless(state.settings.workspace == workspace, Command::Workspace(workspace))
}

/// Whether the structure is there, with its figures.
fn is_there(state: &State) -> bool {
    let counted = state.shown.as_ref().is_some_and(|shown| shown.stats.is_some());
    state.loading.is_none() && state.building.is_none() && counted
}

fn boxes(state: &State) -> Act {
    let now = state.settings.overlay;
    let overlay = OverlaySettings { boxes: true, leaves_only: false, subtree_only: false, depth: 1, from_depth: 1, ..now };
    if is_there(state) { unless(now == overlay, Command::Overlay(overlay)) } else { Act::Wait }
}

fn no_boxes(state: &State) -> Act {
    let now = state.settings.overlay;
    unless(!now.boxes, Command::Overlay(OverlaySettings { boxes: false, ..now }))
}

fn root(state: &State) -> Act {
    if !is_there(state) || state.tree.outline.is_none() {
        return Act::Wait;
    }
    unless(state.tree.selected == Some(0), Command::SelectRow(0))
}

fn plane(state: &State) -> Act {
    if state.tree.selecting.is_some() {
        return Act::Wait;
    }
    let Some(cell) = state.picked.as_ref().and_then(Picked::selected) else { return Act::Wait };
    let axis = cell.shape.bounds().longest_axis();
    unless(state.tree.tried.is_some(), Command::TryPlane(Some((axis, TRIED))))
}

/// Clicks a triangle in the middle of the list.
fn ray(state: &State) -> Act {
    let (true, Some(model)) = (is_there(state), &state.model) else { return Act::Wait };
    if !state.rays.columns.is_empty() || state.rays.following.is_some() {
        return Act::Pass;
    }
    let geometry = &model.geometry;
    if geometry.live_count() == 0 {
        return Act::Pass;
    }
    let corners = geometry.corners(geometry.live(geometry.live_count() / 2));
    let middle = (corners[0] + corners[1] + corners[2]) / 3.0;
    let view = View::new(&state.camera, geometry.space(), state.aspect());
    // The size of one pixel stands for the whole view.
    let at = view.project(middle, [1, 1]).map_or(Vec2::ZERO, |(at, _)| Vec2::new(2.0 * at.x - 1.0, 1.0 - 2.0 * at.y));
    Act::Do(Command::Pick(at))
}

fn first_leaf(state: &State) -> Act {
    if state.rays.following.is_some() {
        return Act::Wait;
    }
    let leaf = state.rays.columns.first().and_then(|column| column.followed.leaf(0, true));
    leaf.map_or(Act::Pass, |leaf| Act::Do(Command::Step(0, leaf)))
}

fn measure(state: &State) -> Act {
    if !is_there(state) || state.is_measuring() || state.is_checking() {
        return Act::Wait;
    }
    unless(state.timings.view.is_some(), Command::Measure)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_step_begins_with_all_to_do_and_ends_with_nothing() {
        let mut tour = Tour::at(STEPS.len());
        assert_eq!(tour.at + 1, STEPS.len());
        for _ in tour.step().acts {
            assert!(tour.is_acting());
            tour.advance();
        }
        assert!(!tour.is_acting());
    }

    #[test]
    fn every_step_says_something_in_plain_sentences() {
        for step in &STEPS {
            assert!(step.text.ends_with('.') && (80..300).contains(&step.text.len()), "{}: {}", step.title, step.text.len());
        }
    }
}
