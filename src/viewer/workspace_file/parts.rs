//! What a workspace file says besides the settings: how what is measured is looked at, and what is made again once its model is
//! open.

use crate::accel::visibility::Written;
use crate::render::{Mode, Range};
use crate::viewer::timings::Terms;
use crate::viewer::tradeoffs::{Goodness, Miss, Plot};

/// How what is measured or played is looked at.
#[derive(Clone, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(default)]
pub struct Look {
    /// The range of the colours, where it is fixed.
    pub range: Option<Range>,
    /// The ranges that compared pictures share, each with what it is of.
    pub shared: Vec<(Mode, Range)>,
    /// Nanoseconds by tile stand in place of the picture.
    pub tiles: bool,
    /// The plot of the Compare workspace.
    pub plot: Plot,
    /// What of intersections is drawn there.
    pub miss: Miss,
    /// What of structures is drawn there.
    pub goodness: Goodness,
    /// Figures of errors stand in a table.
    pub errors_as_table: bool,
    /// How structures are timed, and the table sorted.
    pub terms: Terms,
    /// Events of the film a second.
    pub film_speed: Option<f32>,
    /// Steps of a ray a second.
    pub ray_speed: Option<f32>,
}

/// What is made again: it takes time, and may not be possible any more.
#[derive(Clone, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(default)]
pub struct Made {
    /// Sets of hidden triangles: that of the window, and those of the views that were kept.
    pub hidden: Vec<Written>,
    /// Which of them is that of the window, if triangles are hidden.
    pub hidden_now: Option<usize>,
    /// The file of rays.
    pub rays: Option<RaysFile>,
    /// The position of the film, if there is one.
    pub film: Option<u32>,
    /// Tiles are timed.
    pub tiles: bool,
    /// Bounding volumes are compared around the selected node.
    pub volumes: bool,
    /// The kind of them that is drawn.
    pub drawn: Option<String>,
}

/// A file of rays.
#[derive(Clone, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub struct RaysFile {
    /// Its whole path.
    pub path: String,
    /// The number in it of the ray that is followed, from 0.
    #[serde(default)]
    pub followed: Option<u32>,
}
