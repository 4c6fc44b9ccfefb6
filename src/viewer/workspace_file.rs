//! The whole state of the window in one file: what is open, from where and how it is looked at, what is selected, which ray is
//! followed, and the views that were kept. What belongs to the person rather than to the model (look, size, memory) is not in it.

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
}

impl WorkspaceFile {
    /// Of a model and settings; the rest is filled in.
    pub fn new(name: &str, settings: &Settings, camera: Camera, instances: Instances) -> Self {
        let built_in = name.starts_with(crate::scene::builtin::SCHEME) || model::is_case(name);
        let whole = std::path::absolute(name).ok().filter(|_| !built_in);
        Self {
            version: VERSION,
            model: whole.map_or_else(|| name.to_owned(), |path| path.to_string_lossy().into_owned()),
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
        }
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
    use glam::Vec3;

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
}
