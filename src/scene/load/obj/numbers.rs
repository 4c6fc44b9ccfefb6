//! Numbers as nearly every file has them, eight digits at a time. What is written otherwise is left
//! to the standard library.

use crate::geometry::num;
use crate::scene::load::text;

/// The byte at `at`; past the end, the end of a line.
#[inline(always)]
pub(super) fn byte(text: &[u8], at: usize) -> u8 {
    text.get(at).copied().unwrap_or(b'\n')
}

/// The float at `at`, which a blank or the end of the line must follow, and where it ends. It is
/// the very one that the standard library reads.
#[inline]
pub(super) fn float(text: &[u8], at: usize) -> Option<(f32, usize)> {
    decimal(text, at).filter(|(_, end)| byte(text, *end).is_ascii_whitespace()).or_else(|| any_float(text, at))
}

#[cold]
fn any_float(text: &[u8], at: usize) -> Option<(f32, usize)> {
    // A backslash may join the next line, and NaN may have anything behind it.
    let word = text[at..].split(u8::is_ascii_whitespace).next().filter(|word| !word.ends_with(b"\\"))?;
    Some((text::float(word)?, at + word.len()))
}

/// A whole number, which may have a minus before it, and where it ends.
#[inline(always)]
pub(super) fn integer(text: &[u8], at: usize) -> Option<(i64, usize)> {
    let minus = byte(text, at) == b'-';
    let (size, end) = whole(text, at + usize::from(minus))?;
    Some((if minus { -size } else { size }, end))
}

#[inline(always)]
fn whole(text: &[u8], at: usize) -> Option<(i64, usize)> {
    let (size, count) = digits(text, at, 0);
    let size = i64::try_from(size).ok().filter(|_| (1..=MAX_DIGITS).contains(&count))?;
    Some((size, at + count))
}

/// As many digits as 64 bits hold, whichever they are.
const MAX_DIGITS: usize = 19;
/// Up to this power, a power of ten is a 64-bit float to the last bit.
const MAX_POWER: i64 = 22;
/// 10^-22 to 10^22, each the nearest float.
const POWERS: [f64; 45] = {
    let mut powers = [1.0; 45];
    let mut i = 1;
    while i <= 22 {
        powers[22 + i] = powers[21 + i] * 10.0;
        powers[22 - i] = 1.0 / powers[22 + i];
        i += 1;
    }
    powers
};

/// A decimal number, if its nearest 32-bit float is certain.
#[inline(always)]
fn decimal(text: &[u8], at: usize) -> Option<(f32, usize)> {
    let signed = |at: usize| (byte(text, at) == b'-', at + usize::from(matches!(byte(text, at), b'-' | b'+')));
    let (minus, from) = signed(at);
    let (mut mantissa, before) = digits(text, from, 0);
    let (mut end, mut after) = (from + before, 0);
    if byte(text, end) == b'.' {
        (mantissa, after) = digits(text, end + 1, mantissa);
        end += 1 + after;
    }
    let mut exponent = -i64::try_from(after).ok()?;
    if matches!(byte(text, end), b'e' | b'E') {
        let (down, from) = signed(end + 1);
        let (power, stop) = whole(text, from)?;
        exponent = exponent.saturating_add(if down { -power } else { power });
        end = stop;
    }
    let power = POWERS.get(usize::try_from(exponent.saturating_add(MAX_POWER)).ok()?)?;
    let size = nearest(mantissa as f64 * power).filter(|_| (1..=MAX_DIGITS).contains(&(before + after)))?;
    Some((if minus { -size } else { size }, end))
}

/// The 32-bit float nearest to the number of which `near` is an approximation, if that is certain.
///
/// The mantissa, the power of ten and their product were each rounded to the nearest 64-bit float:
/// `near` is off by less than four units in its last place. So it is certain unless a midpoint
/// between two 32-bit floats, which ends in a one and 28 zeros, is as near as that. Below the
/// normal 32-bit floats midpoints look otherwise.
#[inline(always)]
fn nearest(near: f64) -> Option<f32> {
    const BELOW: u64 = (1 << 29) - 1;
    const MIDPOINT: u64 = 1 << 28;
    let certain = (near.to_bits() & BELOW).abs_diff(MIDPOINT) > 4 && near > 2.0 * f64::from(f32::MIN_POSITIVE);
    (certain || near == 0.0).then(|| num::narrow(near))
}

/// `number` with the digits at `at` put behind it, and how many those are. With more of them than
/// [`MAX_DIGITS`] the number means nothing.
#[inline(always)]
fn digits(text: &[u8], at: usize, mut number: u64) -> (u64, usize) {
    const TENS: [u64; 9] = [1, 10, 100, 1_000, 10_000, 100_000, 1_000_000, 10_000_000, 100_000_000];
    let mut count = 0;
    loop {
        let (more, n) = up_to_eight(eight(text, at + count));
        number = if number == 0 { more } else { number.wrapping_mul(TENS[n]).wrapping_add(more) };
        count += n;
        if n < 8 {
            return (number, count);
        }
    }
}

/// The eight bytes from `at` on, the first the lowest; past the end, ends of lines.
#[inline(always)]
fn eight(text: &[u8], at: usize) -> u64 {
    match text.get(at..).and_then(|rest| rest.first_chunk()) {
        Some(bytes) => u64::from_le_bytes(*bytes),
        None => u64::from_le_bytes(std::array::from_fn(|i| byte(text, at + i))),
    }
}

/// The number that the digits in the lowest bytes make, and how many those are. All eight bytes are
/// worked on at once (D. Lemire, "Quickly parsing eight digits", 2018).
#[inline(always)]
fn up_to_eight(bytes: u64) -> (u64, usize) {
    const HIGH: u64 = 0x8080_8080_8080_8080;
    let values = bytes ^ 0x3030_3030_3030_3030; // '0' to '9' become 0 to 9, all else more
    // Carries run upwards, so that the lowest byte that is no digit is found for certain.
    let others = (values.wrapping_add(0x7676_7676_7676_7676) | values) & HIGH;
    let bits = others.trailing_zeros() & !7;
    // Zeros in the lowest bytes are digits that count for nothing.
    let ones = values.checked_shl(64 - bits).unwrap_or(0);
    let tens = ones.wrapping_mul(10).wrapping_add(ones >> 8);
    const EVERY_FOURTH: u64 = 0x0000_00FF_0000_00FF;
    let low = (tens & EVERY_FOURTH).wrapping_mul(100 + (1_000_000 << 32));
    let high = ((tens >> 16) & EVERY_FOURTH).wrapping_mul(1 + (10_000 << 32));
    (low.wrapping_add(high) >> 32, bits as usize / 8)
}

#[cfg(test)]
mod tests;
