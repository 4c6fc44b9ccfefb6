//! Files that are written whole or not at all.

use std::io::Write;
use std::path::{Path, PathBuf};

use crate::sys::{folder_of, temporary_in};

/// Writes a file: to a temporary one beside it, which is renamed once it is complete.
///
/// # Errors
/// Why it can't be written, in words for the user.
pub fn write(path: &Path, bytes: &[u8]) -> Result<(), String> {
    let fail = |why: std::io::Error| format!("Can't save {}: {why}. Choose another folder.", path.display());
    let mut file = temporary_in(folder_of(path)).map_err(fail)?;
    file.write_all(bytes).and_then(|()| file.flush()).map_err(fail)?;
    file.persist(path).map_err(|why| fail(why.error))?;
    Ok(())
}

/// The path that a dialog answered, with the ending that it has to have.
///
/// # Errors
/// In words, if that is a file which the dialog has not asked about, because it gave another name.
pub fn with_ending(path: PathBuf, ending: &str) -> Result<PathBuf, String> {
    if path.extension().is_some_and(|given| given.eq_ignore_ascii_case(ending)) {
        return Ok(path);
    }
    let mut whole = path;
    whole.as_mut_os_string().push(format!(".{ending}"));
    if whole.exists() {
        return Err(format!("Can't save {}: it is there already. Choose it by its whole name.", whole.display()));
    }
    Ok(whole)
}

/// A folder of that name in another one, or of that name and a number where there is one: it is made.
///
/// # Errors
/// Why it can't be made, in words for the user.
pub fn new_folder(within: &Path, name: &str) -> Result<PathBuf, String> {
    let numbered = (2..=MOST).map(|n| format!("{name} {n}"));
    for name in std::iter::once(name.to_owned()).chain(numbered) {
        let folder = within.join(name);
        match std::fs::create_dir(&folder) {
            Ok(()) => return Ok(folder),
            Err(why) if why.kind() == std::io::ErrorKind::AlreadyExists => {}
            Err(why) => return Err(format!("Can't make a folder in {}: {why}. Choose another one.", within.display())),
        }
    }
    Err(format!("There are too many folders named '{name}' in {}. Choose another one.", within.display()))
}

/// Folders of one name, at most.
const MOST: u32 = 999;

/// A name for files, made of that of a model: its last part, without what file systems refuse.
pub fn name_of(model: &str) -> String {
    let last = model.rsplit(['/', '\\', ':']).next().unwrap_or(model);
    let last = last.split('?').next().unwrap_or(last);
    let stem = last.rsplit_once('.').map_or(last, |(stem, _)| if stem.is_empty() { last } else { stem });
    let fit = |c: char| !c.is_control() && !"<>\"|*".contains(c);
    let name: String = stem.chars().filter(|c| fit(*c)).take(64).collect();
    if name.trim().is_empty() { "model".to_owned() } else { name.trim().to_owned() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_that_is_there_is_written_over_unasked() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("a.csv");
        write(&path, b"1").expect("written");
        write(&path, b"2").expect("written over, as the dialog has asked");
        assert_eq!(std::fs::read(&path).expect("there"), b"2");
        assert_eq!(with_ending(path.clone(), "csv"), Ok(path.clone()));
        assert_eq!(with_ending(folder.path().join("b"), "csv"), Ok(folder.path().join("b.csv")));
        assert!(with_ending(folder.path().join("a"), "csv").is_err_and(|why| why.contains("a.csv")));
        let first = new_folder(folder.path(), "report").expect("made");
        let second = new_folder(folder.path(), "report").expect("made");
        assert!(first.ends_with("report") && second.ends_with("report 2") && second.is_dir());
        assert!(new_folder(&path, "x").is_err() && write(Path::new("/nowhere/x"), b"").is_err());
    }

    #[test]
    fn models_give_names_that_files_may_have() {
        for (model, name) in [
            ("builtin:teapot?triangles=1000", "teapot"),
            ("/home/x/My model.v2.glb", "My model.v2"),
            ("case:zero-directions", "zero-directions"),
            ("/home/.glb", ".glb"),
            ("a/<>", "model"),
            ("", "model"),
        ] {
            assert_eq!(name_of(model), name, "{model}");
        }
    }
}
