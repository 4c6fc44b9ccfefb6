//! A mesh cut into pieces small enough for 16-bit indices, and quick enough to make that a few fit
//! into a frame.

use std::sync::Arc;

use glam::Vec3;

use crate::geometry::num;
use crate::scene::Geometry;

/// The most vertices of a chunk.
const MAX_VERTICES: usize = 1 << 16;
/// The most triangles of a chunk, so that one chunk is never long work.
const MAX_TRIANGLES: usize = 1 << 16;

/// Part of a mesh, with vertices of its own.
#[derive(Debug, Default, PartialEq)]
pub(super) struct Chunk {
    pub(super) positions: Vec<Vec3>,
    /// Ordered so that every prefix is an even sample of the chunk.
    pub(super) triangles: Vec<[u16; 3]>,
}

impl Chunk {
    pub(super) fn bytes(&self) -> usize {
        size_of_val(&self.positions[..]) + size_of_val(&self.triangles[..])
    }
}

/// Cuts what structures hold of a scene into chunks, in order.
pub(super) struct Chunks {
    geometry: Arc<Geometry>,
    /// The next triangle, counted as in [`Geometry::live`].
    next: usize,
    /// A vertex's index in the chunk that last used it. Whether that is this chunk, the chunk's own
    /// list tells (a sparse set: Briggs and Torczon 1993), so this is never cleared.
    local: Vec<u16>,
}

impl Chunks {
    pub(super) fn new(geometry: Arc<Geometry>) -> Self {
        let local = vec![0; geometry.indexed().0.len()];
        Self { geometry, next: 0, local }
    }
}

impl Iterator for Chunks {
    type Item = Chunk;

    fn next(&mut self) -> Option<Chunk> {
        let (positions, triangles) = self.geometry.indexed();
        let mut chunk = Chunk::default();
        let mut global: Vec<u32> = Vec::new();
        while self.next < self.geometry.live_count()
            && chunk.triangles.len() < MAX_TRIANGLES
            && chunk.positions.len() + 3 <= MAX_VERTICES
        {
            let corners = triangles[self.geometry.live(self.next) as usize];
            chunk.triangles.push(corners.map(|vertex| {
                let known = &mut self.local[vertex as usize];
                if global.get(usize::from(*known)) != Some(&vertex) {
                    *known = (global.len() & 0xFFFF) as u16;
                    global.push(vertex);
                    chunk.positions.push(positions[vertex as usize]);
                }
                *known
            }));
            self.next += 1;
        }
        chunk.triangles = evenly(&chunk.triangles);
        (!chunk.triangles.is_empty()).then_some(chunk)
    }
}

/// Reordered so that a prefix is spread over the whole: first every 32nd run of eight, then the runs
/// after those, and so on. Runs, because neighbours share vertices.
fn evenly(triangles: &[[u16; 3]]) -> Vec<[u16; 3]> {
    const RUN: usize = 8;
    const STRIDE: usize = 32;
    let runs: Vec<_> = triangles.chunks(RUN).collect();
    (0..STRIDE).flat_map(|first| runs.iter().skip(first).step_by(STRIDE)).flat_map(|run| run.iter().copied()).collect()
}

/// How many of a chunk's triangles to draw, so that all chunks together draw about `most` of `total`.
pub(super) fn sampled(in_chunk: usize, total: usize, most: usize) -> u32 {
    if most >= total {
        return num::index(in_chunk);
    }
    let share = most as f64 / total as f64;
    num::index(num::floor_index((in_chunk as f64 * share).ceil(), in_chunk))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Instance, LoadCx, Mesh, Scene};

    /// A strip of `n` triangles that share vertices with their neighbours.
    fn strip(n: u32) -> Arc<Geometry> {
        let positions = (0..n + 2).map(|i| Vec3::new((i / 2) as f32, (i % 2) as f32, 0.0)).collect();
        let triangles = (0..n).map(|i| [i, i + 1, i + 2]).collect();
        let mesh = Mesh { positions, triangles, ..Mesh::default() };
        let scene = Scene { meshes: vec![mesh], instances: vec![Instance::identity(0)], ..Scene::default() };
        Arc::new(Geometry::new(&scene, &LoadCx::unattended()).expect("small"))
    }

    #[test]
    fn every_triangle_is_in_one_chunk() {
        let geometry = strip(150_000);
        let chunks: Vec<Chunk> = Chunks::new(Arc::clone(&geometry)).collect();
        assert!(chunks.len() >= 3);
        let mut found: Vec<[[u32; 3]; 3]> = Vec::new();
        for chunk in &chunks {
            assert!(chunk.positions.len() <= MAX_VERTICES);
            let corner = |i: u16| chunk.positions[usize::from(i)].to_array().map(f32::to_bits);
            found.extend(chunk.triangles.iter().map(|t| t.map(corner)));
        }
        let mut expected: Vec<_> = (0..150_000).map(|i| geometry.corners(i).map(|p| p.to_array().map(f32::to_bits))).collect();
        found.sort_unstable();
        expected.sort_unstable();
        assert!(found == expected);
    }

    #[test]
    fn a_prefix_is_an_even_sample() {
        let all: Vec<[u16; 3]> = (0..4096).map(|i| [i, i, i]).collect();
        let mut ordered = evenly(&all);
        let prefix = &ordered[..512];
        for quarter in 0..4 {
            let inside = prefix.iter().filter(|t| usize::from(t[0]) / 1024 == quarter).count();
            assert_eq!(inside, 128);
        }
        ordered.sort_unstable();
        assert_eq!(ordered, all);
        assert_eq!(sampled(1000, 10_000, 2_500), 250);
        assert_eq!(sampled(1000, 10_000, 10_000), 1000);
        assert_eq!(sampled(3, 10_000_000, 1), 1);
    }
}
