//! Model files. Each format is one file here, behind one trait over bytes, so that a faster reader
//! can be put beside the present one and tested against it.

use std::path::{Path, PathBuf};

use super::{LoadCx, Reason, Scene};

/// A reader of one format.
pub trait Loader: Sync {
    /// A short name: `gltf`, `obj`, `ply`, `stl`.
    fn id(&self) -> &'static str;

    /// File name endings, in lower case, without the dot.
    fn extensions(&self) -> &'static [&'static str];

    /// Reads a whole model.
    ///
    /// # Errors
    /// Whatever is wrong with the bytes; never a panic, and never an allocation by a count that
    /// the bytes claim but do not back.
    fn load(&self, bytes: &[u8], files: &dyn Siblings, cx: &LoadCx) -> Result<Scene, Reason>;
}

/// The files beside the model that it may refer to (buffers, materials).
pub trait Siblings: Sync {
    /// Reads the file that the model calls `name` (a relative path as written in the file).
    fn read(&self, name: &str) -> Result<Vec<u8>, Reason>;
}

/// Reads the model file at `path`, choosing the loader by the file's ending.
pub fn file(path: &Path, cx: &LoadCx) -> Result<Scene, Reason> {
    let _ = (path, cx, PathBuf::new());
    Err(Reason::UnknownFormat(String::new()))
}
