//! The boxes over pictures beside that of the shown structure: each of its own structure, in the chosen colours, which go over one
//! range with those of the first.

use std::sync::Arc;

use super::panes::{Pane, Panes};
use super::visiting::{Of, Visiting};
use super::{State, finished};
use crate::accel::outline::{Outline, OutlineError};
use crate::job::Outcome;
use crate::lab::Visits;
use crate::render::{self, Mode};
use crate::viewer::gpu::Overlay;
use crate::viewer::kept::Key;
use crate::viewer::overlay::{Collected, Known, Wanted};
use crate::viewer::settings::BoxColor;
use crate::viewer::tree::Listed;
use crate::viewer::workers::{self, Collecting, Outlining};

/// What is known and under way for the boxes over one picture.
#[derive(Default)]
pub struct Boxes {
    collecting: Option<(Wanted, Collecting)>,
    collected_for: Option<Wanted>,
    /// What the amounts of its cells go from and to, if colours stand for amounts.
    amounts: Option<[f32; 2]>,
    /// Its cells, while colours need their rows.
    outline: Option<Arc<Outline>>,
    outlining: Option<Outlining>,
    /// Its cells do not fit: boxes have the colour of what is not known.
    unlisted: bool,
    visiting: Visiting,
}

impl Boxes {
    /// Stops what would disturb a measurement.
    pub(super) fn stop(&mut self) {
        self.outlining = None;
        self.visiting.stop();
    }

    /// Forgets that the cells did not fit: there may be room for them now.
    pub(super) fn list_again(&mut self) {
        self.unlisted = false;
    }

    /// The amounts that colours of a kind stand for.
    fn amounts_of(&self, color: BoxColor) -> Option<[f32; 2]> {
        self.amounts.filter(|_| self.collected_for.as_ref().is_some_and(|wanted| wanted.settings.color == color))
    }
}

impl Panes {
    /// What is known and under way of those of a structure.
    fn boxes_of(&self, key: &Key) -> impl Iterator<Item = &Boxes> {
        let its = |pane: &&Pane| pane.built.as_ref().is_some_and(|built| built.key == *key);
        self.all.iter().filter(its).map(|pane| &pane.boxes)
    }

    /// The list of a structure's cells, if one of them has it.
    pub(super) fn outline_of(&self, key: &Key) -> Option<Arc<Outline>> {
        self.boxes_of(key).find_map(|boxes| boxes.outline.clone())
    }

    /// What was counted of a view of a structure, if that was done for one of them.
    pub(super) fn visits_of(&self, of: &Of) -> Option<Arc<Visits>> {
        self.all.iter().find_map(|pane| pane.boxes.visiting.found_of(of))
    }
}

impl State {
    /// What colours of boxes go from and to, where several pictures have some: from the least amount to the greatest of all.
    /// `beside` is a pane that is looked at apart from the others.
    pub(super) fn range_of_boxes(&self, beside: Option<&Pane>) -> Option<[f32; 2]> {
        let color = self.settings.overlay.color;
        let first = self.collected_for.as_ref().filter(|(wanted, _)| wanted.settings.color == color);
        let first = first.and(self.collected.amounts);
        let others = self.panes.all.iter().chain(beside).filter_map(|pane| pane.boxes.amounts_of(color));
        let all = first.into_iter().chain(others).reduce(|[a, b], [low, high]| [a.min(low), b.max(high)]);
        all.filter(|_| self.is_comparing())
    }

    /// The boxes of the pane's own structure that the present view is to show.
    fn wanted_boxes(&self, pane: &Pane) -> Option<Wanted> {
        let settings = self.settings.overlay.of_content();
        // Which of its cells would be below the selected one nobody can say.
        let drawn = (settings.boxes || settings.planes) && !settings.subtree_only;
        let limit = self.graphics.comfortable_boxes() / (self.panes.all.len() + 1);
        let counted = pane.boxes.visiting.newest().filter(|_| settings.color == BoxColor::Visits);
        drawn.then_some(Wanted {
            numbered: self.needs_rows_beside() && pane.boxes.outline.is_some(),
            counted: counted.map(|(number, _)| number),
            range: self.range_of_boxes(Some(pane)),
            ..Wanted::new(settings, self.view()?, self.size_px, limit)
        })
    }

    /// Whether colours of boxes are told by lists of cells.
    fn needs_rows_beside(&self) -> bool {
        let overlay = &self.settings.overlay;
        overlay.boxes && !overlay.subtree_only && overlay.color.needs_rows()
    }

    /// Whether the boxes over a pane are still to change.
    pub(super) fn boxes_are_busy(&self, pane: &Pane) -> bool {
        let boxes = &pane.boxes;
        let listed = !self.needs_rows_beside() || boxes.outline.is_some() || boxes.unlisted;
        !listed || self.wanted_visits(pane).is_some() || boxes.collected_for != self.wanted_boxes(pane)
    }

    /// Lists cells and counts visits where colours need them, and collects boxes where the view or the settings have changed.
    pub(super) fn advance_pane_boxes(&mut self, pane: &mut Pane) {
        self.advance_rows(pane);
        self.advance_pane_visits(pane);
        if let Some((wanted, job)) = pane.boxes.collecting.take() {
            match job.poll() {
                Outcome::Running => pane.boxes.collecting = Some((wanted, job)),
                Outcome::Done(Ok(Collected { overlay, amounts, .. })) => {
                    self.generation += 1;
                    pane.overlay = Some(Arc::new(Overlay { generation: self.generation, ..overlay }));
                    (pane.boxes.collected_for, pane.boxes.amounts) = (Some(wanted), amounts);
                    (self.shared.wake)(); // the others' colours may go over another range now
                }
                Outcome::Done(Err(_)) | Outcome::Died => pane.boxes.collected_for = Some(wanted),
            }
        }
        let wanted = self.wanted_boxes(pane);
        if wanted.is_none() {
            (pane.overlay, pane.boxes.collecting, pane.boxes.collected_for) = (None, None, None);
        }
        let (Some(wanted), Some(built)) = (wanted, &pane.built) else { return };
        let idle = pane.boxes.collecting.is_none() && !self.is_measuring();
        if idle && pane.picture.is_some() && pane.boxes.collected_for.as_ref() != Some(&wanted) {
            let visits = pane.boxes.visiting.newest().map(|(_, visits)| visits);
            let known = Known { outline: pane.boxes.outline.clone(), visits, film: None };
            let job = workers::collect(&self.shared, Arc::clone(&built.accel), known, wanted.clone());
            pane.boxes.collecting = job.ok().map(|job| (wanted, job));
        }
    }

    /// Gets the list of the cells of a pane's structure while colours need their rows: pictures of one structure share one.
    fn advance_rows(&mut self, pane: &mut Pane) {
        if !self.needs_rows_beside() {
            (pane.boxes.outlining, pane.boxes.unlisted) = (None, false);
            if let Some(outline) = pane.boxes.outline.take() {
                self.shared.give_back(outline); // it may be large
            }
            return;
        }
        if let Some(job) = pane.boxes.outlining.take() {
            match job.poll() {
                Outcome::Running => pane.boxes.outlining = Some(job),
                over => {
                    self.listed(pane, over);
                    (self.shared.wake)(); // others may wait for it
                }
            }
        }
        let Some(built) = pane.built.as_ref().filter(|_| pane.boxes.outline.is_none()) else { return };
        if let Some(outline) = self.listed_elsewhere(&built.key) {
            (pane.boxes.outline, pane.boxes.outlining, pane.boxes.unlisted) = (Some(outline), None, false);
        } else if self.is_listed_elsewhere(&built.key) {
            pane.boxes.outlining = None; // that one is taken
        } else if self.panes.boxes_of(&built.key).any(|boxes| boxes.unlisted) {
            pane.boxes.unlisted = true; // why was said
        } else if pane.boxes.outlining.is_none() && !pane.boxes.unlisted && pane.picture.is_some() && !self.is_measuring() {
            pane.boxes.outlining = workers::outline(&self.shared, built, None).ok();
        }
    }

    /// Takes in the list of a pane's cells, or why there is none.
    fn listed(&mut self, pane: &mut Pane, over: Outcome<Result<Listed, OutlineError>>) {
        match over {
            Outcome::Done(Ok(listed)) => pane.boxes.outline = Some(listed.outline),
            Outcome::Running | Outcome::Done(Err(OutlineError::Cancelled(_))) => {}
            Outcome::Done(Err(OutlineError::Memory(_))) if self.make_room(Some(&*pane)) => {} // it is listed again
            Outcome::Done(Err(e)) => self.unlisted(pane, &e.to_string()),
            Outcome::Died => self.unlisted(pane, "listing its cells failed. Please report this"),
        }
    }

    /// The list of a structure's cells, if another picture has it.
    fn listed_elsewhere(&self, key: &Key) -> Option<Arc<Outline>> {
        let first = self.tree.outline.as_ref().filter(|_| self.tree.of.as_ref() == Some(key));
        first.cloned().or_else(|| self.panes.outline_of(key))
    }

    /// Whether it is made for another picture, or will be for A, which needs the same.
    fn is_listed_elsewhere(&self, key: &Key) -> bool {
        let shown = self.shown.as_ref().is_some_and(|shown| shown.key == *key);
        let first = shown && (self.tree.outlining.is_some() || self.tree.of.as_ref() != Some(key));
        first || self.panes.boxes_of(key).any(|boxes| boxes.outlining.is_some())
    }

    /// Says why there is no list of a pane's cells.
    fn unlisted(&mut self, pane: &mut Pane, why: &str) {
        pane.boxes.unlisted = true;
        let name = pane.built.as_ref().map_or("the structure beside", |built| built.key.entry.name);
        self.fail(finished::sentence(&format!("Can't colour the boxes of {name}: {why}")));
    }

    /// What visits of a pane's structure are yet to be counted of.
    fn wanted_visits(&self, pane: &Pane) -> Option<Of> {
        let built = pane.built.as_ref().filter(|_| self.wants_visits() && !self.settings.overlay.subtree_only)?;
        Some(self.visited_view(&built.key)).filter(|of| pane.boxes.visiting.lacks(of))
    }

    /// What was counted of that for another picture.
    fn counted_elsewhere(&self, of: &Of) -> Option<Arc<Visits>> {
        self.visiting.found_of(of).or_else(|| self.panes.visits_of(of))
    }

    /// Whether that is counted for another picture, or will be for A.
    fn is_counted_elsewhere(&self, of: &Of) -> bool {
        self.awaited_visits().as_ref() == Some(of) || self.panes.all.iter().any(|pane| pane.boxes.visiting.counts(of))
    }

    /// Counts how often rays of the view enter the cells of a pane's structure, where boxes are coloured by it. Pictures of one
    /// structure share what was counted: a second count ends after other rays.
    fn advance_pane_visits(&mut self, pane: &mut Pane) {
        let wanted = self.wanted_visits(pane);
        if let Some((of, visits)) = wanted.as_ref().and_then(|of| Some((of.clone(), self.counted_elsewhere(of)?))) {
            pane.boxes.visiting.take(of, visits, &self.shared);
        }
        let wanted = self.wanted_visits(pane).filter(|of| !self.is_counted_elsewhere(of));
        if !pane.boxes.visiting.take_in(wanted.as_ref(), &self.shared) {
            return self.fail_visits();
        }
        if wanted.as_ref().is_some_and(|of| !pane.boxes.visiting.lacks(of)) {
            (self.shared.wake)(); // others may wait for it
        }
        let (Some(of), Some(built), Some(whole)) = (wanted, &pane.built, self.traced_view(Mode::Shaded)) else { return };
        if pane.whole().is_some() && pane.boxes.visiting.lacks(&of) && !self.is_measuring() {
            let view = render::Job { accel: Arc::clone(&built.accel), section: self.section(), ..whole };
            pane.boxes.visiting.count(of, view, &self.shared);
        }
    }
}
