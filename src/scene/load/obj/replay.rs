//! Puts together what the pieces of a file say, in its order: faces, now that all vertices are
//! known, and the objects, groups and materials they are under.

use super::corners::{Corner, Counts, Layout, NONE, Places, resolve, written};
use super::materials::Materials;
use super::meshes::Meshes;
use super::piece::{Piece, Step};
use super::statements::{Statements, values};
use super::vertices::Vertices;
use crate::scene::load::pace::Pace;
use crate::scene::load::text::{Line, lossy, shown};
use crate::scene::{Instance, LoadCx, Reason, Scene};

pub(super) struct Replay<'a, 'b> {
    materials: &'a mut Materials<'b>,
    meshes: Meshes<'a>,
    totals: Counts,
    /// What came before the present piece.
    before: Before,
    left_out: LeftOut,
    pace: Pace<'a>,
    cx: &'a LoadCx,
}

#[derive(Clone, Copy, Default)]
struct Before {
    lines: usize,
    /// What negative indices count back from.
    counts: Counts,
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

impl<'a, 'b> Replay<'a, 'b> {
    /// For a file of so many `triangles`.
    pub fn new(
        vertices: &'a Vertices,
        triangles: usize,
        materials: &'a mut Materials<'b>,
        cx: &'a LoadCx,
    ) -> Result<Self, Reason> {
        let (before, left_out) = Default::default();
        let meshes = Meshes::new(vertices, triangles, cx)?;
        Ok(Self { materials, meshes, totals: vertices.counts(), before, left_out, pace: Pace::new(cx), cx })
    }

    /// Takes the next piece, which was read from `text`.
    pub fn piece(&mut self, piece: &Piece, text: &[u8]) -> Result<(), Reason> {
        let places = Places::new(self.before.counts, piece.length, self.totals);
        let mut indices = &piece.indices[..];
        for step in &piece.steps {
            match *step {
                Step::Faces { layout, corners, count } => {
                    let (these, others) = indices.split_at(layout.stride() * corners as usize * count as usize);
                    self.faces(layout, corners as usize, these, &places, text)?;
                    indices = others;
                }
                Step::Name(name) => self.meshes.rename(lossy(piece.name(name)))?,
                Step::Material(name) => self.meshes.use_material(self.materials.find(piece.name(name)))?,
                Step::Library(_) => {}
                Step::Wrong => return Err(self.error(text)),
            }
            self.pace.step(1)?;
        }
        self.left_out.no_triangles += piece.no_triangles;
        self.before.lines += piece.lines;
        for (to, count) in self.before.counts.iter_mut().zip(piece.counts) {
            *to += count;
        }
        Ok(())
    }

    /// Polygons of so many corners, each cut into a fan.
    fn faces(&mut self, layout: Layout, corners: usize, indices: &[i32], places: &Places, text: &[u8]) -> Result<(), Reason> {
        self.meshes.make_room(indices.len() / layout.stride())?;
        let mut face = Vec::with_capacity(corners);
        for indices in indices.chunks_exact(layout.stride() * corners) {
            face.clear();
            for indices in indices.chunks_exact(layout.stride()) {
                let (corner, attribute_missing) = places.corner(layout, indices);
                if corner.position == NONE {
                    return Err(self.error(text));
                }
                if attribute_missing {
                    self.attribute_missing(text)?;
                }
                face.push(corner);
            }
            self.face(&face)?;
        }
        Ok(())
    }

    fn face(&mut self, corners: &[Corner]) -> Result<(), Reason> {
        if corners.len() < 3 {
            self.left_out.no_triangles += 1;
        } else {
            self.meshes.fan(corners)?;
        }
        Ok(self.pace.step(corners.len())?)
    }

    #[cold]
    fn attribute_missing(&mut self, text: &[u8]) -> Result<(), Reason> {
        self.left_out.attributes += 1;
        if self.left_out.first == 0 {
            self.left_out.first = self.look_again(text)?;
        }
        Ok(())
    }

    /// What is wrong in the present piece.
    #[cold]
    fn error(&self, text: &[u8]) -> Reason {
        let unclear = |line| Reason::malformed(format_args!("line {line}"), "it names a vertex that is not there");
        self.look_again(text).map_or_else(|reason| reason, unclear)
    }

    /// Reads the faces of the present piece by the line: fails at the first that is wrong, or gives
    /// the first that lacks an attribute.
    fn look_again(&self, text: &[u8]) -> Result<usize, Reason> {
        let Before { lines, counts: mut seen } = self.before;
        let mut first = 0;
        let mut statements = Statements::within(text, lines + 1, self.cx);
        while let Some(line) = statements.next()? {
            match line.words().next().unwrap_or_default() {
                b"v" => seen[0] += 1,
                b"vt" => seen[1] += 1,
                b"vn" => seen[2] += 1,
                b"f" | b"fo" => {
                    for word in values(&line) {
                        if self.lacks_attribute(word, &line, seen)? && first == 0 {
                            first = line.number;
                        }
                    }
                }
                _ => {}
            }
        }
        Ok(first)
    }

    /// Whether a corner names an attribute that is not there. The vertex must be there.
    fn lacks_attribute(&self, word: &[u8], line: &Line, seen: Counts) -> Result<bool, Reason> {
        let indices = written(word).ok_or_else(|| line.error(format_args!("{} is no corner of a face", shown(word))))?;
        let there = |part: usize| resolve(indices[part], seen[part], self.totals[part]).is_some();
        if !there(0) {
            let what = format_args!("there is no vertex {}; the file has {}", indices[0], self.totals[0]);
            return Err(line.error(what));
        }
        Ok((indices[1] != 0 && !there(1)) || (indices[2] != 0 && !there(2)))
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
