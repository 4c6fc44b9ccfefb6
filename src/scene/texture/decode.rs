//! The bytes of one image become a texture.

use std::io::Cursor;
use std::path::Path;

use image::{DynamicImage, ImageDecoder, ImageError, ImageFormat, ImageReader};

use super::pack::{Wanted, pack};
use super::source::{Image, ImageSource};
use super::texels::{Layout, Texture};
use crate::scene::load::image_file;
use crate::scene::{LoadCx, Reason};
use crate::task::{Charge, OverBudget};

/// More texels than this along a side are refused, whatever the budget: no graphics card and no
/// program that makes images goes further, so that it is a header gone wrong.
const MAX_SIDE: u32 = 1 << 15;

/// Why an image is not there.
#[derive(Debug, thiserror::Error)]
pub(super) enum Refusal {
    #[error(transparent)]
    Unread(#[from] Reason),
    #[error("it has {0} by {1} texels, and no side may have more than {MAX_SIDE}")]
    TooLarge(u32, u32),
    #[error("light of more than 8 bits is for surroundings, not for surfaces. Store it as PNG")]
    Light,
    #[error("it has no texels")]
    Empty,
    #[error(transparent)]
    Memory(#[from] OverBudget),
    #[error(transparent)]
    Undecoded(#[from] ImageError),
    #[error("its decoder failed")]
    Failed,
}

/// Reads and decodes an image, and charges the budget with what it takes: while it is decoded, and
/// after that.
pub(super) fn decode(image: &Image, wanted: &Wanted, cx: &LoadCx) -> Result<(Texture, Charge), Refusal> {
    match &image.source {
        ImageSource::Bytes(bytes) => texture(bytes, Path::new(&image.name), wanted, cx),
        ImageSource::File(path) => {
            let (bytes, _memory) = image_file(path, cx)?;
            texture(&bytes, path, wanted, cx)
        }
    }
}

fn texture(bytes: &[u8], name: &Path, wanted: &Wanted, cx: &LoadCx) -> Result<(Texture, Charge), Refusal> {
    let mut reader = ImageReader::new(Cursor::new(bytes));
    // What the bytes begin with is believed before the name; a TGA begins with nothing of its own.
    if let Ok(by_name) = ImageFormat::from_path(name) {
        reader.set_format(by_name);
    }
    let reader = reader.with_guessed_format().map_err(ImageError::IoError)?;
    if matches!(reader.format(), Some(ImageFormat::Hdr | ImageFormat::OpenExr)) {
        return Err(Refusal::Light);
    }
    let decoder = reader.into_decoder()?;
    let (width, height) = decoder.dimensions();
    if width.max(height) > MAX_SIDE {
        return Err(Refusal::TooLarge(width, height));
    }
    if width.min(height) == 0 {
        return Err(Refusal::Empty);
    }
    // Once for what comes out of the decoder, and as much again for what it holds meanwhile.
    let mut memory = cx.budget.charge(decoder.total_bytes().saturating_mul(2))?;
    let (layout, texels) = eight_bits(DynamicImage::from_decoder(decoder)?);
    let texture = pack((width as usize, height as usize), layout, texels, wanted);
    memory.shrink(texture.bytes());
    Ok((texture, memory))
}

/// The texels in 8 bits a channel; nothing is copied where they are.
fn eight_bits(image: DynamicImage) -> (Layout, Vec<u8>) {
    let color = image.color();
    match (color.has_color(), color.has_alpha()) {
        (false, false) => (Layout::Grey, image.into_luma8().into_raw()),
        (false, true) => (Layout::GreyAlpha, image.into_luma_alpha8().into_raw()),
        (true, false) => (Layout::Rgb, image.into_rgb8().into_raw()),
        (true, true) => (Layout::Rgba, image.into_rgba8().into_raw()),
    }
}
