//! The terms of the window: each in one sentence, with its formula, what it comes to here, and where it is from.

use eframe::egui::{self, Grid, Label, RichText, ScrollArea, Ui};

use super::Commands;
use crate::accel::stats::Stats;
use crate::viewer::command::Command;
use crate::viewer::format::{count, number, or_missing, share};
use crate::viewer::state::State;
use crate::viewer::theme::{self, Palette};

/// A term.
struct Term {
    name: &'static str,
    /// What it is, in a sentence.
    what: &'static str,
    formula: &'static str,
    /// What it is of the shown structure and view.
    here: fn(&State) -> String,
    source: &'static str,
}

fn of_stats(state: &State, write: fn(&Stats) -> String) -> String {
    or_missing(state.shown.as_ref().and_then(|shown| shown.stats.as_ref()), |stats| write(stats))
}

/// The row of the selected cell.
fn selected(state: &State, write: fn(crate::accel::outline::Row) -> String) -> String {
    let row = state.tree.outline.as_ref().zip(state.tree.selected).map(|(outline, at)| outline.row(at));
    or_missing(row, write)
}

/// What rays of the view did, over how many of them.
fn per_ray(state: &State, of: fn(&crate::accel::probe::Counts) -> u64) -> String {
    let progress = state.picture.as_ref().map(|picture| picture.progress).filter(|progress| progress.counted > 0);
    or_missing(progress, |progress| format!("{} a ray", number(of(&progress.counts) as f64 / progress.counted as f64)))
}

/// All of them.
const TERMS: &[Term] = &[
    Term {
        name: "Bounding volume hierarchy",
        what: "A tree of boxes around boxes: a ray that misses a box misses everything in it.",
        formula: "box(n) = union of box(children)",
        here: |state| of_stats(state, |stats| format!("{} nodes, {} deep", count(stats.nodes), stats.max_depth)),
        source: "Kay and Kajiya 1986",
    },
    Term {
        name: "Surface area heuristic (SAH)",
        what: "The expected cost of a random line: a convex cell is met with a chance that is its area over the root's.",
        formula: crate::accel::stats::SAH_FORMULA,
        here: |state| of_stats(state, |stats| number(stats.sah)),
        source: "Goldsmith and Salmon 1987; MacDonald and Booth 1990",
    },
    Term {
        name: "SAH share",
        what: "The part of that cost that a cell and what is below it make up.",
        formula: "cost below n / cost of the whole",
        here: |state| selected(state, |row| share(row.share)),
        source: "the selected cell (F2)",
    },
    Term {
        name: "Cost of a division",
        what: "What a line through a node would cost, were its triangles divided in two.",
        formula: "C_trav + C_isect (A_l n_l + A_r n_r) / A",
        here: |state| {
            // What is hidden is told nowhere.
            let curves = state.curves.as_ref().and_then(|curves| curves.1.as_ref()).filter(|_| !super::node::hidden(state));
            or_missing(curves.and_then(|curves| curves.chosen), |chosen| number(chosen.cost))
        },
        source: "MacDonald and Booth 1990",
    },
    Term {
        name: "Binning",
        what: "Weighing only the planes between a few slices of equal width, not those between all triangles.",
        formula: "bin(c) = floor(bins (c - min) / (max - min))",
        here: |state| {
            or_missing(state.shown.as_ref().and_then(|shown| shown.key.params.get("bins")), |bins| format!("{bins} bins"))
        },
        source: "Wald 2007",
    },
    Term {
        name: "Spatial split",
        what: "Cutting a triangle's box in two, so that boxes of siblings overlap less; the triangle is then in both.",
        formula: "references / triangles",
        here: |state| {
            let triangles = state.model.as_ref().map_or(0, |model| model.geometry.stored_live());
            let references = state.shown.as_ref().and_then(|shown| shown.stats.as_ref()).map(|stats| stats.references);
            or_missing(references.filter(|_| triangles > 0), |n| number(n as f64 / triangles as f64))
        },
        source: "Stich, Friedrich and Dietrich 2009",
    },
    Term {
        name: "Overlap",
        what: "The chance that a line that meets a node meets the overlap of two of its children, and has to look into both.",
        formula: "sum over pairs of A(a and b) / sum over nodes of A(n)",
        here: |state| or_missing(state.shown.as_ref().and_then(|shown| shown.stats.as_ref()).and_then(|s| s.overlap), share),
        source: "this program",
    },
    Term {
        name: "End-point overlap (EPO)",
        what: "How much of the surface lies in nodes that do not hold it: what rays that end on surfaces pay for.",
        formula: "sum over n of C(n) area(surface in n, not below n) / area(surface)",
        here: |state| {
            let quality = state.shown.as_ref().and_then(|shown| shown.quality.as_ref());
            or_missing(quality.and_then(|quality| quality.epo), |epo| number(epo.value))
        },
        source: "Aila, Karras and Laine 2013",
    },
    Term {
        name: "Leaf",
        what: "A cell that holds triangles rather than cells.",
        formula: "a leaf is made where C_isect n is less than the cheapest division",
        here: |state| of_stats(state, |stats| format!("{}, {} of them empty", count(stats.leaves), count(stats.empty_leaves))),
        source: "MacDonald and Booth 1990",
    },
    Term {
        name: "k-d tree",
        what: "A tree of planes across the axes that divide space: cells do not overlap, and a triangle may be in several.",
        formula: "cost - bonus where one side is empty",
        here: |state| of_stats(state, |stats| format!("{} references", count(stats.references))),
        source: "Bentley 1975; Wald and Havran 2006",
    },
    Term {
        name: "Nodes a ray",
        what: "Nodes or cells that camera rays of this view enter, on average.",
        formula: "visits / rays",
        here: |state| per_ray(state, |counts| counts.nodes),
        source: "counted in this picture",
    },
    Term {
        name: "Tests a ray",
        what: "Triangles that camera rays of this view are tested against, on average.",
        formula: "tests / rays",
        here: |state| per_ray(state, |counts| counts.prims),
        source: "counted in this picture",
    },
    Term {
        name: "Watertight test",
        what: "A triangle test by which no ray slips between triangles that share an edge.",
        formula: "signs of the edge functions after a shear of the ray to +z",
        here: |state| or_missing(state.shown.as_ref(), |shown| format!("{} is used", shown.key.test.id())),
        source: "Woop, Benthin and Wald 2013",
    },
    Term {
        name: "RMSE",
        what: "The error of a picture against a reference: large errors count most.",
        formula: "sqrt(mean((v - r)^2))",
        here: |_| "in the Compare workspace (F4)".to_owned(),
        source: "docs/convergence.md",
    },
];

/// Draws the page, if it is open.
pub fn show(ui: &Ui, state: &State, commands: &mut Commands) {
    if !state.terms {
        return;
    }
    let mut open = true;
    let window = egui::Window::new("Terms").open(&mut open).collapsible(false).default_width(theme::PAGE);
    window.default_height(theme::PAGE).anchor(egui::Align2::CENTER_CENTER, egui::Vec2::ZERO).show(ui.ctx(), |ui| {
        ScrollArea::vertical().auto_shrink([false, true]).show(ui, |ui| {
            for term in TERMS {
                one(ui, state, term);
            }
        });
    });
    if !open {
        commands.push(Command::Terms(false));
    }
}

fn one(ui: &mut Ui, state: &State, term: &Term) {
    let dim = Palette::in_ui(ui).dim;
    ui.add_space(theme::GRID);
    ui.label(RichText::new(term.name).strong());
    ui.add(Label::new(term.what).wrap());
    Grid::new(term.name).num_columns(2).show(ui, |ui| {
        for (name, text) in [("Formula", term.formula.to_owned()), ("Here", (term.here)(state)), ("From", term.source.to_owned())]
        {
            ui.label(RichText::new(name).small().color(dim));
            ui.add(Label::new(RichText::new(text).small()).wrap());
            ui.end_row();
        }
    });
}
