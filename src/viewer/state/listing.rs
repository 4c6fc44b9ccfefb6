//! A file of rays in the Ray workspace: read and traced in the background, and followed one by one.

use std::path::PathBuf;
use std::sync::Arc;

use super::State;
use super::finished::sentence;
use crate::job::Outcome;
use crate::lab::RayKind;
use crate::viewer::command::Command;
use crate::viewer::dialogs::answered;
use crate::viewer::ray_list::{self, Brought, RayList};
use crate::viewer::settings::Workspace;
use crate::viewer::workspace_file::{RaysFile, WorkspaceFile};

impl State {
    /// Asks for a file of rays.
    pub(super) fn ask_for_rays(&mut self) {
        if self.ray_list.asked.is_none() {
            self.ray_list.asked = Some(self.dialog.pick_rays(Arc::clone(&self.shared.wake)));
        }
    }

    /// Reads a file of rays, and shows them in the Ray workspace.
    pub(super) fn open_rays(&mut self, path: PathBuf) {
        (self.asking, self.error) = (None, None);
        if self.loading.is_some() {
            return self.await_rays(path);
        }
        self.ray_list.brought = None;
        self.read_rays(path);
    }

    fn read_rays(&mut self, path: PathBuf) {
        match ray_list::read(&self.shared, path) {
            Ok(job) => self.ray_list.reading = Some(job),
            Err(e) => self.fail(format!("Can't open the rays: {e}.")),
        }
    }

    /// Reads a file of rays once a model is open.
    pub fn await_rays(&mut self, path: PathBuf) {
        (self.ray_list.awaited, self.ray_list.brought) = (Some(path), None);
    }

    /// Reads that of a workspace file once its model is open, unless somebody asked for another one.
    pub(super) fn bring_rays(&mut self, file: RaysFile) {
        if self.ray_list.awaited.is_none() {
            let path = PathBuf::from(file.path);
            self.ray_list.awaited = Some(path.clone());
            self.ray_list.brought = Some(Brought { path, followed: file.followed });
        }
    }

    /// The file of rays that is open or on its way, for a workspace file.
    pub(super) fn rays_file(&self) -> Option<RaysFile> {
        let brought = self.ray_list.brought.as_ref().map(|brought| &brought.path);
        let path = brought.or(self.ray_list.file.as_ref().map(|file| &file.path))?;
        Some(RaysFile { path: WorkspaceFile::whole_path(path), followed: self.ray_list.number_followed() })
    }

    /// Forgets the rays; a file that waits for its model stays, and one that is asked for.
    pub(super) fn close_rays(&mut self) {
        let (awaited, asked) = (self.ray_list.awaited.take(), self.ray_list.asked.take());
        let before = std::mem::replace(&mut self.ray_list, RayList { awaited, asked, ..RayList::default() });
        self.shared.give_back((before.file, before.traced)); // they may be large
    }

    /// Stops reading or tracing them; what was not traced is not listed.
    pub(super) fn cancel_rays(&mut self) {
        (self.ray_list.reading, self.ray_list.brought) = (None, None);
        if self.ray_list.tracing.is_some() {
            self.close_rays();
        }
    }

    /// Follows the ray of a row.
    pub(super) fn follow_listed(&mut self, row: u32) {
        let Some((_, ray, _)) = self.ray_list.row(row) else { return };
        self.rays.kind = RayKind::Primary;
        self.follow_anew(ray);
        (self.ray_list.chosen, self.ray_list.moved) = (Some(row), self.ray_list.moved + 1);
    }

    pub(super) fn advance_ray_list(&mut self) {
        if let Some(path) = answered(&mut self.ray_list.asked) {
            self.open_rays(path);
        }
        if self.loading.is_none()
            && let Some(path) = self.ray_list.awaited.take()
            && self.model.is_some()
        {
            self.read_rays(path);
        }
        self.advance_reading();
        self.advance_tracing();
    }

    fn advance_reading(&mut self) {
        let Some(job) = &self.ray_list.reading else { return };
        match job.poll() {
            Outcome::Running => return,
            Outcome::Done(Ok(file)) => {
                let brought = self.ray_list.brought.take();
                self.close_rays();
                self.ray_list.file = Some(file);
                match brought {
                    Some(brought) => self.ray_list.followed = brought.followed,
                    None => self.carry_out(Command::Workspace(Workspace::Ray)),
                }
            }
            Outcome::Done(Err(why)) => match self.ray_list.brought.take() {
                Some(_) => self.also_fail(&format!("{} The rest of the workspace is open.", sentence(&why))),
                None => self.fail(format!("{} Your scene is unchanged.", sentence(&why))),
            },
            Outcome::Died => self.fail("Can't open the rays: reading them failed. Please report this file.".to_owned()),
        }
        (self.ray_list.reading, self.ray_list.brought) = (None, None);
    }

    /// Traces them through the shown structure where somebody looks at them.
    fn advance_tracing(&mut self) {
        let shown = self.shown.as_ref().map(|shown| &shown.key);
        if let Some((key, job)) = self.ray_list.tracing.take_if(|(key, _)| Some(&*key) == shown) {
            match job.poll() {
                Outcome::Running => self.ray_list.tracing = Some((key, job)),
                Outcome::Done(Ok(traced)) => {
                    self.shared.give_back(self.ray_list.traced.replace(Arc::new(traced)));
                    self.ray_list.chosen = None;
                    self.ray_list.find_followed(self.rays.asked);
                }
                Outcome::Done(Err(_)) => {}
                Outcome::Died => {
                    self.close_rays();
                    self.fail("Can't trace the rays: tracing failed. Please report this file.".to_owned());
                }
            }
            return;
        }
        self.ray_list.tracing = None; // of another structure
        let (Some(shown), Some(file)) = (&self.shown, &self.ray_list.file) else { return };
        let known = self.ray_list.traced.as_ref().is_some_and(|traced| traced.of == shown.key);
        let looked_at = self.settings.workspace == Workspace::Ray && self.building.is_none();
        if !known && looked_at && !self.is_measuring() {
            let job = ray_list::trace(&self.shared, shown, Arc::clone(&file.rays));
            self.ray_list.tracing = job.ok().map(|job| (shown.key.clone(), job));
        }
    }
}
