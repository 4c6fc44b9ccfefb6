//! A scripted hand that shows the window at work, frame by frame: it turns the view, goes from one structure to the next, and
//! goes down the levels of each. How the animation of the README is made.

use std::path::PathBuf;
use std::time::{Duration, Instant};

use eframe::egui::{Context, ViewportCommand};

use super::capture::{self, Capture};
use super::command::Command;
use super::navigation;
use super::panels::Commands;
use super::settings::OverlaySettings;
use super::state::State;
use glam::Vec2;

/// Pictures a second that they are meant for.
const RATE: u32 = 10;
/// Turn of each picture, in points of a view 600 points high.
const TURN: Vec2 = Vec2::new(18.0, 0.0);
/// A view that never comes to rest is shown as it is.
const PATIENCE: Duration = Duration::from_secs(60);

/// What a picture shows that the one before did not.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Change {
    /// Nothing: time to look.
    Nothing,
    /// The view turns.
    Turn,
    /// Another structure.
    Structure(&'static str),
    /// Boxes of that depth.
    Depth(u32),
}

/// The pictures, in their order: eight seconds at most.
fn script() -> Vec<Change> {
    let depths = |from: u32, to: u32| (from..=to).flat_map(|depth| [Change::Depth(depth), Change::Nothing]);
    let turns = |n: usize| std::iter::repeat_n(Change::Turn, n);
    let looks = |n: usize| std::iter::repeat_n(Change::Nothing, n);
    looks(4)
        .chain(turns(16))
        .chain(depths(2, 9))
        .chain(turns(8))
        .chain([Change::Structure("kdtree")])
        .chain(looks(5))
        .chain(turns(10))
        .chain([Change::Structure("grid")])
        .chain(looks(5))
        .chain(turns(10))
        .chain([Change::Structure("bvh")])
        .chain(looks(3))
        .collect()
}

/// How far it is.
#[derive(Debug)]
pub struct Animation {
    folder: PathBuf,
    script: Vec<Change>,
    /// The next picture.
    at: usize,
    /// The window was asked for its picture.
    asked: bool,
    /// When what is to be seen was asked for.
    since: Instant,
    capture: Capture,
}

impl Animation {
    /// Pictures `000.png`, `001.png` … in a folder, which is made if it is not there.
    pub fn new(folder: PathBuf) -> Self {
        let capture = Capture::default();
        Self { folder, script: script(), at: 0, asked: false, since: Instant::now(), capture }
    }

    /// Looks whether the next picture can be taken, once a frame.
    pub fn advance(&mut self, ctx: &Context, state: &State, commands: &mut Commands) {
        ctx.request_repaint_after(Duration::from_millis(20));
        if self.asked {
            let Some(image) = self.capture.take() else { return };
            capture::save(&self.folder.join(format!("{:03}.png", self.at)), &image);
            (self.at, self.asked, self.since) = (self.at + 1, false, Instant::now());
            match self.script.get(self.at) {
                Some(change) => commands.extend(command(*change, state)),
                None => {
                    eprintln!("boxwood: {} pictures for {RATE} a second in {}", self.at, self.folder.display());
                    ctx.send_viewport_cmd(ViewportCommand::Close);
                }
            }
            return;
        }
        let settled = state.shown.is_some() && !state.is_busy();
        if self.at < self.script.len() && (settled || self.since.elapsed() > PATIENCE) {
            if self.at == 0
                && let Err(why) = std::fs::create_dir_all(&self.folder)
            {
                eprintln!("boxwood: Can't make the folder {}: {why}", self.folder.display());
                return ctx.send_viewport_cmd(ViewportCommand::Close);
            }
            self.capture.ask(ctx);
            self.asked = true;
        }
    }
}

fn command(change: Change, state: &State) -> Option<Command> {
    match change {
        Change::Nothing => None,
        Change::Turn => Some(Command::Camera(navigation::orbit(&state.camera, TURN, 600.0))),
        Change::Structure(id) => Some(Command::Structure(id)),
        Change::Depth(depth) => {
            let overlay = state.settings.overlay;
            Some(Command::Overlay(OverlaySettings { depth, from_depth: depth, boxes: true, ..overlay }))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accel::registry;

    #[test]
    fn it_takes_eight_seconds_at_most_and_shows_what_there_is() {
        let script = script();
        assert!(script.len() <= 8 * RATE as usize, "{} pictures", script.len());
        for change in script {
            assert!(!matches!(change, Change::Structure(id) if registry::find(id).is_none()));
        }
    }
}
