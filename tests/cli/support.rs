//! Running the program, and reading what it made.

use std::fs;
use std::io::Read;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use serde_json::Value;

/// A cube's worth of corners: two triangles a face, one of no area, one with a corner nowhere.
const PLY: &str = "ply\nformat ascii 1.0\nelement vertex 9\nproperty float x\nproperty float y\nproperty float z\n\
    element face 14\nproperty list uchar int vertex_indices\nend_header\n\
    0 0 0\n1 0 0\n1 1 0\n0 1 0\n0 0 1\n1 0 1\n1 1 1\n0 1 1\nnan 0 0\n\
    3 0 0 1\n3 0 1 2\n3 0 2 3\n3 4 5 6\n3 4 6 7\n3 0 1 5\n3 0 5 4\n3 8 1 2\n3 1 2 6\n3 1 6 5\n3 2 3 7\n3 2 7 6\n3 3 0 4\n3 3 4 7\n";

/// A folder of the test's own, with a name that is no ASCII.
pub struct Folder {
    _parent: tempfile::TempDir,
    path: PathBuf,
}

impl Folder {
    pub fn new() -> Self {
        let parent = tempfile::tempdir().expect("a folder");
        let path = parent.path().join("Bücher 木箱");
        fs::create_dir(&path).expect("a folder in it");
        Self { _parent: parent, path }
    }

    pub fn at(&self, name: &str) -> String {
        self.path.join(name).to_str().expect("UTF-8").to_owned()
    }

    /// Writes a file and returns its path.
    pub fn file(&self, name: &str, bytes: impl AsRef<[u8]>) -> String {
        fs::write(self.path.join(name), bytes).expect("written");
        self.at(name)
    }

    /// The small model in it.
    pub fn model(&self) -> String {
        self.file("Würfel.ply", PLY)
    }

    pub fn names(&self) -> Vec<String> {
        let entry =
            |entry: std::io::Result<fs::DirEntry>| entry.expect("readable").file_name().to_str().expect("UTF-8").to_owned();
        let mut names: Vec<String> = fs::read_dir(&self.path).expect("readable").map(entry).collect();
        names.sort();
        names
    }
}

/// The program, to be run with two threads.
pub fn program(args: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_boxwood"));
    command.args(args);
    command
}

pub fn run(args: &[&str]) -> Output {
    program(args).output().expect("it runs")
}

/// Standard output of a run that went well and had nothing to complain about.
pub fn good(args: &[&str]) -> String {
    let output = run(args);
    let errors = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!((output.status.code(), errors.as_str()), (Some(0), ""), "{args:?}");
    String::from_utf8(output.stdout).expect("UTF-8")
}

/// The one object on standard output.
pub fn json(args: &[&str]) -> Value {
    let value: Value = serde_json::from_str(&good(args)).expect("one JSON value");
    assert!(value.is_object());
    value
}

/// What a run said that ended with `code`; it must be one line, and standard output empty.
pub fn bad(args: &[&str], code: i32) -> String {
    let output = run(args);
    let errors = String::from_utf8(output.stderr).expect("UTF-8");
    assert_eq!(output.status.code(), Some(code), "{args:?}: {errors}");
    assert!(output.stdout.is_empty(), "{args:?}");
    assert!(errors.starts_with("boxwood: ") && errors.ends_with('\n') && errors.lines().count() == 1, "{errors}");
    errors
}

/// The arrays of an .npz, read with crates that know nothing of Boxwood.
#[derive(Debug, PartialEq)]
pub struct Hits {
    pub t: Vec<f32>,
    pub u: Vec<f32>,
    pub v: Vec<f32>,
    pub primitive: Vec<u32>,
}

pub fn hits(path: impl AsRef<Path>) -> Hits {
    let mut zip = zip::ZipArchive::new(fs::File::open(path).expect("there")).expect("a zip");
    let mut array = |name: &str| {
        let mut bytes = Vec::new();
        zip.by_name(&format!("{name}.npy")).expect(name).read_to_end(&mut bytes).expect("whole");
        bytes
    };
    let floats = |bytes: Vec<u8>| npyz::NpyFile::new(&bytes[..]).expect("an array").into_vec::<f32>().expect("float32");
    let [t, u, v] = ["t", "u", "v"].map(|name| floats(array(name)));
    let primitive = npyz::NpyFile::new(&array("primitive")[..]).expect("an array").into_vec::<u32>().expect("uint32");
    Hits { t, u, v, primitive }
}
