//! Gathers faces into meshes: one for each stretch of the file with one name and one material, so
//! that the triangles stay in file order.

use glam::{Vec2, Vec3};

use super::vertices::Vertices;
use crate::geometry::num;
use crate::scene::load::mesh_bytes;
use crate::scene::{LoadCx, Mesh, Reason};
use crate::task::Charge;

/// One corner of a face.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) struct Corner {
    pub position: u32,
    pub uv: Option<u32>,
    pub normal: Option<u32>,
}

pub(super) struct Meshes<'a> {
    from: &'a Vertices,
    done: Vec<Mesh>,
    mesh: Mesh,
    /// The corner that each vertex of the mesh was made of, and the vertex that was made of the
    /// same position before it.
    made_of: Vec<(Corner, u32)>,
    /// By position, the last vertex made of it. Entries of meshes before this one are recognised
    /// by what `made_of` says, so that nothing has to be cleared between meshes.
    last: Vec<u32>,
    uses: Uses,
    memory: Charge,
    /// Bytes of the present mesh that are charged.
    charged: u64,
}

/// Which attributes a corner of the present mesh has.
#[derive(Default)]
struct Uses {
    uvs: bool,
    normals: bool,
}

const NONE: u32 = u32::MAX;

impl<'a> Meshes<'a> {
    pub fn new(from: &'a Vertices, cx: &LoadCx) -> Result<Self, Reason> {
        let memory = cx.budget.charge(from.positions.len() as u64 * 4)?;
        let last = vec![NONE; from.positions.len()];
        let (done, mesh, made_of, uses) = Default::default();
        Ok(Self { from, done, mesh, made_of, last, uses, memory, charged: 0 })
    }

    /// An object or a group begins.
    pub fn rename(&mut self, name: String) -> Result<(), Reason> {
        self.end()?;
        self.mesh.name = name;
        Ok(())
    }

    /// The faces that follow are of `material`.
    pub fn use_material(&mut self, material: Option<usize>) -> Result<(), Reason> {
        if material != self.mesh.material {
            self.end()?;
            self.mesh.material = material;
        }
        Ok(())
    }

    /// Adds a polygon of three corners or more.
    pub fn fan(&mut self, corners: &[Corner]) -> Result<(), Reason> {
        let [a, b, rest @ ..] = corners else { return Ok(()) };
        let (first, mut before) = (self.vertex(a), self.vertex(b));
        for corner in rest {
            let vertex = self.vertex(corner);
            self.mesh.triangles.push([first, before, vertex]);
            before = vertex;
        }
        self.account()
    }

    /// The vertex for a corner, an earlier one where there is one. After a few that share the
    /// position but nothing else a new one is made: a file of such corners must not take
    /// quadratic time.
    fn vertex(&mut self, corner: &Corner) -> u32 {
        const LOOKS: usize = 32;
        let newest = self.last[corner.position as usize];
        let mut at = newest;
        for _ in 0..LOOKS {
            match self.made_of.get(at as usize) {
                Some((made_of, _)) if made_of == corner => return at,
                Some((made_of, older)) if made_of.position == corner.position => at = *older,
                _ => break,
            }
        }
        let vertex = num::index(self.mesh.positions.len());
        self.made_of.push((*corner, newest));
        self.last[corner.position as usize] = vertex;
        self.push(corner);
        vertex
    }

    fn push(&mut self, corner: &Corner) {
        let (mesh, from) = (&mut self.mesh, self.from);
        let pick = |i: Option<u32>| i.map(|i| i as usize);
        mesh.positions.push(from.positions[corner.position as usize]);
        mesh.colors.extend(from.colors.get(corner.position as usize));
        mesh.uvs.push(pick(corner.uv).map_or(Vec2::ZERO, |i| from.uvs[i]));
        mesh.normals.push(pick(corner.normal).map_or(Vec3::ZERO, |i| from.normals[i]));
        self.uses.uvs |= corner.uv.is_some();
        self.uses.normals |= corner.normal.is_some();
    }

    /// Charges what the mesh has grown by, a step at a time.
    fn account(&mut self) -> Result<(), Reason> {
        const STEP: u64 = 1 << 20;
        let bytes = mesh_bytes(&self.mesh) + self.made_of.len() as u64 * size_of::<(Corner, u32)>() as u64;
        if bytes > self.charged + STEP {
            self.memory.grow(bytes - self.charged)?;
            self.charged = bytes;
        }
        let vertices = self.mesh.positions.len();
        if vertices >= num::MAX_INDEX / 2 { Err(Reason::TooLarge(vertices as u64, "vertices")) } else { Ok(()) }
    }

    /// Puts the present mesh away, if it holds anything, and begins one of the same name and
    /// material. Where only some corners have an attribute, the others have zeros.
    fn end(&mut self) -> Result<(), Reason> {
        if self.mesh.triangles.is_empty() {
            return Ok(());
        }
        let next = Mesh { name: self.mesh.name.clone(), material: self.mesh.material, ..Mesh::default() };
        let mut mesh = std::mem::replace(&mut self.mesh, next);
        let uses = std::mem::take(&mut self.uses);
        if !uses.uvs {
            mesh.uvs = Vec::new();
        }
        if !uses.normals {
            mesh.normals = Vec::new();
        }
        self.memory.grow(mesh_bytes(&mesh).saturating_sub(self.charged))?;
        self.charged = 0;
        self.made_of.clear();
        self.done.push(mesh);
        Ok(())
    }

    pub fn finish(mut self) -> Result<Vec<Mesh>, Reason> {
        self.end()?;
        Ok(self.done)
    }
}
