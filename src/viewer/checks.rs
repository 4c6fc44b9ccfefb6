//! What the Check workspace knows: the matrix of the stability lab as it fills, what was found out about the open model,
//! and the rays that are drawn over the view.

use std::sync::mpsc::Receiver;

use super::workers::{Checking, Stability};
use crate::geometry::Ray;
use crate::geometry::tri::TestKind;
use crate::lab::ModelCheck;
use crate::lab::format::count;
use crate::lab::stability::cases::{self, Case};
use crate::lab::stability::{CaseRow, Row, Verdict};

/// Makes the scenes and rays of the lab in the window.
pub const SEED: u64 = 1;
/// About so many rays a case: fewer than on the command line, so that the matrix is full within a minute or two.
pub const RAYS: usize = 400;

/// Everything of the workspace.
#[derive(Default)]
pub struct Checks {
    /// Cases that are through, in their order.
    pub cases: Vec<CaseRow>,
    /// The lab, while it runs, and where it puts cases that are through.
    pub running: Option<(Stability, Receiver<CaseRow>)>,
    /// The cell that was clicked.
    pub selected: Option<Cell>,
    /// What was found out about the open model.
    pub model: Option<ModelCheck>,
    /// Which of its structures has its rays marked.
    pub marked: Option<usize>,
    /// The check of the open model, while it runs.
    pub checking: Option<Checking>,
    /// What is drawn over the view.
    pub marks: Vec<Mark>,
    /// What that is, in words.
    pub caption: String,
}

/// A cell of the matrix.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Cell {
    /// The case's id.
    pub case: &'static str,
    /// The structure's.
    pub structure: &'static str,
    /// The triangle test.
    pub test: TestKind,
}

/// A ray that is drawn over the view, in the world.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mark {
    /// The ray.
    pub ray: Ray,
    /// Where it is known to end; infinite where nothing is hit.
    pub t: f32,
    /// What it stands for.
    pub kind: MarkKind,
}

/// What a marked ray stands for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MarkKind {
    /// Answered wrongly.
    Wrong,
    /// Answered as rounding may have it.
    Rounded,
    /// One of a case's rays, as an example, or the one that is followed.
    Plain,
    /// How far that is played.
    Here,
}

/// Rays of a case that are drawn where none is wrong.
const EXAMPLES: usize = 16;

impl Checks {
    /// The case and the row of a cell, if that case is through.
    pub fn row(&self, cell: Cell) -> Option<(&'static Case, &Row)> {
        let case = cases::find(cell.case)?;
        let rows = &self.cases.iter().find(|row| row.id == cell.case)?.structures;
        Some((case, rows.iter().find(|row| row.id == cell.structure && row.test == cell.test)?))
    }

    /// The first cell that rays slip through.
    pub fn first_slip(&self) -> Option<Cell> {
        let rows = self.cases.iter().flat_map(|case| case.structures.iter().map(move |row| (case.id, row)));
        let slips = rows.into_iter().find(|(_, row)| row.verdict == Verdict::Warn);
        slips.map(|(case, row)| Cell { case, structure: row.id, test: row.test })
    }

    /// Forgets what was of the model before.
    pub fn opened(&mut self) {
        (self.model, self.checking) = (None, None);
        self.mark(Vec::new(), String::new());
    }

    fn mark(&mut self, marks: Vec<Mark>, caption: String) {
        (self.marked, self.marks, self.caption) = (None, marks, caption);
    }

    /// Draws a cell's wrong rays; where there is none, some of the case's, so that one sees what it is about.
    pub fn mark_case(&mut self, rays: &[Ray]) {
        let Some((_, row)) = self.selected.and_then(|cell| self.row(cell)) else { return };
        let of = |ray: &Ray, kind| Mark { ray: *ray, t: f32::INFINITY, kind };
        let wrong = row.wrong.iter().filter_map(|wrong| rays.get(wrong.ray)).map(|ray| of(ray, MarkKind::Wrong));
        let mut marks: Vec<Mark> = wrong.collect();
        let mut caption = format!(
            "{} of {} rays that {}, {} answers wrongly",
            marks.len(),
            count((row.clear_wrong + row.boundary_wrong) as u64),
            row.id,
            row.test.id()
        );
        if marks.is_empty() {
            let step = rays.len().div_ceil(EXAMPLES).max(1);
            marks.extend(rays.iter().step_by(step).filter(|ray| ray.is_valid()).map(|ray| of(ray, MarkKind::Plain)));
        }
        if marks.iter().any(|mark| mark.kind == MarkKind::Plain) {
            caption = format!("{} of the case's {} rays", marks.len(), count(rays.len() as u64));
        }
        self.mark(marks, caption);
    }

    /// Draws the rays that one of the checked structures does not answer exactly, or none.
    pub fn mark_model(&mut self, which: Option<usize>) {
        let Some((check, row)) = self.model.as_ref().and_then(|check| Some((check, check.structures.get(which?)?))) else {
            return self.mark(Vec::new(), String::new());
        };
        let mark = |ray: &crate::lab::stability::DifferingRay| {
            let kind = if ray.why.is_some() { MarkKind::Wrong } else { MarkKind::Rounded };
            Some(Mark { ray: *check.rays.get(ray.ray)?, t: ray.t, kind })
        };
        let marks: Vec<Mark> = row.differing.iter().filter_map(mark).collect();
        let all = row.wrong + row.rounded;
        let caption = match all {
            0 => format!("{}: every ray is answered exactly", row.id),
            _ => format!("{} of {} rays that {} does not answer exactly", marks.len(), count(all as u64), row.id),
        };
        self.mark(marks, caption);
        self.marked = which;
    }
}
