//! Wavefront OBJ (Alias|Wavefront, "Advanced Visualizer", appendix B1, 1993) with its MTL files.
//!
//! Read by hand and not with `tobj`: that one panics where `Kd` has two numbers (and, with overflow
//! checks, on an index far below zero), does not say on which line it fails, and, where only some
//! corners have a texture coordinate or a normal, returns lists that no longer match the vertices.
//! The tests use it to check this reader.
//!
//! The file is cut into pieces that are read side by side ([`piece`]), each by itself; then they are
//! put together in order ([`replay`]), because a face may come before its vertices and counts back
//! from where it stands, and a `usemtl` may come before its `mtllib`.

mod corners;
mod cut;
mod maps;
mod material;
mod materials;
mod meshes;
mod numbers;
mod piece;
mod quick;
mod replay;
mod statements;
mod vertices;

use super::text::without_mark;
use super::{Loader, Siblings};
use crate::scene::{LoadCx, Reason, Scene};
use crate::task::Charge;
use glam::Vec3;
use materials::Materials;
use piece::Piece;
use rayon::prelude::*;
use replay::Replay;
use vertices::Vertices;

/// The reader of `.obj` files.
pub(super) struct Obj;

/// Bytes of a piece. What is made of it fits a core's cache.
const PIECE: usize = 1 << 18;

impl Loader for Obj {
    fn id(&self) -> &'static str {
        "obj"
    }

    fn extensions(&self) -> &'static [&'static str] {
        &["obj"]
    }

    fn load(&self, bytes: &[u8], files: &dyn Siblings, cx: &LoadCx) -> Result<Scene, Reason> {
        cx.pool.run(|| in_pieces(bytes, PIECE, files, cx))
    }
}

/// Reads a model in pieces of about `size` bytes.
fn in_pieces(bytes: &[u8], size: usize, files: &dyn Siblings, cx: &LoadCx) -> Result<Scene, Reason> {
    cx.progress.start("parse", bytes.len() as u64);
    let texts = cut::cut(without_mark(bytes), size, cx)?;
    let mut pieces = read(&texts, cx)?;
    let mut materials = Materials::new(files, cx)?;
    for name in pieces.iter().flat_map(Piece::libraries) {
        materials.library(name)?;
    }
    cx.progress.start("merge", pieces.iter().map(|piece| piece.indices.len() as u64).sum());
    let (vertices, _memory) = join_vertices(&mut pieces, cx)?;
    let triangles = pieces.iter().map(Piece::triangles).sum();
    let mut replay = Replay::new(&vertices, triangles, &mut materials, cx)?;
    for (piece, text) in pieces.into_iter().zip(texts) {
        replay.piece(&piece, text)?;
    }
    let mut scene = Scene { up: Vec3::Y, ..replay.finish()? };
    materials.finish(&mut scene);
    Ok(scene)
}

/// Reads all pieces. If there is something wrong with several of them, the first one counts.
fn read(texts: &[&[u8]], cx: &LoadCx) -> Result<Vec<Piece>, Reason> {
    let results: Vec<_> = texts.par_iter().map(|text| Piece::read(text, 1, cx)).collect();
    let mut pieces = Vec::with_capacity(texts.len());
    let mut first = 1;
    for (result, text) in results.into_iter().zip(texts) {
        let piece = match result {
            // Only now is it known which line that is.
            Err(Reason::Malformed { .. }) => Piece::read(text, first, cx)?,
            other => other?,
        };
        first += piece.lines;
        pieces.push(piece);
    }
    Ok(pieces)
}

fn join_vertices(pieces: &mut [Piece], cx: &LoadCx) -> Result<(Vertices, Charge), Reason> {
    let mut totals = [0; 3];
    let mut parts = Vec::with_capacity(pieces.len());
    let mut memory = Vec::with_capacity(pieces.len());
    for piece in pieces {
        totals = std::array::from_fn(|part| totals[part] + piece.counts[part]);
        let (vertices, charge) = piece.take_vertices(cx)?;
        parts.push(vertices);
        memory.push(charge);
    }
    Vertices::joined(&parts, totals, cx)
}

#[cfg(test)]
mod tests;
