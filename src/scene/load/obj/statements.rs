//! The statements of OBJ and MTL files: lines, of which a backslash at the end joins the next.

use crate::scene::load::text::{Line, Lines, MAX_LINE};
use crate::scene::{LoadCx, Reason};
use crate::task::Cancelled;

pub(super) struct Statements<'a> {
    lines: Lines<'a>,
    joined: Vec<u8>,
}

impl<'a> Statements<'a> {
    /// The statements of a part of a text, of which the first line is number `first`.
    pub fn within(part: &'a [u8], first: usize, cx: &'a LoadCx) -> Self {
        Self { lines: Lines::within(part, first, cx), joined: Vec::new() }
    }

    /// The next one, which may be blank or a comment, by the number of its last line.
    pub fn next(&mut self) -> Result<Option<Line<'_>>, Reason> {
        let Some(mut line) = self.lines.next()? else { return Ok(None) };
        self.joined.clear();
        while let Some(begin) = line.bytes.strip_suffix(b"\\") {
            self.joined.extend_from_slice(begin);
            self.joined.push(b' ');
            if self.joined.len() > MAX_LINE {
                return Err(line.error("it is joined to a line longer than a mebibyte"));
            }
            let Some(next) = self.lines.next()? else { break };
            line = next;
        }
        if !self.joined.is_empty() {
            self.joined.extend_from_slice(line.bytes);
            line.bytes = &self.joined;
        }
        Ok(Some(line))
    }

    /// What is still to be read.
    pub fn rest(&self) -> &'a [u8] {
        self.lines.rest()
    }

    /// Passes over a statement of one line, `length` bytes with its end, that the caller has read.
    #[inline]
    pub fn pass(&mut self, length: usize) -> Result<(), Cancelled> {
        self.lines.pass(length)
    }

    /// The number of the last line that was read.
    pub fn number(&self) -> usize {
        self.lines.number()
    }
}

/// The values of a statement: its words without the first, up to a comment.
pub(super) fn values<'a>(line: &Line<'a>) -> impl Iterator<Item = &'a [u8]> + use<'a> {
    line.words().skip(1).take_while(|word| !word.starts_with(b"#"))
}
