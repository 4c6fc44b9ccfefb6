//! GLB: a header of 12 bytes, then chunks, of which the first is the JSON and the next the buffer
//! without a name (glTF 2.0, section 4).

use crate::scene::Reason;

pub(super) struct Parts<'a> {
    pub json: &'a [u8],
    pub bin: Option<&'a [u8]>,
}

/// Tells GLB by its first bytes; anything else must be JSON.
pub(super) fn open(bytes: &[u8]) -> Result<Parts<'_>, Reason> {
    if !bytes.starts_with(b"glTF") {
        let json = bytes.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(bytes); // a byte order mark
        return Ok(Parts { json, bin: None });
    }
    let (Some(version), Some(length)) = (word(bytes, 4), word(bytes, 8)) else {
        return Err(Reason::malformed("GLB header", "the file ends within it: it was cut short"));
    };
    if version != 2 {
        return Err(Reason::malformed("GLB header", format_args!("it is of version {version}, and only 2 is known")));
    }
    let Some(body) = bytes.get(..length).and_then(|all| all.get(12..)) else {
        let what = format!("it declares {length} bytes, but the file has {}: it was cut short", bytes.len());
        return Err(Reason::malformed("GLB header", what));
    };
    let mut parts = Parts { json: b"", bin: None };
    let mut rest = body;
    let mut index = 0;
    while !rest.is_empty() {
        let (kind, chunk, after) = chunk(rest, index)?;
        match (index, kind) {
            (0, b"JSON") => parts.json = chunk,
            (0, _) => return Err(Reason::malformed("GLB chunk 0", "it is not the JSON")),
            (1, b"BIN\0") => parts.bin = Some(chunk),
            _ => {} // for extensions; to be passed over
        }
        rest = after;
        index += 1;
    }
    Ok(parts)
}

type Chunk<'a> = (&'a [u8; 4], &'a [u8], &'a [u8]);

/// The kind of the chunk that `bytes` begin with, its content, and what follows.
fn chunk(bytes: &[u8], index: usize) -> Result<Chunk<'_>, Reason> {
    let cut = |what: String| Reason::malformed(format_args!("GLB chunk {index}"), what);
    let header = word(bytes, 0).zip(bytes.get(4..).and_then(|b| b.first_chunk::<4>()));
    let (length, kind) = header.ok_or_else(|| cut("the file ends within its header".to_owned()))?;
    let content = &bytes[8..];
    if length > content.len() {
        return Err(cut(format!("it declares {length} bytes, but {} are left: the file was cut short", content.len())));
    }
    let (content, rest) = content.split_at(length);
    Ok((kind, content, rest))
}

fn word(bytes: &[u8], at: usize) -> Option<usize> {
    let word = bytes.get(at..)?.first_chunk::<4>()?;
    usize::try_from(u32::from_le_bytes(*word)).ok()
}
