//! The second reading of an OBJ file: faces, and the objects, groups and materials they are under.

use super::materials::Materials;
use super::meshes::{Corner, Meshes};
use super::values;
use super::vertices::Vertices;
use crate::geometry::num;
use crate::scene::load::text::{Line, lossy, number, shown};
use crate::scene::{Instance, LoadCx, Reason, Scene};

pub(super) struct Faces<'a, 'b> {
    vertices: &'a Vertices,
    materials: &'a mut Materials<'b>,
    meshes: Meshes<'a>,
    /// How many of each statement came before this line: what negative indices count back from.
    seen: Seen,
    corners: Vec<Corner>,
    left_out: LeftOut,
}

#[derive(Default)]
struct Seen {
    positions: usize,
    uvs: usize,
    normals: usize,
}

/// What was not read, for the warnings.
#[derive(Default)]
struct LeftOut {
    /// Lines, points, and faces of fewer than three corners.
    no_triangles: u64,
    /// Corners whose texture coordinate or normal is not there, and the line of the first.
    attributes: u64,
    first: usize,
}

impl<'a, 'b> Faces<'a, 'b> {
    pub fn new(vertices: &'a Vertices, materials: &'a mut Materials<'b>, cx: &LoadCx) -> Result<Self, Reason> {
        let meshes = Meshes::new(vertices, cx)?;
        Ok(Self { vertices, materials, meshes, seen: Seen::default(), corners: Vec::new(), left_out: LeftOut::default() })
    }

    /// Reads the statement if it is one of ours.
    pub fn statement(&mut self, word: &[u8], line: &Line) -> Result<(), Reason> {
        match word {
            b"v" => self.seen.positions += 1,
            b"vt" => self.seen.uvs += 1,
            b"vn" => self.seen.normals += 1,
            b"f" | b"fo" => self.face(line)?,
            b"l" | b"p" => self.left_out.no_triangles += 1,
            b"o" | b"g" => self.meshes.rename(lossy(line.tail()))?,
            b"usemtl" => self.meshes.use_material(self.materials.find(line.tail()))?,
            _ => {}
        }
        Ok(())
    }

    /// A polygon, cut into a fan.
    fn face(&mut self, line: &Line) -> Result<(), Reason> {
        self.corners.clear();
        for word in values(line) {
            let corner = self.corner(word, line)?;
            self.corners.push(corner);
        }
        if self.corners.len() < 3 {
            self.left_out.no_triangles += 1;
            return Ok(());
        }
        let Self { corners, meshes, .. } = self;
        meshes.fan(corners)
    }

    /// `v`, `v/vt`, `v//vn` or `v/vt/vn`. The vertex must be there; what else is not is left out.
    fn corner(&mut self, word: &[u8], line: &Line) -> Result<Corner, Reason> {
        let mut indices = [0i64; 3];
        let mut parts = word.split(|b| *b == b'/');
        for (to, part) in indices.iter_mut().zip(&mut parts).filter(|(_, part)| !part.is_empty()) {
            *to = number(part).ok_or_else(|| line.error(format_args!("{} is no corner of a face", shown(word))))?;
        }
        if parts.next().is_some() {
            return Err(line.error(format_args!("{} is no corner of a face", shown(word))));
        }
        let (v, vertices) = (indices[0], self.vertices);
        let position = resolve(v, self.seen.positions, vertices.positions.len())
            .ok_or_else(|| line.error(format_args!("there is no vertex {v}; the file has {}", vertices.positions.len())))?;
        let uv = resolve(indices[1], self.seen.uvs, vertices.uvs.len());
        let normal = resolve(indices[2], self.seen.normals, vertices.normals.len());
        if (indices[1] != 0 && uv.is_none()) || (indices[2] != 0 && normal.is_none()) {
            self.left_out.attributes += 1;
            if self.left_out.first == 0 {
                self.left_out.first = line.number;
            }
        }
        Ok(Corner { position, uv, normal })
    }

    /// The meshes, each placed once where it is.
    pub fn finish(self) -> Result<Scene, Reason> {
        let mut warnings = Vec::new();
        let LeftOut { no_triangles, attributes, first } = self.left_out;
        if no_triangles > 0 {
            let what = "Points, lines and faces of fewer than three corners were left out";
            warnings.push(format!("{what}: {no_triangles}."));
        }
        if attributes > 0 {
            let what = "Corners that name a texture coordinate or a normal which is not there were read without it";
            warnings.push(format!("{what}: {attributes}, the first in line {first}."));
        }
        let meshes = self.meshes.finish()?;
        let instances = (0..meshes.len()).map(Instance::identity).collect();
        Ok(Scene { meshes, instances, warnings, ..Scene::default() })
    }
}

/// An index as written, counted from 1 or, negative, back from the last one `seen`.
fn resolve(written: i64, seen: usize, total: usize) -> Option<u32> {
    let index = match written {
        0 => None,
        1.. => usize::try_from(written).ok().map(|i| i - 1),
        _ => usize::try_from(written.unsigned_abs()).ok().and_then(|back| seen.checked_sub(back)),
    };
    index.filter(|i| *i < total).map(num::index)
}
