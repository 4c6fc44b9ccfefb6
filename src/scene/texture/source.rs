//! Where the bytes of an image are.

use std::path::PathBuf;
use std::sync::Arc;

/// An image of a model, not yet decoded.
#[derive(Clone, Debug)]
pub struct Image {
    /// What messages call it.
    pub name: String,
    /// Its bytes, in the format that it is stored in.
    pub source: ImageSource,
}

impl Image {
    /// One white texel.
    pub(in crate::scene) fn white() -> Self {
        /// A Windows bitmap: header of the file, header of the picture, one texel of 24 bits.
        const BMP: [u8; 58] = [
            b'B', b'M', 58, 0, 0, 0, 0, 0, 0, 0, 54, 0, 0, 0, 40, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 24, 0, 0, 0, 0, 0, 4, 0,
            0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 255, 255, 255, 0,
        ];
        Self { name: "white".to_owned(), source: ImageSource::Bytes(Arc::from(BMP)) }
    }

    /// Bytes of it that are held in memory as they are stored.
    pub(in crate::scene) fn bytes(&self) -> u64 {
        match &self.source {
            ImageSource::File(_) => 0,
            ImageSource::Bytes(bytes) => bytes.len() as u64,
        }
    }
}

/// Where the bytes of an image are.
#[derive(Clone, Debug)]
pub enum ImageSource {
    /// In a file beside the model, read when the image is decoded.
    File(PathBuf),
    /// In the model's own file, of which this is a copy.
    Bytes(Arc<[u8]>),
}
