//! The layers: each file imports only from its own layer or those before it. And the look: no
//! colours or sizes outside the theme.

use std::fs;
use std::path::{Path, PathBuf};

/// In order; layers in one entry do not know each other.
const LAYERS: &[&[&str]] =
    &[&["task", "sys"], &["simd"], &["geometry"], &["scene"], &["accel"], &["render"], &["lab"], &["job"], &["cli", "viewer"]];

/// `task` asks `sys` how large the machine is.
const ALLOWED: &[(&str, &str)] = &[("task", "sys"), ("cli", "viewer")];

fn rust_files(folder: &Path, into: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).expect("a folder").map(|e| e.expect("an entry").path()) {
        if entry.is_dir() {
            rust_files(&entry, into);
        } else if entry.extension().is_some_and(|e| e == "rs") {
            into.push(entry);
        }
    }
}

fn sources() -> Vec<(String, String)> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut files = Vec::new();
    rust_files(&root, &mut files);
    let name = |p: &Path| p.strip_prefix(&root).expect("below src").to_string_lossy().replace('\\', "/");
    files.iter().map(|p| (name(p), fs::read_to_string(p).expect("text"))).collect()
}

fn rank(layer: &str) -> Option<usize> {
    LAYERS.iter().position(|names| names.contains(&layer))
}

/// The top-level modules that a file names as `crate::…`, in imports and in the code.
fn named(text: &str) -> impl Iterator<Item = (usize, &str)> {
    text.lines().enumerate().filter(|(_, line)| !line.trim_start().starts_with("//")).flat_map(|(i, line)| {
        line.match_indices("crate::").map(move |(at, found)| {
            let rest = &line[at + found.len()..];
            let end = rest.find(|c: char| !c.is_alphanumeric() && c != '_').unwrap_or(rest.len());
            (i + 1, &rest[..end])
        })
    })
}

#[test]
fn no_import_runs_backwards() {
    let (mut wrong, mut seen) = (Vec::new(), 0);
    for (file, text) in sources() {
        let own = file.split('/').next().unwrap_or(&file).trim_end_matches(".rs");
        let Some(own_rank) = rank(own) else {
            assert!(["lib", "main"].contains(&own), "{file} belongs to no layer: add it to LAYERS");
            continue;
        };
        for (line, module) in named(&text) {
            seen += 1;
            let Some(other) = rank(module) else {
                wrong.push(format!("{file}:{line} names crate::{module}, which is no layer (group imports are written out)"));
                continue;
            };
            let fine = own == module || other < own_rank || ALLOWED.contains(&(own, module));
            if !fine {
                wrong.push(format!("{file}:{line} uses crate::{module}"));
            }
        }
    }
    assert!(seen > 100, "the search finds imports: {seen}");
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn colours_come_from_the_theme() {
    let literal = ["Color32::from_rgb(", "Color32::RED", "Color32::WHITE", "Color32::BLACK", "Color32::GRAY", "hex_color!"];
    let mut wrong = Vec::new();
    for (file, text) in sources().into_iter().filter(|(f, _)| f.starts_with("viewer/") && !f.starts_with("viewer/theme")) {
        for (i, line) in text.lines().enumerate() {
            let computed = line.contains("from_rgb(r, g, b)"); // from a colour map
            if literal.iter().any(|l| line.contains(l)) && !computed {
                wrong.push(format!("{file}:{}: {}", i + 1, line.trim()));
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn unsafe_code_lives_in_sys_and_simd_alone() {
    for (file, text) in sources() {
        let allowed = file.starts_with("sys/") || file.starts_with("simd/");
        assert!(allowed || !text.contains("unsafe "), "{file}");
    }
}
