//! A picture of a fixed number of samples, for files.

use super::{Development, Film, Job, Range, auto_range};
use crate::task::{Cancel, Cancelled, Pool, Progress};

/// A rendered picture.
#[derive(Clone, Debug)]
pub struct Still {
    /// The samples.
    pub film: Film,
    /// Rays traced, camera and others.
    pub rays: u64,
    /// Seconds of tracing and shading.
    pub secs: f64,
}

/// Renders `samples` samples a pixel.
///
/// # Errors
/// [`Cancelled`] if asked to stop.
pub fn render(
    job: &Job,
    width: u32,
    height: u32,
    samples: u32,
    pool: &Pool,
    cancel: &Cancel,
    progress: &Progress,
) -> Result<Still, Cancelled> {
    progress.start("render", u64::from(samples));
    let start = std::time::Instant::now();
    let mut film = Film::new(width, height);
    let mut rays = 0;
    for _ in 0..samples.max(1) {
        rays += job.pass(&mut film, pool, cancel)?;
        progress.advance(1);
    }
    Ok(Still { film, rays, secs: start.elapsed().as_secs_f64() })
}

impl Still {
    /// Four bytes a pixel; `range` for amounts, one that suits if `None`.
    pub fn develop(&self, job: &Job, range: Option<Range>, background: Option<[f32; 3]>, pool: &Pool) -> Vec<u8> {
        let range = range.unwrap_or_else(|| auto_range(&self.film, job.mode));
        pool.run(|| Development { mode: job.mode, range, background }.develop(&self.film))
    }
}
