//! What the window knows; `dispatch` is how commands change it, `finished` what finished jobs change, and `refresh` what is asked
//! for anew when the view changes. No drawing here.

mod again;
mod asked;
mod bookmarks;
mod brute_force;
mod causes;
mod checking;
mod dialog;
mod dispatch;
mod erring;
mod exploring;
mod exporting;
mod filming;
mod finished;
mod following;
mod growing;
mod heating;
mod hiding;
mod keeping;
mod listing;
mod pane_boxes;
mod panes;
mod ranges;
mod refresh;
mod rehiding;
mod saving;
mod sectioning;
#[cfg(test)]
mod tests;
mod tiling;
mod touring;
mod trading;
mod undoing;
mod visiting;
mod volumes;

use again::Again;
use asked::Asked;
pub use bookmarks::Bookmark;
pub use causes::Causes;
pub use heating::LEAST_SPAN;
use hiding::Hiding;
pub use panes::{Pane, Panes};
use rehiding::Rehiding;
use saving::{Awaited, Saving};
use visiting::Visiting;
pub use volumes::Fits;

use std::path::PathBuf;
use std::sync::Arc;
use std::sync::mpsc::Receiver;
use std::time::{Duration, Instant};

use super::brute::Brute;
use super::checks::Checks;
use super::dialogs::FileDialog;
use super::errors::Errors;
use super::exports::Exports;
use super::filming::Filming;
use super::gpu::Overlay;
use super::graphics::Graphics;
use super::history::{Choices, History, Kind};
use super::kept::{Built, Kept, Key};
use super::model::{Instances, Model};
use super::overlay::{Collected, Wanted};
use super::panes::Pauses;
use super::pick::Picked;
use super::ray_list::RayList;
use super::rays::Rays;
use super::settings::{Settings, Workspace};
use super::tiles::Tiles;
use super::timings::{Terms, Timings};
use super::tour::Tour;
use super::tradeoffs::Tradeoffs;
use super::tree::Tree;
use super::workers::{
    self, Building, Collecting, Counting, Curving, Decoding, Loading, Measuring, Needing, Picking, Plan, Predicting, Shared,
};
use super::workspace_file::WorkspaceFile;
use crate::accel::{CellId, cell};
use crate::lab::SahCurves;
use crate::lab::needs::NeedsReport;
use crate::render::{Mode, Picture, Range, Renderer};
use crate::scene::texture::Detail;
use crate::scene::{Camera, CameraSpec, Section};
use crate::task::Pool;
use glam::Vec2;

/// How long the window says what a switch of structures changed.
const CHANGE_SHOWN: Duration = Duration::from_secs(3);

/// Everything.
pub struct State {
    /// What is remembered.
    pub settings: Settings,
    /// The open model.
    pub model: Option<Model>,
    /// The structure on the screen.
    pub shown: Option<Built>,
    /// The view.
    pub camera: Camera,
    /// The view that an opened model was framed in, and for what viewport: as long as nobody has moved
    /// it, it follows the viewport's shape.
    framed: Option<(Camera, [u32; 2])>,
    /// Where the first model is to be seen from, instead of where it suits.
    pub first_camera: Option<CameraSpec>,
    /// Where the first model is cut open.
    pub first_section: Option<Section>,
    /// For amounts: fixed by the user, or from the picture.
    pub range: Option<Range>,
    /// Where the picture was last clicked, and from where it was seen.
    clicked: Option<(Camera, Vec2)>,
    /// Nanoseconds by tiles of the picture.
    pub tiles: Tiles,
    /// The newest picture of the open model.
    pub picture: Option<Arc<Picture>>,
    /// What is drawn over it.
    pub overlay: Option<Arc<Overlay>>,
    /// How much of the structure that is.
    pub collected: Collected,
    /// The table of timings.
    pub timings: Timings,
    /// How that is measured and sorted.
    pub terms_of_timings: Terms,
    /// What is taken away from the window.
    pub exports: Exports,
    /// The Check workspace.
    pub checks: Checks,
    /// The picture's error, in the Compare workspace.
    pub errors: Errors,
    /// Quality against its cost, there.
    pub tradeoffs: Tradeoffs,
    /// The cells of the shown structure, in the Structure workspace.
    pub tree: Tree,
    /// The film of the shown structure's build, in the Structure workspace.
    pub filming: Filming,
    /// Why rays are slow in the shown structure.
    pub causes: Causes,
    /// Bounding volumes around the selected node.
    pub fits: Fits,
    /// Pictures beside that of the shown structure.
    pub panes: Panes,
    /// Threads that trace.
    trace_pool: Pool,
    /// The ray of the Ray workspace.
    pub rays: Rays,
    /// The picture compared with brute force.
    pub brute: Brute,
    /// A file of rays, there.
    pub ray_list: RayList,
    /// Triangles to be hidden, on their way.
    pub hiding: Option<Hiding>,
    /// What was last clicked.
    pub picked: Option<Picked>,
    /// An error to show, until it is put away.
    pub error: Option<String>,
    /// The camera's moves, which can be taken back.
    pub cameras: History<Camera>,
    /// Choices of structure, parameters, selection and visibility, which can be taken back.
    pub choices: History<Choices>,
    /// The first picture of what was last asked for, once it is there.
    pub answer: Option<Answer>,
    /// What the last switch of structures changed, and until when it is said.
    pub change: Option<(String, Instant)>,
    /// The field for a path is open, with this in it.
    pub asking: Option<String>,
    /// The palette of commands is open.
    pub palette: bool,
    /// The page of keys is open.
    pub help: bool,
    /// The page of settings is open.
    pub preferences: bool,
    /// The page of terms is open.
    pub terms: bool,
    /// How far somebody is on the tour, if anybody is.
    pub tour: Option<Tour>,
    /// Everything is larger and the panels are away, for an audience.
    pub presenting: bool,
    /// The window is too narrow for the panel at the right: it is folded to a strip.
    pub folds: bool,
    /// That panel is open all the same, over the view.
    pub unfolded: bool,
    /// The workspace file that is saved or opened.
    saving: Saving,
    /// A cell to select once its structure is there.
    awaited: Option<Awaited>,
    /// What a workspace file says was made of its structure.
    again: Again,
    /// Hidden triangles of a workspace file.
    rehiding: Option<Rehiding>,
    /// Views of the open model that were kept.
    pub bookmarks: Vec<Bookmark>,
    /// The first and the last depth that were chosen, whether or not the shown structure is as deep.
    chosen_depths: (u32, u32),
    /// The viewport in pixels, as it was last drawn.
    pub size_px: [u32; 2],
    /// What draws the window.
    graphics: Graphics,
    /// What is loading.
    pub loading: Option<(String, Loading)>,
    /// What is being built.
    pub building: Option<Building>,
    /// What is being measured.
    pub measuring: Option<Measuring>,
    /// What leaving out saves for the open model, once it was measured.
    pub needs: Option<NeedsReport>,
    /// That, on its way.
    pub needing: Option<Needing>,
    /// What becomes of the instances of models that are opened.
    pub instances: Instances,
    /// The view to go on with when the same model was opened anew, and what became of instances before.
    reopened: Option<(Camera, Instances)>,
    /// Keeps the renderer at rest while nobody sees the window.
    hidden: Option<Pauses>,
    /// Bytes of memory that the machine has.
    pub machine_bytes: u64,
    kept: Kept,
    /// The structure of which a picture is on the screen: what is worked out beside it comes after.
    seen: Option<Key>,
    /// The structure whose figures were asked for last.
    counted: Option<Key>,
    counting: Option<Counting>,
    predicting: Option<Predicting>,
    /// The structure whose predictions were asked for last.
    predicted: Option<Key>,
    decoding: Option<(Detail, Decoding)>,
    /// Which images are decoded, as far as they can be read.
    textures: Option<Detail>,
    collecting: Option<(Wanted, Key, Collecting)>,
    collected_for: Option<(Wanted, Key)>,
    /// How often rays enter cells, for their colours.
    visiting: Visiting,
    /// The boxes are those of the present view, structure and settings.
    overlay_is_current: bool,
    dialog: Box<dyn FileDialog>,
    asked_for_file: Option<Receiver<Option<PathBuf>>>,
    picking: Option<Picking>,
    /// The SAH curves of the selected cell, once they are worked out.
    pub curves: Option<(CellId, Option<SahCurves>)>,
    curving: Option<(CellId, Curving)>,
    renderer: Renderer,
    requested: Option<Asked>,
    requested_at: Instant,
    /// Nodes a ray of the structure shown before, to be compared once the new one is counted.
    before: Option<(&'static str, f64)>,
    generation: u64,
    /// Models that were opened: the number of the present one.
    models: u64,
    shared: Shared,
}

/// How soon the first picture of a request was there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Answer {
    /// Which request.
    pub request: u64,
    /// Seconds from the frame that asked to the one that has it.
    pub secs: f64,
    /// One pixel for so many on each axis.
    pub step: u32,
}

impl State {
    /// An empty window with its threads.
    ///
    /// # Errors
    /// If the system grants no thread.
    pub fn new(settings: Settings, shared: Shared, dialog: Box<dyn FileDialog>, graphics: Graphics) -> std::io::Result<Self> {
        let wake = Arc::clone(&shared.wake);
        // One core is left to the window, so that it always finds one.
        let pool = Pool::new("trace", crate::sys::cores().saturating_sub(1).max(1));
        let renderer = Renderer::new(pool.clone(), move || wake())?;
        Ok(Self {
            chosen_depths: (settings.overlay.from_depth, settings.overlay.depth),
            settings,
            model: None,
            shown: None,
            camera: Camera::framing(&crate::geometry::Aabb::EMPTY, glam::Vec3::Z, glam::Vec3::Y, 1.0),
            framed: None,
            first_camera: None,
            first_section: None,
            range: None,
            clicked: None,
            tiles: Tiles::default(),
            picture: None,
            overlay: None,
            collected: Collected::default(),
            timings: Timings::default(),
            terms_of_timings: Terms::default(),
            exports: Exports::default(),
            checks: Checks::default(),
            errors: Errors::default(),
            tradeoffs: Tradeoffs::default(),
            tree: Tree::default(),
            filming: Filming::default(),
            causes: Causes::default(),
            fits: Fits::default(),
            panes: Panes::default(),
            trace_pool: pool.clone(),
            rays: Rays::default(),
            brute: Brute::default(),
            ray_list: RayList::default(),
            hiding: None,
            picked: None,
            error: None,
            answer: None,
            cameras: History::default(),
            choices: History::default(),
            change: None,
            asking: None,
            palette: false,
            help: false,
            preferences: false,
            terms: false,
            tour: None,
            presenting: false,
            folds: false,
            unfolded: false,
            saving: Saving::default(),
            awaited: None,
            again: Again::default(),
            rehiding: None,
            bookmarks: Vec::new(),
            size_px: [0, 0],
            graphics,
            loading: None,
            building: None,
            measuring: None,
            needs: None,
            needing: None,
            instances: Instances::default(),
            reopened: None,
            hidden: None,
            machine_bytes: crate::sys::memory_bytes(),
            kept: Kept::default(),
            seen: None,
            counted: None,
            counting: None,
            predicting: None,
            predicted: None,
            decoding: None,
            textures: None,
            collecting: None,
            collected_for: None,
            visiting: Visiting::default(),
            overlay_is_current: false,
            dialog,
            asked_for_file: None,
            picking: None,
            curves: None,
            curving: None,
            renderer,
            requested: None,
            requested_at: Instant::now(),
            before: None,
            generation: 0,
            models: 0,
            shared,
        })
    }

    /// The key of the structure that is chosen.
    pub fn wanted_key(&self) -> Key {
        let entry = self.settings.entry();
        Key { entry, params: self.settings.params_of(entry), test: self.settings.test_of(entry) }
    }

    /// Whether work that must not be disturbed runs.
    pub fn is_measuring(&self) -> bool {
        self.measuring.is_some()
            || self.exports.report.is_some()
            || self.needing.is_some()
            || self.causes.running.is_some()
            || self.fits.running.is_some()
            || self.errors.making.is_some()
            || self.tradeoffs.running.is_some()
            || self.tiles.running.is_some()
            || self.tradeoffs.growing.is_some()
    }

    /// Whether the lab runs, the model is checked, a file of rays is traced, a film is made or triangles are sorted out, which
    /// would disturb a measurement.
    pub fn is_checking(&self) -> bool {
        self.checks.running.is_some()
            || self.checks.checking.is_some()
            || self.ray_list.tracing.is_some()
            || self.filming.making.is_some()
            || self.is_hiding()
    }

    /// Whether a measurement can begin: there is a structure, and nothing runs that either would disturb.
    pub fn can_measure(&self) -> bool {
        self.shown.is_some() && self.building.is_none() && !self.is_measuring() && !self.is_checking()
    }

    /// Width over height of the viewport.
    pub fn aspect(&self) -> f32 {
        self.size_px[0].max(1) as f32 / self.size_px[1].max(1) as f32
    }

    /// The most triangles that this machine rasterises fluently.
    pub fn preview_limit(&self) -> usize {
        self.graphics.comfortable_triangles()
    }

    /// Whether anything runs that will change what is shown.
    pub fn is_busy(&self) -> bool {
        let asked = self.requested.as_ref().map(|a| a.number);
        let at_rest = |p: &Arc<Picture>| p.progress.done && Some(p.request) == asked;
        let drawing = self.shown.is_some() && !(self.picture.as_ref().is_some_and(at_rest) && self.overlay_is_current);
        self.loading.is_some()
            || self.building.is_some()
            || self.is_measuring()
            || self.counting.is_some()
            || self.predicting.is_some()
            || self.is_exploring()
            || self.filming.making.is_some()
            || self.rays.following.is_some()
            || self.brute.running.is_some()
            || self.is_tiling()
            || self.awaits_visits()
            || self.ray_list.is_busy()
            || self.is_hiding()
            || self.saving.is_busy()
            || self.exports.is_writing()
            || self.awaited.is_some()
            || self.again.is_busy()
            || self.is_touring()
            || self.panes_are_busy()
            || drawing
    }

    fn pick(&mut self, at: Vec2) {
        let ray = self.ray_at(at);
        self.select_no_more();
        self.note_click(at);
        if self.settings.workspace == Workspace::Ray {
            self.follow_anew(ray);
        }
        let (Some(model), Some(shown)) = (&self.model, &self.shown) else { return };
        let through = (Arc::clone(&shown.accel), self.visible().cloned());
        self.picking = workers::pick(&self.shared, Arc::clone(&model.scene), through, ray).ok();
    }

    /// Moves the camera; it can be moved back.
    fn look(&mut self, camera: Camera, kind: Kind) {
        self.cameras.leave(self.camera, kind, Instant::now());
        self.camera = camera;
    }

    /// The selected box is drawn with the others, so they are collected anew.
    fn select(&mut self, picked: Option<Picked>) {
        let id = |picked: &Option<Picked>| picked.as_ref().and_then(Picked::selected).map(|cell| cell.id);
        if id(&self.picked) != id(&picked) {
            (self.tree.tried, self.tree.revealed) = (None, false);
        }
        self.picked = picked;
        self.collected_for = None;
        self.curving = None;
        self.shared.give_back(self.curves.take()); // they may be large
        self.follow_selection();
    }

    fn frame_all(&mut self) {
        if let Some(model) = &self.model {
            let framed = self.camera.reframed(&model.bounds(), self.aspect());
            self.look(framed, Kind::Single);
        }
    }

    fn open(&mut self, model: String) {
        if WorkspaceFile::is_one(&model) {
            return self.open_workspace(model);
        }
        if RayList::is_one(&model) {
            return self.open_rays(model.into());
        }
        self.saving.forget();
        self.asking = None;
        self.error = None;
        self.checks.checking = None;
        self.generation += 1;
        self.stay();
        match workers::load(&self.shared, model.clone(), self.generation, self.instances) {
            Ok(job) => self.loading = Some((model, job)),
            Err(e) => self.fail(format!("Can't open {model}: {e}.")),
        }
    }

    /// Tells whether anybody can see the window: what nobody sees is not traced.
    pub fn hide(&mut self, hidden: bool) {
        if hidden != self.hidden.is_some() {
            self.hidden = hidden.then(|| self.pause_rendering());
        }
    }

    fn fail(&mut self, error: String) {
        self.error = Some(error);
    }

    /// Tells one thing more that went wrong.
    fn also_fail(&mut self, error: &str) {
        let before = self.error.take().map(|before| before + " ").unwrap_or_default();
        self.error = Some(before + error);
    }

    /// Shows the chosen structure: a kept one at once, another after its build.
    fn choose(&mut self) {
        let key = self.wanted_key();
        if self.shown.as_ref().is_some_and(|b| b.key == key) {
            self.building = None;
            return;
        }
        if self.building.as_ref().is_some_and(|b| b.key == key) {
            return;
        }
        if let Some(built) = self.kept.take_up(&key) {
            self.building = None;
            self.timings.built(&built);
            self.show(built);
            return;
        }
        let Some(model) = &self.model else { return };
        match workers::build(&self.shared, key, Arc::clone(&model.geometry)) {
            Ok(building) => self.building = Some(building),
            Err(e) => self.fail(format!("Can't build {}: {e}.", self.settings.structure)),
        }
    }

    /// The last structure stays, and is the chosen one again.
    fn cancel_build(&mut self) {
        self.building = None;
        if let Some(shown) = &self.shown {
            let key = shown.key.clone();
            self.settings.structure = key.entry.id.to_owned();
            self.settings.remember(key.entry, &key.params);
            self.settings.test = key.test;
        }
    }

    fn show(&mut self, built: Built) {
        self.before = self.nodes_per_ray();
        self.change = None;
        self.picking = None;
        self.select(None);
        self.shared.give_back(self.tree.outline.take()); // it may be large
        self.tree.clear();
        self.close_film();
        self.causes = Causes::default();
        self.fits = Fits::default();
        self.rays.clear();
        self.shared.give_back(std::mem::take(&mut self.visiting));
        self.shown = Some(built);
        if self.settings.workspace == Workspace::Ray {
            self.follow_again();
        }
        // A depth that the new structure does not have would show nothing.
        self.clamp_depth();
    }

    /// The chosen depths come back with a structure that has them.
    fn clamp_depth(&mut self) {
        if let Some(stats) = self.shown.as_ref().and_then(|b| b.stats.as_ref()) {
            let overlay = &mut self.settings.overlay;
            let (from_depth, depth) = self.chosen_depths;
            overlay.depth = depth.min(stats.max_depth);
            overlay.from_depth = from_depth.min(overlay.depth);
        }
    }

    /// Every structure over the open model, those that are kept and those to be built, and the present view.
    fn plan(&mut self) -> Option<Plan> {
        let (Some(_model), Some(_shown)) = (&self.model, &self.shown) else { return None };
        let test = self.settings.common_test();
        let wanted = crate::accel::registry::ALL.iter().map(|entry| Key { entry, params: self.settings.params_of(entry), test });
        let (mut kept, mut missing) = (Vec::new(), Vec::new());
        for key in wanted {
            match self.kept.take_up(&key) {
                Some(built) => kept.push(built),
                None => missing.push(key),
            }
        }
        let view = self.traced_view(Mode::Shaded)?;
        self.building = None;
        Some(Plan { kept, missing, view, size_px: self.size_px })
    }

    fn measure(&mut self) {
        if self.is_checking() || self.is_measuring() {
            return;
        }
        let Some(plan) = self.plan() else { return };
        let pause = self.begin_measuring();
        match workers::measure_all(&self.shared, plan, self.terms_of_timings.fairness, pause) {
            Ok(job) => self.measuring = Some(job),
            Err(e) => self.fail(format!("Can't measure: {e}.")),
        }
    }

    /// Takes in what jobs have finished, and starts what follows from it. Called once a frame.
    pub fn advance(&mut self) {
        self.advance_dialog();
        self.advance_saving();
        self.advance_exports();
        self.advance_load();
        self.advance_build();
        self.advance_causes();
        self.advance_fitting();
        self.advance_outline();
        self.advance_filming();
        self.advance_following();
        self.advance_brute_force();
        self.advance_ray_list();
        self.advance_hiding();
        self.advance_rehiding();
        self.advance_picking();
        self.advance_curves();
        self.advance_measuring();
        self.advance_needs();
        self.advance_lab();
        self.advance_check();
        self.follow_viewport();
        self.refresh_picture();
        self.advance_visits(); // those beside take what A has
        self.advance_panes();
        self.advance_errors();
        self.advance_tradeoffs();
        self.advance_tiles();
        self.advance_scaling();
        self.advance_statistics();
        self.advance_prediction();
        self.advance_textures();
        self.advance_tour();
        self.refresh_overlay();
        self.advance_again();
    }

    /// How the shown structure's cells relate.
    pub fn layout(&self) -> Option<cell::Layout> {
        self.shown.as_ref().map(|b| b.accel.layout())
    }
}
