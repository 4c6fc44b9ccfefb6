//! Pictures of the window as it stands: asked of the window, written as PNG.

use std::io::Write;
use std::path::Path;
use std::sync::{Arc, Mutex, PoisonError};

use eframe::egui::{ColorImage, Context, ScreenshotCallback, ViewportCommand};

use crate::sys::{folder_of, temporary_in};

/// A picture that was asked for.
#[derive(Debug, Default)]
pub struct Capture(Arc<Mutex<Option<Arc<ColorImage>>>>);

impl Capture {
    /// Asks the window for its picture; it comes frames later.
    pub fn ask(&self, ctx: &Context) {
        let taken = Arc::clone(&self.0);
        let callback = ScreenshotCallback::new(move |image| *taken.lock().unwrap_or_else(PoisonError::into_inner) = Some(image));
        ctx.send_viewport_cmd(ViewportCommand::Screenshot(callback));
    }

    /// The picture, once the window has it.
    pub fn take(&self) -> Option<Arc<ColorImage>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).take()
    }
}

/// Writes a PNG to a temporary file, then renames it; tells on standard error if it can't.
pub fn save(path: &Path, image: &ColorImage) {
    if let Err(why) = write(path, image) {
        eprintln!("boxwood: Can't write {}: {why}", path.display());
    }
}

fn write(path: &Path, image: &ColorImage) -> std::io::Result<()> {
    let bytes: Vec<u8> = image.pixels.iter().flat_map(|p| [p.r(), p.g(), p.b()]).collect();
    let [width, height] = image.size.map(|n| u32::try_from(n).unwrap_or(u32::MAX));
    let mut file = temporary_in(folder_of(path))?;
    let encoder = image::codecs::png::PngEncoder::new(std::io::BufWriter::new(&mut file));
    image::ImageEncoder::write_image(encoder, &bytes, width, height, image::ExtendedColorType::Rgb8)
        .map_err(std::io::Error::other)?;
    file.flush()?;
    file.persist(path)?;
    Ok(())
}
