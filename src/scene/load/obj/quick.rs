//! Reads the statements that files are full of (`v`, `vt`, `vn`, `f`) in one go over their bytes,
//! where they are written as usual. The result is what the long way gives, or none: then the line
//! goes the long way.

use super::corners::{Layout, kept};
use super::numbers::{byte, float, integer};
use super::piece::Piece;
use crate::geometry::num;
use crate::scene::load::text::MAX_LINE;
use glam::{Vec2, Vec3};

impl Piece {
    /// Reads the line that `rest` begins with and returns its length with its end, or leaves
    /// everything as it is.
    #[inline]
    pub(super) fn quick(&mut self, rest: &[u8]) -> Option<usize> {
        let length = match rest {
            [b'v', b' ', ..] => self.quick_position(rest),
            [b'v', b'n', b' ', ..] => {
                let (normal, _, end) = floats::<3>(rest, 3, 3)?;
                self.vertices.normals.push(Vec3::from_array(normal));
                Some(end)
            }
            [b'v', b't', b' ', ..] => {
                let ([u, v], _, end) = floats::<2>(rest, 3, 1)?;
                self.vertices.uvs.push(Vec2::new(u, v));
                Some(end)
            }
            [b'f', b' ', ..] => self.quick_face(rest),
            _ => None,
        };
        length.map(|n| n.min(rest.len()))
    }

    fn quick_position(&mut self, rest: &[u8]) -> Option<usize> {
        let ([x, y, z, rgb @ ..], found, end) = floats::<6>(rest, 2, 3)?;
        self.vertices.push_position(Vec3::new(x, y, z), (found == 6).then_some(rgb));
        Some(end)
    }

    fn quick_face(&mut self, rest: &[u8]) -> Option<usize> {
        let before = self.indices.len();
        let face = self.quick_corners(rest);
        match face {
            Some((layout, corners, end)) => {
                self.push_faces(layout, corners);
                Some(end)
            }
            None => {
                self.indices.truncate(before);
                None
            }
        }
    }

    /// The layout and the number of the corners, all of one layout, and where the line ends.
    #[inline(always)]
    fn quick_corners(&mut self, rest: &[u8]) -> Option<(Layout, u32, usize)> {
        let seen = self.vertices.counts();
        let mut at = blanks(rest, 2);
        let (mut layout, mut corners) = (None, 0);
        loop {
            let (indices, of, end) = corner(rest, at)?;
            let keep = |part: usize| kept(indices[part], seen[part], self.length);
            match of {
                Layout::Position => self.indices.push(keep(0)),
                Layout::Uv => self.indices.extend([keep(0), keep(1)]),
                Layout::Normal => self.indices.extend([keep(0), keep(2)]),
                Layout::Both => self.indices.extend([keep(0), keep(1), keep(2)]),
            }
            corners += 1;
            if *layout.get_or_insert(of) != of {
                return None;
            }
            at = blanks(rest, end);
            if ends_line(byte(rest, at)) {
                return Some((of, num::index(corners), after(rest, at)?));
            }
        }
    }
}

/// A corner, which a blank or the end of the line must follow, and where it ends.
#[inline(always)]
fn corner(text: &[u8], at: usize) -> Option<([i64; 3], Layout, usize)> {
    let (v, end) = integer(text, at)?;
    let (indices, layout, end) = match (byte(text, end), byte(text, end + 1)) {
        (b'/', b'/') => {
            let (vn, end) = integer(text, end + 2)?;
            ([v, 0, vn], Layout::Normal, end)
        }
        (b'/', _) => {
            let (vt, end) = integer(text, end + 1)?;
            if byte(text, end) == b'/' {
                let (vn, end) = integer(text, end + 1)?;
                ([v, vt, vn], Layout::Both, end)
            } else {
                ([v, vt, 0], Layout::Uv, end)
            }
        }
        _ => ([v, 0, 0], Layout::Position, end),
    };
    byte(text, end).is_ascii_whitespace().then_some((indices, layout, end))
}

/// The first `N` values from `at` on, of which at least `least` are there, how many are, and where
/// the line ends.
#[inline(always)]
fn floats<const N: usize>(text: &[u8], at: usize, least: usize) -> Option<([f32; N], usize, usize)> {
    let mut values = [0.0; N];
    let (found, end) = fill(&mut values, text, at)?;
    (found >= least).then_some((values, found, end))
}

/// Once for lists of any length: it is long, and a processor keeps only so much code at hand.
#[inline(never)]
fn fill(values: &mut [f32], text: &[u8], mut at: usize) -> Option<(usize, usize)> {
    for (found, value) in values.iter_mut().enumerate() {
        at = blanks(text, at);
        if ends_line(byte(text, at)) {
            return Some((found, after(text, at)?));
        }
        (*value, at) = float(text, at)?;
    }
    let more = text.get(at..)?;
    at += more.iter().position(|b| ends_line(*b)).unwrap_or(more.len());
    // A backslash there joins the next line.
    let end = after(text, at).filter(|_| byte(text, at - 1) != b'\\')?;
    Some((values.len(), end))
}

/// The first byte from `at` on that does not part words.
#[inline(always)]
fn blanks(text: &[u8], mut at: usize) -> usize {
    while matches!(byte(text, at), b' ' | b'\t') {
        at += 1;
    }
    at
}

const fn ends_line(byte: u8) -> bool {
    matches!(byte, b'\n' | b'\r')
}

/// Where the line begins that follows the line end at `at`. None if this line is so long that it
/// may have to be refused.
#[inline(always)]
fn after(text: &[u8], at: usize) -> Option<usize> {
    let both = byte(text, at) == b'\r' && text.get(at + 1) == Some(&b'\n');
    (at < MAX_LINE).then_some(at + 1 + usize::from(both))
}
