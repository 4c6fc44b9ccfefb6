//! Takes a picture of the window once everything in it is there, and closes it: how the pictures of
//! the README are made.

use std::path::PathBuf;
use std::time::{Duration, Instant};

use eframe::egui::{Context, ViewportCommand};

use super::capture::{self, Capture};
use super::command::Command;
use super::endurance::Endurance;
use super::options::ViewerOptions;
use super::pace::Pace;
use super::panels::Commands;
use super::rehearsal::Rehearsal;
use super::state::State;
use super::tradeoffs::Plot;
use crate::accel::outline::Rank;
use crate::accel::registry;
use crate::accel::visibility::Change;
use crate::geometry::Axis;

/// What is still to be done.
#[derive(Debug)]
pub struct Screenshot {
    path: PathBuf,
    measure: bool,
    check: bool,
    /// The plot of errors that is still to be filled, and how far that is.
    errors: Option<(Plot, usize)>,
    /// The cell that is still to be selected, and the plane to be tried in it.
    select: Option<Rank>,
    /// Its triangles are still to be isolated.
    isolate: bool,
    try_plane: Option<(Axis, f64)>,
    /// The part of the film that is still to be gone to, and whether the film was asked for.
    film: Option<(f32, bool)>,
    /// The volumes that are still to be compared around it, and the one to be drawn.
    fit: Vec<Command>,
    /// What is still to be done in the Ray workspace.
    follow: Vec<Command>,
    /// The view is still to be compared with brute force.
    brute: bool,
    /// What shows the times of tiles.
    tiles: Vec<Command>,
    rehearsal: Option<Rehearsal>,
    endurance: Option<Endurance>,
    /// What the long run found, in words.
    endured: String,
    stage: Stage,
    start: Instant,
    capture: Capture,
}

#[derive(Debug, PartialEq, Eq)]
enum Stage {
    /// Loading, building, tracing.
    Settling,
    /// Turning the camera, switching structures.
    Rehearsing,
    /// The same for long, and opening models.
    Enduring,
    /// Timing every structure.
    Measuring,
    /// Running the stability lab.
    Checking,
    /// Frames in which nothing is left to do; a few, so that the last one is on the screen.
    Still(u32),
    /// The window was asked for its picture.
    Asked,
    Done,
}

/// Frames without work before the picture is taken.
const STILL_FRAMES: u32 = 4;
/// A window that never comes to rest is shown as it is.
const PATIENCE: Duration = Duration::from_secs(600);

impl Screenshot {
    /// A picture for `path`, after measuring or checking, and trying how soon the window answers, if asked for.
    pub fn new(path: PathBuf, options: &ViewerOptions) -> Self {
        Self {
            path,
            measure: options.measure,
            check: options.check,
            errors: options.errors.map(|plot| (plot, 0)),
            select: options.select,
            isolate: options.isolate,
            try_plane: options.try_plane,
            film: options.film.map(|part| (part, false)),
            fit: options.fit.map_or_else(Vec::new, |kind| vec![Command::FitVolumes, Command::DrawVolume(Some(kind))]),
            follow: follow(options),
            brute: options.brute,
            tiles: if options.time_tiles { vec![Command::ShowTiles(true), Command::TimeTiles] } else { Vec::new() },
            rehearsal: options.pace.then(Rehearsal::default),
            endurance: options.endure.then(Endurance::default),
            endured: String::new(),
            stage: Stage::Settling,
            start: Instant::now(),
            capture: Capture::default(),
        }
    }

    /// Looks whether it is time, once a frame.
    pub fn advance(&mut self, ctx: &Context, state: &State, pace: &mut Pace, commands: &mut Commands) {
        ctx.request_repaint_after(Duration::from_millis(20));
        let settled = (!state.is_busy() && (state.shown.is_some() || state.error.is_some())) || self.start.elapsed() > PATIENCE;
        match self.stage {
            Stage::Settling if settled && self.errors.is_some() => self.fill(state, commands),
            Stage::Settling if settled && self.select.is_some() => {
                let outline = state.tree.outline.as_ref();
                commands.extend(self.select.take().and_then(|rank| outline?.greatest(rank)).map(Command::SelectRow));
            }
            Stage::Settling if settled && std::mem::take(&mut self.isolate) => commands.push(Command::Hide(Change::Isolate)),
            Stage::Settling if settled && self.try_plane.is_some() => {
                commands.push(Command::TryPlane(self.try_plane.take()));
            }
            Stage::Settling if settled && self.film.is_some() => self.film(state, commands),
            Stage::Settling if settled && !self.follow.is_empty() => {
                commands.push(match self.follow.remove(0) {
                    // The middle of the way says more than its start.
                    Command::Step(column, _) => Command::Step(column, state.rays.last() * 2 / 3),
                    other => other,
                });
            }
            Stage::Settling if settled && self.rehearsal.is_some() => self.stage = Stage::Rehearsing,
            Stage::Rehearsing => {
                if self.rehearsal.as_mut().is_none_or(|r| r.advance(state, pace, commands)) {
                    (self.rehearsal, self.stage) = (None, Stage::Settling);
                }
            }
            Stage::Settling if settled && self.endurance.is_some() => self.stage = Stage::Enduring,
            Stage::Enduring => {
                if self.endurance.as_mut().is_none_or(|endurance| endurance.advance(state, commands)) {
                    self.endured = self.endurance.take().map(|endurance| endurance.report()).unwrap_or_default();
                    self.stage = Stage::Settling;
                }
            }
            Stage::Settling if settled && std::mem::take(&mut self.brute) => commands.push(Command::CheckByBrute(None)),
            Stage::Settling if settled && !self.tiles.is_empty() => commands.push(self.tiles.remove(0)),
            Stage::Settling if settled && !self.fit.is_empty() => commands.push(self.fit.remove(0)),
            Stage::Settling if settled && self.measure => {
                commands.push(Command::Measure);
                self.stage = Stage::Measuring;
            }
            Stage::Settling if settled && self.check => {
                commands.push(Command::RunLab);
                (self.check, self.stage) = (false, Stage::Checking);
            }
            Stage::Checking
                if (state.checks.running.is_none() && !state.checks.cases.is_empty()) || self.start.elapsed() > PATIENCE =>
            {
                commands.extend(state.checks.first_slip().map(Command::OpenCase));
                self.stage = Stage::Settling;
            }
            Stage::Measuring if settled && state.timings.view.is_some() => self.stage = Stage::Still(0),
            Stage::Settling if settled && !self.measure => self.stage = Stage::Still(0),
            Stage::Still(n) if n < STILL_FRAMES => self.stage = if settled { Stage::Still(n + 1) } else { Stage::Settling },
            Stage::Still(_) => {
                self.capture.ask(ctx);
                self.stage = Stage::Asked;
            }
            Stage::Asked => {
                if let Some(image) = self.capture.take() {
                    capture::save(&self.path, &image);
                    eprintln!("{}{}", self.endured, pace.report(state));
                    self.stage = Stage::Done;
                    ctx.send_viewport_cmd(ViewportCommand::Close);
                }
            }
            Stage::Settling | Stage::Measuring | Stage::Checking | Stage::Done => {}
        }
    }
}

/// What shows a ray in several structures.
fn follow(options: &ViewerOptions) -> Vec<Command> {
    let first = match (options.follow, &options.rays) {
        (Some(at), _) => Command::Pick(at.into()),
        (None, Some(_)) => Command::FollowListed(0),
        (None, None) => return Vec::new(),
    };
    let beside = options.beside.iter().filter_map(|id| registry::find(id)).map(|entry| Command::Beside(entry.id, true));
    std::iter::once(first).chain(beside).chain([Command::Step(0, 0)]).collect()
}

impl Screenshot {
    /// Makes the film of the build, then goes to a part of it; there may be none.
    fn film(&mut self, state: &State, commands: &mut Commands) {
        match &mut self.film {
            Some((_, asked)) if !*asked => {
                *asked = true;
                commands.push(Command::MakeFilm);
            }
            film => {
                let part = film.take().map_or(0.0, |film| film.0);
                commands.push(Command::FilmTo((part * state.filming.last() as f32).round() as u32));
            }
        }
    }
}

/// Structures whose curves of errors are drawn beside that of the one that is shown first.
const BESIDE: [&str; 3] = ["wide", "kdtree", "grid2"];

impl Screenshot {
    /// Does the next thing that fills a plot of errors.
    fn fill(&mut self, state: &State, commands: &mut Commands) {
        let Some((plot, step)) = &mut self.errors else { return };
        let next = match (*plot, *step) {
            (Plot::Image, step) if step < BESIDE.len() => Some(Command::Structure(BESIDE[step])),
            (Plot::Image, step) if step == BESIDE.len() => Some(Command::MakeReference),
            (Plot::Image, _) => None,
            (Plot::Scaling, 0) => Some(Command::MeasureScaling),
            (_, 0) => Some(Command::MeasureTradeoffs),
            _ => None,
        };
        *step += 1;
        match next {
            Some(next) => commands.push(next),
            None if state.errors.erring.is_none() || self.start.elapsed() > PATIENCE => self.errors = None,
            None => {}
        }
    }
}
