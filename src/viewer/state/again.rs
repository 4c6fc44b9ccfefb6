//! What a workspace file says was made of its structure, made again in the background, each thing once it is possible: the film,
//! bounding volumes around the selected node, and the times of tiles.

use super::State;
use crate::accel::CellId;
use crate::accel::volumes::KINDS;
use crate::render::{Mode, Range};
use crate::viewer::filming;
use crate::viewer::kept::Key;
use crate::viewer::rays;
use crate::viewer::workspace_file::{Look, Made};

/// What is still to be made.
#[derive(Default)]
pub(super) struct Again {
    structure: Option<OfStructure>,
    /// Ranges that compared pictures shared, each with what it is of.
    shared: Vec<(Mode, Range)>,
}

/// What is made of a structure, once that is shown.
struct OfStructure {
    key: Key,
    /// The position of the film.
    film: Option<u32>,
    /// The cells from the root to the node that volumes are compared around.
    volumes: Option<Vec<CellId>>,
    /// The kind of them that is drawn.
    drawn: Option<&'static str>,
    /// Tiles are timed.
    tiles: bool,
}

impl Again {
    /// Whether anything is still to be made.
    pub(super) const fn is_busy(&self) -> bool {
        self.structure.is_some()
    }

    /// Whether the cells of the structure are needed for its film.
    pub(super) fn needs_outline(&self) -> bool {
        self.structure.as_ref().is_some_and(|of| of.film.is_some())
    }

    /// The range that compared pictures of a kind shared: told once, since they find one of their own afterwards.
    pub(super) fn take_shared(&mut self, mode: Mode) -> Option<Range> {
        let at = self.shared.iter().position(|(of, _)| *of == mode)?;
        Some(self.shared.swap_remove(at).1)
    }

    /// Such ranges are found anew.
    pub(super) fn forget_shared(&mut self) {
        self.shared.clear();
    }
}

impl OfStructure {
    const fn is_left(&self) -> bool {
        self.film.is_some() || self.volumes.is_some() || self.tiles
    }
}

/// Whether colours can be made by a range.
fn is_one(range: &Range) -> bool {
    range.min.is_finite() && range.max.is_finite() && range.min < range.max
}

impl State {
    /// How what is measured is looked at, for a file.
    pub(super) fn to_look(&self) -> Look {
        let shared = self.shared_ranges().chain(self.again.shared.iter().copied());
        Look {
            range: self.range.filter(is_one),
            shared: shared.filter(|(_, range)| is_one(range)).collect(),
            tiles: self.tiles.shown,
            plot: self.tradeoffs.plot,
            miss: self.tradeoffs.miss,
            goodness: self.tradeoffs.goodness,
            errors_as_table: self.errors.as_table,
            terms: self.terms_of_timings,
            film_speed: Some(self.filming.speed),
            ray_speed: Some(self.rays.speed),
        }
    }

    /// Looks at it as a file says.
    pub(super) fn look_as(&mut self, look: Look) {
        self.show_tiles(look.tiles);
        self.set_heat_range(look.range);
        self.again.shared = look.shared.into_iter().filter(|(_, range)| is_one(range)).collect();
        (self.tradeoffs.plot, self.tradeoffs.miss, self.tradeoffs.goodness) = (look.plot, look.miss, look.goodness);
        self.errors.as_table = look.errors_as_table;
        self.terms_of_timings = look.terms;
        let within = |speed: Option<f32>, speeds: std::ops::RangeInclusive<f32>| {
            speed.filter(|speed| speed.is_finite()).map(|speed| speed.clamp(*speeds.start(), *speeds.end()))
        };
        self.filming.speed = within(look.film_speed, filming::SPEEDS).unwrap_or(self.filming.speed);
        self.rays.speed = within(look.ray_speed, rays::SPEEDS).unwrap_or(self.rays.speed);
    }

    /// What was made or is on its way, for a file; hidden triangles are numbered elsewhere.
    pub(super) fn to_made(&self) -> Made {
        // What is to be made of another structure than the chosen one is not wanted any more.
        let awaited = self.again.structure.as_ref().filter(|of| of.key == self.wanted_key());
        // What is made is of the structure that is shown, while another one may be on its way.
        let stays = self.building.is_none();
        let volumes = self.fitting().is_some() || self.fits.running.is_some();
        let tiles = self.shows_tiles() || self.tiles.running.is_some();
        let drawn = awaited.and_then(|of| of.drawn).or_else(|| self.fits.drawn.filter(|_| stays));
        Made {
            rays: self.rays_file(),
            film: awaited.and_then(|of| of.film).or_else(|| self.filming.place().filter(|_| stays)),
            tiles: awaited.is_some_and(|of| of.tiles) || (tiles && stays),
            volumes: awaited.is_some_and(|of| of.volumes.is_some()) || (volumes && stays),
            drawn: drawn.map(str::to_owned),
            ..Made::default()
        }
    }

    /// Makes again what a file says: of the chosen structure, around the cell at the end of those.
    pub(super) fn make_again(&mut self, made: Made, selected: &[(u32, u32)]) {
        self.rehide(made.hidden, made.hidden_now);
        if let Some(rays) = made.rays {
            self.bring_rays(rays);
        }
        let drawn = made.drawn.and_then(|id| KINDS.iter().find(|kind| kind.id == id)).map(|kind| kind.id);
        let path = selected.iter().map(|(instance, node)| CellId { instance: *instance, node: *node });
        let volumes = made.volumes.then(|| path.collect());
        let of = OfStructure { key: self.wanted_key(), film: made.film, volumes, drawn, tiles: made.tiles };
        self.again.structure = Some(of);
    }

    /// Begins what has become possible, one after the other.
    pub(super) fn advance_again(&mut self) {
        let under_way = self.loading.is_some() || self.building.is_some() || self.awaited.is_some();
        if under_way || self.tree.selecting.is_some() || self.model.is_none() {
            return;
        }
        let Some(mut of) = self.again.structure.take() else { return };
        // Where the build came to nothing, or another structure was chosen, nobody waits any more.
        if self.shown.as_ref().is_none_or(|shown| shown.key != of.key) {
            return;
        }
        self.fits.drawn = of.drawn.take().or(self.fits.drawn);
        self.film_again(&mut of);
        if of.film.is_none() && of.volumes.is_some() && (self.fits.running.is_some() || self.has_rest()) {
            self.fit_again(&of.volumes.take().unwrap_or_default());
        } else if of.film.is_none() && of.tiles && (self.tiles.running.is_some() || !self.tiles.shown || self.has_rest()) {
            of.tiles = false;
            self.tiles_again();
        }
        self.again.structure = Some(of).filter(OfStructure::is_left);
    }

    fn film_again(&mut self, of: &mut OfStructure) {
        let Some(at) = of.film else { return };
        let made = self.filming.film.is_some() || self.filming.making.is_some();
        if made {
            of.film = None;
        } else if let Some(why) = self.no_film() {
            of.film = None;
            self.not_made_again("make the film", why);
        } else if self.can_make_film() {
            of.film = None;
            self.begin_film(at);
        }
    }

    /// Why there can be no film of the shown structure, in words for the user.
    fn no_film(&self) -> Option<&'static str> {
        if !self.has_film() {
            Some("this structure has none")
        } else if self.tree.failed.is_some() {
            Some("the cells of the structure could not be listed")
        } else if self.tree.outline.as_ref().is_some_and(|outline| outline.is_cut()) {
            Some("not all cells of the structure could be listed: they do not fit")
        } else {
            None
        }
    }

    /// Tells what can't be done that was done when a file was saved, and why.
    fn not_made_again(&mut self, what: &str, why: &str) {
        self.also_fail(&format!("Can't {what} again: {why}. The rest of the workspace is open."));
    }

    fn fit_again(&mut self, path: &[CellId]) {
        if self.fitting().is_some() || self.fits.running.is_some() {
            return;
        }
        let there = self.picked.as_ref().is_some_and(|picked| picked.selected().is_some() && picked.ids() == path);
        if !there {
            self.not_made_again("compare bounding volumes", "the node that they were around is not selected");
        } else if self.fittable().is_none() {
            self.not_made_again("compare bounding volumes", "the node is of the upper level, whose triangles are in many spaces");
        } else {
            self.fit_volumes();
        }
    }

    fn tiles_again(&mut self) {
        if self.tiles.shown && self.tiles.found.is_none() && self.tiles.running.is_none() {
            self.time_tiles();
        }
    }

    /// Whether something can be measured of the view: it is drawn as it will stay, and nothing has just begun that this would end.
    fn has_rest(&self) -> bool {
        let begun = self.counting.is_some() || self.predicting.is_some() || self.is_exploring() || self.awaits_visits();
        let followed = self.rays.following.is_some() || self.brute.running.is_some() || self.pane_in_building().is_some();
        // Panels that have come, as that of the film, have made the view smaller once the boxes are those of the view.
        let drawn = self.overlay_is_current && self.whole_picture().is_some();
        self.can_measure() && !begun && !followed && drawn
    }
}
