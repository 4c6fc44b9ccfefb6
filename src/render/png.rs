//! Pictures as PNG files.

/// Why there is no file.
#[derive(Debug, thiserror::Error)]
pub enum PngError {
    /// There are not four bytes for each pixel.
    #[error("the picture is not whole")]
    Size,
    /// The encoder's own words.
    #[error(transparent)]
    Encoding(#[from] image::ImageError),
}

/// The bytes of a PNG file of so many columns and rows: four bytes a pixel, gamma-encoded, which opacity has been multiplied into. In
/// the file it has not.
///
/// # Errors
/// If there are not as many bytes, or the encoder fails.
pub fn png(rgba: &[u8], [width, height]: [u32; 2]) -> Result<Vec<u8>, PngError> {
    if rgba.len() as u64 != u64::from(width) * u64::from(height) * 4 {
        return Err(PngError::Size); // the encoder would panic
    }
    let plain = |rgba: &[u8; 4]| {
        let [r, g, b, a] = *rgba;
        let divided = |c: u8| u8::try_from(u32::from(c) * 255 / u32::from(a.max(1))).unwrap_or(u8::MAX);
        [divided(r), divided(g), divided(b), a]
    };
    let bytes: Vec<u8> = rgba.as_chunks::<4>().0.iter().flat_map(plain).collect();
    let mut png = Vec::new();
    let encoder = image::codecs::png::PngEncoder::new(&mut png);
    image::ImageEncoder::write_image(encoder, &bytes, width, height, image::ExtendedColorType::Rgba8)?;
    Ok(png)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colours_in_the_file_are_those_before_opacity() {
        let file = png(&[100, 50, 0, 200, 10, 20, 30, 255, 0, 0, 0, 0], [3, 1]).expect("whole");
        let read = image::load_from_memory(&file).expect("just written").to_rgba8();
        assert_eq!(read.as_raw()[..], [127, 63, 0, 200, 10, 20, 30, 255, 0, 0, 0, 0]);
        assert!(matches!(png(&[0; 5], [1, 1]), Err(PngError::Size)));
    }
}
