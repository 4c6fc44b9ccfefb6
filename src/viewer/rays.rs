//! What the Ray workspace knows: one ray, the steps of up to four structures that trace it, and how far it is played.

use std::time::{Duration, Instant};

use super::checks::{Mark, MarkKind};
use super::kept::Built;
use super::workers::Following;
use crate::accel::Mode;
use crate::geometry::Ray;
use crate::lab::RayKind;
use crate::lab::follow::Followed;

/// Columns of steps beside each other, at most.
pub const MOST: usize = 4;
/// Steps a second.
pub const SPEEDS: std::ops::RangeInclusive<f32> = 0.5..=120.0;
/// The kinds of rays that can be followed from a pixel.
pub const KINDS: [RayKind; 3] = [RayKind::Primary, RayKind::Shadow, RayKind::Diffuse];

/// Everything of the workspace.
pub struct Rays {
    /// The ray of the pixel that was clicked, or one that was typed.
    pub asked: Option<Ray>,
    /// Whether that, or one that leaves what it meets.
    pub kind: RayKind,
    /// The ray that is followed.
    pub ray: Option<Ray>,
    /// Structures beside the shown one, by id.
    pub beside: Vec<&'static str>,
    /// The steps of each, those of the shown one first.
    pub columns: Vec<Column>,
    /// The column whose step is chosen; the others follow it.
    pub lead: usize,
    /// Its step.
    pub at: usize,
    /// The ray, on its way.
    pub following: Option<Following>,
    /// The structure and the step of a workspace file, until the ray is followed.
    pub awaited: Option<(String, usize)>,
    /// When the last step was played, while it plays.
    pub playing: Option<Instant>,
    /// Steps a second.
    pub speed: f32,
    /// Why there is no ray, or not all structures trace it, in words for the user.
    pub note: Option<String>,
}

/// A structure and its steps.
pub struct Column {
    /// The structure.
    pub built: Built,
    /// Its steps.
    pub followed: Followed,
}

impl Default for Rays {
    fn default() -> Self {
        Self {
            asked: None,
            kind: RayKind::Primary,
            ray: None,
            beside: Vec::new(),
            columns: Vec::new(),
            lead: 0,
            at: 0,
            awaited: None,
            following: None,
            playing: None,
            speed: 4.0,
            note: None,
        }
    }
}

impl Rays {
    /// The step of a column: of the others the last before the first that is farther along the ray than the leading one has
    /// come.
    pub fn position(&self, column: usize) -> usize {
        let Some(lead) = self.columns.get(self.lead) else { return 0 };
        if column == self.lead {
            return self.at;
        }
        let end = self.at + 1 >= lead.followed.steps.len();
        self.columns.get(column).map_or(0, |column| match end {
            true => column.followed.steps.len().saturating_sub(1),
            false => column.followed.until(lead.followed.reached(self.at)),
        })
    }

    /// Whether there is no room for one more column beside those of the shown structure and others.
    pub fn is_full(&self, shown: &str) -> bool {
        self.beside.iter().filter(|id| **id != shown).count() + 1 >= MOST
    }

    /// The last step of the leading column.
    pub fn last(&self) -> usize {
        self.columns.get(self.lead).map_or(0, |column| column.followed.steps.len().saturating_sub(1))
    }

    /// Goes to a step of a column, which leads from then on.
    pub fn go(&mut self, column: usize, step: usize) {
        self.lead = column.min(self.columns.len().saturating_sub(1));
        self.at = step.min(self.last());
    }

    /// The structure that leads, and its step: those that are awaited, if any are.
    pub fn place(&self) -> Option<(String, usize)> {
        let now = || self.columns.get(self.lead).map(|lead| (lead.built.key.entry.id.to_owned(), self.at));
        self.awaited.clone().or_else(now)
    }

    /// Goes to the awaited step, if there is one.
    pub fn go_to_awaited(&mut self) {
        let Some((id, at)) = self.awaited.take() else { return };
        if let Some(column) = self.columns.iter().position(|column| column.built.key.entry.id == id) {
            self.go(column, at);
        }
    }

    /// Plays on, if it is time; returns when it will be next, and whether something has changed.
    pub fn play(&mut self, now: Instant) -> (Option<Duration>, bool) {
        let Some(since) = self.playing else { return (None, false) };
        let step = Duration::from_secs_f32(1.0 / self.speed.max(0.1));
        let steps = now.saturating_duration_since(since).as_secs_f32() / step.as_secs_f32();
        if steps < 1.0 {
            return (Some(step), false);
        }
        // A late frame plays all that it is late by.
        let before = self.at;
        self.at = (self.at + steps as usize).min(self.last());
        self.playing = (self.at < self.last()).then_some(now);
        (self.playing.map(|_| step), self.at != before)
    }

    /// What of it is drawn over the view: the whole ray, and how far it is played.
    pub fn marks(&self) -> Vec<Mark> {
        let (Some(ray), Some(lead)) = (self.ray, self.columns.get(self.lead)) else { return Vec::new() };
        let whole = Mark { ray, t: lead.followed.hit.map_or(f32::INFINITY, |hit| hit.t), kind: MarkKind::Plain };
        // That any hit will do for shadow rays says nothing of where it is.
        let whole = if lead.followed.mode == Mode::Any { Mark { t: ray.tmax, ..whole } } else { whole };
        let here = lead.followed.steps.get(self.at).map(|step| Mark { t: step.t, kind: MarkKind::Here, ..whole });
        std::iter::once(whole).chain(here).collect()
    }

    /// Forgets the steps, not the ray: another structure or model is shown.
    pub fn clear(&mut self) {
        (self.columns, self.ray, self.playing, self.following, self.note) = (Vec::new(), None, None, None, None);
        (self.lead, self.at) = (0, 0);
    }
}
