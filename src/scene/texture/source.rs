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

/// Where the bytes of an image are.
#[derive(Clone, Debug)]
pub enum ImageSource {
    /// In a file beside the model, read when the image is decoded.
    File(PathBuf),
    /// In the model's own file, of which this is a copy.
    Bytes(Arc<[u8]>),
}
