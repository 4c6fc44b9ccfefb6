//! Where the bytes of a buffer or an image are: in the URI itself, or in a file that it names.

use base64::Engine;
use base64::alphabet::STANDARD;
use base64::engine::{DecodePaddingMode, GeneralPurpose, GeneralPurposeConfig};

use crate::scene::load::pace::Pace;
use crate::scene::{LoadCx, Reason};

/// The bytes of a `data:` URI (RFC 2397), or `None` for any other.
pub(super) fn data(uri: &str, place: &str, cx: &LoadCx) -> Result<Option<Vec<u8>>, Reason> {
    if !is_data(uri) {
        return Ok(None);
    }
    let bad = |what: &str| Reason::malformed(place, what);
    let (kind, data) = uri[5..].split_once(',').ok_or_else(|| bad("its data URI has no comma"))?;
    if kind.to_ascii_lowercase().ends_with(";base64") { base64(data, place, cx).map(Some) } else { Ok(Some(unescape(data))) }
}

/// Whether the bytes are in the URI itself.
pub(super) fn is_data(uri: &str) -> bool {
    uri.get(..5).unwrap_or_default().eq_ignore_ascii_case("data:")
}

/// The name of the file that a URI means.
pub(super) fn file_name(uri: &str) -> String {
    String::from_utf8(unescape(uri)).unwrap_or_else(|_| uri.to_owned())
}

/// Decodes piece by piece, so that a long one can be stopped.
fn base64(data: &str, place: &str, cx: &LoadCx) -> Result<Vec<u8>, Reason> {
    const PIECE: usize = 1 << 16; // a multiple of 4 characters, which are 3 bytes
    let lenient = GeneralPurposeConfig::new()
        .with_decode_padding_mode(DecodePaddingMode::Indifferent)
        .with_decode_allow_trailing_bits(true);
    let engine = GeneralPurpose::new(&STANDARD, lenient);
    let _memory = cx.budget.charge(data.len() as u64 / 4 * 3)?;
    let mut pace = Pace::new(cx);
    let mut bytes = Vec::new();
    for (i, piece) in data.as_bytes().chunks(PIECE).enumerate() {
        pace.step(piece.len())?;
        engine.decode_vec(piece, &mut bytes).map_err(|error| {
            Reason::malformed(place, format_args!("its base64 data is wrong after character {}: {error}", i * PIECE))
        })?;
    }
    Ok(bytes)
}

/// Takes `%20` and the like for the bytes that they stand for (RFC 3986, section 2.1).
fn unescape(text: &str) -> Vec<u8> {
    let bytes = text.as_bytes();
    let digit = |i: usize| bytes.get(i).and_then(|b| char::from(*b).to_digit(16)).and_then(|d| u8::try_from(d).ok());
    let mut out = Vec::with_capacity(bytes.len());
    let mut i = 0;
    while i < bytes.len() {
        match (bytes[i], digit(i + 1), digit(i + 2)) {
            (b'%', Some(high), Some(low)) => {
                out.push(high * 16 + low);
                i += 3;
            }
            (byte, ..) => {
                out.push(byte);
                i += 1;
            }
        }
    }
    out
}
