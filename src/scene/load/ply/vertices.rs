//! The vertices of a PLY file.

use glam::{Vec2, Vec3};

use super::header::{Element, ScalarType, Shape, size};
use super::payload::Payload;
use super::records::{Column, Records};
use crate::geometry::num;
use crate::scene::load::{linear_from_srgb, unit};
use crate::scene::{LoadCx, Mesh, Reason};
use crate::task::Charge;

/// What a property means to us; the number is the axis or channel.
#[derive(Clone, Copy)]
enum Meaning {
    Position(usize),
    Normal(usize),
    Uv(usize),
    /// With what makes it 0 to 1.
    Color(usize, f32),
}

/// What the properties of a vertex mean, in their order, and which attributes they make up.
struct Layout {
    meanings: Vec<Option<Meaning>>,
    normals: bool,
    uvs: bool,
    colors: bool,
}

impl Layout {
    fn of(element: &Element) -> Result<Self, Reason> {
        let meanings: Vec<_> = element.fields.iter().map(|field| meaning(&field.name, &field.shape)).collect();
        let has = |n: usize, of: fn(&Meaning) -> Option<usize>| {
            (0..n).all(|axis| meanings.iter().flatten().any(|meaning| of(meaning) == Some(axis)))
        };
        if !has(3, |m| if let Meaning::Position(axis) = m { Some(*axis) } else { None }) {
            return Err(Reason::malformed("header", "the vertices have no x, y and z"));
        }
        let normals = has(3, |m| if let Meaning::Normal(axis) = m { Some(*axis) } else { None });
        let uvs = has(2, |m| if let Meaning::Uv(axis) = m { Some(*axis) } else { None });
        let colors = has(3, |m| if let Meaning::Color(channel, _) = m { Some(*channel) } else { None });
        Ok(Self { meanings, normals, uvs, colors })
    }

    /// Bytes of a vertex in our lists.
    fn bytes(&self) -> u64 {
        12 + if self.normals { 12 } else { 0 } + if self.uvs { 8 } else { 0 } + if self.colors { 16 } else { 0 }
    }

    /// Reads every vertex by the quick road, one attribute after the other.
    fn read_records(&self, element: &Element, records: &Records, mesh: &mut Mesh, cx: &LoadCx) -> Result<(), Reason> {
        let [x, y, z] = self.columns(element, |m| if let Meaning::Position(axis) = m { Some((axis, 1.0)) } else { None });
        let value = |column: Option<(Column, f32)>, record: &[u8]| column.map_or(0.0, |(column, _)| column.value(record, cx));
        mesh.positions = records.list(records.size, cx, |r| Vec3::new(value(x, r), value(y, r), value(z, r)))?;
        if self.normals {
            let [x, y, z] = self.columns(element, |m| if let Meaning::Normal(axis) = m { Some((axis, 1.0)) } else { None });
            mesh.normals = records.list(0, cx, |r| Vec3::new(value(x, r), value(y, r), value(z, r)))?;
        }
        if self.uvs {
            let [u, v] = self.columns(element, |m| if let Meaning::Uv(axis) = m { Some((axis, 1.0)) } else { None });
            mesh.uvs = records.list(0, cx, |r| Vec2::new(value(u, r), value(v, r)))?;
        }
        if self.colors {
            let rgba: [_; 4] =
                self.columns(element, |m| if let Meaning::Color(channel, scale) = m { Some((channel, scale)) } else { None });
            let opaque = [0.0, 0.0, 0.0, 1.0];
            mesh.colors = records.list(0, cx, |r| {
                let channel = |c: usize| rgba[c].map_or(opaque[c], |(column, scale)| column.value(r, cx) * scale);
                linear([0, 1, 2, 3].map(channel))
            })?;
        }
        Ok(())
    }

    /// Where the axes of an attribute are, and what scales them; the last of several, as when one is read
    /// after the other.
    fn columns<'a, const N: usize>(
        &self,
        element: &'a Element,
        axis: impl Fn(Meaning) -> Option<(usize, f32)>,
    ) -> [Option<(Column<'a>, f32)>; N] {
        let (mut columns, mut offset) = ([None; N], 0);
        for (field, meaning) in element.fields.iter().zip(&self.meanings) {
            let (Shape::One(kind) | Shape::List { count: kind, .. }) = &field.shape;
            if let Some((axis, scale)) = meaning.and_then(&axis) {
                columns[axis] = Some((Column { offset, kind }, scale));
            }
            offset += size(kind);
        }
        columns
    }
}

/// Reads every vertex of `element`.
pub(super) fn read(
    element: &Element,
    payload: &mut impl Payload,
    mesh: &mut Mesh,
    memory: &mut Charge,
    cx: &LoadCx,
) -> Result<(), Reason> {
    element.check_count("vertices")?;
    let layout = Layout::of(element)?;
    memory.grow(element.count as u64 * layout.bytes())?;
    if let Some(records) = payload.little_endian().and_then(|bytes| Records::of_scalars(element, bytes)) {
        layout.read_records(element, &records, mesh, cx)?;
        let read = records.bytes.len();
        payload.pass(read);
        return Ok(());
    }
    for i in 0..element.count {
        payload.begin(element, i)?;
        let (mut position, mut normal, mut uv, mut color) = (Vec3::ZERO, Vec3::ZERO, Vec2::ZERO, [0.0, 0.0, 0.0, 1.0]);
        for (field, meaning) in element.fields.iter().zip(&layout.meanings) {
            let (Shape::One(kind), Some(meaning)) = (&field.shape, meaning) else {
                payload.skip(field)?;
                continue;
            };
            let value = num::narrow(payload.scalar(kind)?);
            match *meaning {
                Meaning::Position(axis) => position[axis] = value,
                Meaning::Normal(axis) => normal[axis] = value,
                Meaning::Uv(axis) => uv[axis] = value,
                Meaning::Color(channel, scale) => color[channel] = value * scale,
            }
        }
        mesh.positions.push(position);
        layout.normals.then(|| mesh.normals.push(normal));
        layout.uvs.then(|| mesh.uvs.push(uv));
        layout.colors.then(|| mesh.colors.push(linear(color)));
    }
    Ok(())
}

fn linear([red, green, blue, alpha]: [f32; 4]) -> [f32; 4] {
    let [r, g, b] = linear_from_srgb([red, green, blue]);
    [r, g, b, unit(alpha)]
}

/// By the names that the usual programs write. Colours of whole numbers fill their range, as a
/// `uchar` does; those of floats are 0 to 1.
fn meaning(name: &str, shape: &Shape) -> Option<Meaning> {
    let Shape::One(kind) = shape else { return None };
    let scale = match kind {
        ScalarType::Float | ScalarType::Double => 1.0,
        ScalarType::UShort => 1.0 / 65535.0,
        _ => 1.0 / 255.0,
    };
    Some(match name {
        "x" => Meaning::Position(0),
        "y" => Meaning::Position(1),
        "z" => Meaning::Position(2),
        "nx" => Meaning::Normal(0),
        "ny" => Meaning::Normal(1),
        "nz" => Meaning::Normal(2),
        "s" | "u" | "texture_u" | "texture_s" => Meaning::Uv(0),
        "t" | "v" | "texture_v" | "texture_t" => Meaning::Uv(1),
        "red" | "r" | "diffuse_red" => Meaning::Color(0, scale),
        "green" | "g" | "diffuse_green" => Meaning::Color(1, scale),
        "blue" | "b" | "diffuse_blue" => Meaning::Color(2, scale),
        "alpha" | "a" => Meaning::Color(3, scale),
        _ => return None,
    })
}
