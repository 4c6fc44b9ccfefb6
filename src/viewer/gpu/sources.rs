//! What of a scene goes to the GPU, piece by piece: the triangles that were flattened, and each mesh that stands in
//! several places once, with its places.

use std::sync::Arc;

use super::chunks::{Chunk, Chunks};
use crate::scene::{Geometry, Place};
use glam::{DAffine3, Vec4};

/// The rows of the way from a mesh's space to the scene's.
pub(super) type Rows = [Vec4; 3];

/// The most places of one piece.
const MOST_PLACES: usize = 1 << 14;

/// A piece. Sources are numbered from 0; the places of one come before its triangles.
pub(super) enum Piece {
    Places { source: usize, rows: Vec<Rows> },
    Triangles { source: usize, chunk: Chunk },
}

/// All pieces of a scene, in order.
pub(super) struct Sources {
    geometry: Arc<Geometry>,
    /// Which source is at work: 0 is what was flattened, then come the meshes.
    source: usize,
    /// Places of it that were given.
    places: usize,
    chunks: Option<Chunks>,
}

impl Sources {
    pub(super) fn new(geometry: Arc<Geometry>) -> Self {
        Self { geometry, source: 0, places: 0, chunks: None }
    }

    /// The triangles of a source.
    fn triangles(&self) -> Option<Arc<Geometry>> {
        match self.source.checked_sub(1) {
            None => Some(Arc::clone(&self.geometry)),
            Some(part) => self.geometry.placed()?.parts().get(part).cloned(),
        }
    }

    /// The next places of the source; none once all were given.
    fn rows(&mut self) -> Vec<Rows> {
        let first = self.places;
        let Some(part) = self.source.checked_sub(1) else {
            self.places = 1;
            return if first == 0 { vec![rows(&DAffine3::IDENTITY)] } else { Vec::new() };
        };
        let all = self.geometry.placed().map_or(&[][..], |placed| placed.places_of(part));
        let end = all.len().min(first + MOST_PLACES);
        self.places = end;
        // In no order, so that the first so many are an even sample.
        let mut some: Vec<&Place> = all[first..end].iter().collect();
        some.sort_by_key(|place| place.instance.wrapping_mul(0x9E37_79B9));
        some.iter().map(|place| rows(&place.scene_from_part())).collect()
    }
}

impl Iterator for Sources {
    type Item = Piece;

    fn next(&mut self) -> Option<Piece> {
        loop {
            if self.chunks.is_none() {
                let source = self.source;
                let rows = self.rows();
                if !rows.is_empty() {
                    return Some(Piece::Places { source, rows });
                }
                self.chunks = Some(Chunks::new(self.triangles()?));
            }
            if let Some(chunk) = self.chunks.as_mut().and_then(Chunks::next) {
                return Some(Piece::Triangles { source: self.source, chunk });
            }
            (self.chunks, self.places) = (None, 0);
            self.source += 1;
        }
    }
}

fn rows(map: &DAffine3) -> Rows {
    let m = map.matrix3.transpose();
    let row = |i: usize| m.col(i).extend(map.translation[i]).as_vec4();
    [row(0), row(1), row(2)]
}
