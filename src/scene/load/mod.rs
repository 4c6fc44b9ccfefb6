//! Model files. Each format is one file or folder here, behind one trait over bytes, so that a
//! faster reader can be put beside the present one and tested against it.
//!
//! The bytes come from anywhere: whoever reads them looks at each count before trusting it.

mod bytes;
mod disk;
mod fill;
mod gltf;
mod obj;
mod pace;
mod ply;
mod stl;
mod text;

use std::ops::Deref;
use std::path::{Path, PathBuf};

pub use bytes::Bytes;

use super::{Keep, LoadCx, Mesh, Reason, Scene, needs};
use crate::task::Charge;

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
    ///
    /// # Errors
    /// It cannot be read, or `name` is no relative path.
    fn read(&self, name: &str) -> Result<Bytes, Reason>;

    /// Where the file is that the model calls `name`, for reading it later. It need not be there.
    ///
    /// # Errors
    /// `name` is no relative path.
    fn locate(&self, name: &str) -> Result<PathBuf, Reason>;
}

/// Every format there is, in the order in which they are listed to the user.
pub fn loaders() -> &'static [&'static dyn Loader] {
    &[&gltf::Gltf, &obj::Obj, &ply::Ply, &stl::Stl]
}

/// Reads the model file at `path`, choosing the loader by the file's ending.
///
/// # Errors
/// The file cannot be read, its ending is not known, or the loader refuses its content.
pub fn file(path: &Path, cx: &LoadCx) -> Result<Scene, Reason> {
    let size = disk::size(path)?;
    let loader = by_extension(path)?;
    cx.progress.start("read", size);
    let (bytes, _memory) = disk::read(path, cx, |n| cx.progress.advance(n))?;
    let folder = path.parent().unwrap_or(Path::new(""));
    let mut scene = loader.load(&bytes, &disk::Folder::new(folder, cx), cx)?;
    if cx.keep == Keep::Needed {
        needs::drop_idle(&mut scene);
    }
    Ok(scene)
}

/// Reads the file of an image, which [`Siblings::locate`] has found.
pub(super) fn image_file(path: &Path, cx: &LoadCx) -> Result<(impl Deref<Target = [u8]>, Charge), Reason> {
    disk::read(path, cx, |_| ())
}

fn by_extension(path: &Path) -> Result<&'static dyn Loader, Reason> {
    let name = path.extension().or(path.file_name()).unwrap_or_default();
    let ending = path.extension().unwrap_or_default().to_string_lossy().to_lowercase();
    let found = loaders().iter().find(|loader| loader.extensions().contains(&ending.as_str()));
    found.copied().ok_or_else(|| Reason::UnknownFormat(name.to_string_lossy().into_owned()))
}

/// Bytes that a mesh takes, for charging them to the budget.
fn mesh_bytes(mesh: &Mesh) -> u64 {
    let lists = mesh.positions.len() * 12 + mesh.triangles.len() * 12 + mesh.normals.len() * 12;
    let more = mesh.uvs.len() * 8 + mesh.colors.len() * 16 + mesh.name.len();
    (lists + more + size_of::<Mesh>()) as u64
}

/// From the sRGB curve (IEC 61966-2-1), which stored colours follow unless their format says
/// otherwise, to linear.
pub(super) fn linear_from_srgb(rgb: [f32; 3]) -> [f32; 3] {
    rgb.map(unit).map(|c| if c <= 0.04045 { c / 12.92 } else { ((c + 0.055) / 1.055).powf(2.4) })
}

/// Clamped to 0 to 1; NaN is 0.
pub(super) fn unit(x: f32) -> f32 {
    if x.is_nan() { 0.0 } else { x.clamp(0.0, 1.0) }
}

#[cfg(test)]
mod tests;
