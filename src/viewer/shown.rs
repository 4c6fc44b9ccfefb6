//! Pictures that are not the renderer's: light that was kept, as it was or less a reference, and amounts less those of another
//! structure.

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use crate::render::colormap::difference;
use crate::render::{Amounts, Picture, Range, Tone, encode};
use crate::task::{Cancel, Cancelled};

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
    let Picture { request, camera, range, suits, progress, .. } = *present;
    Picture { generation, request, camera, width, height, rgba, depth, range, suits, amounts: None, progress, shots: Vec::new() }
}

/// Brightness less the reference's, blue where it is too dark and orange where it is too bright.
fn differences(light: &[[f32; 3]], reference: &[[f32; 3]]) -> (Vec<u8>, Range) {
    let bright = |[r, g, b]: &[f32; 3]| 0.2126 * r + 0.7152 * g + 0.0722 * b;
    let off: Vec<f32> = light.iter().zip(reference).map(|(a, b)| bright(a) - bright(b)).collect();
    let most = most(&off).unwrap_or(1.0).max(f32::MIN_POSITIVE);
    let rgba = off.iter().flat_map(|d| {
        let [r, g, b] = difference(d / most).map(byte);
        [r, g, b, 255]
    });
    (rgba.collect(), Range { min: -most, max: most })
}

/// The size that all but a few differences stay below; `None` if there are none.
fn most(off: &[f32]) -> Option<f32> {
    let mut sizes: Vec<f32> = off.iter().map(|d| d.abs()).filter(|d| !d.is_nan()).collect();
    let at = sizes.len().checked_sub(1 + sizes.len() / BEYOND)?;
    Some(*sizes.select_nth_unstable_by(at, f32::total_cmp).1)
}

/// Amounts of the first picture less those of the second, in the second's place: blue where rays do more in the second, orange
/// where they do in the first, clear where they do nothing in either. Its amounts are the differences. Runs on the threads of the
/// pool that it is called in.
///
/// # Errors
/// [`Cancelled`] if asked to stop, or if one of them has no amounts, or they are of different sizes.
pub fn amounts_less(first: &Picture, second: &Picture, cancel: &Cancel) -> Result<Picture, Cancelled> {
    let (Some(a), Some(b)) = (&first.amounts, &second.amounts) else { return Err(Cancelled) };
    if (first.width, first.height) != (second.width, second.height) {
        return Err(Cancelled);
    }
    let off: Vec<f32> = a.values.iter().zip(&b.values).map(|(a, b)| less(*a, *b)).collect();
    cancel.check()?;
    let most = most(&off).unwrap_or(1.0).max(1.0).ceil();
    cancel.check()?;
    let pixel = |d: &f32| {
        let [r, g, b] = difference(d / most).map(byte);
        if d.is_nan() { [0; 4] } else { [r, g, b, 255] }
    };
    let rgba = off.iter().flat_map(pixel).collect();
    let range = Range { min: -most, max: most };
    let amounts = Some(Arc::new(Amounts::of_differences(off)));
    Ok(Picture { range, suits: range, amounts, ..in_place_of(second, [second.width, second.height], rgba) })
}

/// A difference where rays that do nothing in one of the structures count as 0 there.
fn less(a: f32, b: f32) -> f32 {
    let or_none = |x: f32| if x.is_nan() { 0.0 } else { x };
    if a.is_nan() && b.is_nan() { f32::NAN } else { or_none(a) - or_none(b) }
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

    #[test]
    fn amounts_differ_by_their_sign_around_white() {
        let of = |amounts: Option<Vec<f32>>, width| {
            let camera = crate::scene::Camera::framing(&crate::geometry::Aabb::EMPTY, glam::Vec3::Z, glam::Vec3::Y, 1.0);
            let range = Range { min: 0.0, max: 1.0 };
            Picture {
                generation: 1,
                request: 1,
                camera,
                width,
                height: 1,
                rgba: vec![0; 4 * width as usize],
                depth: Arc::new(vec![1.0; width as usize]),
                range,
                suits: range,
                amounts: amounts.map(|values| Arc::new(Amounts::new(values))),
                progress: Default::default(),
                shots: Vec::new(),
            }
        };
        let first = of(Some(vec![9.0, 2.0, 5.0, f32::NAN, f32::NAN]), 5);
        let second = of(Some(vec![2.0, 9.0, 5.0, 3.0, f32::NAN]), 5);
        let less = amounts_less(&first, &second, &Cancel::new()).expect("both have amounts");
        assert_eq!((less.range.min, less.range.max), (-7.0, 7.0));
        let pixel = |i: usize| [0, 1, 2, 3].map(|k| less.rgba[4 * i + k]);
        let ([r, _, b, _], [dr, _, db, _], same, [_, _, _, one], none) = (pixel(0), pixel(1), pixel(2), pixel(3), pixel(4));
        assert!(r > b + 60 && db > dr + 60, "more in the first is orange, more in the second blue");
        assert!(same.iter().all(|c| *c > 230) && one == 255 && none == [0; 4]);
        let told = |x: f32| less.amount_at(glam::Vec2::new(x, 0.0));
        assert_eq!([-0.8, -0.4, 0.4, 0.8].map(told), [Some(7.0), Some(-7.0), Some(-3.0), None]);
        assert!(amounts_less(&first, &of(None, 5), &Cancel::new()).is_err());
        assert!(amounts_less(&first, &of(Some(vec![1.0]), 1), &Cancel::new()).is_err());
        let cancel = Cancel::new();
        cancel.cancel();
        assert!(amounts_less(&first, &second, &cancel).is_err());
    }
}
