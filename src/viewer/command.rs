//! What panels ask for. They never change shared state in the middle of a frame: they send a
//! command, and [`super::state::State::carry_out`] does it afterwards.

use super::checks::Cell;
use super::exports::Export;
use super::model::Instances;
use super::panes::{Arrange, PaneChoice};
use super::settings::{Navigation, OverlaySettings, SectionSettings, ThemeChoice, Workspace};
use super::timings::Column;
use super::tradeoffs::{Goodness, Miss, Plot};
use crate::accel::params::ParamValues;
use crate::accel::visibility::Change;
use crate::geometry::Axis;
use crate::geometry::tri::TestKind;
use crate::lab::{Fairness, PixelRect, RayKind};
use crate::render::sampler::SamplerKind;
use crate::render::{HeatRays, Mode, Range, Tone};
use crate::scene::Camera;
use glam::Vec2;

/// One thing to do.
#[derive(Clone, Debug, PartialEq)]
pub enum Command {
    /// Open a file or a built-in scene by name.
    Open(String),
    /// Ask for a file with the system's dialog.
    OpenDialog,
    /// Show, or hide, the field for a path.
    AskForPath(bool),
    /// Stop loading.
    CancelLoad,
    /// Show another structure.
    Structure(&'static str),
    /// Build the shown structure with other parameters.
    Params(ParamValues),
    /// Use another triangle test.
    Test(TestKind),
    /// Stop building; the last structure stays.
    CancelBuild,
    /// Show something else of the hits.
    Mode(Mode),
    /// Show the work of other rays.
    HeatRays(HeatRays),
    /// Show nanoseconds by tiles of the picture, or the picture again.
    ShowTiles(bool),
    /// Time the tiles of the present view.
    TimeTiles,
    /// Stop that.
    CancelTiles,
    /// Map amounts with a fixed range, or with one that suits.
    HeatRange(Option<Range>),
    /// Other boxes and planes.
    Overlay(OverlaySettings),
    /// Cut the model open elsewhere, or not at all.
    Section(SectionSettings),
    /// Show the triangles of the selected cell alone, or hide them.
    Hide(Change),
    /// Stop that.
    CancelHide,
    /// Show all triangles again.
    ShowAll,
    /// Look from elsewhere.
    Camera(Camera),
    /// Look from where the camera was before its last move.
    CameraBack,
    /// And forward again.
    CameraForward,
    /// Take back the last choice of structure, parameters, selection or visibility.
    Undo,
    /// Make it again.
    Redo,
    /// Say what is there: (-1, -1) is the lower left corner of the view, (1, 1) the upper right.
    Pick(Vec2),
    /// Select another of the cells that hold what was clicked, by depth.
    SelectLevel(usize),
    /// Select a cell by its row in the tree.
    SelectRow(u32),
    /// The same by an arrow key: rows that follow each other so are one step to take back.
    WalkToRow(u32),
    /// Show the children of a row, or hide all that is below it.
    OpenRow(u32, bool),
    /// Show everything below a row.
    OpenBelow(u32),
    /// Hide all but the root and its children.
    CloseTree,
    /// Try a plane in the selected node: across which axis, and where from 0 to 1.
    TryPlane(Option<(Axis, f64)>),
    /// Make the film of the shown structure's build.
    MakeFilm,
    /// Put it away, or stop making it.
    CloseFilm,
    /// Show it after so many events.
    FilmTo(u32),
    /// Play it, or stop.
    PlayFilm(bool),
    /// Its events a second.
    FilmSpeed(f32),
    /// Compare bounding volumes around the selected node.
    FitVolumes,
    /// Stop that.
    CancelFitVolumes,
    /// Draw a kind of them around it, or none.
    DrawVolume(Option<&'static str>),
    /// Look why rays of this view are slow.
    FindCauses,
    /// Stop that.
    CancelCauses,
    /// Show the cell where that is seen, by its row.
    ShowCause(u32),
    /// Follow the ray of the pixel, or one that leaves what it meets.
    RayKind(RayKind),
    /// Follow a ray that was typed.
    RayText(String),
    /// Ask for a file of rays.
    OpenRays,
    /// Follow a ray of the file, by its row in the list.
    FollowListed(u32),
    /// Stop reading or tracing them.
    CancelRays,
    /// Put the file of rays away.
    CloseRays,
    /// Stop following a ray.
    CancelFollow,
    /// Let the next drag in the view mark a rectangle that is compared with brute force, or no longer.
    MarkRectangle(bool),
    /// Compare a rectangle of the view, or all of it, with brute force.
    CheckByBrute(Option<PixelRect>),
    /// Stop that.
    CancelBrute,
    /// Follow the ray of a pixel that differs, by its number.
    FollowUnlike(usize),
    /// Show a structure's steps beside the shown one's, or hide them.
    Beside(&'static str, bool),
    /// Go to a step of a column of steps.
    Step(usize, usize),
    /// Play the steps, or stop.
    Play(bool),
    /// Steps a second.
    PlaySpeed(f32),
    /// Hide how nodes are divided, and what would be cheapest, until asked.
    HideOutcome(bool),
    /// Show it of the selected node.
    Reveal,
    /// Frame the selected cell.
    FrameSelected,
    /// Frame the whole model.
    FrameAll,
    /// Between perspective and orthographic.
    ToggleProjection,
    /// Samples after which to rest.
    MaxSamples(u32),
    /// Time every structure on the present view.
    Measure,
    /// Stop timing.
    CancelMeasure,
    /// On which terms structures are timed from now on.
    Fairness(Fairness),
    /// Sort the timings by a column; the other way round if they are sorted by it.
    SortTimings(Column),
    /// Work out what is predicted of rays in the shown structure: somebody looks at it.
    Predict,
    /// Measure what leaving out saves for the open model.
    MeasureNeeds,
    /// Stop that.
    CancelNeeds,
    /// Keep meshes that stand in several places once, or flatten them; the model is opened anew.
    Instances(Instances),
    /// Another workspace.
    Workspace(Workspace),
    /// Run the stability lab.
    RunLab,
    /// Stop it.
    CancelLab,
    /// Open a case of the lab, as a structure traced it.
    OpenCase(Cell),
    /// Look at the open model's triangles, and where structures err on them.
    CheckModel,
    /// Stop that.
    CancelCheck,
    /// Draw the rays that one of the checked structures does not answer exactly, or none.
    MarkModel(Option<usize>),
    /// How light becomes colour.
    Tone(Tone),
    /// The numbers that samples are made of.
    Sampler(SamplerKind),
    /// Make a reference that the errors of the present view are measured against.
    MakeReference,
    /// Stop that.
    CancelReference,
    /// Show the picture of a point of a curve of errors, by curve and point, or the present one again; and whether its
    /// difference from the reference.
    Shot(Option<(usize, usize)>, bool),
    /// Figures of errors in a table, or in plots.
    ErrorsAsTable(bool),
    /// Another plot of the Compare workspace.
    ErrorPlot(Plot),
    /// What of intersections is drawn.
    Miss(Miss),
    /// What of structures is drawn.
    Goodness(Goodness),
    /// Measure every structure, builder and triangle test on the present view.
    MeasureTradeoffs,
    /// Stop that.
    CancelTradeoffs,
    /// Measure time against the number of triangles.
    MeasureScaling,
    /// Stop that.
    CancelScaling,
    /// Put away the message.
    Dismiss,
    /// The memory budget in MiB, or half of the machine.
    Memory(Option<u64>),
    /// Light, dark, or as the system has it.
    Theme(ThemeChoice),
    /// Which button does what.
    Navigation(Navigation),
    /// Enlarge or shrink everything; 1 is the system's size.
    Scale(f32),
    /// Show, or hide, the palette of all commands.
    Palette(bool),
    /// Show, or hide, the page of settings.
    Preferences(bool),
    /// Show, or hide, the page of keys.
    Help(bool),
    /// Show, or hide, the page of terms.
    Terms(bool),
    /// Begin the tour at a step, from 0, or leave it.
    Tour(Option<usize>),
    /// For an audience: larger, and without panels; or back.
    Present(bool),
    /// Compare with the picture of a second structure; or one picture again.
    PutBeside(Option<&'static str>),
    /// Put another choice into a pane beside the first, counted from 0, or add one.
    PutPane(usize, PaneChoice),
    /// Close a pane beside the first.
    ClosePane(usize),
    /// Open the parameters of a pane, or close them.
    TunePane(Option<usize>),
    /// How compared pictures stand.
    Arrange(Arrange),
    /// Where the strip after a divider begins, from 0 to 1.
    Divider(usize, f32),
    /// Find the range that compared pictures share anew.
    FitRange,
    /// Save the whole state of the window.
    SaveWorkspace,
    /// Save the report, a table, a plot, the figure or the picture.
    Export(Export),
    /// Stop making the report.
    CancelReport,
    /// Keep the present view, with what is selected.
    AddBookmark,
    /// Go back to one that was kept.
    Bookmark(usize),
    /// Forget it.
    DropBookmark(usize),
    /// Open the panel at the right, which a narrow window folds, or close it.
    Unfold(bool),
    /// Panels back to their first sizes.
    ResetLayout,
    /// Bring the focus to the next panel, or to the one before.
    NextPanel(bool),
    /// In and out of full screen.
    FullScreen,
    /// Close the window.
    Quit,
}
