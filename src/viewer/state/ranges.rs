//! One range for the colours of all pictures that show amounts of one kind.

use super::State;
use crate::render::{Mode, Picture, Range};
use crate::viewer::kept::Key;

/// A range that pictures share.
pub struct Fit {
    /// Of what amounts.
    mode: Mode,
    range: Range,
    /// The structures that it was found for; none if it is to be found anew.
    of: Vec<Key>,
}

impl Fit {
    /// Whether it is of amounts of a kind, found for those structures.
    pub(super) fn is_of(&self, mode: Mode, of: &[Key]) -> bool {
        self.mode == mode && self.of == of
    }
}

impl State {
    /// The amounts whose range the user sets, and whose spread is told: those of A, or of the first picture beside that shows some.
    pub fn heat_kind(&self) -> Option<Mode> {
        let first = self.settings.mode;
        let beside = || self.settings.panes.on_screen().iter().map(|choice| choice.mode(first)).find(|mode| mode.is_heat());
        if first.is_heat() { Some(first) } else { self.is_comparing().then(beside).flatten() }
    }

    /// The range that amounts of a kind are to be mapped with: the user's, or the one that pictures share.
    pub fn range_of(&self, mode: Mode) -> Option<Range> {
        let fixed = self.range.filter(|_| mode == self.heat_kind().unwrap_or(self.settings.mode));
        fixed.or_else(|| self.panes.fits.iter().find(|fit| fit.mode == mode).map(|fit| fit.range))
    }

    /// Whether several pictures share a range.
    pub fn shares_ranges(&self) -> bool {
        self.is_comparing() && !self.panes.fits.is_empty()
    }

    /// The ranges that pictures share, each with what it is of.
    pub(super) fn shared_ranges(&self) -> impl Iterator<Item = (Mode, Range)> {
        self.panes.fits.iter().map(|fit| (fit.mode, fit.range))
    }

    /// Finds the shared ranges anew.
    pub(super) fn fit_anew(&mut self) {
        self.range = None;
        self.again.forget_shared();
        self.panes.fits.iter_mut().for_each(|fit| fit.of.clear());
    }

    /// The kinds of amounts that several pictures show, and the structures of each.
    pub(super) fn shared_modes(&self) -> Vec<(Mode, Vec<Key>)> {
        let Some(first) = self.requested.as_ref().filter(|_| self.is_comparing()) else { return Vec::new() };
        let mut modes = vec![(first.mode, vec![first.key.clone()])];
        for choice in self.settings.panes.on_screen().iter().filter(|choice| !choice.differs(first.mode)) {
            let mode = choice.mode(first.mode);
            match modes.iter_mut().find(|(known, _)| *known == mode) {
                Some((_, keys)) => keys.push(choice.key()),
                None => modes.push((mode, vec![choice.key()])),
            }
        }
        modes.retain(|(mode, keys)| mode.is_heat() && keys.len() > 1);
        modes
    }

    /// Finds the ranges of pictures that show amounts of one kind, once all of them are whole: that of the largest. It stays,
    /// while the camera moves, until there are other structures or somebody asks.
    pub(super) fn fit_ranges(&mut self) {
        let modes = self.shared_modes();
        self.panes.fits.retain(|fit| modes.iter().any(|(mode, _)| *mode == fit.mode));
        for (mode, of) in modes {
            if self.panes.fits.iter().any(|fit| fit.is_of(mode, &of)) {
                continue;
            }
            let Some(range) = self.again.take_shared(mode).or_else(|| self.suiting(mode)) else { continue };
            self.panes.fits.retain(|fit| fit.mode != mode);
            self.panes.fits.push(Fit { mode, range, of });
            (self.shared.wake)(); // pictures are mapped anew in the next frame
        }
    }

    /// The range that suits all pictures of a kind, if all are whole.
    fn suiting(&self, mode: Mode) -> Option<Range> {
        let asked = self.requested.as_ref()?;
        let whole = |picture: &&Picture| picture.request == asked.number && picture.progress.step == 1;
        let mut all = Vec::new();
        if asked.mode == mode {
            all.push(self.picture.as_deref().filter(whole)?.suits);
        }
        for (pane, choice) in self.panes.all.iter().zip(self.settings.panes.on_screen()) {
            if choice.mode(asked.mode) == mode && !choice.differs(asked.mode) {
                let current = pane.requested.as_ref().is_some_and(|requested| requested.mode == mode);
                all.push(pane.whole().filter(|_| current)?.suits);
            }
        }
        all.into_iter().reduce(|a, b| Range { min: a.min.min(b.min), max: a.max.max(b.max) })
    }
}
