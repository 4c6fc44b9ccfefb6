//! Conversions between number types that say what they do to a value that does not fit.

/// Rounds to the nearest 32-bit float; what is too large becomes infinite.
#[inline(always)]
#[expect(clippy::cast_possible_truncation, reason = "rounding is what this is for")]
pub const fn narrow(x: f64) -> f32 {
    x as f32
}

/// An index as 32 bits. Every list that is indexed by 32 bits is checked against [`MAX_INDEX`]
/// when it is made, so this never saturates in practice.
#[inline(always)]
pub const fn index(i: usize) -> u32 {
    debug_assert!(i <= MAX_INDEX);
    if i > MAX_INDEX { u32::MAX } else { (i & 0xFFFF_FFFF) as u32 }
}

/// The largest index that 32 bits hold, one less than the value that stands for "none".
pub const MAX_INDEX: usize = (u32::MAX - 1) as usize;

/// The integer part of `x` clamped to `0..=max`; NaN becomes 0.
#[inline(always)]
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "`as` saturates and NaN gives 0")]
pub fn floor_index(x: f64, max: usize) -> usize {
    (x as usize).min(max)
}

/// The lesser, in one instruction; the second if one is no number.
#[inline(always)]
pub fn min(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
}

/// The greater, likewise.
#[inline(always)]
pub fn max(a: f32, b: f32) -> f32 {
    if a > b { a } else { b }
}

/// The unit roundoff of 32-bit floats: half the distance from 1 to the next float.
pub const UNIT_ROUNDOFF: f32 = f32::EPSILON / 2.0;

/// The greatest 32-bit float that is not above `x`.
#[inline(always)]
pub fn narrow_down(x: f64) -> f32 {
    let near = narrow(x);
    if f64::from(near) > x { near.next_down() } else { near }
}

/// The least 32-bit float that is not below `x`.
#[inline(always)]
pub fn narrow_up(x: f64) -> f32 {
    let near = narrow(x);
    if f64::from(near) < x { near.next_up() } else { near }
}

/// A 32-bit float that is surely less.
#[inline(always)]
pub const fn round_down(x: f64) -> f32 {
    narrow(x).next_down()
}

/// A 32-bit float that is surely greater.
#[inline(always)]
pub const fn round_up(x: f64) -> f32 {
    narrow(x).next_up()
}
