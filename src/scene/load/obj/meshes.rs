//! Gathers faces into meshes: one for each stretch of the file with one name and one material, so
//! that the triangles stay in file order.

use glam::{Vec2, Vec3};
use rayon::prelude::*;

use super::corners::{Corner, NONE};
use super::vertices::Vertices;
use crate::geometry::num;
use crate::scene::load::mesh_bytes;
use crate::scene::{LoadCx, Mesh, Reason};
use crate::sys::list_in_large_pages;
use crate::task::{Cancelled, Charge};

pub(super) struct Meshes<'a> {
    from: &'a Vertices,
    cx: &'a LoadCx,
    done: Vec<Mesh>,
    /// The present mesh, of which the lists are made when it ends.
    mesh: Mesh,
    /// Its triangles, with room for all of the file.
    triangles: Vec<[u32; 3]>,
    made_of: Vec<Made>,
    /// By position, the last vertex made of it. Entries of meshes before this one are recognised
    /// by what `made_of` says, so that nothing has to be cleared between meshes.
    last: Vec<u32>,
    uses: Uses,
    memory: Charge,
}

/// The corner that a vertex of the mesh was made of, and the vertex that was made of the same
/// position before it.
#[derive(Clone, Copy)]
struct Made {
    of: Corner,
    older: u32,
}

/// Which attributes a corner of the present mesh has.
#[derive(Default)]
struct Uses {
    uvs: bool,
    normals: bool,
}

impl<'a> Meshes<'a> {
    /// For a file of so many triangles.
    pub fn new(from: &'a Vertices, triangles: usize, cx: &'a LoadCx) -> Result<Self, Reason> {
        let memory = cx.budget.charge(from.positions.len() as u64 * 4 + triangles as u64 * 12)?;
        let last = gather(&from.positions, cx, |_| NONE)?;
        let (done, mesh, made_of, uses) = Default::default();
        Ok(Self { from, cx, done, mesh, triangles: list_in_large_pages(triangles), made_of, last, uses, memory })
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

    /// Makes room for the vertices of faces of so many corners together, which is charged.
    pub fn make_room(&mut self, corners: usize) -> Result<(), Reason> {
        let needed = self.made_of.len() + corners;
        if needed > self.made_of.capacity() {
            let capacity = needed.max(2 * self.made_of.capacity());
            self.memory.grow(((capacity - self.made_of.capacity()) * size_of::<Made>()) as u64)?;
            self.made_of.reserve_exact(capacity - self.made_of.len());
        }
        Ok(())
    }

    /// Adds a polygon of three corners or more.
    pub fn fan(&mut self, corners: &[Corner]) -> Result<(), Reason> {
        let [a, b, rest @ ..] = corners else { return Ok(()) };
        let (first, mut before) = (self.vertex(a), self.vertex(b));
        for corner in rest {
            let vertex = self.vertex(corner);
            self.triangles.push([first, before, vertex]);
            before = vertex;
        }
        let vertices = self.made_of.len();
        if vertices >= num::MAX_INDEX / 2 { Err(Reason::TooLarge(vertices as u64, "vertices")) } else { Ok(()) }
    }

    /// The vertex for a corner, an earlier one where there is one. After a few that share the
    /// position but nothing else a new one is made: a file of such corners must not take
    /// quadratic time.
    #[inline]
    fn vertex(&mut self, corner: &Corner) -> u32 {
        const LOOKS: usize = 32;
        let last = &mut self.last[corner.position as usize];
        let mut at = *last;
        for _ in 0..LOOKS {
            match self.made_of.get(at as usize) {
                Some(made) if made.of == *corner => return at,
                Some(made) if made.of.position == corner.position => at = made.older,
                _ => break,
            }
        }
        let vertex = num::index(self.made_of.len());
        self.made_of.push(Made { of: *corner, older: *last });
        *last = vertex;
        self.uses.uvs |= corner.uv != NONE;
        self.uses.normals |= corner.normal != NONE;
        vertex
    }

    /// Puts the present mesh away, if it holds anything, and begins one of the same name and
    /// material.
    fn end(&mut self) -> Result<(), Reason> {
        if self.triangles.is_empty() {
            return Ok(());
        }
        let next = Mesh { name: self.mesh.name.clone(), material: self.mesh.material, ..Mesh::default() };
        let mut mesh = std::mem::replace(&mut self.mesh, next);
        self.memory.grow(self.bytes() + mesh_bytes(&mesh))?;
        self.make_lists(&mut mesh)?;
        self.done.push(mesh);
        self.uses = Uses::default();
        self.triangles.clear();
        self.made_of.clear();
        Ok(())
    }

    /// What the lists of the present mesh will take.
    fn bytes(&self) -> u64 {
        let each = |there: bool, bytes: usize| if there { bytes } else { 0 };
        let colored = !self.from.colors.is_empty();
        let vertex = 12 + each(self.uses.uvs, 8) + each(self.uses.normals, 12) + each(colored, 16);
        (self.made_of.len() * vertex + self.triangles.len() * 12) as u64
    }

    /// Where only some corners have an attribute, the others have zeros.
    fn make_lists(&mut self, mesh: &mut Mesh) -> Result<(), Cancelled> {
        // The only mesh of a file need not be copied.
        let all = self.triangles.len() == self.triangles.capacity();
        mesh.triangles = if all { std::mem::take(&mut self.triangles) } else { gather(&self.triangles, self.cx, |t| *t)? };
        let Self { from, uses, cx, made_of, .. } = self;
        mesh.positions = gather(made_of, cx, |made| from.positions[made.of.position as usize])?;
        if uses.uvs {
            mesh.uvs = gather(made_of, cx, |made| from.uvs.get(made.of.uv as usize).copied().unwrap_or(Vec2::ZERO))?;
        }
        if uses.normals {
            mesh.normals = gather(made_of, cx, |made| from.normals.get(made.of.normal as usize).copied().unwrap_or(Vec3::ZERO))?;
        }
        if !from.colors.is_empty() {
            mesh.colors = gather(made_of, cx, |made| from.colors[made.of.position as usize])?;
        }
        Ok(())
    }

    pub fn finish(mut self) -> Result<Vec<Mesh>, Reason> {
        self.end()?;
        Ok(self.done)
    }
}

/// What `pick` says of every item.
fn gather<S: Sync, T: Send>(items: &[S], cx: &LoadCx, pick: impl Fn(&S) -> T + Sync) -> Result<Vec<T>, Cancelled> {
    /// Items between two looks at the cancel flag.
    const BLOCK: usize = 1 << 19;
    /// Items that are not worth another thread.
    const FEW: usize = 1 << 12;
    let mut list = list_in_large_pages(items.len());
    for block in items.chunks(BLOCK) {
        cx.cancel.check()?;
        if block.len() <= FEW {
            list.extend(block.iter().map(&pick));
        } else {
            list.par_extend(block.par_iter().with_min_len(FEW).map(&pick));
        }
    }
    Ok(list)
}
