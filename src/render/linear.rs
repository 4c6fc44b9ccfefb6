//! Pictures of linear light in OpenEXR files, with notes on what they are of.

use std::io::{BufRead, Seek, Write};

use exr::image::read::read;
use exr::image::write::WritableImage;
use exr::image::write::channels::GetPixel;
use exr::image::{Encoding, Image, Layer, SpecificChannels};
use exr::math::Vec2;
use exr::meta::attribute::{AttributeValue, Text};
use exr::meta::header::LayerAttributes;
use exr::prelude::{ReadChannels, ReadLayers};

/// Linear red, green and blue.
#[derive(Clone, Debug, PartialEq)]
pub struct LinearPicture {
    /// Columns.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Row by row, the uppermost first.
    pub pixels: Vec<[f32; 3]>,
    /// What is said of it, by name.
    pub notes: Vec<(String, String)>,
}

/// Why a picture could not be read or written.
#[derive(Debug, thiserror::Error)]
pub enum LinearError {
    /// The file is not what it should be, or the system failed.
    #[error(transparent)]
    Exr(#[from] exr::error::Error),
    /// It has more pixels than that.
    #[error("it has {0} by {1} pixels, more than a picture can have")]
    TooLarge(usize, usize),
}

/// What names of notes begin with in the file, so that other programs' keep out.
const PREFIX: &str = "boxwood:";
/// The most columns or rows.
const MOST: usize = 16_384;

struct Pixels<'a>(&'a LinearPicture);

impl GetPixel for Pixels<'_> {
    type Pixel = (f32, f32, f32);

    fn get_pixel(&self, Vec2(x, y): Vec2<usize>) -> Self::Pixel {
        let [r, g, b] = self.0.pixels[y * self.0.width as usize + x];
        (r, g, b)
    }
}

impl LinearPicture {
    /// The value of a note.
    pub fn note(&self, name: &str) -> Option<&str> {
        self.notes.iter().find(|(known, _)| known == name).map(|(_, value)| value.as_str())
    }

    /// Writes it, without loss.
    ///
    /// # Errors
    /// The system's.
    pub fn write(&self, to: impl Write + Seek) -> Result<(), LinearError> {
        let size = (self.width as usize, self.height as usize);
        let mut attributes = LayerAttributes::named("light");
        for (name, value) in &self.notes {
            if let (Some(name), Some(value)) = (Text::new_or_none(format!("{PREFIX}{name}")), Text::new_or_none(value)) {
                attributes.other.insert(name, AttributeValue::Text(value));
            }
        }
        let layer = Layer::new(size, attributes, Encoding::SMALL_LOSSLESS, SpecificChannels::rgb(Pixels(self)));
        Ok(Image::from_layer(layer).write().non_parallel().to_buffered(to)?)
    }

    /// Reads one that was written so, or by another program: the first layer with red, green and blue.
    ///
    /// # Errors
    /// It is no such file, or has more pixels than a picture here.
    pub fn read(from: impl BufRead + Seek) -> Result<Self, LinearError> {
        type Grid = (usize, Vec<[f32; 3]>);
        let start = |size: Vec2<usize>, _: &_| -> Grid {
            let fits = size.0.max(size.1) <= MOST;
            (size.0, if fits { vec![[0.0; 3]; size.0 * size.1] } else { Vec::new() })
        };
        let set = |(width, pixels): &mut Grid, Vec2(x, y): Vec2<usize>, (r, g, b): (f32, f32, f32)| {
            if let Some(pixel) = pixels.get_mut(y * *width + x) {
                *pixel = [r, g, b];
            }
        };
        let reader = read().no_deep_data().largest_resolution_level().rgb_channels(start, set);
        let image = reader.first_valid_layer().all_attributes().non_parallel().from_buffered(from)?;
        let (size, layer) = (image.layer_data.size, image.layer_data);
        let (width, height) = (u32::try_from(size.0), u32::try_from(size.1));
        let (Ok(width), Ok(height), true) = (width, height, size.0.max(size.1) <= MOST) else {
            return Err(LinearError::TooLarge(size.0, size.1));
        };
        let note = |(name, value): (&Text, &AttributeValue)| match value {
            AttributeValue::Text(value) => Some((name.to_string().strip_prefix(PREFIX)?.to_owned(), value.to_string())),
            _ => None,
        };
        let mut notes: Vec<_> = layer.attributes.other.iter().filter_map(note).collect();
        notes.sort();
        Ok(Self { width, height, pixels: layer.channel_data.pixels.1, notes })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::Cursor;

    #[test]
    fn what_is_written_is_read_to_the_bit() {
        let pixels = (0..6u16).map(|i| [f32::from(i) * 0.1, 1e-20, 65_504.0 * f32::from(i)]).collect();
        let notes = vec![("seed".to_owned(), "7".to_owned()), ("spp".to_owned(), "1024".to_owned())];
        let picture = LinearPicture { width: 3, height: 2, pixels, notes };
        let mut bytes = Cursor::new(Vec::new());
        picture.write(&mut bytes).expect("written");
        let bytes = bytes.into_inner();
        let read = LinearPicture::read(Cursor::new(&bytes)).expect("read");
        assert_eq!((&read, read.note("spp"), read.note("camera")), (&picture, Some("1024"), None));
        for cut in [0, 10, bytes.len() / 2] {
            assert!(LinearPicture::read(Cursor::new(&bytes[..cut])).is_err(), "{cut}");
        }
    }
}
