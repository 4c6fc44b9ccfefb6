//! The bytes of a file, read or mapped.

use std::ops::Deref;

use crate::sys::Map;

/// The bytes of a file.
#[derive(Debug)]
pub struct Bytes(Kept);

#[derive(Debug)]
enum Kept {
    Held(Vec<u8>),
    Mapped(Map),
}

impl Bytes {
    /// How many of them are in memory of our own.
    pub(super) fn held(&self) -> u64 {
        match &self.0 {
            Kept::Held(bytes) => bytes.len() as u64,
            Kept::Mapped(_) => 0,
        }
    }
}

impl Deref for Bytes {
    type Target = [u8];

    fn deref(&self) -> &[u8] {
        match &self.0 {
            Kept::Held(bytes) => bytes,
            Kept::Mapped(map) => map,
        }
    }
}

impl From<Vec<u8>> for Bytes {
    fn from(bytes: Vec<u8>) -> Self {
        Self(Kept::Held(bytes))
    }
}

impl From<Map> for Bytes {
    fn from(map: Map) -> Self {
        Self(Kept::Mapped(map))
    }
}
