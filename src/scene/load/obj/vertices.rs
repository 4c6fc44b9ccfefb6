//! What faces refer to by number: positions with colours, texture coordinates, normals.

use glam::{Vec2, Vec3};

use super::corners::{Counts, MOST};
use super::statements::values;
use crate::scene::load::linear_from_srgb;
use crate::scene::load::text::{Line, float, shown};
use crate::scene::{LoadCx, Reason};
use crate::sys::list_in_large_pages;
use crate::task::{Cancelled, Charge};

#[derive(Default)]
pub(super) struct Vertices {
    pub positions: Vec<Vec3>,
    /// Empty, or as long as the positions.
    pub colors: Vec<[f32; 4]>,
    pub uvs: Vec<Vec2>,
    pub normals: Vec<Vec3>,
}

const WHITE: [f32; 4] = [1.0; 4];

impl Vertices {
    /// Reads the statement if it is one of ours.
    pub fn statement(&mut self, word: &[u8], line: &Line) -> Result<(), Reason> {
        match word {
            b"v" => self.position(line)?,
            b"vt" => {
                // The second coordinate may be left out.
                let [u, v] = floats::<2>(line, 1)?;
                self.uvs.push(Vec2::new(u, v));
            }
            b"vn" => self.normals.push(Vec3::from_array(floats::<3>(line, 3)?)),
            _ => {}
        }
        Ok(())
    }

    /// `x y z`, `x y z w` or `x y z r g b`. The weight w is for curves and does not scale. Colours
    /// are no part of the format; programs write them as they show them, which is sRGB.
    fn position(&mut self, line: &Line) -> Result<(), Reason> {
        let position = Vec3::from_array(floats::<3>(line, 3)?);
        let color = values(line).nth(5).map(|_| floats::<6>(line, 6)).transpose()?;
        self.push_position(position, color.map(|[_, _, _, rgb @ ..]| rgb));
        Ok(())
    }

    /// Adds a position, with its sRGB colour if it has one.
    #[inline(always)]
    pub fn push_position(&mut self, position: Vec3, color: Option<[f32; 3]>) {
        if let Some(rgb) = color {
            let [r, g, b] = linear_from_srgb(rgb);
            self.colors.resize(self.positions.len(), WHITE);
            self.colors.push([r, g, b, 1.0]);
        } else if !self.colors.is_empty() {
            self.colors.push(WHITE);
        }
        self.positions.push(position);
    }

    /// How many there are of each.
    #[inline(always)]
    pub fn counts(&self) -> Counts {
        [self.positions.len(), self.uvs.len(), self.normals.len()]
    }

    /// Bytes that the lists hold.
    pub const fn bytes(&self) -> usize {
        let Self { positions, colors, uvs, normals } = self;
        positions.capacity() * 12 + colors.capacity() * 16 + uvs.capacity() * 8 + normals.capacity() * 12
    }

    /// Those of all `parts`, one part behind the other, `counts` together; and the memory that they
    /// are charged.
    pub fn joined(parts: &[Self], counts: Counts, cx: &LoadCx) -> Result<(Self, Charge), Reason> {
        if let Some(many) = counts.into_iter().find(|n| *n > MOST) {
            return Err(Reason::TooLarge(many as u64, "vertices"));
        }
        let colored = parts.iter().any(|part| !part.colors.is_empty());
        let [v, vt, vn] = counts.map(|n| n as u64);
        let memory = cx.budget.charge(v * if colored { 28 } else { 12 } + vt * 8 + vn * 12)?;
        let (colors, (positions, (uvs, normals))) = rayon::join(
            || if colored { colors(parts, counts[0], cx) } else { Ok(Vec::new()) },
            || {
                let positions = || chain(parts.iter().map(|part| &part.positions[..]), counts[0], cx);
                let uvs = || chain(parts.iter().map(|part| &part.uvs[..]), counts[1], cx);
                let normals = || chain(parts.iter().map(|part| &part.normals[..]), counts[2], cx);
                rayon::join(positions, || rayon::join(uvs, normals))
            },
        );
        Ok((Self { positions: positions?, colors: colors?, uvs: uvs?, normals: normals? }, memory))
    }
}

/// As [`chain`], where a part of which no position has a colour is white.
fn colors(parts: &[Vertices], count: usize, cx: &LoadCx) -> Result<Vec<[f32; 4]>, Cancelled> {
    let mut all = list_in_large_pages(count);
    for part in parts {
        cx.cancel.check()?;
        all.extend_from_slice(&part.colors);
        all.resize(all.len() + part.positions.len() - part.colors.len(), WHITE);
    }
    Ok(all)
}

fn chain<'a, T: Copy + 'a>(parts: impl Iterator<Item = &'a [T]>, count: usize, cx: &LoadCx) -> Result<Vec<T>, Cancelled> {
    let mut all = list_in_large_pages(count);
    for part in parts {
        cx.cancel.check()?;
        all.extend_from_slice(part);
    }
    Ok(all)
}

/// The first `N` values of a line, of which at least `least` are there; 0 for the others.
fn floats<const N: usize>(line: &Line, least: usize) -> Result<[f32; N], Reason> {
    let mut floats = [0.0; N];
    let mut found = 0;
    for (to, word) in floats.iter_mut().zip(values(line)) {
        *to = float(word).ok_or_else(|| line.error(format_args!("{} is no number", shown(word))))?;
        found += 1;
    }
    if found < least { Err(line.error(format_args!("it has {found} numbers, not {least}"))) } else { Ok(floats) }
}
