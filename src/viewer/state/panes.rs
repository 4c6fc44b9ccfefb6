//! The pictures beside that of the shown structure: built, traced, brought up to date with the view, and colours of one range.

use std::sync::Arc;

use super::pane_boxes::Boxes;
use super::ranges::Fit;
use super::{Asked, State};
use crate::accel::BuildError;
use crate::accel::registry;
use crate::job::{Job, Outcome};
use crate::render::{Mode, Picture, Renderer};
use crate::task::{Cancel, Cancelled, Progress};
use crate::viewer::gpu::Overlay;
use crate::viewer::kept::{Built, Key};
use crate::viewer::panes::{PaneChoice, Pauses, Shows};
use crate::viewer::settings::Workspace;
use crate::viewer::shown;
use crate::viewer::workers::{self, Building};

/// All that stand beside the shown one.
#[derive(Default)]
pub struct Panes {
    /// Those on the screen, in the order of their choices.
    pub all: Vec<Pane>,
    /// The range of each kind of amounts that several pictures show.
    pub(super) fits: Vec<Fit>,
    /// The one whose parameters are open.
    pub tuned: Option<usize>,
}

/// One of them.
#[derive(Default)]
pub struct Pane {
    /// Its structure, once it is there.
    pub built: Option<Built>,
    /// Its build.
    pub building: Option<Building>,
    /// Its newest picture.
    pub picture: Option<Arc<Picture>>,
    /// What A has more than that, once it was worked out.
    pub difference: Option<Arc<Picture>>,
    /// What is drawn over it.
    pub overlay: Option<Arc<Overlay>>,
    /// What traces it, from the first time on.
    renderer: Option<Renderer>,
    pub(super) requested: Option<Asked>,
    differing: Option<(Compared, Job<Result<Picture, Cancelled>>)>,
    differs_for: Option<Compared>,
    pub(super) boxes: Boxes,
}

/// Which pictures a difference is of.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Compared {
    /// The requests that they answer.
    requests: [u64; 2],
    /// The amounts.
    mode: Mode,
    /// Grows as samples double.
    stage: u32,
    done: bool,
}

impl Compared {
    /// Of two whole pictures of one view that bring their amounts.
    fn of(mode: Mode, first: &Picture, second: &Picture) -> Option<Self> {
        let one_view = first.camera == second.camera && (first.width, first.height) == (second.width, second.height);
        let whole = |picture: &Picture| picture.progress.step == 1 && picture.amounts.is_some();
        let there = one_view && whole(first) && whole(second);
        let [a, b] = [first, second].map(|picture| picture.progress);
        let stage = a.samples.min(b.samples).checked_ilog2().unwrap_or(0);
        there.then_some(Self { requests: [first.request, second.request], mode, stage, done: a.done && b.done })
    }
}

impl Pane {
    /// The picture on the screen: its own, or its difference from A.
    pub fn on_screen(&self, differs: bool) -> Option<&Arc<Picture>> {
        if differs { self.difference.as_ref() } else { self.picture.as_ref() }
    }

    /// The newest picture, if it answers what was last asked for, at full resolution.
    pub(super) fn whole(&self) -> Option<&Picture> {
        let asked = self.requested.as_ref()?;
        self.picture.as_deref().filter(|picture| picture.request == asked.number && picture.progress.step == 1)
    }

    /// Forgets the structure and its pictures, not what traces them.
    fn forget(&mut self) -> Self {
        let renderer = self.renderer.take();
        renderer.iter().for_each(Renderer::clear);
        std::mem::replace(self, Self { renderer, ..Self::default() })
    }
}

impl State {
    /// Chooses the second structure, or none at all beside the first.
    pub(super) fn put_beside(&mut self, id: Option<&'static str>) {
        match id.and_then(registry::find) {
            Some(entry) => {
                let shows = self.settings.panes.others.first().map_or_else(Shows::default, |first| first.shows);
                let choice = PaneChoice { shows, ..PaneChoice::of(entry, &self.settings) };
                self.settings.panes.put(0, choice);
            }
            None => {
                self.settings.panes.others.clear();
                self.settings.panes.dividers.clear();
                self.panes.tuned = None;
            }
        }
    }

    /// Changes which pictures stand beside: a range that the user has set is one of the amounts that it was set for.
    pub(super) fn change_panes(&mut self, change: impl FnOnce(&mut Self)) {
        let kind = self.heat_kind();
        change(self);
        if kind != self.heat_kind() {
            self.range = None;
        }
    }

    /// Takes a pane away; the others stay as they are.
    pub(super) fn close_pane(&mut self, which: usize) {
        self.settings.panes.close(which);
        self.panes.tuned = None;
        if which < self.panes.all.len() {
            let closed = self.panes.all.remove(which);
            self.shared.give_back(closed);
        }
    }

    /// Whether pictures stand beside the first.
    pub fn is_comparing(&self) -> bool {
        self.offers_panes() && !self.settings.panes.on_screen().is_empty()
    }

    /// From where on boxes are drawn, as a part of the view's width: over all of compared pictures.
    pub fn boxes_begin(&self) -> f32 {
        if self.is_comparing() { 0.0 } else { self.settings.overlay.begin.min(99) as f32 / 100.0 }
    }

    /// Whether pictures can stand beside the first.
    pub fn offers_panes(&self) -> bool {
        self.settings.workspace == Workspace::Compare && !self.tiles.shown
    }

    /// Whether all of those are there.
    pub fn is_split(&self) -> bool {
        self.is_comparing() && self.panes.all.iter().all(|pane| pane.picture.is_some()) && !self.panes.all.is_empty()
    }

    /// Whether a picture on the screen is path traced: then it matters how light becomes colour, and what samples are made of.
    pub fn follows_light(&self) -> bool {
        let first = self.settings.mode;
        let beside = || self.settings.panes.on_screen().iter().any(|choice| choice.mode(first) == Mode::Path);
        (first == Mode::Path && !self.tiles.shown) || (self.is_comparing() && beside())
    }

    /// The exposure that suits the first path traced picture on the screen.
    pub fn fitting_exposure(&self) -> Option<f32> {
        let beside = self.panes.all.iter().filter_map(|pane| pane.picture.as_ref());
        self.picture.iter().chain(beside).find_map(|picture| picture.progress.exposure)
    }

    /// The pane that is being built.
    pub fn pane_in_building(&self) -> Option<(usize, &Building)> {
        self.panes.all.iter().enumerate().find_map(|(i, pane)| Some((i, pane.building.as_ref()?)))
    }

    /// Keeps all renderers from running, for those who measure.
    pub(super) fn pause_rendering(&self) -> Pauses {
        let others = self.panes.all.iter().filter_map(|pane| pane.renderer.as_ref()).map(Renderer::pause);
        Pauses(std::iter::once(self.renderer.pause()).chain(others).collect())
    }

    /// Ends what would disturb a measurement, and keeps all renderers from running.
    pub(super) fn begin_measuring(&mut self) -> Pauses {
        self.panes.all.iter_mut().for_each(|pane| {
            pane.building = None;
            pane.boxes.stop();
        });
        (self.rays.following, self.rays.playing, self.filming.playing) = (None, None, None);
        if self.brute.running.is_some() {
            self.brute.clear();
        }
        self.visiting.stop();
        if self.tree.outlining.take().is_some() {
            self.tree.of = None; // listed anew afterwards
        }
        self.pause_rendering()
    }

    /// Forgets structures and pictures beside the first, which may be large; not that they were chosen.
    pub(super) fn forget_panes(&mut self) {
        let all = std::mem::take(&mut self.panes.all);
        self.panes.fits.clear();
        self.shared.give_back(all);
    }

    /// Builds what is missing, and asks for pictures where the view has changed.
    pub(super) fn advance_panes(&mut self) {
        let wanted = if self.is_comparing() { self.settings.panes.on_screen().len() } else { 0 };
        self.panes.tuned = self.panes.tuned.filter(|which| *which < wanted);
        if wanted == 0 && !self.panes.all.is_empty() {
            return self.forget_panes();
        }
        if self.panes.all.len() > wanted {
            let closed = self.panes.all.split_off(wanted);
            self.shared.give_back(closed);
        }
        self.panes.all.resize_with(wanted, Pane::default);
        let mut failed = Vec::new();
        for which in 0..wanted {
            let mut pane = std::mem::take(&mut self.panes.all[which]);
            let choice = self.settings.panes.others[which].clone();
            if self.advance_pane_build(&mut pane, &choice.key()) {
                self.advance_pane_picture(&mut pane, &choice);
                self.advance_difference(&mut pane, &choice);
                self.advance_pane_boxes(&mut pane);
            } else {
                failed.push(which);
            }
            self.panes.all[which] = pane;
        }
        self.change_panes(|state| failed.into_iter().rev().for_each(|which| state.close_pane(which)));
        self.fit_ranges();
    }

    /// False if it can't be built.
    fn advance_pane_build(&mut self, pane: &mut Pane, key: &Key) -> bool {
        let other = |of: &Key| of != key;
        if pane.built.as_ref().is_some_and(|built| other(&built.key))
            || pane.building.as_ref().is_some_and(|building| other(&building.key))
        {
            self.shared.give_back(pane.forget());
        }
        if let Some(building) = pane.building.take() {
            let why = match building.job.poll() {
                Outcome::Running => {
                    pane.building = Some(building);
                    None
                }
                Outcome::Done(Ok(built)) => {
                    self.kept.keep(built.clone());
                    pane.built = Some(built);
                    None
                }
                Outcome::Done(Err(BuildError::Cancelled(_))) => None,
                Outcome::Done(Err(BuildError::Memory { .. })) if self.make_room(Some(&*pane)) => None, // it is built again
                Outcome::Done(Err(e)) => Some(super::finished::sentence(&e.to_string())),
                Outcome::Died => Some("the builder failed. Please report this model.".to_owned()),
            };
            if let Some(why) = why {
                self.fail(format!("Can't build {} beside: {why}", key.entry.name));
                return false;
            }
        }
        let building = self.building.is_some() || self.pane_in_building().is_some() || pane.building.is_some();
        if pane.built.is_some() || building || self.loading.is_some() || self.is_measuring() {
            return true;
        }
        if let Some(built) = self.kept.take_up(key) {
            pane.built = Some(built);
        } else if let Some(model) = &self.model {
            pane.building = workers::build(&self.shared, key.clone(), Arc::clone(&model.geometry)).ok();
        }
        true
    }

    /// What is to be asked for beside what was asked for A.
    fn wanted_of(&self, pane: &Pane, choice: &PaneChoice) -> Option<Asked> {
        let built = pane.built.as_ref()?;
        let first = self.requested.as_ref().filter(|asked| asked.size_px == self.size_px)?;
        let mode = choice.mode(first.mode);
        let range = self.range_of(mode).filter(|_| mode.is_heat() && !choice.differs(first.mode));
        let number = pane.requested.as_ref().map_or(0, |asked| asked.number);
        Some(Asked { number, key: built.key.clone(), mode, range, keeps: false, ..first.clone() })
    }

    fn advance_pane_picture(&self, pane: &mut Pane, choice: &PaneChoice) {
        let (Some(model), Some(wanted)) = (&self.model, self.wanted_of(pane, choice)) else { return };
        if pane.renderer.is_none() {
            let wake = Arc::clone(&self.shared.wake);
            pane.renderer = Renderer::new(self.trace_pool.clone(), move || wake()).ok();
        }
        let (Some(renderer), Some(built)) = (&pane.renderer, &pane.built) else { return };
        if pane.requested.as_ref() != Some(&wanted) && !self.is_measuring() && self.hidden.is_none() {
            let number = renderer.request(wanted.request(model, &built.accel, None));
            pane.requested = Some(Asked { number, ..wanted });
        }
        pane.picture = renderer.picture().or_else(|| pane.picture.take());
    }

    /// Works out what A has more than a pane, as samples double and once both are done.
    fn advance_difference(&self, pane: &mut Pane, choice: &PaneChoice) {
        if !choice.differs(self.settings.mode) {
            (pane.difference, pane.differing, pane.differs_for) = (None, None, None);
            return;
        }
        if let Some((of, job)) = pane.differing.take() {
            match job.poll() {
                Outcome::Running => pane.differing = Some((of, job)),
                Outcome::Done(Ok(picture)) => (pane.difference, pane.differs_for) = (Some(Arc::new(picture)), Some(of)),
                Outcome::Done(Err(_)) | Outcome::Died => pane.differs_for = Some(of),
            }
        }
        if pane.differs_for.is_some_and(|of| of.mode != self.settings.mode) {
            pane.difference = None; // of other amounts
        }
        let Some((of, first, second)) = self.to_compare(pane) else { return };
        if pane.differing.is_some() || pane.differs_for == Some(of) {
            return;
        }
        let pool = self.shared.pool.clone();
        let work = move |cancel: &Cancel, _: &Progress| pool.run(|| shown::amounts_less(&first, &second, cancel));
        let job = Job::spawn("difference", self.shared.waker(), work);
        pane.differing = job.ok().map(|job| (of, job));
    }

    /// The pictures whose difference is wanted, if they answer what was last asked for.
    fn to_compare(&self, pane: &Pane) -> Option<(Compared, Arc<Picture>, Arc<Picture>)> {
        let (first, second) = (self.picture.as_ref()?, pane.picture.as_ref()?);
        let [asked, beside] = [self.requested.as_ref()?, pane.requested.as_ref()?];
        let answered = first.request == asked.number && second.request == beside.number && asked.mode == beside.mode;
        let of = Compared::of(asked.mode, first, second).filter(|_| answered)?;
        Some((of, Arc::clone(first), Arc::clone(second)))
    }

    /// Whether anything runs that will change what is shown beside A.
    pub(super) fn panes_are_busy(&self) -> bool {
        if !self.is_comparing() || self.shown.is_none() {
            return false;
        }
        let current = |(mode, of): &(Mode, Vec<Key>)| self.panes.fits.iter().any(|fit| fit.is_of(*mode, of));
        let fitted = self.shared_modes().iter().all(current);
        let range = self.range_of(self.settings.mode);
        let mapped = self.requested.as_ref().is_some_and(|asked| asked.range == range);
        let at_rest = |(pane, choice): (&Pane, &PaneChoice)| {
            let asked = pane.requested.is_some() && pane.requested == self.wanted_of(pane, choice);
            let drawn = pane.whole().is_some_and(|picture| picture.progress.done);
            let compared = !choice.differs(self.settings.mode)
                || (pane.differing.is_none() && self.to_compare(pane).is_some_and(|(of, ..)| pane.differs_for == Some(of)));
            asked && drawn && compared && !self.boxes_are_busy(pane)
        };
        let choices = self.settings.panes.on_screen();
        let all = self.panes.all.len() == choices.len() && self.panes.all.iter().zip(choices).all(at_rest);
        !(fitted && mapped && all)
    }
}
