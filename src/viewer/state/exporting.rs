//! What is taken away from the window: asked for, made and written in the background.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::State;
use super::finished::sentence;
use crate::accel::BuildCx;
use crate::job::{Job, Outcome};
use crate::lab::everything::{self, Amount, ReportError, Subject};
use crate::lab::plot::png_of;
use crate::render::Looks;
use crate::scene::texture::Detail;
use crate::scene::{CameraSpec, LoadCx};
use crate::task::{Cancel, Progress};
use crate::viewer::dialogs::answered;
use crate::viewer::exports::{Export, Form, Writing};
use crate::viewer::figure::Figure;
use crate::viewer::mosaic::Mosaic;
use crate::viewer::sheets::{ListedRays, What};
use crate::viewer::workers::Shared;
use crate::viewer::{figure, files, plots, sheets};

/// Makes what is written.
type Make = Box<dyn FnOnce(&Cancel) -> Result<Vec<u8>, String> + Send>;

impl State {
    /// Asks for a file, or for a folder.
    pub(super) fn ask_where_to_export(&mut self, export: Export) {
        let is_report = matches!(export, Export::Report { .. });
        let busy = is_report && (self.is_measuring() || self.is_checking());
        if self.model.is_none() || self.exports.asked.is_some() || self.exports.writing.is_some() || busy {
            return;
        }
        let wake = Arc::clone(&self.shared.wake);
        let answer = if is_report {
            self.dialog.folder(wake)
        } else {
            self.dialog.save(&format!("{}.{}", export.name(), export.ending()), wake)
        };
        self.exports.said = None;
        self.exports.asked = Some((export, answer));
    }

    /// Takes the answers of dialogs, and what was written.
    pub(super) fn advance_exports(&mut self) {
        if let Some((export, receiver)) = self.exports.asked.take() {
            let mut asked = Some(receiver);
            if let Some(path) = answered(&mut asked) {
                self.export(export, path);
            }
            self.exports.asked = asked.map(|receiver| (export, receiver));
        }
        if let Some((export, job)) = self.exports.writing.take()
            && let Some(job) = self.written(export.name(), job)
        {
            self.exports.writing = Some((export, job));
        }
        if let Some(job) = self.exports.report.take() {
            self.exports.report = self.written("report", job);
        }
    }

    /// Says what became of a file; gives it back if that is not known yet.
    fn written(&mut self, name: &str, job: Writing) -> Option<Writing> {
        match job.poll() {
            Outcome::Running => return Some(job),
            Outcome::Done(Ok(Some(path))) => {
                self.exports.said = Some(format!("{} written to {}", crate::lab::format::capital(name), path.display()));
            }
            Outcome::Done(Ok(None)) => {}
            Outcome::Done(Err(why)) => self.fail(why),
            Outcome::Died => self.fail(format!("Can't save the {name}: making it failed. Please report this.")),
        }
        None
    }

    fn export(&mut self, export: Export, path: PathBuf) {
        let started = match export {
            Export::Report { quick } => return self.make_report(quick, path),
            Export::Table(What::Rays) => ListedRays::of(self).map(|rays| {
                let budget = self.shared.budget.clone();
                Box::new(move |cancel: &Cancel| rays.csv(&budget, cancel).map_err(|why| sentence(&why))) as Make
            }),
            Export::Table(What::Film) => self.film_on_screen().map(|(film, _)| {
                let film = Arc::clone(film);
                Box::new(move |_: &Cancel| Ok(sheets::film(&film).csv().into_bytes())) as Make
            }),
            Export::Table(what) => {
                sheets::sheet(self, what).map(|sheet| Box::new(move |_: &Cancel| Ok(sheet.csv().into_bytes())) as Make)
            }
            Export::Plot(what, form) => plots::drawing(self, what).map(|drawing| {
                Box::new(move |_: &Cancel| {
                    let svg = drawing.svg().map_err(|why| format!("Can't draw the plot: {why}."))?;
                    match form {
                        Form::Svg => Ok(svg.into_bytes()),
                        Form::Png => png_of(&svg).map_err(|why| format!("Can't draw the plot: {why}.")),
                    }
                }) as Make
            }),
            Export::Figure => Figure::of(self).map(|figure| Box::new(move |cancel: &Cancel| figure.svg(cancel)) as Make),
            Export::Picture if self.is_comparing() => {
                Mosaic::of(self).map(|mosaic| Box::new(move |cancel: &Cancel| mosaic.png(cancel)) as Make)
            }
            Export::Picture => self.on_screen().cloned().map(|picture| Box::new(move |_: &Cancel| figure::png(&picture)) as Make),
        };
        let Some(make) = started else {
            return self.fail(format!("There is nothing to save yet: no {}.", export.name()));
        };
        let write = move |cancel: &Cancel, _: &Progress| {
            let path = files::with_ending(path, export.ending())?;
            let bytes = make(cancel)?;
            if cancel.is_cancelled() {
                return Ok(None);
            }
            files::write(&path, &bytes)?;
            Ok(Some(path))
        };
        match Job::spawn("export", self.shared.waker(), write) {
            Ok(job) => self.exports.writing = Some((export, job)),
            Err(e) => self.fail(format!("Can't save: {e}.")),
        }
    }

    /// Starts the report; the renderer is kept from running meanwhile.
    fn make_report(&mut self, quick: bool, within: PathBuf) {
        if self.is_measuring() || self.is_checking() {
            return self.fail("Can't make the report while something else is measured. Try again when that is done.".to_owned());
        }
        let amount = Amount::of(quick);
        let Some((subject, name)) = self.subject(&amount) else { return };
        let pause = self.begin_measuring();
        self.building = None;
        let shared = self.shared.clone();
        let make = move |cancel: &Cancel, progress: &Progress| {
            pause.wait();
            report((subject, &amount), (&within, &name), &shared, (cancel, progress))
        };
        match Job::spawn("report", self.shared.waker(), make) {
            Ok(job) => self.exports.report = Some(job),
            Err(e) => self.fail(format!("Can't make the report: {e}.")),
        }
    }

    /// What the report is of, and what its folder is called.
    fn subject(&self, amount: &Amount) -> Option<(Subject, String)> {
        let model = self.model.as_ref()?;
        let (entries, test) = (amount.entries(), self.settings.common_test());
        let ids: Vec<&str> = entries.iter().map(|entry| entry.id).collect();
        let structures: Vec<_> = entries.iter().map(|entry| (*entry, self.settings.params_of(entry))).collect();
        let camera = CameraSpec::written(&self.camera);
        let view = format!(" --camera \"{camera}\" --test {}{}", test.id(), everything::settings(&structures));
        let flat = model.geometry.placed().is_none();
        let subject = Subject {
            scene: Arc::clone(&model.scene),
            geometry: Arc::clone(&model.geometry),
            looks: Arc::clone(&model.looks),
            camera: self.camera,
            test,
            commands: amount.commands(&model.scene.name, &ids.join(","), [&view, ""], flat),
            structures,
        };
        Some((subject, format!("{} report", files::name_of(&model.scene.name))))
    }
}

/// Makes the report and writes it into a new folder: all of it or nothing.
fn report(
    (mut subject, amount): (Subject, &Amount),
    (within, name): (&Path, &str),
    shared: &Shared,
    (cancel, progress): (&Cancel, &Progress),
) -> Result<Option<PathBuf>, String> {
    let fail = |why: &dyn std::fmt::Display| format!("Can't make the report: {}", sentence(&why.to_string()));
    let Shared { pool, budget, .. } = shared.clone();
    let cx = LoadCx::new(cancel.clone(), progress.clone(), budget.clone(), pool.clone());
    let Ok(looks) = Looks::decode(&subject.scene, Detail::Light, &cx) else { return Ok(None) };
    subject.looks = Arc::new(looks);
    let cx = BuildCx::new(cancel.clone(), progress.clone(), pool, budget);
    let made = match everything::report(&subject, amount, (None, &mut |_| Ok(())), &cx) {
        Ok(made) => made,
        Err(ReportError::Cancelled(_)) => return Ok(None),
        Err(why) => return Err(fail(&why)),
    };
    if cancel.is_cancelled() {
        return Ok(None);
    }
    let folder = files::new_folder(within, name)?;
    // The page comes last: where it is, all is.
    let written = made.iter().try_for_each(|(name, bytes)| files::write(&folder.join(name), bytes));
    if written.is_err() {
        // Nothing else can be in a folder that was just made; if it stays there is no page in it.
        let _ = std::fs::remove_dir_all(&folder);
    }
    written.map(|()| Some(folder.join(everything::PAGE)))
}
