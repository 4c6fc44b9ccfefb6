//! What faces refer to by number: positions with colours, texture coordinates, normals.

use glam::{Vec2, Vec3};

use super::values;
use crate::geometry::num;
use crate::scene::Reason;
use crate::scene::load::linear_from_srgb;
use crate::scene::load::text::{Line, float, shown};

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
            _ => return Ok(()),
        }
        let most = self.positions.len().max(self.uvs.len()).max(self.normals.len());
        if most > num::MAX_INDEX { Err(Reason::TooLarge(most as u64, "vertices")) } else { Ok(()) }
    }

    /// `x y z`, `x y z w` or `x y z r g b`. The weight w is for curves and does not scale. Colours
    /// are no part of the format; programs write them as they show them, which is sRGB.
    fn position(&mut self, line: &Line) -> Result<(), Reason> {
        let [x, y, z] = floats::<3>(line, 3)?;
        self.positions.push(Vec3::new(x, y, z));
        if values(line).nth(5).is_some() {
            let [_, _, _, red, green, blue] = floats::<6>(line, 6)?;
            let [r, g, b] = linear_from_srgb([red, green, blue]);
            self.colors.resize(self.positions.len() - 1, WHITE);
            self.colors.push([r, g, b, 1.0]);
        } else if !self.colors.is_empty() {
            self.colors.push(WHITE);
        }
        Ok(())
    }
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
