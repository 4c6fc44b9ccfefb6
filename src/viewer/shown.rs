//! Pictures of light that was kept: as it was, or how it differs from a reference.

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use crate::render::colormap::difference;
use crate::render::{Picture, Range, Tone, encode};

/// Pictures that are not the renderer's count from the other end.
static GENERATION: AtomicU64 = AtomicU64::new(u64::MAX);

/// The share of pixels whose difference is beyond the ends of the range.
const BEYOND: usize = 200;

/// A picture of light of that size, in place of the present one.
pub fn picture(
    light: &[[f32; 3]],
    reference: Option<&[[f32; 3]]>,
    (present, [width, height]): (&Picture, [u32; 2]),
    tone: Tone,
) -> Picture {
    let (rgba, range) = match reference {
        None => (light.iter().flat_map(|pixel| tone.of(*pixel).map(|x| byte(encode(x)))).collect(), present.range),
        Some(reference) => differences(light, reference),
    };
    let rgba = if reference.is_none() { opaque(&rgba) } else { rgba };
    Picture { range, ..in_place_of(present, [width, height], rgba) }
}

/// Bytes as a picture that stands in place of the present one; its depths are those of that.
pub fn in_place_of(present: &Picture, [width, height]: [u32; 2], rgba: Vec<u8>) -> Picture {
    let generation = GENERATION.fetch_sub(1, Ordering::Relaxed);
    // While the present picture is coarse it has no depth for each pixel.
    let whole = (present.width, present.height) == (width, height);
    let depth = if whole { Arc::clone(&present.depth) } else { Arc::new(vec![f32::INFINITY; rgba.len() / 4]) };
    let Picture { request, camera, range, progress, .. } = *present;
    Picture { generation, request, camera, width, height, rgba, depth, range, amounts: None, progress, shots: Vec::new() }
}

/// Brightness less the reference's, blue where it is too dark and orange where it is too bright.
fn differences(light: &[[f32; 3]], reference: &[[f32; 3]]) -> (Vec<u8>, Range) {
    let bright = |[r, g, b]: &[f32; 3]| 0.2126 * r + 0.7152 * g + 0.0722 * b;
    let off: Vec<f32> = light.iter().zip(reference).map(|(a, b)| bright(a) - bright(b)).collect();
    let mut sizes: Vec<f32> = off.iter().map(|d| d.abs()).collect();
    sizes.sort_unstable_by(f32::total_cmp);
    let most = sizes.len().checked_sub(1 + sizes.len() / BEYOND).map_or(1.0, |i| sizes[i]).max(f32::MIN_POSITIVE);
    let rgba = off.iter().flat_map(|d| {
        let [r, g, b] = difference(d / most).map(byte);
        [r, g, b, 255]
    });
    (rgba.collect(), Range { min: -most, max: most })
}

fn opaque(rgb: &[u8]) -> Vec<u8> {
    rgb.as_chunks::<3>().0.iter().flat_map(|[r, g, b]| [*r, *g, *b, 255]).collect()
}

fn byte(x: f32) -> u8 {
    (x * 255.0 + 0.5) as u8
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn too_dark_is_blue_and_too_bright_is_orange() {
        let (rgba, range) = differences(&[[1.0; 3], [0.0; 3], [0.5; 3]], &[[0.5; 3]; 3]);
        let pixel = |i: usize| [rgba[4 * i], rgba[4 * i + 1], rgba[4 * i + 2]];
        let [[r, _, b], [dr, _, db], same] = [0, 1, 2].map(pixel);
        assert!(r > b + 60 && db > dr + 60 && same.iter().all(|c| *c > 230), "{rgba:?}");
        assert!((range.max - 0.5).abs() < 1e-6 && range.min == -range.max);
        assert_eq!(differences(&[], &[]).0, Vec::<u8>::new());
    }
}
