//! Model files for a test, gone with it.

use std::path::PathBuf;

use tempfile::TempDir;

/// A folder of model files.
pub struct Files(TempDir);

impl Files {
    pub fn new() -> Self {
        Self(tempfile::tempdir().expect("a folder"))
    }

    /// Writes a file and returns its path.
    pub fn write(&self, name: &str, content: impl AsRef<[u8]>) -> PathBuf {
        let path = self.0.path().join(name);
        std::fs::write(&path, content).expect("written");
        path
    }

    /// A path at which there is nothing.
    pub fn missing(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }
}

const PLY_HEAD: &str = "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n";

/// Four corners and two triangles.
pub fn ply() -> String {
    ply_of("0 0 0\n1 0 0\n1 1 0\n0 1 1\n", &["3 0 1 2", "3 0 2 3"])
}

/// Four corners and nothing between them.
pub fn ply_without_faces() -> String {
    ply_of("0 0 0\n1 0 0\n1 1 0\n0 1 1\n", &[])
}

fn ply_of(vertices: &str, faces: &[&str]) -> String {
    let faces_head = format!("element face {}\nproperty list uchar int vertex_indices\nend_header\n", faces.len());
    let faces: String = faces.iter().map(|f| format!("{f}\n")).collect();
    format!("{PLY_HEAD}{faces_head}{vertices}{faces}")
}

/// Three triangles.
pub const OBJ: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\nf 1 2 4\nf 1 3 4\n";
