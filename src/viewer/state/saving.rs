//! The whole state of the window, saved to a file and opened from it.

use std::path::PathBuf;
use std::sync::Arc;
use std::sync::mpsc::Receiver;

use super::State;
use crate::accel::{CellId, registry};
use crate::geometry::Axis;
use crate::job::{Job, Outcome};
use crate::lab::follow::{from_text, to_text};
use crate::task::Cancel;
use crate::viewer::dialogs::answered;
use crate::viewer::files;
use crate::viewer::kept::Key;
use crate::viewer::model::Instances;
use crate::viewer::pick::Picked;
use crate::viewer::rays::MOST;
use crate::viewer::workers;
use crate::viewer::workspace_file::{ENDING, WorkspaceFile};

/// A file on its way in or out, and what it awaits.
#[derive(Default)]
pub struct Saving {
    /// Where it shall be saved: the answer of the dialog.
    asked: Option<Receiver<Option<PathBuf>>>,
    writing: Option<Job<Result<(), String>>>,
    reading: Option<Job<Result<WorkspaceFile, String>>>,
    /// What was read, until its model is open; and what became of instances before.
    read: Option<(WorkspaceFile, Instances)>,
}

/// A cell that is to be selected: awaited until it is.
pub struct Awaited {
    /// The structure that it is of.
    key: Key,
    /// The cells from the root to it.
    path: Vec<CellId>,
    /// A plane to try in it.
    pub(super) tried: Option<(Axis, f64)>,
}

impl Saving {
    /// Something else is opened: what was on its way is not wanted any more.
    pub fn forget(&mut self) {
        (self.reading, self.read) = (None, None);
    }

    /// Whether a file is on its way.
    pub const fn is_busy(&self) -> bool {
        self.writing.is_some() || self.reading.is_some() || self.read.is_some()
    }
}

impl State {
    /// Asks where to save.
    pub(super) fn ask_where_to_save(&mut self) {
        if self.model.is_some() && self.saving.asked.is_none() {
            self.saving.asked = Some(self.dialog.save(&format!("workspace.{ENDING}"), Arc::clone(&self.shared.wake)));
        }
    }

    /// What would be saved now.
    fn to_file(&self) -> Option<WorkspaceFile> {
        let model = self.model.as_ref()?;
        let mut file = WorkspaceFile::new(&model.scene.name, &self.settings, self.camera, self.instances);
        file.selected = self.selected_of_chosen().iter().map(|id| (id.instance, id.node)).collect();
        file.ray = self.rays.asked.as_ref().map(to_text);
        file.ray_kind = self.rays.kind.id().to_owned();
        file.step = self.rays.place();
        let tried =
            self.awaited_of_chosen().map_or(self.tree.tried, |awaited| awaited.tried).filter(|_| !file.selected.is_empty());
        file.tried = tried.map(|(axis, place)| (axis.index(), place));
        file.beside = self.rays.beside.iter().map(|id| (*id).to_owned()).collect();
        file.bookmarks.clone_from(&self.bookmarks);
        (file.look, file.made) = (Some(self.to_look()), self.to_made());
        Some(file)
    }

    /// What is still to be selected of the chosen structure.
    fn awaited_of_chosen(&self) -> Option<&Awaited> {
        self.awaited.as_ref().filter(|awaited| awaited.key == self.wanted_key())
    }

    /// The cells of the chosen structure from the root to that which is selected, or still to be.
    pub(super) fn selected_of_chosen(&self) -> Vec<CellId> {
        // A selection is of the structure that is shown, while another one may be on its way.
        let selected = || self.picked.as_ref().filter(|_| self.building.is_none()).map(Picked::ids);
        let awaited = self.awaited_of_chosen().map(|awaited| awaited.path.clone());
        awaited.or_else(selected).unwrap_or_default()
    }

    /// Starts reading a file.
    pub(super) fn open_workspace(&mut self, path: String) {
        self.asking = None;
        match Job::spawn("workspace", self.shared.waker(), move |_, _| WorkspaceFile::read(&path)) {
            Ok(job) => self.saving.reading = Some(job),
            Err(e) => self.fail(format!("Can't open the workspace: {e}.")),
        }
    }

    pub(super) fn advance_saving(&mut self) {
        if let Some(path) = answered(&mut self.saving.asked) {
            self.write(path);
        }
        if let Some(job) = self.saving.writing.take() {
            match job.poll() {
                Outcome::Running => self.saving.writing = Some(job),
                Outcome::Done(Ok(())) => {}
                Outcome::Done(Err(why)) => self.fail(why),
                Outcome::Died => self.fail("Can't save the workspace: writing failed. Please report this.".to_owned()),
            }
        }
        if let Some(job) = self.saving.reading.take() {
            match job.poll() {
                Outcome::Running => self.saving.reading = Some(job),
                Outcome::Done(Ok(file)) => {
                    let before = std::mem::replace(&mut self.instances, file.instances);
                    self.open(file.model.clone());
                    self.saving.read = Some((file, before));
                }
                Outcome::Done(Err(why)) => self.fail(why),
                Outcome::Died => self.fail("Can't open the workspace: reading failed. Please report this.".to_owned()),
            }
        }
        if self.loading.is_none()
            && let Some((_, before)) = self.saving.read.take()
        {
            self.instances = before; // its model could not be opened
        }
        self.await_selection();
    }

    fn write(&mut self, path: PathBuf) {
        let Some(mut file) = self.to_file() else { return };
        let Some(hidden) = self.number_hidden(&mut file) else { return };
        let write = move |cancel: &Cancel| {
            file.made.hidden = hidden.written(cancel).map_err(|why| format!("Can't save {}: {why}.", path.display()))?;
            file.write(&files::with_ending(path, ENDING)?)
        };
        match Job::spawn("save", self.shared.waker(), move |cancel, _| write(cancel)) {
            Ok(job) => self.saving.writing = Some(job),
            Err(e) => self.fail(format!("Can't save: {e}.")),
        }
    }

    /// Brings back what was saved, now that the model is open.
    pub(super) fn bring_back(&mut self) {
        let Some((file, _)) = self.saving.read.take() else { return };
        self.settings.take_view(&file.settings);
        self.show_tiles(false);
        self.chosen_depths = (self.settings.overlay.from_depth, self.settings.overlay.depth);
        (self.camera, self.framed) = (file.camera, None);
        self.bookmarks = file.bookmarks;
        let tried = file.tried.and_then(|(axis, place)| Some((*Axis::ALL.get(axis)?, place)));
        self.await_cell(&file.selected, tried.filter(|(_, place)| place.is_finite()));
        self.rays.beside = file.beside.iter().filter_map(|id| registry::find(id)).map(|entry| entry.id).take(MOST - 1).collect();
        self.rays.beside.dedup();
        self.settings.panes.mend();
        self.rays.kind = file.ray_kind.parse().unwrap_or(self.rays.kind);
        self.rays.asked = file.ray.and_then(|text| from_text(&text).ok());
        self.rays.awaited = file.step.filter(|_| self.rays.asked.is_some());
        if let Some(look) = file.look {
            self.look_as(look);
        }
        self.make_again(file.made, &file.selected);
    }

    /// Selects what was saved, once its structure is there.
    fn await_selection(&mut self) {
        let on_its_way = self.tree.restoring && self.tree.selecting.is_some();
        if self.building.is_some() || self.loading.is_some() || on_its_way {
            return;
        }
        let Some(Awaited { key, path, .. }) = &self.awaited else { return };
        let shown = self.shown.as_ref().filter(|shown| shown.key == *key && !path.is_empty());
        let job = shown.and_then(|shown| workers::select_path(&self.shared, Arc::clone(&shown.accel), path.clone()).ok());
        match job {
            Some(job) => (self.tree.restoring, self.tree.selecting) = (true, Some(job)),
            // Where the build came to nothing, or another structure was chosen, nobody waits any more.
            None => self.awaited = None,
        }
    }

    /// Selects a cell of the chosen structure, by the cells from the root to it, once that is there, and tries a plane in it.
    pub(super) fn await_cell(&mut self, path: &[(u32, u32)], tried: Option<(Axis, f64)>) {
        self.select_no_more();
        let path = path.iter().map(|(instance, node)| CellId { instance: *instance, node: *node }).collect();
        self.awaited = Some(Awaited { key: self.wanted_key(), path, tried });
    }
}
