//! Hidden triangles as they stand in a file: runs of them in the order of the scene's instances and their triangles, so that
//! they are the same whatever structure they were hidden in, and whether or not instances are flattened.

use std::collections::HashMap;
use std::fmt::Write as _;
use std::str::SplitAsciiWhitespace;
use std::sync::Arc;
use std::sync::atomic::Ordering;

use super::{Bits, NUMBER, OfPlace, PER_CHECK, Triangles, Visibility, VisibilityError, bytes};
use crate::geometry::num;
use crate::scene::Geometry;
use crate::task::{Budget, Cancel, Cancelled};

/// Hidden triangles, written down.
#[derive(Clone, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub struct Written {
    /// Triangles of the scene, each counted as often as it stands somewhere.
    of: u64,
    /// How many are seen, how many after those are hidden, and so on by turns: numbers between spaces, whose sum is `of`.
    runs: String,
}

impl Visibility {
    /// Writes it down.
    ///
    /// # Errors
    /// [`Cancelled`] if asked to stop.
    pub fn written(&self, geometry: &Geometry, cancel: &Cancel) -> Result<Written, Cancelled> {
        let mut runs = Runs::default();
        for instance in 0..geometry.instance_end() {
            if (instance as usize).is_multiple_of(PER_CHECK) {
                cancel.check()?;
            }
            let count = geometry.count_of(instance);
            let (bits, first) = match (geometry.flat(instance, 0), self.hidden.places.get(&instance)) {
                (Some(first), _) => (&self.hidden.flat, first),
                (None, Some(OfPlace::Some(bits))) => (bits, 0),
                (None, whole) => {
                    runs.add(whole.is_some(), count as u64);
                    continue;
                }
            };
            for i in 0..count {
                if i.is_multiple_of(PER_CHECK) {
                    cancel.check()?;
                }
                runs.add(bits.has(first + num::index(i)), 1);
            }
        }
        Ok(runs.end())
    }

    /// Hides what was written down.
    ///
    /// # Errors
    /// It is of another scene, or not whole; the budget has no room, or it was asked to stop.
    pub fn read(written: &Written, geometry: &Arc<Geometry>, budget: &Budget, cancel: &Cancel) -> Result<Self, VisibilityError> {
        let instances = || 0..geometry.instance_end();
        let has: u64 = instances().map(|instance| geometry.count_of(instance) as u64).sum();
        if written.of != has {
            return Err(VisibilityError::OfAnother { of: written.of, has });
        }
        let mut charge = budget.charge(bytes(geometry))?;
        let mut hidden = Triangles { flat: Bits::of(geometry.triangle_count()), places: HashMap::new() };
        let mut pieces = Pieces { words: written.runs.split_ascii_whitespace(), hidden: true, left: 0 };
        for instance in instances() {
            if (instance as usize).is_multiple_of(PER_CHECK) {
                cancel.check()?;
            }
            let count = geometry.count_of(instance);
            if let Some(first) = geometry.flat(instance, 0) {
                pieces.put_into(&mut hidden.flat, first as usize..first as usize + count, cancel)?;
            } else if let Some(whole) = pieces.whole(count)? {
                if whole {
                    hidden.places.insert(instance, OfPlace::All);
                }
            } else {
                charge.grow(count as u64 / 8 + 8)?;
                let mut bits = Bits::of(count);
                pieces.put_into(&mut bits, 0..count, cancel)?;
                hidden.places.insert(instance, OfPlace::Some(bits));
            }
        }
        if pieces.left > 0 || pieces.words.next().is_some() {
            return Err(VisibilityError::Damaged);
        }
        let (number, count) = (NUMBER.fetch_add(1, Ordering::Relaxed), hidden.count(geometry, cancel)?);
        Ok(Self { number, geometry: Arc::downgrade(geometry), hidden, count, _charge: charge })
    }
}

/// Runs as they are written.
#[derive(Default)]
struct Runs {
    text: String,
    of: u64,
    /// Whether the triangles of the last run are hidden, and how many it has so far.
    last: (bool, u64),
}

impl Runs {
    /// Goes on with triangles that are hidden, or seen.
    fn add(&mut self, hidden: bool, count: u64) {
        if count > 0 && hidden != self.last.0 {
            self.put_last();
            self.last = (hidden, 0);
        }
        self.last.1 += count;
        self.of += count;
    }

    fn put_last(&mut self) {
        let between = if self.text.is_empty() { "" } else { " " };
        let _ = write!(self.text, "{between}{}", self.last.1); // a string takes all
    }

    fn end(mut self) -> Written {
        self.put_last();
        Written { of: self.of, runs: self.text }
    }
}

/// Runs as they are read, in pieces.
struct Pieces<'a> {
    words: SplitAsciiWhitespace<'a>,
    /// Whether the triangles of the present run are hidden, and how many of them are left.
    hidden: bool,
    left: u64,
}

impl Pieces<'_> {
    /// Goes on to a run that has triangles left.
    fn go_on(&mut self) -> Result<(), VisibilityError> {
        while self.left == 0 {
            let word = self.words.next().ok_or(VisibilityError::Damaged)?;
            self.left = word.parse().map_err(|_| VisibilityError::Damaged)?;
            self.hidden = !self.hidden;
        }
        Ok(())
    }

    /// Whether the next so many are hidden, or seen, all of them; nothing, and none is taken, if only some are.
    fn whole(&mut self, count: usize) -> Result<Option<bool>, VisibilityError> {
        if count == 0 {
            return Ok(Some(false));
        }
        self.go_on()?;
        let whole = self.left >= count as u64;
        self.left -= if whole { count as u64 } else { 0 };
        Ok(whole.then_some(self.hidden))
    }

    /// Takes as many as a range has, and sets those that are hidden.
    fn put_into(&mut self, bits: &mut Bits, range: std::ops::Range<usize>, cancel: &Cancel) -> Result<(), VisibilityError> {
        let mut at = range.start;
        while at < range.end {
            self.go_on()?;
            cancel.check()?;
            let most = (range.end - at).min(PER_CHECK);
            let count = usize::try_from(self.left).map_or(most, |left| left.min(most));
            if self.hidden {
                (at..at + count).for_each(|i| bits.set(num::index(i)));
            }
            self.left -= count as u64;
            at += count;
        }
        Ok(())
    }
}
