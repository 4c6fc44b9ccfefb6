//! Nanoseconds by tiles of the picture: what is measured of which view, and the picture of it.

use std::sync::Arc;

use super::kept::Key;
use super::panes::Pauses;
use super::shown;
use super::workers::Shared;
use crate::geometry::HalfSpace;
use crate::job::Job;
use crate::lab::Fairness;
use crate::lab::tile_times::{TileTimes, time_tiles};
use crate::render::{self, Amounts, HeatRays, Picture, Range};
use crate::scene::Camera;
use crate::task::Cancelled;

/// What tiles were timed of.
#[derive(Clone, Debug, PartialEq)]
pub struct TileView {
    /// The structure.
    pub key: Key,
    /// From where it is seen.
    pub camera: Camera,
    /// Where the model is cut open for it.
    pub section: Option<HalfSpace>,
    /// Columns and rows.
    pub size_px: [u32; 2],
    /// Which rays.
    pub rays: HeatRays,
}

/// Tiles on their way.
pub type TimingTiles = Job<Result<TileTimes, Cancelled>>;
/// The depths of the picture that boxes are hidden by.
pub type Depths = Arc<Vec<f32>>;
/// Their picture, on its way, with the depths that it was given.
pub type DrawingTiles = Job<(Depths, Picture)>;

/// Everything of it.
#[derive(Default)]
pub struct Tiles {
    /// Whether their picture is asked for in place of the renderer's.
    pub shown: bool,
    /// The measurement, while it runs, and of what.
    pub running: Option<(TileView, TimingTiles)>,
    /// What was measured.
    pub found: Option<(TileView, Arc<TileTimes>)>,
    /// Its picture, the range that was asked for, and the depths that boxes are hidden by.
    pub picture: Option<(Option<Range>, Depths, Arc<Picture>)>,
    /// That, on its way.
    pub drawing: Option<(Option<Range>, DrawingTiles)>,
}

impl Tiles {
    /// Forgets what was measured, not that it is asked for.
    pub fn clear(&mut self) {
        *self = Self { shown: self.shown, ..Self::default() };
    }
}

/// The terms on which they are timed: those of the table of timings.
pub const TERMS: Fairness = Fairness::LikeForLike;

/// Starts timing the tiles of a view, on one thread; the renderer is kept from running meanwhile.
pub fn time(shared: &Shared, view: render::Job, size_px: [u32; 2], pause: Pauses) -> std::io::Result<TimingTiles> {
    Job::spawn("tiles", shared.waker(), move |cancel, progress| {
        pause.wait();
        time_tiles(&view, size_px, TERMS, cancel, progress)
    })
}

/// Starts drawing them in a range, or in one that suits; depths are those of the present picture, if it is whole.
pub fn draw(
    shared: &Shared,
    (view, times): (TileView, Arc<TileTimes>),
    present: Arc<Picture>,
    range: Option<Range>,
) -> std::io::Result<DrawingTiles> {
    let pool = shared.pool.clone();
    Job::spawn("draw tiles", shared.waker(), move |_, _| {
        let (range, rgba, amounts) = pool.run(|| {
            let amounts = Amounts::new(times.by_pixel());
            let range = range.unwrap_or_else(|| amounts.fitting_range());
            (range, amounts.develop(range), amounts)
        });
        let picture = shown::in_place_of(&present, view.size_px, rgba);
        let picture = Picture { range, amounts: Some(Arc::new(amounts)), camera: view.camera, ..picture };
        (Arc::clone(&present.depth), picture)
    })
}
