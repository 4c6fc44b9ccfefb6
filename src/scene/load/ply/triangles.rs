//! The quick road for faces: binary, and all of them triangles, as most large files are.

use super::faces::list_of;
use super::header::{Element, Field, ScalarType, Shape, size};
use super::payload::Payload;
use super::records::Records;
use crate::scene::load::fill::{self, Stop};
use crate::scene::{LoadCx, Mesh, Reason};

/// Where the indices are in a face.
struct Layout {
    /// Bytes of a face that is a triangle.
    size: usize,
    /// Where its number of corners is, in so many bytes.
    count: (usize, usize),
    /// Where its three indices are.
    indices: usize,
    /// The indices are below this.
    limit: usize,
}

/// Reads the faces, if each is a triangle. If it returns `false` nothing has happened.
pub(super) fn read(
    element: &Element,
    payload: &mut impl Payload,
    vertex_count: usize,
    mesh: &mut Mesh,
    cx: &LoadCx,
) -> Result<bool, Reason> {
    let layout = payload.little_endian().zip(Layout::of(element, vertex_count));
    let records = layout.and_then(|(bytes, layout)| Some((Records::new(bytes, layout.size, element.count)?, layout)));
    let Some((records, layout)) = records.filter(|_| mesh.triangles.is_empty()) else { return Ok(false) };
    let _memory = cx.budget.charge(element.count as u64 * 12)?;
    let triangles = fill::try_list(element.count, layout.size as u64, cx, |start, piece| layout.fill(&records, start, piece));
    let Some(triangles) = Stop::or_slow_road(triangles)? else { return Ok(false) };
    mesh.triangles = triangles;
    let read = records.bytes.len();
    payload.pass(read);
    Ok(true)
}

impl Layout {
    /// `None` where faces of three corners take different numbers of bytes, or a type is unusual.
    fn of(element: &Element, vertex_count: usize) -> Option<Self> {
        let list = list_of(element).filter(|_| element.name == "face")?;
        let Shape::List { count, item } = &element.fields[list].shape else { return None };
        let limit = match item {
            ScalarType::UInt => vertex_count,
            ScalarType::Int => vertex_count.min(1 << 31), // those below zero are above it as they are read here
            _ => return None,
        };
        if matches!(count, ScalarType::Float | ScalarType::Double) {
            return None;
        }
        let scalar = |field: &Field| if let Shape::One(kind) = &field.shape { Some(size(kind)) } else { None };
        let sum = |fields: &[Field]| fields.iter().map(scalar).sum::<Option<usize>>();
        let (before, after) = (sum(&element.fields[..list])?, sum(&element.fields[list + 1..])?);
        let indices = before + size(count);
        Some(Self { size: indices + 12 + after, count: (before, size(count)), indices, limit })
    }

    /// What is read is looked at after it was copied: the file may be written to meanwhile.
    fn fill(&self, records: &Records, start: usize, piece: &mut [[u32; 3]]) -> Result<(), Stop> {
        const THREE: [u8; 4] = [3, 0, 0, 0];
        let (at, bytes) = self.count;
        let mut ok = true;
        for (to, record) in piece.iter_mut().zip(records.from(start)) {
            let (words, _) = record[self.indices..].as_chunks();
            let Some(words) = words.first_chunk::<3>() else { return Err(Stop::Unusual) };
            *to = words.map(u32::from_le_bytes);
            ok &= record[at] == 3 && (bytes == 1 || record[at..].starts_with(&THREE[..bytes]));
            ok &= to.iter().all(|i| (*i as usize) < self.limit);
        }
        if ok { Ok(()) } else { Err(Stop::Unusual) }
    }
}
