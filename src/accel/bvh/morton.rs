//! Triangles in the order of the Morton curve through their centres (Lauterbach et al. 2009, §3.1).

use super::boxes::{Bounds, PrimBox, in_chunks};
use crate::accel::{BuildCx, BuildError};
use crate::geometry::num;
use crate::task::sort;

/// A triangle's code, and its index.
pub type Coded = (u64, u32);

/// Triangles from which on an axis has 21 bits rather than 10: with fewer, too many centres of a
/// large scene fall into one cell of the curve.
const LARGE: usize = 1 << 18;

/// Codes and indices in ascending order; equal codes by index.
pub fn sorted(boxes: &[PrimBox], cx: &BuildCx) -> Result<Vec<Coded>, BuildError> {
    let centres = boxes.iter().fold(Bounds::EMPTY, |b, p| b.with(p.centre_twice()));
    let bits = if boxes.len() < LARGE { 10 } else { 21 };
    let cells = (1u32 << bits) as f32 * (1.0 - 2.0 * f32::EPSILON);
    let size = centres.size();
    // One scale for all axes: cells of the curve are cubes, or flat scenes would be cut finely across.
    let scale = cells / size.x.max(size.y).max(size.z);
    let scale = if scale.is_finite() { scale } else { 0.0 };
    let code = |i: usize| {
        let at = (boxes[i].centre_twice() - centres.min()) * scale;
        (interleave(cell(at.x), cell(at.y), cell(at.z)), num::index(i))
    };
    if bits == 21 {
        let mut codes = in_chunks(boxes.len(), cx, code)?;
        cx.pool.run(|| sort::by_value(&mut codes, &cx.cancel))?;
        return Ok(codes);
    }
    let pack = |(code, index): Coded| code << 32 | u64::from(index);
    let mut codes = in_chunks(boxes.len(), cx, |i| pack(code(i)))?;
    cx.pool.run(|| sort::by_value(&mut codes, &cx.cancel))?;
    Ok(codes.into_iter().map(|packed| (packed >> 32, (packed & 0xFFFF_FFFF) as u32)).collect())
}

#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "`as` saturates")]
const fn cell(x: f32) -> u64 {
    x as u64
}

/// The bits of three numbers below 2^21 in turn, x highest.
const fn interleave(x: u64, y: u64, z: u64) -> u64 {
    spread(x) << 2 | spread(y) << 1 | spread(z)
}

/// Two zeros between neighbouring bits.
const fn spread(x: u64) -> u64 {
    let x = x & 0x1F_FFFF;
    let x = (x | x << 32) & 0x1F_0000_0000_FFFF;
    let x = (x | x << 16) & 0x1F_0000_FF00_00FF;
    let x = (x | x << 8) & 0x100F_00F0_0F00_F00F;
    let x = (x | x << 4) & 0x10C3_0C30_C30C_30C3;
    (x | x << 2) & 0x1249_2492_4924_9249
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bits_take_turns() {
        assert_eq!(interleave(1, 0, 0), 0b100);
        assert_eq!(interleave(0b11, 0b01, 0b10), 0b101_110);
        assert_eq!(interleave(0x1F_FFFF, 0x1F_FFFF, 0x1F_FFFF), (1 << 63) - 1);
    }
}
