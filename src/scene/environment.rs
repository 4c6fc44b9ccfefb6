//! An image of everything around a scene, as light: linear colours for all directions.

use std::io::{self, BufRead, Cursor, ErrorKind, Read, Seek, SeekFrom};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;

use image::codecs::hdr::HdrDecoder;
use image::codecs::openexr::OpenExrDecoder;
use image::{ImageDecoder, ImageError};

use super::{LoadCx, LoadError, Reason, load};
use crate::task::{Cancel, Charge};

/// More texels than this along a side are refused, whatever the budget, as they are of textures.
const MAX_SIDE: u32 = 1 << 15;

/// What an OpenEXR file begins with.
const EXR: [u8; 4] = [0x76, 0x2f, 0x31, 0x01];

/// An image that surrounds a scene: columns are longitudes, rows are latitudes, evenly in angle.
#[derive(Debug)]
pub struct Environment {
    name: String,
    width: usize,
    height: usize,
    texels: Vec<[f32; 3]>,
    warnings: Vec<String>,
    _memory: Option<Charge>,
}

impl Environment {
    /// An image without a name, of `width * height` texels by rows from the zenith down: linear radiance in red, green and
    /// blue. Values that are negative or not finite become 0. `None` if the number of texels is another, or a side is 0 or
    /// greater than 32768.
    pub fn new(width: usize, height: usize, mut texels: Vec<[f32; 3]>) -> Option<Self> {
        let fits = |side| (1..=MAX_SIDE as usize).contains(&side);
        if !fits(width) || !fits(height) || texels.len() != width * height {
            return None;
        }
        let mended = mend(&mut texels);
        Some(Self { name: String::new(), width, height, warnings: told(mended, texels.len()), texels, _memory: None })
    }

    /// Reads the file at `path`: Radiance (`.hdr`; Ward 1991) or OpenEXR (`.exr`), told apart by what they begin with. Values
    /// are taken as they are stored: an `EXPOSURE` of a Radiance file changes nothing, and alpha is left out.
    ///
    /// # Errors
    /// A [`LoadError`] with [`Reason::Io`], [`Reason::Malformed`] (another format, damage, or no or too many texels),
    /// [`Reason::Memory`] or [`Reason::Cancelled`].
    pub fn open(path: &Path, cx: &LoadCx) -> Result<Self, LoadError> {
        let name = path.display().to_string();
        Self::read(path, name.clone(), cx).map_err(|reason| reason.of(name))
    }

    fn read(path: &Path, name: String, cx: &LoadCx) -> Result<Self, Reason> {
        cx.progress.start("environment", 0);
        let (bytes, _memory) = load::image_file(path, cx)?;
        // A damaged file may make a decoder panic.
        let decoded = catch_unwind(AssertUnwindSafe(|| decode(&bytes, cx)));
        cx.cancel.check()?;
        let Decoded { width, height, mut texels, memory } = decoded.unwrap_or_else(|_| Err(wrong("its decoder failed")))?;
        let mut mended = 0;
        for row in texels.chunks_mut(width) {
            cx.cancel.check()?;
            mended += mend(row);
        }
        Ok(Self { name, width, height, warnings: told(mended, texels.len()), texels, _memory: Some(memory) })
    }

    /// What the user knows it by: the file's path as given.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Texels in a row, 1 to 32768.
    pub const fn width(&self) -> usize {
        self.width
    }

    /// Rows, 1 to 32768.
    pub const fn height(&self) -> usize {
        self.height
    }

    /// Linear radiance by rows, the first around the zenith; finite and not negative.
    pub fn texels(&self) -> &[[f32; 3]] {
        &self.texels
    }

    /// What was not as it should be, in words for the user. Each is one sentence.
    pub fn warnings(&self) -> &[String] {
        &self.warnings
    }
}

/// Makes values 0 that are no light; returns the number of texels that have some.
fn mend(texels: &mut [[f32; 3]]) -> usize {
    let bad = |c: &f32| !c.is_finite() || *c < 0.0;
    let mut mended = 0;
    for texel in texels.iter_mut().filter(|texel| texel.iter().any(bad)) {
        *texel = texel.map(|c| if bad(&c) { 0.0 } else { c });
        mended += 1;
    }
    mended
}

fn told(mended: usize, of: usize) -> Vec<String> {
    let sentence = || {
        format!("The image around the scene has values that are negative or not finite, taken as 0: in {mended} of {of} texels.")
    };
    (mended > 0).then(sentence).into_iter().collect()
}

/// An image just read.
struct Decoded {
    width: usize,
    height: usize,
    texels: Vec<[f32; 3]>,
    memory: Charge,
}

fn wrong(what: impl std::fmt::Display) -> Reason {
    Reason::malformed("the image", what.to_string().trim_end_matches('.'))
}

fn undecoded(error: ImageError) -> Reason {
    match error {
        ImageError::IoError(error) if error.kind() == ErrorKind::UnexpectedEof => wrong("the file ends before its last texel"),
        error => wrong(error),
    }
}

fn too_large(width: impl std::fmt::Display, height: impl std::fmt::Display) -> Reason {
    wrong(format!("it has {width} by {height} texels, and no side may have more than {MAX_SIDE}"))
}

fn decode(bytes: &[u8], cx: &LoadCx) -> Result<Decoded, Reason> {
    let input = Input { bytes: Cursor::new(bytes), cancel: &cx.cancel };
    if bytes.starts_with(b"#?") {
        // The strict decoder asks for "#?RADIANCE", but many files say "#?RGBE".
        fill(HdrDecoder::new_nonstrict(input).map_err(undecoded)?, |_| 0, cx)
    } else if bytes.starts_with(&EXR) {
        let block = largest_block(bytes).unwrap_or_else(|| Err(wrong("its header is cut off")))?;
        let decoder = OpenExrDecoder::with_alpha_preference(input, Some(false)).map_err(undecoded)?;
        // It fills an image of its own first, from one block after another: as stored, and unpacked.
        fill(decoder, |size| size.saturating_add(block.saturating_mul(2)), cx)
    } else {
        Err(wrong("it is neither Radiance (.hdr) nor OpenEXR (.exr). Save it as one of these"))
    }
}

/// Decodes into memory that the budget has granted, as it has what the decoder takes `meanwhile`, for an image of so many bytes.
fn fill(decoder: impl ImageDecoder, meanwhile: impl Fn(u64) -> u64, cx: &LoadCx) -> Result<Decoded, Reason> {
    let (width, height) = decoder.dimensions();
    if width.max(height) > MAX_SIDE {
        return Err(too_large(width, height));
    }
    if width.min(height) == 0 {
        return Err(wrong("it has no texels"));
    }
    let size = decoder.total_bytes();
    let mut memory = cx.budget.charge(size.saturating_add(meanwhile(size)))?;
    let (width, height) = (width as usize, height as usize);
    let mut texels = vec![[0.0f32; 3]; width * height];
    decoder.read_image(bytemuck::cast_slice_mut(&mut texels)).map_err(undecoded)?;
    memory.shrink(size);
    Ok(Decoded { width, height, texels, memory })
}

/// Bytes of the largest block of an OpenEXR file, unpacked, as its headers tell of it (OpenEXR file layout, section "Header"):
/// the decoder makes room by them, however short the file is. `None` where they are cut off.
fn largest_block(bytes: &[u8]) -> Option<Result<u64, Reason>> {
    /// A block that is no tile has at most so many rows.
    const ROWS: u64 = 256;
    let (flags, mut rest) = bytes.get(EXR.len()..)?.split_first_chunk()?;
    let several = u32::from_le_bytes(*flags) & 1 << 12 != 0;
    let (mut texels, mut channels, mut begun) = (0, 0, false);
    loop {
        let name = text(&mut rest)?;
        if name.is_empty() {
            // The end of a header; one of several is followed by another, or by the end of all.
            if !several || !begun {
                return Some(Ok(texels * channels * 4));
            }
            begun = false;
            continue;
        }
        begun = true;
        text(&mut rest)?; // the attribute's type
        let (size, after) = rest.split_first_chunk()?;
        let (value, after) = after.split_at_checked(u32::from_le_bytes(*size) as usize)?;
        rest = after;
        let number = |k: usize| Some(i32::from_le_bytes(*value.get(4 * k..)?.first_chunk()?));
        let (width, height) = match name {
            b"dataWindow" => {
                (number(2)?.abs_diff(number(0)?).saturating_add(1), number(3)?.abs_diff(number(1)?).saturating_add(1))
            }
            b"tiles" => (number(0)?.cast_unsigned(), number(1)?.cast_unsigned()),
            b"channels" => {
                channels = channels.max(value.len() as u64 / 18); // each has a name, its end, and 16 bytes
                continue;
            }
            _ => continue,
        };
        if width.max(height) > MAX_SIDE {
            return Some(Err(too_large(width, height)));
        }
        let rows = if name == b"tiles" { height.into() } else { ROWS.min(height.into()) };
        texels = texels.max(u64::from(width) * rows);
    }
}

/// The bytes up to a zero, which is taken with them.
fn text<'a>(rest: &mut &'a [u8]) -> Option<&'a [u8]> {
    let end = rest.iter().position(|byte| *byte == 0)?;
    let (text, after) = rest.split_at(end);
    *rest = &after[1..];
    Some(text)
}

/// Bytes that end with an error once the user cancels: decoders cannot be stopped otherwise.
struct Input<'a> {
    bytes: Cursor<&'a [u8]>,
    cancel: &'a Cancel,
}

impl Read for Input<'_> {
    fn read(&mut self, into: &mut [u8]) -> io::Result<usize> {
        self.cancel.check().map_err(io::Error::other)?;
        self.bytes.read(into)
    }
}

impl BufRead for Input<'_> {
    fn fill_buf(&mut self) -> io::Result<&[u8]> {
        self.cancel.check().map_err(io::Error::other)?;
        self.bytes.fill_buf()
    }

    fn consume(&mut self, n: usize) {
        self.bytes.consume(n);
    }
}

impl Seek for Input<'_> {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        self.bytes.seek(to)
    }
}

#[cfg(test)]
mod tests {
    use image::{DynamicImage, ImageFormat, Rgb, Rgb32FImage};

    use super::*;
    use crate::task::{Budget, OverBudget};

    /// Stores texels of rows of `width`.
    fn stored(width: u32, texels: &[[f32; 3]], format: ImageFormat) -> Vec<u8> {
        let height = u32::try_from(texels.len()).expect("small") / width;
        let mut bytes = Cursor::new(Vec::new());
        let image = Rgb32FImage::from_raw(width, height, texels.concat()).expect("whole rows");
        DynamicImage::from(image).write_to(&mut bytes, format).expect("a vector takes it");
        bytes.into_inner()
    }

    fn opened(bytes: &[u8], cx: &LoadCx) -> Result<Environment, Reason> {
        let folder = tempfile::tempdir().expect("a folder");
        // The name says nothing about the format.
        let path = folder.path().join("around");
        std::fs::write(&path, bytes).expect("it is written");
        Environment::open(&path, cx).map_err(|e| e.reason)
    }

    fn refused(bytes: &[u8]) -> String {
        let reason = opened(bytes, &LoadCx::unattended()).expect_err("it is refused");
        assert!(matches!(reason, Reason::Malformed { .. }), "{reason:?}");
        reason.to_string()
    }

    /// A gradient that both formats store exactly.
    fn gradient() -> Vec<[f32; 3]> {
        (0..12u8).map(|i| [1.0 + f32::from(i) / 16.0, 0.5, 1.5]).collect()
    }

    #[test]
    fn both_formats_come_back_as_they_were_stored() {
        for format in [ImageFormat::Hdr, ImageFormat::OpenExr] {
            let cx = LoadCx::unattended();
            let image = opened(&stored(4, &gradient(), format), &cx).expect("it is read");
            assert_eq!((image.width(), image.height(), image.texels()), (4, 3, &gradient()[..]), "{format:?}");
            assert!(image.name().ends_with("around") && image.warnings().is_empty());
            assert_eq!(cx.budget.used(), 12 * 12, "what is kept is charged, and nothing else");
            drop(image);
            assert_eq!(cx.budget.used(), 0);
        }
        let other = [&b"#?RGBE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 1\n"[..], &[128, 64, 0, 129]].concat();
        let image = opened(&other, &LoadCx::unattended()).expect("it is read");
        assert_eq!(image.texels(), [[1.0, 0.5, 0.0]]);
    }

    #[test]
    fn values_that_are_no_light_become_zero_and_are_told() {
        let texels = vec![[f32::NAN, 1.0, 2.0], [-1.0, f32::INFINITY, 3.0], [0.0, 4.0, f32::MAX], [1.0; 3]];
        let mended = [[0.0, 1.0, 2.0], [0.0, 0.0, 3.0], [0.0, 4.0, f32::MAX], [1.0; 3]];
        let read = opened(&stored(2, &texels, ImageFormat::OpenExr), &LoadCx::unattended()).expect("it is read");
        for image in [read, Environment::new(2, 2, texels).expect("it fits")] {
            assert_eq!(image.texels(), mended);
            assert!(image.warnings().len() == 1 && image.warnings()[0].contains("2 of 4"), "{:?}", image.warnings());
        }
        assert!(Environment::new(2, 2, vec![[0.0; 3]; 3]).is_none() && Environment::new(0, 2, Vec::new()).is_none());
        assert!(Environment::new(32769, 1, vec![[0.0; 3]; 32769]).is_none());
    }

    #[test]
    fn damaged_files_are_errors() {
        let (hdr, exr) = (stored(4, &gradient(), ImageFormat::Hdr), stored(4, &gradient(), ImageFormat::OpenExr));
        for whole in [&hdr, &exr] {
            for end in 0..whole.len() {
                assert!(!refused(&whole[..end]).is_empty(), "cut off at {end}");
            }
            // Any byte may be another; what is still an image is read.
            for (at, to) in (0..whole.len()).flat_map(|at| [(at, 0), (at, 0x7f), (at, 0xff)]) {
                let mut bytes = whole.clone();
                bytes[at] = to;
                let _ = opened(&bytes, &LoadCx::unattended());
            }
        }
        let png = stored_png();
        assert!(refused(&png).contains("Save it as one of these"));
        assert!(refused(b"#?RADIANCE\n\n-Y 40000 +X 1\n").contains("40000"));
        assert!(refused(b"#?RADIANCE\n\n-Y 0 +X 1\n").contains("no texels"));
        // A window far wider than the file backs, and tiles.
        for (name, at) in [(&b"dataWindow\0box2i\0"[..], 12), (b"tiles\0tiledesc\0", 4)] {
            let start = exr.windows(name.len()).position(|w| w == name).expect("it has one") + name.len() + at;
            let mut wide = exr.clone();
            wide[start..start + 4].copy_from_slice(&0x1fff_ffffu32.to_le_bytes());
            assert!(refused(&wide).contains("no side may have more"), "{}", refused(&wide));
        }
    }

    fn stored_png() -> Vec<u8> {
        let mut bytes = Cursor::new(Vec::new());
        DynamicImage::from(image::RgbImage::from_pixel(1, 1, Rgb([9; 3]))).write_to(&mut bytes, ImageFormat::Png).expect("it is");
        bytes.into_inner()
    }

    #[test]
    fn the_budget_and_the_user_end_it() {
        for format in [ImageFormat::Hdr, ImageFormat::OpenExr] {
            let bytes = stored(64, &vec![[1.0, 2.0, 3.0]; 64 * 32], format);
            let cx = LoadCx { budget: Budget::new(bytes.len() as u64 + 1000), ..LoadCx::unattended() };
            let reason = opened(&bytes, &cx).expect_err("it does not fit");
            assert!(matches!(reason, Reason::Memory(OverBudget { asked, .. }) if asked >= 64 * 32 * 12), "{reason:?}");
            assert_eq!(cx.budget.used(), 0);
            cx.cancel.cancel();
            assert!(matches!(opened(&bytes, &cx), Err(Reason::Cancelled(_))));
            let cx = LoadCx { budget: Budget::unlimited(), ..cx };
            assert!(decode(&bytes, &cx).is_err(), "decoders are stopped, too");
        }
        // What the file does not back is asked of the budget first.
        let cx = LoadCx { budget: Budget::of_mib(100), ..LoadCx::unattended() };
        assert!(matches!(opened(b"#?RADIANCE\n\n-Y 32768 +X 32768\n", &cx), Err(Reason::Memory(_))));
    }
}
