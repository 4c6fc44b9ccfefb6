//! A picture for files: of so many samples, of so many seconds, or down to an error.

use std::time::Instant;

use super::spread::LEAST;
use super::{Development, Film, Job, Range, Tone, Work, auto_range};
use crate::task::{Cancel, Cancelled, Pool, Progress};

/// When a picture is done: at whichever comes first.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Until {
    /// Samples in each pixel, at least one.
    pub samples: u32,
    /// Seconds of tracing and shading: no pass begins after them.
    pub secs: Option<f64>,
    /// The estimated noise ([`Film::noise`]) that it comes down to.
    pub noise: Option<f64>,
    /// Pixels that have converged get no more samples, which biases the picture ([`Film::converging`]).
    pub adaptive: bool,
}

impl Until {
    /// So many samples and nothing else.
    pub const fn samples(samples: u32) -> Self {
        Self { samples, secs: None, noise: None, adaptive: false }
    }

    fn film(&self, width: u32, height: u32) -> Film {
        match (self.adaptive, self.noise) {
            (true, _) => Film::converging(width, height),
            (false, Some(_)) => Film::estimating(width, height),
            (false, None) => Film::new(width, height),
        }
    }

    fn is_reached(&self, film: &Film, secs: f64) -> bool {
        // Of a few samples alike, black ones say, nothing is known of their noise.
        let some = film.samples() >= LEAST;
        let sure = some && self.noise.zip(film.noise()).is_some_and(|(wanted, noise)| noise <= wanted);
        film.is_done(self.samples.max(1)) || self.secs.is_some_and(|most| secs >= most) || sure
    }
}

/// A rendered picture.
#[derive(Clone, Debug)]
pub struct Still {
    /// The samples.
    pub film: Film,
    /// What it took.
    pub work: Work,
    /// Seconds of tracing and shading.
    pub secs: f64,
}

/// Renders a picture.
///
/// # Errors
/// [`Cancelled`] if asked to stop.
pub fn render(
    job: &Job,
    (width, height): (u32, u32),
    until: &Until,
    pool: &Pool,
    cancel: &Cancel,
    progress: &Progress,
) -> Result<Still, Cancelled> {
    progress.start("render", u64::from(until.samples));
    let start = Instant::now();
    let mut still = Still { film: until.film(width, height), work: Work::default(), secs: 0.0 };
    while still.film.samples() == 0 || !until.is_reached(&still.film, still.secs) {
        still.work += job.pass(&mut still.film, pool, cancel)?;
        still.secs = start.elapsed().as_secs_f64();
        progress.advance(1);
    }
    Ok(still)
}

impl Still {
    /// Four bytes a pixel; `range` for amounts, one that suits if `None`.
    pub fn develop(&self, job: &Job, range: Option<Range>, tone: Tone, background: Option<[f32; 3]>, pool: &Pool) -> Vec<u8> {
        let range = range.unwrap_or_else(|| auto_range(&self.film, job.mode));
        pool.run(|| Development { mode: job.mode, range, tone, background }.develop(&self.film))
    }
}
