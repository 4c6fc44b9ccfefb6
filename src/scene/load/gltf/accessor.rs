//! Accessors: lists of numbers or vectors in a buffer view. They are measured against the view
//! once, when they are opened; reading an element needs no check after that.

use gltf::json::accessor::{ComponentType, IndexComponentType, sparse};
use gltf::json::validation::Checked;
use gltf::json::{Accessor as Json, Index, Root};

use super::buffers::{Buffers, View};
use crate::geometry::num;
use crate::scene::Reason;

pub(super) struct Accessor<'a> {
    pub count: usize,
    /// Components of an element.
    pub width: usize,
    pub kind: ComponentType,
    normalized: bool,
    base: Option<Elements<'a>>,
    /// Elements that replace those of the base: where, ascending, and by what.
    replaced: Option<(Vec<u32>, Elements<'a>)>,
}

/// `count` elements of some size at a stride, all of them within `bytes`.
#[derive(Clone, Copy)]
struct Elements<'a> {
    bytes: &'a [u8],
    stride: usize,
}

/// A sparse accessor without a base is zeros, which no bytes back: more than this is refused.
const MAX_ZEROS: u64 = 1 << 22;

/// Whether an accessor refers to any data, rather than being zeros or filled by an extension.
pub(super) fn has_data(root: &Root, index: Index<Json>) -> bool {
    root.get(index).is_some_and(|json| json.buffer_view.is_some() || json.sparse.is_some())
}

impl<'a> Accessor<'a> {
    /// Opens an accessor; `place` says who asks.
    pub fn open(root: &Root, buffers: &'a Buffers, index: Index<Json>, place: &str) -> Result<Self, Reason> {
        let place = format!("{place}, accessor {}", index.value());
        let bad = |what: &str| Reason::malformed(&place, what);
        let json = root.get(index).ok_or_else(|| bad("there is no such accessor"))?;
        let (Checked::Valid(component), Checked::Valid(shape)) = (&json.component_type, &json.type_) else {
            return Err(bad("its type is not known"));
        };
        let (kind, width) = (component.0, shape.multiplicity());
        let size = kind.size() * width;
        let Ok(count) = usize::try_from(json.count.0) else { return Err(bad("its count is too large")) };
        if count > num::MAX_INDEX {
            return Err(Reason::TooLarge(json.count.0, "elements in an accessor"));
        }
        let base = match json.buffer_view {
            Some(view) => Some(Elements::open(buffers.view(view)?, json.byte_offset.map_or(0, |o| o.0), size, count, &place)?),
            None if json.sparse.is_none() => return Err(bad("it has no data")),
            None if json.count.0 > MAX_ZEROS => return Err(bad("it claims more zeros than are sensible")),
            None => None,
        };
        let replaced = json.sparse.as_ref().map(|sparse| replacements(sparse, buffers, size, count, &place)).transpose()?;
        Ok(Self { count, width, kind, normalized: json.normalized, base, replaced })
    }

    /// The element `i` as floats, normalised where the accessor says so; what it does not have
    /// stays as in `or`.
    #[inline]
    pub fn vector<const N: usize>(&self, i: usize, or: [f32; N]) -> [f32; N] {
        if let Some(floats) = self.floats::<N>(i) {
            return floats;
        }
        let mut vector = or;
        let bytes = self.element(i);
        for (c, x) in vector.iter_mut().enumerate().take(self.width) {
            *x = bytes.map_or(0.0, |bytes| self.component(bytes, c));
        }
        vector
    }

    /// The usual case on a road of its own: floats, as many as are wanted, none of them replaced.
    #[inline(always)]
    fn floats<const N: usize>(&self, i: usize) -> Option<[f32; N]> {
        if self.width != N || self.kind != ComponentType::F32 || self.replaced.is_some() {
            return None;
        }
        let (components, _) = self.base?.get(i).as_chunks();
        components.first_chunk::<N>().map(|floats| floats.map(f32::from_le_bytes))
    }

    /// The element `i` as an index. The accessor is one of unsigned scalars.
    #[inline]
    pub fn index(&self, i: usize) -> u32 {
        self.element(i).map_or(0, |bytes| unsigned(bytes, self.kind))
    }

    #[inline]
    fn element(&self, i: usize) -> Option<&'a [u8]> {
        if let Some((at, elements)) = &self.replaced
            && let Ok(k) = at.binary_search(&num::index(i))
        {
            return Some(elements.get(k));
        }
        self.base.map(|base| base.get(i))
    }

    /// A component as a float (glTF 2.0, section 3.6.2.2 and the table of normalised integers).
    #[inline]
    fn component(&self, element: &[u8], c: usize) -> f32 {
        let at = &element[c * self.kind.size()..];
        let (value, full) = match self.kind {
            ComponentType::F32 => return f32::from_le_bytes(chunk(at)),
            ComponentType::I8 => (f64::from(i8::from_le_bytes(chunk(at))), f64::from(i8::MAX)),
            ComponentType::I16 => (f64::from(i16::from_le_bytes(chunk(at))), f64::from(i16::MAX)),
            ComponentType::U8 => (f64::from(u8::from_le_bytes(chunk(at))), f64::from(u8::MAX)),
            ComponentType::U16 => (f64::from(u16::from_le_bytes(chunk(at))), f64::from(u16::MAX)),
            ComponentType::U32 => (f64::from(u32::from_le_bytes(chunk(at))), f64::from(u32::MAX)),
        };
        num::narrow(if self.normalized { (value / full).max(-1.0) } else { value })
    }
}

impl<'a> Elements<'a> {
    fn open(view: View<'a>, offset: u64, size: usize, count: usize, place: &str) -> Result<Self, Reason> {
        let stride = view.stride.unwrap_or(size);
        let needed = (count as u64).saturating_sub(1).saturating_mul(stride as u64).saturating_add(size as u64);
        let needed = if count == 0 { 0 } else { needed };
        let end = offset.saturating_add(needed);
        let bytes = usize::try_from(offset).ok().and_then(|from| view.bytes.get(from..));
        match bytes {
            Some(bytes) if end <= view.bytes.len() as u64 => Ok(Self { bytes, stride }),
            _ => Err(Reason::malformed(
                place,
                format_args!("its {count} elements end at byte {end} of a bufferView of {}", view.bytes.len()),
            )),
        }
    }

    #[inline]
    fn get(&self, i: usize) -> &'a [u8] {
        &self.bytes[i * self.stride..]
    }
}

/// The replacements of a sparse accessor of `count` elements.
fn replacements<'a>(
    sparse: &sparse::Sparse,
    buffers: &'a Buffers,
    size: usize,
    count: usize,
    place: &str,
) -> Result<(Vec<u32>, Elements<'a>), Reason> {
    let bad = |what: String| Reason::malformed(place, what);
    let n = usize::try_from(sparse.count.0).ok().filter(|n| *n <= count);
    let n = n.ok_or_else(|| bad(format!("it replaces {} of {count} elements", sparse.count.0)))?;
    let Checked::Valid(IndexComponentType(kind)) = sparse.indices.component_type else {
        return Err(bad("the type of its sparse indices is not known".to_owned()));
    };
    let indices = buffers.view(sparse.indices.buffer_view)?;
    let indices = Elements::open(indices, sparse.indices.byte_offset.0, kind.size(), n, place)?;
    let values = buffers.view(sparse.values.buffer_view)?;
    let values = Elements::open(values, sparse.values.byte_offset.0, size, n, place)?;
    let at: Vec<u32> = (0..n).map(|i| unsigned(indices.get(i), kind)).collect();
    let ascending = at.windows(2).all(|pair| pair[0] < pair[1]);
    if !ascending || at.last().is_some_and(|last| *last as usize >= count) {
        return Err(bad(format!("its sparse indices do not ascend below {count}")));
    }
    Ok((at, values))
}

#[inline]
fn unsigned(bytes: &[u8], kind: ComponentType) -> u32 {
    match kind {
        ComponentType::I8 | ComponentType::U8 => u32::from(u8::from_le_bytes(chunk(bytes))),
        ComponentType::I16 | ComponentType::U16 => u32::from(u16::from_le_bytes(chunk(bytes))),
        ComponentType::U32 | ComponentType::F32 => u32::from_le_bytes(chunk(bytes)),
    }
}

#[inline]
fn chunk<const N: usize>(bytes: &[u8]) -> [u8; N] {
    bytes.first_chunk().copied().unwrap_or([0; N])
}
