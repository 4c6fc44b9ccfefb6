//! One primitive of a glTF mesh becomes one mesh of ours.

use bytemuck::Zeroable;
use glam::{Vec2, Vec3};
use gltf::json::accessor::ComponentType;
use gltf::json::mesh::{Mode, Primitive, Semantic};
use gltf::json::validation::Checked;
use gltf::json::{Accessor as Json, Index, Root};

use super::accessor::{self, Accessor};
use super::buffers::Buffers;
use super::picked::Picked;
use super::{extensions, materials, textures};
use crate::geometry::num;
use crate::scene::load::fill;
use crate::scene::load::pace::Pace;
use crate::scene::load::text::clipped;
use crate::scene::{Keep, LoadCx, Mesh, Reason};
use crate::task::Charge;

/// Bytes of a vertex with every attribute.
const VERTEX: u64 = 12 + 12 + 8 + 16;

pub(super) struct Primitives<'a, 'b> {
    root: &'a Root,
    buffers: &'a Buffers<'b>,
    cx: &'a LoadCx,
    pace: Pace<'a>,
    left_out: LeftOut,
}

/// What was not read, for the warnings.
#[derive(Default)]
struct LeftOut {
    points_and_lines: usize,
    without_positions: usize,
    wrong_counts: usize,
}

impl<'a, 'b> Primitives<'a, 'b> {
    pub fn new(root: &'a Root, buffers: &'a Buffers<'b>, cx: &'a LoadCx) -> Self {
        Self { root, buffers, cx, pace: Pace::new(cx), left_out: LeftOut::default() }
    }

    /// What was left out so far.
    pub fn warnings(&self) -> Vec<String> {
        let left_out = [
            ("Primitives of points or lines were left out", self.left_out.points_and_lines),
            ("Primitives without positions were left out", self.left_out.without_positions),
            ("Vertex attributes longer or shorter than the positions were left out", self.left_out.wrong_counts),
        ];
        left_out.into_iter().filter(|(_, n)| *n > 0).map(|(what, n)| format!("{what}: {n}.")).collect()
    }

    /// Reads primitive `p` of mesh `m`; `None` if it has no triangles.
    pub fn load(&mut self, m: usize, p: usize, primitive: &Primitive) -> Result<Option<Mesh>, Reason> {
        let name = self.root.meshes.get(m).and_then(|mesh| mesh.name.clone()).unwrap_or_default();
        let called = if name.is_empty() { String::new() } else { format!(" ({})", clipped(name.as_bytes())) };
        let place = format!("mesh {m}{called} primitive {p}");
        let Checked::Valid(mode) = primitive.mode else {
            return Err(Reason::malformed(place, "its mode is not known"));
        };
        if !matches!(mode, Mode::Triangles | Mode::TriangleStrip | Mode::TriangleFan) {
            self.left_out.points_and_lines += 1;
            return Ok(None);
        }
        self.check_compression(primitive, &place)?;
        let Some(positions) = attribute(primitive, Semantic::Positions) else {
            self.left_out.without_positions += 1; // which is allowed, for extensions to fill
            return Ok(None);
        };
        let positions = self.open(positions, &place)?;
        if positions.width != 3 {
            return Err(Reason::malformed(place, "its POSITION is not of VEC3"));
        }
        // For as long as this takes; whoever keeps the mesh charges it again.
        let mut memory = self.cx.budget.charge(0)?;
        let corners = self.corners(primitive, positions.count, &place, &mut memory)?;
        let triangles = self.triangles(mode, corners, positions.count, &mut memory)?;
        let (picked, triangles) = Picked::of(triangles, positions.count, &mut self.pace)?;
        memory.grow(picked.count() as u64 * VERTEX)?;

        let mut mesh = Mesh { name, triangles, material: self.material(primitive, &place)?, ..Mesh::default() };
        mesh.positions = self.read(&positions, &picked, |a, i| Vec3::from_array(a.vector(i, [0.0; 3])))?;
        self.attributes(primitive, &picked, positions.count, &place, &mut mesh)?;
        Ok(Some(mesh))
    }

    /// Reads what vertices have besides a position.
    fn attributes(
        &mut self,
        primitive: &Primitive,
        picked: &Picked,
        count: usize,
        place: &str,
        mesh: &mut Mesh,
    ) -> Result<(), Reason> {
        if let Some(normals) = self.optional(primitive, Semantic::Normals, count, place)? {
            mesh.normals = self.read(&normals, picked, |a, i| Vec3::from_array(a.vector(i, [0.0; 3])))?;
        }
        // Where no image is looked up, nothing needs them.
        let uv_set = mesh.material.and_then(|m| textures::uv_set(self.root, m));
        let uv_set = uv_set.or((self.cx.keep == Keep::All).then_some(0)).map(Semantic::TexCoords);
        let uvs = uv_set.map_or(Ok(None), |set| self.optional(primitive, set, count, place))?;
        if let Some(uvs) = uvs {
            mesh.uvs = self.read(&uvs, picked, |a, i| Vec2::from_array(a.vector(i, [0.0; 2])))?;
        }
        if let Some(colors) = self.optional(primitive, Semantic::Colors(0), count, place)? {
            let opaque = mesh.material.is_none_or(|m| materials::is_opaque(&self.root.materials[m]));
            mesh.colors = self.read(&colors, picked, |a, i| {
                let [r, g, b, a] = a.vector(i, [1.0; 4]);
                [r, g, b, if opaque { 1.0 } else { a }]
            })?;
        }
        Ok(())
    }

    /// A compressed primitive can be read where it has the plain data too.
    fn check_compression(&self, primitive: &Primitive, place: &str) -> Result<(), Reason> {
        let Some(extension) = extensions::compression_of_primitive(primitive) else { return Ok(()) };
        let position = attribute(primitive, Semantic::Positions);
        let plain = position.into_iter().chain(primitive.indices).all(|index| accessor::has_data(self.root, index));
        if plain && position.is_some() { Ok(()) } else { Err(extensions::unsupported(place.to_owned(), extension)) }
    }

    fn open(&self, index: Index<Json>, place: &str) -> Result<Accessor<'a>, Reason> {
        Accessor::open(self.root, self.buffers, index, place)
    }

    fn optional(
        &mut self,
        primitive: &Primitive,
        semantic: Semantic,
        count: usize,
        place: &str,
    ) -> Result<Option<Accessor<'a>>, Reason> {
        let Some(index) = attribute(primitive, semantic) else { return Ok(None) };
        let found = self.open(index, place)?;
        if found.count == count {
            return Ok(Some(found));
        }
        self.left_out.wrong_counts += 1;
        Ok(None)
    }

    /// The indices, each below `count`; `None` if the vertices are used in order.
    fn corners(
        &mut self,
        primitive: &Primitive,
        count: usize,
        place: &str,
        memory: &mut Charge,
    ) -> Result<Option<Vec<u32>>, Reason> {
        let Some(index) = primitive.indices else { return Ok(None) };
        let indices = self.open(index, place)?;
        if indices.width != 1 || !matches!(indices.kind, ComponentType::U8 | ComponentType::U16 | ComponentType::U32) {
            return Err(Reason::malformed(place, "its indices are not unsigned scalars"));
        }
        memory.grow(indices.count as u64 * 4)?;
        let corners = self.read(&indices, &Picked::All(indices.count), |a, i| a.index(i))?;
        match fill::position(&corners, self.cx, |i| *i as usize >= count) {
            Some(at) => {
                let what = format!("index {at} is {}, but there are {count} vertices", corners[at]);
                Err(Reason::malformed(place, what))
            }
            None => Ok(Some(corners)),
        }
    }

    /// Triangles of lists, strips and fans (glTF 2.0, section 3.7.2.1). What is left over is
    /// passed over.
    fn triangles(
        &self,
        mode: Mode,
        mut corners: Option<Vec<u32>>,
        count: usize,
        memory: &mut Charge,
    ) -> Result<Vec<[u32; 3]>, Reason> {
        if matches!(mode, Mode::Triangles)
            && let Some(list) = corners.take()
        {
            match bytemuck::try_cast_vec(list) {
                Ok(triangles) => return Ok(triangles), // nothing is left over, as nearly always: no copy
                Err((_, list)) => corners = Some(list),
            }
        }
        let corners = corners.as_deref();
        let corner = |i: usize| corners.map_or(num::index(i), |corners| corners[i]);
        let corner_count = corners.map_or(count, <[u32]>::len);
        let n = if matches!(mode, Mode::Triangles) { corner_count / 3 } else { corner_count.saturating_sub(2) };
        memory.grow(n as u64 * 12)?;
        let triangle = |i: usize| match mode {
            Mode::TriangleStrip if i % 2 == 1 => [i, i + 2, i + 1].map(corner),
            Mode::TriangleStrip => [i, i + 1, i + 2].map(corner),
            Mode::TriangleFan => [i + 1, i + 2, 0].map(corner),
            _ => [3 * i, 3 * i + 1, 3 * i + 2].map(corner),
        };
        Ok(fill::list(n, 12, self.cx, |start, piece| (start..).zip(piece).for_each(|(i, to)| *to = triangle(i)))?)
    }

    fn read<T: Zeroable + Send>(
        &self,
        from: &Accessor,
        picked: &Picked,
        get: impl Fn(&Accessor, usize) -> T + Sync,
    ) -> Result<Vec<T>, Reason> {
        let n = picked.count();
        Ok(fill::list(n, size_of::<T>() as u64, self.cx, |start, piece| {
            (start..).zip(piece).for_each(|(i, to)| *to = get(from, picked.source(i)));
        })?)
    }

    fn material(&self, primitive: &Primitive, place: &str) -> Result<Option<usize>, Reason> {
        let index = primitive.material.map(|index| index.value());
        match index {
            Some(i) if i >= self.root.materials.len() => Err(Reason::malformed(place, format_args!("there is no material {i}"))),
            _ => Ok(index),
        }
    }
}

fn attribute(primitive: &Primitive, semantic: Semantic) -> Option<Index<Json>> {
    primitive.attributes.get(&Checked::Valid(semantic)).copied()
}
