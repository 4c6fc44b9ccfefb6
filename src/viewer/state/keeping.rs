//! What is kept of models and structures: instances or flattened triangles, the memory that all may take, and what leaving out
//! saves.

use super::{Pane, State};
use crate::job::Outcome;
use crate::viewer::kept::{Built, Key};
use crate::viewer::model::Instances;
use crate::viewer::state::finished::sentence;
use crate::viewer::workers;

/// Columns of the rays that times of [`crate::lab::needs`] are taken with.
const COLUMNS: u32 = 256;

impl State {
    /// Opens the same model with its instances kept or flattened.
    pub(super) fn reopen(&mut self, instances: Instances) {
        if let Some(name) = self.model.as_ref().map(|model| model.scene.name.clone()) {
            self.stay();
            let before = std::mem::replace(&mut self.instances, instances);
            self.open(name);
            self.reopened = Some((self.camera, before));
        }
    }

    /// The model that was to be opened is not.
    pub(super) fn stay(&mut self) {
        self.loading = None;
        if let Some((_, before)) = self.reopened.take() {
            self.instances = before;
        }
    }

    /// Limits the memory; kept structures go until the others fit.
    pub(super) fn set_memory(&mut self, mib: Option<u64>) {
        self.settings.memory_mib = mib;
        let limit = mib.map_or(self.machine_bytes / 2, |mib| mib.saturating_mul(1 << 20));
        self.shared.budget.set_limit(limit);
        if self.tree.failed.is_some() {
            self.tree.clear(); // there may be room for it now
        }
        self.panes.all.iter_mut().for_each(|pane| pane.boxes.list_again());
        let mut left = self.shared.budget.used();
        while left > limit
            && let Some(oldest) = self.kept.take_oldest(&self.in_use(None))
        {
            left = left.saturating_sub(oldest.bytes());
            self.shared.give_back(oldest);
        }
    }

    /// The structures whose pictures are on the screen: to forget that they are kept would free nothing. `beside` is a pane that
    /// is looked at apart from the others.
    fn in_use(&self, beside: Option<&Pane>) -> Vec<Key> {
        let others = self.panes.all.iter().chain(beside).filter_map(|pane| pane.built.as_ref());
        self.shown.iter().chain(others).map(|built| built.key.clone()).collect()
    }

    /// Gives back the least recently used structure that is kept, which the next build or list waits for; false if there is none.
    /// `beside` is the pane that needs the room, if it is one.
    pub(super) fn make_room(&mut self, beside: Option<&Pane>) -> bool {
        let oldest = self.kept.take_oldest(&self.in_use(beside));
        let there = oldest.is_some();
        self.shared.give_back(oldest);
        there
    }

    /// Bytes that are charged, and the most there may be.
    pub fn memory(&self) -> (u64, u64) {
        (self.shared.budget.used(), self.shared.budget.limit())
    }

    /// Structures that are kept, the last used first.
    pub fn kept_structures(&self) -> impl Iterator<Item = &Built> {
        self.kept.iter()
    }

    pub(super) fn measure_needs(&mut self) {
        if self.is_checking() || self.is_measuring() {
            return;
        }
        let pause = self.begin_measuring();
        let (Some(model), Some(shown)) = (&self.model, &self.shown) else { return };
        let [width, height] = self.size_px;
        let size = [COLUMNS, (COLUMNS * height).div_ceil(width.max(1)).clamp(1, COLUMNS * 2)];
        match workers::needs(&self.shared, (model, shown), (self.camera, size), pause) {
            Ok(job) => self.needing = Some(job),
            Err(e) => self.fail(format!("Can't measure: {e}.")),
        }
    }

    pub(super) fn advance_needs(&mut self) {
        let Some(job) = &self.needing else { return };
        match job.poll() {
            Outcome::Running => return,
            Outcome::Done(Ok(report)) => self.needs = Some(report),
            Outcome::Done(Err(why)) => self.fail(format!("Can't measure what is left out: {}", sentence(&why))),
            Outcome::Died => self.fail("Can't measure what is left out: the measurement failed.".to_owned()),
        }
        self.needing = None;
    }
}
