//! The whole state of the window in one file: what is open, from where and how it is looked at, what is selected and hidden,
//! which ray is followed, what was made of all that, and the views that were kept. What was measured is not in it, and what
//! belongs to the person rather than to the model (look, size, memory) is not either.

mod parts;

pub use parts::{Look, Made, RaysFile};

use std::path::Path;

use super::files;
use super::model::{self, Instances};
use super::settings::Settings;
use super::state::Bookmark;
use crate::lab::RayKind;
use crate::scene::Camera;

/// The ending of such files.
pub const ENDING: &str = "boxwood";
/// What this program writes; files of later versions are refused.
const VERSION: u32 = 1;

/// What is in the file.
#[derive(Clone, Debug, serde::Serialize, serde::Deserialize)]
pub struct WorkspaceFile {
    version: u32,
    /// The model, by its whole path.
    pub model: String,
    /// What of the settings concerns the view.
    pub settings: Settings,
    /// From where it is seen.
    pub camera: Camera,
    /// Whether instances are kept.
    pub instances: Instances,
    /// The cells from the root to the selected one: level and number of each.
    pub selected: Vec<(u32, u32)>,
    /// The ray that was clicked or typed, as text.
    pub ray: Option<String>,
    /// Whether that is followed, or one that leaves what it meets.
    pub ray_kind: String,
    /// The structure whose step is chosen, and which step that is.
    #[serde(default)]
    pub step: Option<(String, usize)>,
    /// The plane that is tried in the selected cell: the number of its axis, and where from 0 to 1.
    #[serde(default)]
    pub tried: Option<(usize, f64)>,
    /// Structures whose steps stand beside.
    pub beside: Vec<String>,
    /// The views that were kept.
    pub bookmarks: Vec<Bookmark>,
    /// How what is measured is looked at: of a file that does not say, as it is.
    #[serde(default)]
    pub look: Option<Look>,
    /// What is made again.
    #[serde(default)]
    pub made: Made,
}

impl WorkspaceFile {
    /// Of a model and settings; the rest is filled in.
    pub fn new(name: &str, settings: &Settings, camera: Camera, instances: Instances) -> Self {
        let built_in = name.starts_with(crate::scene::builtin::SCHEME) || model::is_case(name);
        Self {
            version: VERSION,
            model: if built_in { name.to_owned() } else { Self::whole_path(Path::new(name)) },
            settings: Settings { recent: Vec::new(), memory_mib: None, ..settings.clone() },
            camera,
            instances,
            selected: Vec::new(),
            ray: None,
            ray_kind: RayKind::Primary.id().to_owned(),
            step: None,
            tried: None,
            beside: Vec::new(),
            bookmarks: Vec::new(),
            look: None,
            made: Made::default(),
        }
    }

    /// The whole path of a file, as it stands in one.
    pub fn whole_path(path: &Path) -> String {
        std::path::absolute(path).as_deref().unwrap_or(path).to_string_lossy().into_owned()
    }

    /// Whether a name is that of such a file.
    pub fn is_one(name: &str) -> bool {
        Path::new(name).extension().is_some_and(|ending| ending.eq_ignore_ascii_case(ENDING))
    }

    /// Reads one.
    ///
    /// # Errors
    /// Why it can't be read, in words for the user.
    pub fn read(path: &str) -> Result<Self, String> {
        let text = std::fs::read(path).map_err(|why| format!("Can't open {path}: {why}."))?;
        let wrong = |why: &dyn std::fmt::Display| format!("Can't open {path}: it is no workspace file ({why}). Save it anew.");
        let file: Self = serde_json::from_slice(&text).map_err(|why| wrong(&why))?;
        if file.version > VERSION {
            return Err(format!("Can't open {path}: a later version of Boxwood wrote it. Update this one."));
        }
        let vectors = [file.camera.eye, file.camera.target, file.camera.up];
        if vectors.iter().any(|v| !v.is_finite()) { Err(wrong(&"its camera is nowhere")) } else { Ok(file) }
    }

    /// Writes it to a temporary file, then renames that.
    ///
    /// # Errors
    /// Why it can't be written, in words for the user.
    pub fn write(&self, path: &Path) -> Result<(), String> {
        let text = serde_json::to_vec_pretty(self).map_err(|why| format!("Can't save {}: {why}.", path.display()))?;
        files::write(path, &text)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Aabb;
    use crate::lab::Fairness;
    use crate::render::{Mode, Range};
    use crate::viewer::timings::{Column, Terms};
    use crate::viewer::tradeoffs::{Goodness, Miss, Plot};
    use glam::Vec3;
    use serde_json::json;

    #[test]
    fn what_is_written_is_read_and_what_is_not_ours_is_refused() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("lesson.boxwood");
        let camera = Camera::framing(&Aabb { min: Vec3::NEG_ONE, max: Vec3::ONE }, Vec3::ONE, Vec3::Y, 1.3);
        let settings = Settings { structure: "kdtree".to_owned(), recent: vec!["private.glb".to_owned()], ..Settings::default() };
        let mut file = WorkspaceFile::new("builtin:lecture", &settings, camera, Instances::default());
        file.selected = vec![(0, 0), (0, 7)];
        file.write(&path).expect("written");
        let name = path.to_string_lossy();
        let read = WorkspaceFile::read(&name).expect("just written");
        assert_eq!((read.camera, &read.selected, &read.model[..]), (camera, &file.selected, "builtin:lecture"));
        assert!(read.settings.structure == "kdtree" && read.settings.recent.is_empty());
        assert!(WorkspaceFile::is_one(&name) && !WorkspaceFile::is_one("model.glb"));
        assert_eq!(std::fs::read_dir(folder.path()).expect("there").count(), 1, "no temporary file is left");
        let text = std::fs::read_to_string(&path).expect("there");
        for (text, part) in [
            ("{}".to_owned(), "no workspace file"),
            ("\u{0}".to_owned(), "no workspace file"),
            (text.replace("\"version\": 1", "\"version\": 2"), "later version"),
        ] {
            std::fs::write(&path, text).expect("written");
            assert!(WorkspaceFile::read(&name).is_err_and(|why| why.contains(part)), "{part}");
        }
        assert!(WorkspaceFile::read("/nowhere/x.boxwood").is_err_and(|why| why.contains("/nowhere/x.boxwood")));
        assert!(file.write(Path::new("/nowhere/x.boxwood")).is_err_and(|why| why.contains("another folder")));
    }

    /// A file that says all that can be said of what is looked at and made again, as it is written.
    fn full() -> serde_json::Value {
        let camera = Camera::framing(&Aabb { min: Vec3::NEG_ONE, max: Vec3::ONE }, Vec3::ONE, Vec3::Y, 1.3);
        let mut file = WorkspaceFile::new("builtin:lecture", &Settings::default(), camera, Instances::default());
        let range = Range { min: 1.5, max: 7.1 };
        file.look = Some(Look {
            range: Some(range),
            shared: vec![(Mode::Prims, range)],
            tiles: true,
            plot: Plot::Model,
            miss: Miss::Ulps,
            goodness: Goodness::Epo,
            errors_as_table: true,
            terms: Terms { fairness: Fairness::Best, column: Column::Rate, reversed: true },
            film_speed: Some(0.1),
            ray_speed: Some(12.0),
        });
        file.made = Made {
            hidden: vec![serde_json::from_str(r#"{"of": 16, "runs": "3 13"}"#).expect("as it is written")],
            hidden_now: Some(0),
            rays: Some(RaysFile { path: "/somewhere/a.rays".to_owned(), followed: Some(7) }),
            film: Some(12),
            tiles: true,
            volumes: true,
            drawn: Some("kdop14".to_owned()),
        };
        serde_json::to_value(&file).expect("plain data")
    }

    /// What is read of a file with that in it.
    fn read(value: &serde_json::Value) -> Result<WorkspaceFile, String> {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("lesson.boxwood");
        std::fs::write(&path, value.to_string()).expect("written");
        WorkspaceFile::read(&path.to_string_lossy())
    }

    #[test]
    fn all_that_is_said_is_read_and_what_is_not_said_is_as_it_was() {
        let whole = full();
        let file = read(&whole).expect("as it is written");
        assert_eq!(serde_json::to_value(&file).expect("plain data"), whole);
        assert_eq!(file.look.as_ref().and_then(|look| look.range), Some(Range { min: 1.5, max: 7.1 }));
        // Files of earlier versions say nothing of this, those of later ones more.
        let mut old = whole.clone();
        let parts = old.as_object_mut().expect("an object");
        assert!(parts.remove("look").is_some() && parts.remove("made").is_some());
        let old = read(&old).expect("as it was written");
        assert_eq!((old.look, old.made), (None, Made::default()));
        let mut later = whole;
        (later["look"], later["made"]) = (json!({"sound": "loud"}), json!({"film": 3, "smell": 1}));
        let later = read(&later).expect("what is unknown is left out");
        assert_eq!((later.look, later.made), (Some(Look::default()), Made { film: Some(3), ..Made::default() }));
    }

    #[test]
    fn parts_that_make_no_sense_are_refused() {
        for (part, name, broken) in [
            ("look", "plot", json!("Pie")),
            ("look", "range", json!({"min": null, "max": 1.0})),
            ("look", "range", json!([1.0, 2.0, 3.0])),
            ("look", "shared", json!([["nodes"]])),
            ("look", "terms", json!({"column": "Price"})),
            ("look", "terms", json!({"fairness": "unfair"})),
            ("look", "film_speed", json!("fast")),
            ("made", "film", json!(-1)),
            ("made", "film", json!(4_294_967_296_u64)),
            ("made", "hidden", json!([{"of": 16}])),
            ("made", "hidden", json!([{"of": 16, "runs": [3, 13]}])),
            ("made", "hidden_now", json!("all")),
            ("made", "rays", json!({"followed": 1})),
            ("made", "drawn", json!(3)),
        ] {
            let mut file = full();
            file[part][name] = broken.clone();
            assert!(read(&file).is_err_and(|why| why.contains("no workspace file")), "{name}: {broken}");
        }
    }
}
