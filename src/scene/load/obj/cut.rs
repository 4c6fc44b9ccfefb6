//! Cuts a text into pieces at line ends, so that they can be read side by side.

use crate::scene::load::text::MAX_LINE;
use crate::scene::{LoadCx, Reason};

/// Longer than any statement that is read: at most a mebibyte of joined lines, which may take three
/// bytes of text (`\`, carriage return, line feed) for each byte that is left of them, and a line.
const MAX_STATEMENT: usize = 5 * MAX_LINE;

/// Pieces of `size` bytes and what is left of the last statement in them. One that is cut off
/// within a statement, because it is too long, holds the error.
pub(super) fn cut<'a>(text: &'a [u8], size: usize, cx: &LoadCx) -> Result<Vec<&'a [u8]>, Reason> {
    let (mut pieces, mut rest) = (Vec::new(), text);
    while !rest.is_empty() {
        cx.cancel.check()?;
        let (piece, more) = rest.split_at(end(rest, size));
        pieces.push(piece);
        rest = more;
    }
    Ok(pieces)
}

/// Where the first statement ends that goes on to `size` or past it.
fn end(text: &[u8], size: usize) -> usize {
    let reach = text.len().min(size.saturating_add(MAX_STATEMENT));
    let mut at = size.min(reach);
    while let Some(found) = text[at..reach].iter().position(|b| matches!(b, b'\n' | b'\r')) {
        let here = at + found;
        let (line, ends) = text.split_at(here);
        // Both bytes of "\r\n" stay together, whichever of them was found.
        let line = line.strip_suffix(b"\r").filter(|_| ends[0] == b'\n').unwrap_or(line);
        at = here + if ends.starts_with(b"\r\n") { 2 } else { 1 };
        if !line.ends_with(b"\\") {
            return at;
        }
        if at >= reach {
            break;
        }
    }
    reach
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pieces_end_where_statements_end() {
        let cx = LoadCx::unattended();
        let text = b"a\r\nb\\\r\nc\n\rd\\\n\\\ne\r";
        for size in 0..text.len() + 1 {
            let pieces = cut(text, size, &cx).expect("not cancelled");
            assert_eq!(pieces.concat(), text);
            let whole: [&[u8]; 5] = [b"a\r\n", b"b\\\r\nc\n", b"\r", b"d\\\n\\\ne\r", b""];
            let bounds: Vec<_> = (0..5).map(|n| whole[..n].concat().len()).collect();
            let mut at = 0;
            for piece in pieces {
                at += piece.len();
                assert!(bounds.contains(&at), "{size}: {at}");
            }
        }
        assert_eq!(cut(&[b'x'; 6 << 20], 1, &cx).expect("not cancelled").len(), 2);
    }
}
