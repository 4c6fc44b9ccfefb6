//! Model files and the files beside them: small ones are read from the disk in pieces, large ones mapped.

use std::fs::File;
use std::io::{Error, ErrorKind, Read};
use std::path::{Path, PathBuf};

use super::{Bytes, LoadCx, Reason, Siblings};
use crate::sys::Map;
use crate::task::Charge;

/// Bytes between two looks at the cancel flag.
const PIECE: usize = 1 << 20;

/// A file of fewer bytes is read as quickly, and may then be written to meanwhile.
const WORTH_MAPPING: u64 = 4 << 20;

/// The size of the file at `path`, which must be an ordinary file: a pipe or a device could keep
/// us waiting, or never end.
pub(super) fn size(path: &Path) -> Result<u64, Reason> {
    let io = |error| Reason::Io { path: path.to_owned(), error };
    let about = std::fs::metadata(path).map_err(io)?;
    match about.is_file() {
        true => Ok(about.len()),
        false if about.is_dir() => Err(io(Error::new(ErrorKind::IsADirectory, "it is a folder, not a file"))),
        false => Err(io(Error::new(ErrorKind::InvalidInput, "it is not an ordinary file"))),
    }
}

/// The bytes of a whole file. Those that are read are charged to the budget before and while they are;
/// those that are mapped take no memory that the system could not take back. `done` hears of each piece.
pub(super) fn read(path: &Path, cx: &LoadCx, done: impl Fn(u64)) -> Result<(Bytes, Charge), Reason> {
    let io = |error| Reason::Io { path: path.to_owned(), error };
    let expected = size(path)?;
    let file = File::open(path).map_err(io)?;
    // Not every file system can map.
    if expected >= WORTH_MAPPING
        && let Ok(map) = Map::of(&file)
    {
        done(expected);
        return Ok((map.into(), cx.budget.charge(0)?));
    }
    in_pieces(path, file, expected, cx, done)
}

fn in_pieces(path: &Path, mut file: File, expected: u64, cx: &LoadCx, done: impl Fn(u64)) -> Result<(Bytes, Charge), Reason> {
    let io = |error| Reason::Io { path: path.to_owned(), error };
    let mut memory = cx.budget.charge(expected)?;
    let mut bytes = Vec::with_capacity(usize::try_from(expected).unwrap_or(0));
    loop {
        cx.cancel.check()?;
        let got = (&mut file).take(PIECE as u64).read_to_end(&mut bytes).map_err(io)?;
        if got == 0 {
            return Ok((bytes.into(), memory));
        }
        // A file can grow while it is read.
        memory.grow((bytes.len() as u64).saturating_sub(memory.bytes()))?;
        done(got as u64);
    }
}

/// The folder that the model lies in.
pub(super) struct Folder<'a> {
    folder: &'a Path,
    cx: &'a LoadCx,
}

impl<'a> Folder<'a> {
    pub fn new(folder: &'a Path, cx: &'a LoadCx) -> Self {
        Self { folder, cx }
    }

    fn path(&self, name: &str) -> PathBuf {
        let path = self.folder.join(name);
        // Files written on Windows part folders with a backslash, which elsewhere is a letter.
        let slashed = name.replace('\\', "/");
        if slashed != name && !path.exists() { self.folder.join(slashed) } else { path }
    }
}

impl Siblings for Folder<'_> {
    fn read(&self, name: &str) -> Result<Bytes, Reason> {
        read(&self.locate(name)?, self.cx, |_| ()).map(|(bytes, _memory)| bytes)
    }

    fn locate(&self, name: &str) -> Result<PathBuf, Reason> {
        if leads_elsewhere(name) {
            let what = "it is an absolute path or an address, and only files named relative to the model are read. \
                        Put it beside the model and refer to it by its name";
            return Err(Reason::malformed(name, what));
        }
        Ok(self.path(name))
    }
}

/// Whether `name` is something else than a relative path: absolute on any system, or with a scheme
/// (`http:`) or a drive (`C:`). A model must not make us read what has nothing to do with it.
fn leads_elsewhere(name: &str) -> bool {
    let scheme = |s: &str| !s.is_empty() && s.chars().all(|c| c.is_ascii_alphanumeric() || "+-.".contains(c));
    name.starts_with(['/', '\\']) || name.split_once(':').is_some_and(|(before, _)| scheme(before))
}
