//! Why rays are slow: looked for in the background, and shown in the tree.

use super::State;
use crate::job::Outcome;
use crate::lab::findings::Findings;
use crate::render::Mode;
use crate::scene::Camera;
use crate::viewer::kept::Key;
use crate::viewer::settings::Workspace;
use crate::viewer::workers::{self, FindingCauses};

/// What was found, of the shown structure.
#[derive(Default)]
pub struct Causes {
    /// The sentences.
    pub found: Option<Findings>,
    /// The search, while it runs.
    pub running: Option<FindingCauses>,
    /// The structure that it is of, and the view.
    of: Option<(Key, Camera)>,
    /// Those of the search that runs.
    asked: Option<(Key, Camera)>,
}

impl State {
    /// Starts looking.
    pub(super) fn find_causes(&mut self) {
        let Some((view, pause)) = self.begin_on_view(Mode::Shaded) else { return };
        let Some(shown) = &self.shown else { return };
        let outline = self.tree.outline.clone();
        self.causes.asked = Some((shown.key.clone(), self.camera));
        match workers::find_causes(&self.shared, (shown, outline), (view, self.size_px), pause) {
            Ok(job) => self.causes.running = Some(job),
            Err(e) => self.fail(format!("Can't look for causes: {e}.")),
        }
    }

    pub(super) fn advance_causes(&mut self) {
        let Some(job) = &self.causes.running else { return };
        match job.poll() {
            Outcome::Running => return,
            Outcome::Done(Ok((found, outline))) => {
                self.causes.found = Some(found);
                self.causes.of = self.causes.asked.take();
                if self.tree.outline.is_none() {
                    self.tree.of = self.causes.of.as_ref().map(|of| of.0.clone());
                    self.tree.outlining = None;
                    self.tree.listed(outline);
                    self.follow_selection();
                }
            }
            Outcome::Done(Err(why)) if !why.is_empty() => {
                self.fail(format!("Can't look for causes: {}", super::finished::sentence(&why)));
            }
            Outcome::Done(Err(_)) => {}
            Outcome::Died => self.fail("Can't look for causes: following rays failed. Please report this.".to_owned()),
        }
        self.causes.running = None;
    }

    /// Whether the camera has moved since.
    pub fn causes_are_old(&self) -> bool {
        self.causes.of.as_ref().is_some_and(|of| of.1 != self.camera)
    }

    /// Shows the cell of a finding.
    pub(super) fn show_cause(&mut self, row: u32) {
        self.settings.workspace = Workspace::Structure;
        self.select_row(row, false);
    }
}
