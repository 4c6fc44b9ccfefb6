//! The quick road through a binary file: elements that all take the same number of bytes, so that each can
//! be found without those before it, and all threads read them.

use bytemuck::Zeroable;

use super::header::{Element, ScalarType, Shape};
use super::payload::{Binary, Payload};
use crate::geometry::num;
use crate::scene::LoadCx;
use crate::scene::load::fill;
use crate::task::Cancelled;

/// Elements that follow each other, each of `size` bytes.
pub(super) struct Records<'a> {
    pub bytes: &'a [u8],
    pub size: usize,
}

/// A scalar of every record.
#[derive(Clone, Copy)]
pub(super) struct Column<'a> {
    pub offset: usize,
    pub kind: &'a ScalarType,
}

impl<'a> Records<'a> {
    /// The first `count` records of some size; `None` if the bytes do not hold them.
    pub fn new(bytes: &'a [u8], size: usize, count: usize) -> Option<Self> {
        let bytes = bytes.get(..size.checked_mul(count)?)?;
        (size > 0).then_some(Self { bytes, size })
    }

    /// The elements, where none has a list.
    pub fn of_scalars(element: &Element, bytes: &'a [u8]) -> Option<Self> {
        let scalars = element.fields.iter().all(|field| matches!(field.shape, Shape::One(_)));
        scalars.then(|| Self::new(bytes, element.least_bytes(), element.count)).flatten()
    }

    pub fn count(&self) -> usize {
        self.bytes.len() / self.size
    }

    /// The records from the one at `start`.
    pub fn from(&self, start: usize) -> impl Iterator<Item = &'a [u8]> + use<'a> {
        self.bytes[start * self.size..].chunks_exact(self.size)
    }

    /// What `get` makes of each record, which counts as `units` of progress.
    pub fn list<T: Zeroable + Send>(
        &self,
        units: usize,
        cx: &LoadCx,
        get: impl Fn(&[u8]) -> T + Sync,
    ) -> Result<Vec<T>, Cancelled> {
        fill::list(self.count(), units as u64, cx, |start, piece| {
            piece.iter_mut().zip(self.from(start)).for_each(|(to, record)| *to = get(record));
        })
    }
}

impl Column<'_> {
    /// Its value in a record. All but floats are read as on the slow road.
    #[inline(always)]
    pub fn value(&self, record: &[u8], cx: &LoadCx) -> f32 {
        let bytes = record.get(self.offset..).unwrap_or_default();
        match (self.kind, bytes.first_chunk()) {
            (ScalarType::Float, Some(float)) => f32::from_le_bytes(*float),
            _ => num::narrow(Binary::<false>::new(bytes, cx).scalar(self.kind).unwrap_or(f64::NAN)),
        }
    }
}
