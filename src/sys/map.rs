//! Files as memory: the bytes of a large file, without a copy of it.
//!
//! Reading ten million triangles (240 MB) into a list takes 0.33 s, nearly all of it for the pages of the
//! list; reading with two threads into large pages takes 0.1 s; looking at every byte of a map takes
//! 0.02 s, and no memory that the system could not take back (two cores, the file in the page cache).
//!
//! The price: while a file is mapped, it is the file. Who writes to it changes the bytes under us, and if it
//! is cut short, or its disk fails, then touching what is gone ends the program (`SIGBUS`); no system that
//! we run on can keep others from it, but for Windows, which does. So small files, which are edited most,
//! are not worth it, and a map is to be dropped as soon as it was read. Readers look at what they copied
//! out of a map, never twice at the map, where a wrong value would do harm.
#![expect(unsafe_code)]

use std::fs::File;
use std::io;
use std::ops::Deref;

/// A mapped file.
#[derive(Debug)]
pub struct Map(memmap2::Mmap);

impl Map {
    /// Maps the whole of an ordinary file, to be read mostly from its beginning to its end.
    ///
    /// # Errors
    /// What the system says: not every file can be mapped, nor an empty one on every system.
    pub fn of(file: &File) -> io::Result<Self> {
        // SAFETY: the map is only read, is as long as the file is now, and lives as long as `self`. That nobody
        // changes the file meanwhile cannot be made sure of: see above. No reader takes an index or a length
        // on trust because it saw it before, so changed bytes give a wrong model and no wrong access.
        let map = unsafe { memmap2::Mmap::map(file) }?;
        #[cfg(unix)]
        let _ = map.advise(memmap2::Advice::Sequential); // a hint: without it, it is only slower
        Ok(Self(map))
    }
}

impl Deref for Map {
    type Target = [u8];

    fn deref(&self) -> &[u8] {
        &self.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_map_is_the_file() {
        let bytes: Vec<u8> = (0..100_000u32).flat_map(u32::to_le_bytes).collect();
        let mut file = tempfile::tempfile().expect("a file");
        io::Write::write_all(&mut file, &bytes).expect("written");
        assert!(*Map::of(&file).expect("mapped") == bytes);
    }
}
