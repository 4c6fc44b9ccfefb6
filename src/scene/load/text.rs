//! Lines, words and numbers of text formats, over bytes that need not be UTF-8.

use super::pace::Pace;
use super::{LoadCx, Reason};
use crate::task::Cancelled;

/// No sane line is longer; a file without line ends must not keep the cancel flag waiting.
pub(super) const MAX_LINE: usize = 1 << 20;

/// The lines of a text, ended by `\n`, `\r\n` or `\r`, with progress and cancelling.
pub(super) struct Lines<'a> {
    rest: &'a [u8],
    number: usize,
    pace: Pace<'a>,
}

/// One line, without its end.
#[derive(Clone, Copy)]
pub(super) struct Line<'a> {
    /// Counted from 1.
    pub number: usize,
    pub bytes: &'a [u8],
}

impl<'a> Lines<'a> {
    /// The lines of `text`, of which the first is number `first`.
    pub fn new(text: &'a [u8], first: usize, cx: &'a LoadCx) -> Self {
        Self::within(without_mark(text), first, cx)
    }

    /// The lines of a part of a text, which has no byte order mark.
    pub fn within(part: &'a [u8], first: usize, cx: &'a LoadCx) -> Self {
        Self { rest: part, number: first - 1, pace: Pace::new(cx) }
    }

    /// What is still to be read.
    pub fn rest(&self) -> &'a [u8] {
        self.rest
    }

    /// The number of the last line that was read.
    pub fn number(&self) -> usize {
        self.number
    }

    /// Passes over a line of `length` bytes with its end, shorter than [`MAX_LINE`], which the
    /// caller has read in [`Self::rest`].
    #[inline]
    pub fn pass(&mut self, length: usize) -> Result<(), Cancelled> {
        self.number += 1;
        self.rest = &self.rest[length..];
        self.pace.step(length)
    }

    /// The next line, or `None` at the end.
    pub fn next(&mut self) -> Result<Option<Line<'a>>, Reason> {
        if self.rest.is_empty() {
            return Ok(None);
        }
        self.number += 1;
        let reach = self.rest.len().min(MAX_LINE);
        let end = self.rest[..reach].iter().position(|b| matches!(b, b'\n' | b'\r')).unwrap_or(reach);
        if end == MAX_LINE {
            return Err(Reason::malformed(format_args!("line {}", self.number), "it is longer than a mebibyte"));
        }
        let (bytes, ends) = self.rest.split_at(end);
        let skip = if ends.starts_with(b"\r\n") { 2 } else { ends.len().min(1) };
        self.rest = &ends[skip..];
        self.pace.step(end + skip)?;
        Ok(Some(Line { number: self.number, bytes }))
    }
}

impl<'a> Line<'a> {
    pub fn words(&self) -> impl Iterator<Item = &'a [u8]> + use<'a> {
        words(self.bytes)
    }

    /// What follows the first word: a name, which may have spaces in it.
    pub fn tail(&self) -> &'a [u8] {
        let line = self.bytes.trim_ascii();
        let end = line.iter().position(u8::is_ascii_whitespace).unwrap_or(line.len());
        line[end..].trim_ascii()
    }

    /// What is wrong in this line.
    pub fn error(&self, what: impl std::fmt::Display) -> Reason {
        Reason::malformed(format_args!("line {}", self.number), what)
    }
}

/// A text without the byte order mark that may lead it.
pub(super) fn without_mark(text: &[u8]) -> &[u8] {
    text.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(text)
}

/// The words of `bytes`, parted by blanks.
pub(super) fn words(bytes: &[u8]) -> impl Iterator<Item = &[u8]> + use<'_> {
    bytes.split(u8::is_ascii_whitespace).filter(|word| !word.is_empty())
}

/// Bytes as text, with a mark for what is not UTF-8.
pub(super) fn lossy(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

/// A word as it may stand in a message.
pub(super) fn shown(word: &[u8]) -> String {
    format!("'{}'", clipped(word))
}

/// Text for a message, shortened where it is long.
pub(super) fn clipped(text: &[u8]) -> String {
    const MOST: usize = 60;
    let more = if text.len() > MOST { "…" } else { "" };
    format!("{}{more}", lossy(&text[..text.len().min(MOST)]))
}

/// A number as text, `nan` and `inf` among them.
pub(super) fn number<T: std::str::FromStr>(word: &[u8]) -> Option<T> {
    std::str::from_utf8(word).ok()?.parse().ok()
}

/// A 32-bit float. Besides what Rust reads, what C libraries of old print for NaN and infinity.
pub(super) fn float(word: &[u8]) -> Option<f32> {
    number(word).or_else(|| {
        let word = lossy(word).to_ascii_lowercase();
        let sign = if word.starts_with('-') { -1.0 } else { 1.0 };
        match word.trim_start_matches(['-', '+']) {
            w if w.starts_with("1.#inf") => Some(sign * f32::INFINITY),
            w if w.starts_with("1.#") || w.starts_with("nan(") => Some(f32::NAN),
            _ => None,
        }
    })
}
