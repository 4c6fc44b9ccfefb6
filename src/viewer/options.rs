//! What the command line says to the window.

use std::path::PathBuf;

use super::panes::{Arrange, PaneChoice, Shows};
use super::settings::{BoxColor, Settings, ThemeChoice, Workspace};
use super::tradeoffs::Plot;
use crate::accel::outline::Rank;
use crate::accel::registry;
use crate::geometry::Axis;
use crate::render::{HeatRays, Mode};
use crate::scene::{CameraSpec, Section};

/// How the window begins. What is not set comes from the settings of the last time.
#[derive(Clone, Debug, Default)]
pub struct ViewerOptions {
    /// The model to open.
    pub model: Option<String>,
    /// The structure's id.
    pub structure: Option<String>,
    /// What is shown.
    pub mode: Option<Mode>,
    /// Whose work heat maps show.
    pub heat_rays: Option<HeatRays>,
    /// From where it is seen at first.
    pub camera: Option<CameraSpec>,
    /// Where it is cut open at first.
    pub section: Option<Section>,
    /// The depth of the boxes.
    pub depth: Option<u32>,
    /// From where on they are drawn (see [`super::settings::OverlaySettings::begin`]).
    pub boxes_from: Option<u32>,
    /// Only the boxes of leaves.
    pub leaves_only: bool,
    /// What colours of boxes stand for.
    pub color_boxes: Option<BoxColor>,
    /// No boxes and planes at all.
    pub no_overlay: bool,
    /// Samples after which to rest.
    pub samples: Option<u32>,
    /// Light or dark.
    pub theme: Option<ThemeChoice>,
    /// The window's size in points.
    pub size: Option<[f32; 2]>,
    /// Measure every structure once the picture is there; only with `screenshot`.
    pub measure: bool,
    /// Time the tiles of the view and show them; only with `screenshot`.
    pub time_tiles: bool,
    /// Begin in the Check workspace; with `screenshot`, run the lab first.
    pub check: bool,
    /// Begin in the Compare workspace with that plot; with `screenshot`, fill it first.
    pub errors: Option<Plot>,
    /// Begin in the Structure workspace; with `screenshot`, select that cell first.
    pub select: Option<Rank>,
    /// With that, show the triangles of that cell alone.
    pub isolate: bool,
    /// With `select`, try a plane across an axis of it, at a place from 0 to 1.
    pub try_plane: Option<(Axis, f64)>,
    /// Begin in the Structure workspace; with `screenshot`, make the film of the build first, and go to that part of it, from 0
    /// to 1.
    pub film: Option<f32>,
    /// With `select`, compare bounding volumes around it, and draw one of that kind.
    pub fit: Option<&'static str>,
    /// Begin in the Ray workspace; with `screenshot`, follow the ray of that place first: (-1, -1) is the lower left corner of
    /// the view, (1, 1) the upper right.
    pub follow: Option<[f32; 2]>,
    /// Begin in the Ray workspace, with that file of rays; with `screenshot`, follow the dearest of them first.
    pub rays: Option<PathBuf>,
    /// Structures whose steps stand beside the shown one's.
    pub beside: Vec<String>,
    /// With `screenshot`, compare the whole view with brute force first.
    pub brute: bool,
    /// Begin the tour at this step, from 0; without it, the first window of all begins it at the first.
    pub tour: Option<usize>,
    /// Begin in the Compare workspace with these structures beside each other, the first of them the shown one.
    pub panes: Vec<String>,
    /// How they stand.
    pub arrange: Option<Arrange>,
    /// The last of them shows its difference from the first.
    pub difference: bool,
    /// In a window that folds the panel at the right, open it over the view.
    pub unfold: bool,
    /// Turn the camera and switch structures before that, to see how soon pictures follow.
    pub pace: bool,
    /// Switch structures a thousand times and open fifty models before that, to see what becomes of the memory.
    pub endure: bool,
    /// Save a picture of the window here once everything is there, and close.
    pub screenshot: Option<PathBuf>,
    /// Show the window at work, and save a picture of each step into this folder.
    pub animate: Option<PathBuf>,
    /// Threads that load, build and measure; 0 for one a core.
    pub threads: usize,
    /// The memory budget in MiB.
    pub memory_mib: Option<u64>,
}

impl ViewerOptions {
    /// Whether the window is driven by the command line alone: then nothing of the last time shows.
    pub const fn is_scripted(&self) -> bool {
        self.screenshot.is_some() || self.animate.is_some()
    }

    /// Puts what is set into the settings.
    pub fn apply(&self, settings: &mut Settings) {
        if let Some(structure) = &self.structure {
            settings.structure.clone_from(structure);
        }
        settings.mode = self.mode.unwrap_or(settings.mode);
        settings.heat_rays = self.heat_rays.unwrap_or(settings.heat_rays);
        settings.max_samples = self.samples.unwrap_or(settings.max_samples);
        settings.theme = self.theme.unwrap_or(settings.theme);
        if self.check {
            settings.workspace = Workspace::Check;
        }
        if self.select.is_some() || self.film.is_some() {
            settings.workspace = Workspace::Structure;
        }
        if self.follow.is_some() || self.rays.is_some() {
            settings.workspace = Workspace::Ray;
        }
        if let Some(plot) = self.errors {
            settings.workspace = Workspace::Compare;
            if plot == Plot::Image {
                settings.mode = Mode::Path;
            }
        }
        self.compare(settings);
        let overlay = &mut settings.overlay;
        if let Some(depth) = self.depth {
            (overlay.depth, overlay.from_depth, overlay.boxes) = (depth, depth, true);
        }
        overlay.leaves_only |= self.leaves_only;
        overlay.begin = self.boxes_from.unwrap_or(overlay.begin);
        overlay.color = self.color_boxes.unwrap_or(overlay.color);
        if self.no_overlay {
            (overlay.boxes, overlay.planes) = (false, false);
        }
    }

    /// Puts structures beside each other.
    fn compare(&self, settings: &mut Settings) {
        let mut entries = self.panes.iter().filter_map(|id| registry::find(id));
        if let Some(first) = entries.next() {
            first.id.clone_into(&mut settings.structure);
            settings.workspace = Workspace::Compare;
            settings.panes.others.clear();
        }
        for (which, entry) in entries.enumerate() {
            let choice = PaneChoice::of(entry, settings);
            settings.panes.put(which, choice);
        }
        settings.panes.arrange = self.arrange.unwrap_or(settings.panes.arrange);
        if let Some(last) = settings.panes.others.last_mut().filter(|_| self.difference) {
            last.shows = Shows::Difference;
        }
    }
}
