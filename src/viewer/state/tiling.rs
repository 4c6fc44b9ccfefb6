//! Tiles of the view are timed in the background, and shown as long as the view stays what they were timed of.

use std::sync::Arc;

use super::State;
use crate::job::Outcome;
use crate::render::{self, Mode, Picture};
use crate::viewer::tiles::{self, Depths, TileView};

impl State {
    /// The present view.
    fn tile_view(&self) -> Option<TileView> {
        let key = self.shown.as_ref()?.key.clone();
        let (camera, section, size_px, rays) = (self.camera, self.section(), self.size_px, self.settings.heat_rays);
        Some(TileView { key, camera, section, size_px, rays })
    }

    /// Whether what was timed is of another view, structure or kind of rays than the present.
    pub fn tiles_are_old(&self) -> bool {
        self.tiles.found.as_ref().is_some_and(|(view, _)| self.tile_view().as_ref() != Some(view))
    }

    /// Whether the picture on the screen is that of the tiles.
    pub fn shows_tiles(&self) -> bool {
        self.tiles.shown && self.tiles.picture.is_some() && !self.tiles_are_old()
    }

    /// Starts timing the tiles of the present view.
    pub(super) fn time_tiles(&mut self) {
        let Some(of) = self.tile_view() else { return };
        let Some((view, pause)) = self.begin_on_view(Mode::Nodes) else { return };
        let view = render::Job { heat_rays: of.rays, section: of.section, ..view };
        self.tiles.clear();
        match tiles::time(&self.shared, view, self.size_px, pause) {
            Ok(job) => self.tiles.running = Some((of, job)),
            Err(e) => self.fail(format!("Can't time the tiles: {e}.")),
        }
    }

    /// Takes in what was timed, and draws it anew where its range has changed.
    pub(super) fn advance_tiles(&mut self) {
        if let Some((of, job)) = self.tiles.running.take() {
            match job.poll() {
                Outcome::Running => self.tiles.running = Some((of, job)),
                Outcome::Done(Ok(times)) => self.tiles.found = Some((of, Arc::new(times))),
                Outcome::Done(Err(_)) => {}
                Outcome::Died => self.fail("Can't time the tiles: it failed. Please report this.".to_owned()),
            }
        }
        if let Some((range, job)) = self.tiles.drawing.take() {
            match job.poll() {
                Outcome::Running => self.tiles.drawing = Some((range, job)),
                Outcome::Done((of, picture)) => self.tiles.picture = Some((range, of, Arc::new(picture))),
                Outcome::Died => {
                    self.tiles.clear();
                    self.fail("Can't draw the tiles: it failed. Please report this.".to_owned());
                }
            }
        }
        if !self.tiles_await_drawing() {
            return;
        }
        if let (Some(found), Some(present)) = (&self.tiles.found, self.whole_picture()) {
            let drawing = tiles::draw(&self.shared, found.clone(), Arc::clone(present), self.range);
            self.tiles.drawing = drawing.ok().map(|job| (self.range, job));
        }
    }

    /// Whether the tiles on the screen are yet to be drawn, or in another range.
    fn tiles_await_drawing(&self) -> bool {
        // Boxes are hidden by the depths of the picture, which are those of what is seen now.
        let depth = self.whole_picture().map(|picture| &picture.depth);
        let is_current = |of: &Depths| depth.is_none_or(|depth| Arc::ptr_eq(depth, of));
        let current = self.tiles.picture.as_ref().is_some_and(|(range, of, _)| *range == self.range && is_current(of));
        let there = self.tiles.found.is_some() && self.whole_picture().is_some();
        self.tiles.shown && there && !self.tiles_are_old() && self.tiles.drawing.is_none() && !current
    }

    /// The picture of the present view, if it is no coarse one.
    pub(super) fn whole_picture(&self) -> Option<&Arc<Picture>> {
        self.picture.as_ref().filter(|picture| picture.camera == self.camera && picture.progress.step == 1)
    }

    /// Whether something of them is on its way.
    pub(super) fn is_tiling(&self) -> bool {
        self.tiles.running.is_some() || self.tiles.drawing.is_some() || self.tiles_await_drawing()
    }
}
