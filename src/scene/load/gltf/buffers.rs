//! The bytes behind buffers and buffer views, fetched when first asked for.

use std::cell::{OnceCell, RefCell};
use std::ops::Deref;

use gltf::json::{Index, Root, buffer};

use super::{extensions, uri};
use crate::scene::load::text::clipped;
use crate::scene::load::{Bytes, Siblings};
use crate::scene::{LoadCx, Reason};
use crate::task::Charge;

pub(super) struct Buffers<'a> {
    root: &'a Root,
    bin: Option<&'a [u8]>,
    files: &'a dyn Siblings,
    cx: &'a LoadCx,
    loaded: Vec<OnceCell<Content<'a>>>,
    memory: RefCell<Charge>,
}

/// The bytes of a buffer.
enum Content<'a> {
    /// In the model's own file.
    OfModel(&'a [u8]),
    /// In its URI, or a file beside the model.
    Own(Bytes),
}

impl Deref for Content<'_> {
    type Target = [u8];

    fn deref(&self) -> &[u8] {
        match self {
            Self::OfModel(bytes) => bytes,
            Self::Own(bytes) => bytes,
        }
    }
}

/// The bytes of a buffer view.
#[derive(Clone, Copy)]
pub(super) struct View<'a> {
    pub bytes: &'a [u8],
    /// Bytes from one element to the next, where the view says it.
    pub stride: Option<usize>,
}

impl<'a> Buffers<'a> {
    pub fn new(root: &'a Root, bin: Option<&'a [u8]>, files: &'a dyn Siblings, cx: &'a LoadCx) -> Result<Self, Reason> {
        let loaded = root.buffers.iter().map(|_| OnceCell::new()).collect();
        Ok(Self { root, bin, files, cx, loaded, memory: RefCell::new(cx.budget.charge(0)?) })
    }

    /// The bytes of a view, which are all there.
    pub fn view(&self, index: Index<buffer::View>) -> Result<View<'_>, Reason> {
        let place = format!("bufferView {}", index.value());
        let view = self.root.get(index).ok_or_else(|| Reason::malformed(&place, "there is no such view"))?;
        let Some(bytes) = self.buffer(view.buffer)? else {
            let compressed = extensions::compression_of_view(view);
            return Err(compressed.map_or_else(
                || Reason::malformed(&place, "its buffer holds no data"),
                |extension| extensions::unsupported(place.clone(), extension),
            ));
        };
        let (start, length) = (view.byte_offset.map_or(0, |o| o.0), view.byte_length.0);
        let range = usize::try_from(start).ok().zip(start.checked_add(length).and_then(|end| usize::try_from(end).ok()));
        let found = range.and_then(|(start, end)| bytes.get(start..end)).ok_or_else(|| {
            let what = format!(
                "it is bytes {start} to {} of {}, which has {}",
                start.saturating_add(length),
                self.name(view.buffer),
                bytes.len()
            );
            Reason::malformed(&place, what)
        })?;
        // A stride of zero is not allowed, but written where "none" is meant.
        let stride = view.byte_stride.map(|stride| stride.0).filter(|stride| *stride > 0);
        Ok(View { bytes: found, stride })
    }

    /// The bytes of a buffer; `None` if it has none, being a place to put what an extension
    /// decompresses.
    fn buffer(&self, index: Index<buffer::Buffer>) -> Result<Option<&[u8]>, Reason> {
        let place = || self.name(index);
        let missing = || Reason::malformed(place(), "there is no such buffer");
        let (buffer, cell) = self.root.get(index).zip(self.loaded.get(index.value())).ok_or_else(missing)?;
        if let Some(bytes) = cell.get() {
            return Ok(Some(bytes));
        }
        let bytes = match (&buffer.uri, self.bin) {
            (Some(uri), _) => Content::Own(self.fetch(uri, &place())?),
            (None, Some(bin)) if index.value() == 0 => Content::OfModel(bin),
            (None, _) => return Ok(None),
        };
        let declared = buffer.byte_length.0;
        if (bytes.len() as u64) < declared {
            let what = format!("it declares {declared} bytes, but has {}: it was cut short", bytes.len());
            return Err(Reason::malformed(place(), what));
        }
        Ok(Some(cell.get_or_init(|| bytes)))
    }

    fn fetch(&self, uri: &str, place: &str) -> Result<Bytes, Reason> {
        let bytes = match uri::data(uri, place, self.cx)? {
            Some(bytes) => bytes.into(),
            None => self.file(uri)?,
        };
        self.memory.borrow_mut().grow(bytes.held())?;
        Ok(bytes)
    }

    /// The name is escaped as an URI, which not every program knows: try it as written, too.
    fn file(&self, uri: &str) -> Result<Bytes, Reason> {
        let name = uri::file_name(uri);
        match self.files.read(&name) {
            Err(Reason::Io { .. }) if name != uri => self.files.read(uri).or_else(|_| self.files.read(&name)),
            read => read,
        }
    }

    /// What a message calls the buffer: with its file, where it has one.
    fn name(&self, index: Index<buffer::Buffer>) -> String {
        let uri = self.root.get(index).and_then(|b| b.uri.as_deref());
        let file = uri.filter(|uri| !uri::is_data(uri));
        let called = file.map_or(String::new(), |file| format!(" ({})", clipped(file.as_bytes())));
        format!("buffer {}{called}", index.value())
    }
}
