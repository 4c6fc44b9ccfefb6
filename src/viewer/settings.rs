//! What the window remembers from one day to the next.

use std::collections::BTreeMap;
use std::sync::Arc;

use super::panes::PaneSettings;
use crate::accel::Visibility;
use crate::accel::params::ParamValues;
use crate::accel::registry::{self, Entry};
use crate::geometry::tri::TestKind;
use crate::render::sampler::SamplerKind;
use crate::render::{HeatRays, Mode, Tone};
use crate::scene::Section;

/// Everything that is saved.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(default)]
pub struct Settings {
    /// Files opened, the last first.
    pub recent: Vec<String>,
    /// The structure's id.
    pub structure: String,
    /// Parameters that differ from their defaults, by structure and parameter.
    pub params: BTreeMap<String, BTreeMap<String, String>>,
    /// The triangle test.
    pub test: TestKind,
    /// What is shown.
    pub mode: Mode,
    /// Whose work heat maps show.
    pub heat_rays: HeatRays,
    /// Samples after which to rest.
    pub max_samples: u32,
    /// How light becomes colour.
    pub tone: Tone,
    /// The numbers that samples are made of.
    pub sampler: SamplerKind,
    /// Boxes and planes.
    pub overlay: OverlaySettings,
    /// Where the model is cut open: as long as it is the same model.
    pub section: SectionSettings,
    /// Which triangles are hidden: those of the open model, so that of all files only its workspace files say.
    #[serde(skip)]
    pub visible: Option<Arc<Visibility>>,
    /// What stands around the view.
    pub workspace: Workspace,
    /// Pictures beside that of the structure.
    pub panes: PaneSettings,
    /// How nodes are divided is hidden until asked.
    pub hide_outcome: bool,
    /// Light or dark.
    pub theme: ThemeChoice,
    /// Which button does what.
    pub navigation: Navigation,
    /// How much everything is enlarged.
    pub scale: f32,
    /// The memory budget in MiB; `None` for half of the machine.
    pub memory_mib: Option<u64>,
    /// The tour was shown.
    pub toured: bool,
}

/// The most files in the list of recent ones.
const RECENT: usize = 8;
/// The limits of [`Settings::scale`].
pub const SCALE: std::ops::RangeInclusive<f32> = 0.75..=2.0;

impl Default for Settings {
    fn default() -> Self {
        Self {
            recent: Vec::new(),
            structure: "bvh".to_owned(),
            params: BTreeMap::new(),
            test: TestKind::default(),
            mode: Mode::default(),
            heat_rays: HeatRays::default(),
            max_samples: 4096,
            tone: Tone::default(),
            sampler: SamplerKind::default(),
            overlay: OverlaySettings::default(),
            section: SectionSettings::default(),
            visible: None,
            workspace: Workspace::default(),
            panes: PaneSettings::default(),
            hide_outcome: false,
            theme: ThemeChoice::default(),
            navigation: Navigation::default(),
            scale: 1.0,
            memory_mib: None,
            toured: false,
        }
    }
}

/// Which boxes and planes are drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(default)]
pub struct OverlaySettings {
    /// Boxes of nodes and cells.
    pub boxes: bool,
    /// Only those of leaves.
    pub leaves_only: bool,
    /// Planes that divide cells.
    pub planes: bool,
    /// Grid cells without triangles.
    pub empty_cells: bool,
    /// The depth shown, or the deepest of a range.
    pub depth: u32,
    /// Shows also the levels above, from this one on; equal to `depth` for one level.
    pub from_depth: u32,
    /// Of a grid: one layer of cells along `slice_axis`, from 1; 0 for all.
    pub slice: u32,
    /// 0, 1 or 2 for x, y or z.
    pub slice_axis: usize,
    /// Of a grid: only cells that hold at least so many triangles.
    pub occupancy: u32,
    /// Lines behind the surface.
    pub hidden_lines: bool,
    /// From where on they are drawn, in parts of a hundred of the view's width from its left side: what is before that is the
    /// picture alone, to hold it against the boxes.
    pub begin: u32,
    /// Only the selected cell and what is below it.
    pub subtree_only: bool,
    /// Of a scene with two levels: which.
    pub levels: Levels,
    /// What colours of boxes stand for.
    pub color: BoxColor,
}

/// Whether and where the model is cut open for the camera.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(default)]
pub struct SectionSettings {
    /// A part is cut away.
    pub on: bool,
    /// Where, and which.
    pub at: Section,
}

/// Which level of a scene with two is drawn, and from where depths count.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub enum Levels {
    /// As one tree: depths count from the root of the upper level, through to the lower one.
    #[default]
    Through,
    /// The instances, and below each the cells of a depth from its own root.
    Both,
    /// The upper level alone; where only leaves are asked for, its instances.
    Upper,
    /// The lower level alone: cells of a depth from the root of each instance.
    Lower,
}

impl Levels {
    /// All, in the order of menus.
    pub const ALL: [Self; 4] = [Self::Through, Self::Both, Self::Upper, Self::Lower];

    /// The name in menus.
    pub const fn label(self) -> &'static str {
        match self {
            Self::Through => "As one tree",
            Self::Both => "Both levels",
            Self::Upper => "Upper level",
            Self::Lower => "Lower level",
        }
    }
}

/// What colours of boxes stand for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub enum BoxColor {
    /// The steps from the root.
    #[default]
    Depth,
    /// Triangles in the cell and below.
    Triangles,
    /// The part of the SAH cost that the cell and what is below it make up.
    Cost,
    /// How often a line that meets the node meets the overlap of its children.
    Overlap,
    /// How often a camera ray of the present view enters the cell.
    Visits,
}

impl BoxColor {
    /// All, in the order of menus.
    pub const ALL: [Self; 5] = [Self::Depth, Self::Triangles, Self::Cost, Self::Overlap, Self::Visits];

    /// The one of a name on the command line.
    pub fn of_id(id: &str) -> Option<Self> {
        let ids = ["depth", "triangles", "share", "overlap", "visits"];
        ids.into_iter().zip(Self::ALL).find(|(known, _)| *known == id).map(|(_, color)| color)
    }

    /// Whether it is told by the list of cells alone.
    pub const fn needs_rows(self) -> bool {
        matches!(self, Self::Triangles | Self::Cost | Self::Overlap)
    }

    /// The name in menus.
    pub const fn label(self) -> &'static str {
        match self {
            Self::Depth => "By depth",
            Self::Triangles => "By triangles",
            Self::Cost => "By SAH share",
            Self::Overlap => "By overlap",
            Self::Visits => "By visits",
        }
    }

    /// What is written beside the colours.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Depth => "Depth",
            Self::Triangles => "Triangles",
            Self::Cost => "SAH share",
            Self::Overlap => "Overlap",
            Self::Visits => "Visits a ray",
        }
    }
}

impl Default for OverlaySettings {
    fn default() -> Self {
        Self {
            boxes: true,
            leaves_only: false,
            planes: true,
            empty_cells: false,
            depth: 3,
            from_depth: 3,
            slice: 0,
            slice_axis: 2,
            occupancy: 0,
            hidden_lines: true,
            begin: 0,
            subtree_only: false,
            levels: Levels::default(),
            color: BoxColor::default(),
        }
    }
}

impl OverlaySettings {
    /// What tells which boxes and planes are drawn, and not how.
    pub const fn of_content(self) -> Self {
        Self { hidden_lines: true, begin: 0, ..self }
    }
}

/// What stands around the view.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, serde::Serialize, serde::Deserialize)]
pub enum Workspace {
    /// Statistics and timings.
    #[default]
    View,
    /// The tree of cells, and how each is divided.
    Structure,
    /// One ray, step by step.
    Ray,
    /// Structures beside each other, and the picture's error against what it costs.
    Compare,
    /// The stability lab, and what is known to be wrong with the model.
    Check,
}

impl Workspace {
    /// All, in the order of their tabs.
    pub const ALL: [Self; 5] = [Self::View, Self::Structure, Self::Ray, Self::Compare, Self::Check];

    /// The name on the tab.
    pub const fn name(self) -> &'static str {
        match self {
            Self::View => "View",
            Self::Structure => "Structure",
            Self::Ray => "Ray",
            Self::Compare => "Compare",
            Self::Check => "Check",
        }
    }

    /// Whether curves of the picture's error stand in it.
    pub const fn shows_errors(self) -> bool {
        matches!(self, Self::Compare)
    }

    /// What it is for, in a sentence.
    pub const fn help(self) -> &'static str {
        match self {
            Self::View => "Statistics of the structure, and timings of all of them.",
            Self::Structure => "The tree of cells, what each costs, and what dividing it otherwise would have cost.",
            Self::Ray => "One ray, step by step, through up to four structures.",
            Self::Compare => "Structures beside each other on one view, and the error of the picture against what it costs.",
            Self::Check => "Right answers: the stability lab, and a check of the open model.",
        }
    }
}

/// Light, dark, or as the system has it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub enum ThemeChoice {
    /// As the system has it.
    #[default]
    System,
    /// Dark text on light.
    Light,
    /// Light text on dark.
    Dark,
}

/// Which button does what in the viewport.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub enum Navigation {
    /// Left orbits, middle or Shift+left pans.
    #[default]
    Standard,
    /// Middle orbits, Shift+middle pans.
    Blender,
}

impl Settings {
    /// The structure, the first of all if the name is not known any more.
    pub fn entry(&self) -> &'static Entry {
        registry::find(&self.structure).unwrap_or(&registry::ALL[0])
    }

    /// The parameters of a structure: the defaults, changed by what was set and still fits.
    pub fn params_of(&self, entry: &Entry) -> ParamValues {
        let mut values = entry.defaults();
        for (id, text) in self.params.get(entry.id).into_iter().flatten() {
            let _ = values.set(id, text); // a value from another version that no longer fits is forgotten
        }
        values
    }

    /// The triangle test where all structures have the same: not one that stands in brute force alone.
    pub fn common_test(&self) -> TestKind {
        TestKind::ALL.into_iter().find(|test| *test == self.test).unwrap_or_default()
    }

    /// The triangle test of a structure: the chosen one, or the default if it does not have that.
    pub fn test_of(&self, entry: &Entry) -> TestKind {
        entry.tests().find(|test| *test == self.test).unwrap_or_default()
    }

    /// Remembers the parameters of a structure, as far as they differ from the defaults.
    pub fn remember(&mut self, entry: &Entry, values: &ParamValues) {
        let set = values.changed().map(|(p, v)| (p.id.to_owned(), v.to_string())).collect();
        self.params.insert(entry.id.to_owned(), set);
    }

    /// Takes what concerns the view from others; what belongs to the person stays.
    pub fn take_view(&mut self, other: &Self) {
        let own = self.clone();
        *self = Self {
            recent: own.recent,
            theme: own.theme,
            navigation: own.navigation,
            scale: own.scale,
            memory_mib: own.memory_mib,
            toured: own.toured,
            ..other.clone()
        };
    }

    /// Puts a model at the head of the recent ones.
    pub fn opened(&mut self, model: &str) {
        self.recent.retain(|m| m != model);
        self.recent.insert(0, model.to_owned());
        self.recent.truncate(RECENT);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colours_of_boxes_are_known_by_name() {
        let known = ["depth", "triangles", "share", "overlap", "visits"].map(BoxColor::of_id);
        assert_eq!(known, BoxColor::ALL.map(Some));
        assert_eq!(BoxColor::of_id("other"), None);
    }

    #[test]
    fn parameters_are_remembered_by_structure() {
        let mut settings = Settings::default();
        let entry = settings.entry();
        let mut values = entry.defaults();
        values.set("max_leaf", "7").expect("in range");
        settings.remember(entry, &values);
        let saved = serde_json::to_string(&settings).expect("plain data");
        let loaded: Settings = serde_json::from_str(&saved).expect("just written");
        assert_eq!(loaded.params_of(entry), values);
        let odd: Settings =
            serde_json::from_str(r#"{"structure": "gone", "params": {"brute": {"x": "1"}}}"#).expect("fields default");
        assert_eq!(odd.entry().id, "brute");
        assert_eq!(odd.params_of(odd.entry()), odd.entry().defaults());
    }
}
