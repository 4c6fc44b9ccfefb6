//! What panels ask for. They never change shared state in the middle of a frame: they send a
//! command, and [`super::state::State::carry_out`] does it afterwards.

use super::checks::Cell;
use super::model::Instances;
use super::settings::{Navigation, OverlaySettings, ThemeChoice, Workspace};
use super::tradeoffs::{Goodness, Miss, Plot};
use crate::accel::params::ParamValues;
use crate::geometry::Axis;
use crate::geometry::tri::TestKind;
use crate::lab::RayKind;
use crate::render::sampler::SamplerKind;
use crate::render::{Mode, Range, Tone};
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
    /// Map amounts with a fixed range, or with one that suits.
    HeatRange(Option<Range>),
    /// Other boxes and planes.
    Overlay(OverlaySettings),
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
    /// Show the children of a row, or hide all that is below it.
    OpenRow(u32, bool),
    /// Show everything below a row.
    OpenBelow(u32),
    /// Hide all but the root and its children.
    CloseTree,
    /// Try a plane in the selected node: across which axis, and where from 0 to 1.
    TryPlane(Option<(Axis, f64)>),
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
    /// Stop following a ray.
    CancelFollow,
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
    /// Show, or hide, the page of keys.
    Help(bool),
    /// Show, or hide, the page of terms.
    Terms(bool),
    /// For an audience: larger, and without panels; or back.
    Present(bool),
    /// Split the picture: trace the right part through another structure; or one picture again.
    PutBeside(Option<&'static str>),
    /// Where the right part begins, from 0 to 1.
    Divider(f32),
    /// Save the whole state of the window.
    SaveWorkspace,
    /// Keep the present view, with what is selected.
    AddBookmark,
    /// Go back to one that was kept.
    Bookmark(usize),
    /// Forget it.
    DropBookmark(usize),
    /// Panels back to their first sizes.
    ResetLayout,
    /// In and out of full screen.
    FullScreen,
    /// Close the window.
    Quit,
}
