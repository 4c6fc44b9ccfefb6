//! What a command leaves behind: lines on standard output, and files that are there whole or not
//! at all.

use std::fs::{self, File};
use std::io::{self, BufWriter, Seek, Write};
use std::path::{Path, PathBuf};

use super::failure::Failure;
use crate::sys::{folder_of, temporary_in};
use crate::task::Cancel;

/// Writes to standard output.
pub fn print(text: &str) -> Result<(), Failure> {
    let mut out = io::stdout().lock();
    let written = out.write_all(text.as_bytes()).and_then(|()| out.flush());
    written.map_err(|error| Failure::of_output(Path::new("standard output"), &error))
}

/// Writes one JSON object to standard output.
pub fn print_json(value: &impl serde::Serialize) -> Result<(), Failure> {
    let text = serde_json::to_string_pretty(value).map_err(|error| Failure::Other(error.into()))?;
    print(&format!("{text}\n"))
}

/// Says one thing on standard error; with that gone there is nobody left to tell.
pub fn warn(text: &str) {
    let _ = writeln!(io::stderr(), "boxwood: {text}");
}

/// A file to be written.
#[derive(Debug)]
pub struct OutFile {
    path: PathBuf,
    /// Where `path` leads, if it is a link.
    target: PathBuf,
}

impl OutFile {
    /// Looks before long work whether there is a place for the file.
    pub fn at(path: &Path) -> Result<Self, Failure> {
        let wrong = |why: &str| Err(Failure::Input(format!("Can't write {}: {why}", path.display())));
        if path.is_dir() {
            return wrong("it is a folder");
        }
        let target = fs::canonicalize(path).unwrap_or_else(|_| path.to_owned());
        if !folder_of(&target).is_dir() {
            return wrong("there is no such folder");
        }
        Ok(Self { path: path.to_owned(), target })
    }

    /// Fills a temporary file beside the target and renames it into place once it is complete, so
    /// that neither Ctrl-C nor a full disk leaves half a file.
    pub fn write(&self, cancel: &Cancel, fill: impl FnOnce(&mut BufWriter<&mut File>) -> io::Result<()>) -> Result<(), Failure> {
        let cannot = |error: io::Error| Failure::of_output(&self.path, &error);
        // Renaming onto a device or a pipe would replace it.
        let special = fs::metadata(&self.target).is_ok_and(|found| !found.is_file());
        let beside = if special { std::env::temp_dir() } else { folder_of(&self.target).to_owned() };
        let mut temp = temporary_in(&beside).map_err(cannot)?;
        let mut out = BufWriter::new(temp.as_file_mut());
        fill(&mut out).and_then(|()| out.flush()).map_err(cannot)?;
        drop(out);
        cancel.check()?;
        if special {
            return pour(temp.as_file_mut(), &self.target).map_err(cannot);
        }
        temp.persist(&self.target).map(drop).map_err(|error| cannot(error.error))
    }
}

fn pour(from: &mut File, to: &Path) -> io::Result<()> {
    from.rewind()?;
    io::copy(from, &mut File::options().write(true).open(to)?).map(drop)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_is_there_whole_or_not_at_all() {
        let dir = tempfile::tempdir().expect("a folder");
        let path = dir.path().join("out");
        let out = OutFile::at(&path).expect("a place");
        let names = || fs::read_dir(dir.path()).expect("readable").count();
        assert!(out.write(&Cancel::new(), |_| Err(io::Error::other("disk full"))).is_err());
        let cancel = Cancel::new();
        cancel.cancel();
        assert!(matches!(out.write(&cancel, |out| out.write_all(b"half")), Err(Failure::Cancelled)));
        assert_eq!(names(), 0);
        for text in ["first", "second"] {
            out.write(&Cancel::new(), |out| out.write_all(text.as_bytes())).expect("written");
            assert_eq!((fs::read_to_string(&path).expect("there"), names()), (text.to_owned(), 1));
        }
    }

    #[test]
    fn a_place_is_looked_for_first() {
        let dir = tempfile::tempdir().expect("a folder");
        for path in [dir.path().to_owned(), dir.path().join("no/such/file")] {
            assert!(matches!(OutFile::at(&path), Err(Failure::Input(_))), "{path:?}");
        }
        assert!(OutFile::at(Path::new("here")).is_ok());
    }
}
