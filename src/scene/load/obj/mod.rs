//! Wavefront OBJ (Alias|Wavefront, "Advanced Visualizer", appendix B1, 1993) with its MTL files.
//!
//! Read by hand and not with `tobj`: that one panics where `Kd` has two numbers (and, with overflow
//! checks, on an index far below zero), does not say on which line it fails, and, where only some
//! corners have a texture coordinate or a normal, returns lists that no longer match the vertices.
//! The tests use it to check this reader.
//!
//! The file is read twice: positions and the like first, then faces, because a face may come
//! before its vertices, and a `usemtl` before its `mtllib`.

mod faces;
mod maps;
mod material;
mod materials;
mod meshes;
mod vertices;

use super::text::{Line, Lines};
use super::{Loader, Siblings};
use crate::scene::{LoadCx, Reason, Scene};
use glam::Vec3;
use materials::Materials;
use vertices::Vertices;

/// The reader of `.obj` files.
pub(super) struct Obj;

impl Loader for Obj {
    fn id(&self) -> &'static str {
        "obj"
    }

    fn extensions(&self) -> &'static [&'static str] {
        &["obj"]
    }

    fn load(&self, bytes: &[u8], files: &dyn Siblings, cx: &LoadCx) -> Result<Scene, Reason> {
        cx.progress.start("parse", 2 * bytes.len() as u64);
        // A vertex takes 8 bytes of text ("v 0 0 0") and at most 24 in a list.
        let _memory = cx.budget.charge(3 * bytes.len() as u64)?;
        let mut vertices = Vertices::default();
        let mut materials = Materials::new(files, cx)?;
        each_statement(bytes, cx, |word, line| match word {
            b"mtllib" => materials.library(line.tail()),
            _ => vertices.statement(word, &line),
        })?;
        let mut faces = faces::Faces::new(&vertices, &mut materials, cx)?;
        each_statement(bytes, cx, |word, line| faces.statement(word, &line))?;
        let mut scene = Scene { up: Vec3::Y, ..faces.finish()? };
        materials.finish(&mut scene);
        Ok(scene)
    }
}

/// Calls `each` with the first word of every line and the line, of which a backslash at the end
/// joins the next.
fn each_statement(bytes: &[u8], cx: &LoadCx, mut each: impl FnMut(&[u8], Line<'_>) -> Result<(), Reason>) -> Result<(), Reason> {
    const MAX_JOINED: usize = 1 << 20;
    let mut lines = Lines::new(bytes, 1, cx);
    let mut joined = Vec::new();
    while let Some(mut line) = lines.next()? {
        joined.clear();
        while let Some(begin) = line.bytes.strip_suffix(b"\\") {
            joined.extend_from_slice(begin);
            joined.push(b' ');
            if joined.len() > MAX_JOINED {
                return Err(line.error("it is joined to a line longer than a mebibyte"));
            }
            let Some(next) = lines.next()? else { break };
            line = next;
        }
        if !joined.is_empty() {
            joined.extend_from_slice(line.bytes);
            line.bytes = &joined;
        }
        if let Some(word) = line.words().next().filter(|word| !word.starts_with(b"#")) {
            each(word, line)?;
        }
    }
    Ok(())
}

/// The values of a statement: its words without the first, up to a comment.
fn values<'a>(line: &Line<'a>) -> impl Iterator<Item = &'a [u8]> + use<'a> {
    line.words().skip(1).take_while(|word| !word.starts_with(b"#"))
}

#[cfg(test)]
mod tests;
