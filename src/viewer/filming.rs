//! The film of a build, in the Structure workspace: made in the background, and played over the view.

use std::sync::Arc;
use std::time::{Duration, Instant};

use super::kept::Built;
use super::workers::Shared;
use crate::accel::BuildCx;
use crate::accel::outline::Outline;
use crate::job::Job;
use crate::lab::film::{Film, FilmError, Subject};

/// Events a second.
pub const SPEEDS: std::ops::RangeInclusive<f32> = 0.1..=10_000.0;
/// The speed at first.
const FIRST_SPEED: f32 = 8.0;
/// The screen shows no more events than one in so long.
const FRAME: Duration = Duration::from_millis(16);

/// A film on its way.
pub type Making = Job<Result<Film, FilmError>>;

/// Everything of it.
pub struct Filming {
    /// The film of the shown structure, once somebody asked for it.
    pub film: Option<Arc<Film>>,
    /// That, on its way.
    pub making: Option<Making>,
    /// Why there is none, in words for the user.
    pub failed: Option<String>,
    /// How many of its events have happened; of a film on its way, how many will have when it is first seen.
    pub at: u32,
    /// When the last event was played, while it plays.
    pub playing: Option<Instant>,
    /// Events a second.
    pub speed: f32,
}

impl Default for Filming {
    fn default() -> Self {
        Self { film: None, making: None, failed: None, at: 0, playing: None, speed: FIRST_SPEED }
    }
}

/// Starts making the film of a structure, whose cells are listed.
pub fn make(shared: &Shared, shown: &Built, outline: Arc<Outline>) -> std::io::Result<Making> {
    let (accel, key, shared) = (Arc::clone(&shown.accel), shown.key.clone(), shared.clone());
    Job::spawn("film", shared.waker(), move |cancel, progress| {
        shared.wait_for_memory();
        let cx = BuildCx::new(cancel.clone(), progress.clone(), shared.pool, shared.budget);
        Film::of(&Subject { id: key.entry.id, accel: accel.as_ref(), params: &key.params }, outline, &cx)
    })
}

impl Filming {
    /// The last position.
    pub fn last(&self) -> u32 {
        self.film.as_ref().map_or(0, |film| film.last())
    }

    /// Goes to a position.
    pub fn go(&mut self, at: u32) {
        self.at = at.min(self.last());
    }

    /// Starts playing, from the start where it has come to the end; or stops.
    pub fn play(&mut self, play: bool, now: Instant) {
        if play && self.at >= self.last() {
            self.at = 0;
        }
        self.playing = (play && self.film.is_some()).then_some(now);
    }

    /// Plays at another speed from now on.
    pub fn set_speed(&mut self, speed: f32, now: Instant) {
        self.speed = speed;
        self.playing = self.playing.map(|_| now);
    }

    /// Plays on, if it is time; returns when it will be next.
    pub fn play_on(&mut self, now: Instant) -> Option<Duration> {
        let since = self.playing?;
        let event = Duration::from_secs_f32(1.0 / self.speed.clamp(*SPEEDS.start(), *SPEEDS.end()));
        let events = (now.saturating_duration_since(since).as_secs_f64() / event.as_secs_f64()) as u32;
        // A late frame plays all that it is late by, and what is left of the time counts for the next.
        self.go(self.at.saturating_add(events));
        let end = self.at >= self.last();
        self.playing = (!end).then(|| since + event.saturating_mul(events));
        (!end).then(|| event.max(FRAME))
    }

    /// Takes in a film, at the position that was asked for.
    pub fn made(&mut self, film: Film) {
        *self = Self { film: Some(Arc::new(film)), speed: self.speed, at: self.at, ..Self::default() };
        self.go(self.at);
    }

    /// The position, if there is a film or one is on its way.
    pub fn place(&self) -> Option<u32> {
        (self.film.is_some() || self.making.is_some()).then_some(self.at)
    }

    /// Puts the film away, or the work on it, and returns it: it may be large.
    pub fn clear(&mut self) -> Option<Arc<Film>> {
        std::mem::replace(self, Self { speed: self.speed, ..Self::default() }).film
    }
}
