//! What `stats` and `compare` say of quality: predicted, counted, and what steps and tests cost here.

use super::args::{Size, share};
use super::bar;
use super::context::Context;
use super::failure::Failure;
use super::table::Table;
use crate::accel::epo;
use crate::accel::stats::SAH_FORMULA;
use crate::lab::format::{MISSING, number, or_missing, percent};
use crate::lab::{
    Contestant, CostRow, Enough, FitOptions, Quality, QualityOptions, RaySet, Report, StructureRow, built, fit_costs,
};
use crate::task::{Charge, Progress};

#[derive(Debug, clap::Args)]
pub struct QualityArgs {
    /// The weight of end-point overlap (EPO) in the blend (1 - ALPHA) SAH + ALPHA EPO.
    #[arg(long, value_name = "ALPHA", default_value_t = epo::ALPHA, value_parser = share)]
    alpha: f64,
    /// Triangles looked at for end-point overlap; of more, points spread over the surface are taken.
    #[arg(long, value_name = "N", default_value_t = epo::MOST as u64, value_parser = clap::value_parser!(u64).range(2..))]
    epo_sample: u64,
    /// Fit what a step and a test cost on this machine to timed and counted rays.
    #[arg(long)]
    pub fit_costs: bool,
}

/// The picture whose rays costs are fitted to where no other is asked for.
pub const SIZE: Size = Size { width: 640, height: 400 };

impl QualityArgs {
    /// What to find out; what takes more than a walk over the cells only if `deep`.
    pub fn options(&self, deep: bool) -> QualityOptions {
        let most = crate::geometry::num::floor_index(self.epo_sample as f64, usize::MAX);
        QualityOptions { alpha: self.alpha, epo_most: deep.then_some(most), lines: deep.then(Enough::default) }
    }
}

/// Fits the costs of each contestant and puts them into the row of its name.
pub fn fit(
    contestants: &[Contestant],
    sets: &[(RaySet, Charge)],
    rows: &mut [StructureRow],
    cx: &Context,
) -> Result<(), Failure> {
    let sets: Vec<&RaySet> = sets.iter().map(|(set, _)| set).collect();
    let progress = Progress::new();
    let fit = || fit_costs(contestants, &sets, &FitOptions::default(), &cx.pool, &cx.cancel, &progress);
    let fitted = bar::watch("fit costs", &progress, fit)?;
    for (row, costs) in built(rows).zip(fitted) {
        row.costs = costs.zip(row.quality.as_ref()).map(|(costs, quality)| CostRow::of(costs, quality));
    }
    Ok(())
}

/// A table of quality, and one of costs if they were fitted.
pub fn text(report: &Report) -> String {
    let rows: Vec<(&StructureRow, &Quality)> =
        report.structures.iter().filter_map(|row| Some((row, row.quality.as_ref()?))).collect();
    let fitted = report.structures.iter().any(|row| row.costs.is_some());
    qualities(report, &rows) + &if fitted { costs(report) } else { String::new() }
}

fn qualities(report: &Report, rows: &[(&StructureRow, &Quality)]) -> String {
    let Some((_, first)) = rows.first() else { return String::new() };
    let deep = first.lines.is_some();
    let mut headers = vec!["structure", "overlap", "empty", "refs/tri", "nodes/line", "tests/line"];
    let blend = format!("blend {}", number(first.alpha));
    if deep {
        headers.extend(["counted nodes", "±", "counted tests", "±", "EPO", "±", &blend]);
    }
    let (mut table, mut notes) = (Table::new(&headers), String::new());
    for (row, quality) in rows {
        table.row(cells(report.label(row), quality, deep));
        if let Some(why) = &quality.epo_missing {
            notes += &format!("{}: no EPO: {why}\n", report.label(row));
        }
    }
    table.render() + &notes + &legend(deep)
}

fn cells(label: String, quality: &Quality, deep: bool) -> Vec<String> {
    let mut cells = vec![
        label,
        or_missing(quality.overlap, number),
        or_missing(quality.empty_volume, percent),
        or_missing(quality.duplication, number),
        number(quality.expected_nodes),
        number(quality.expected_tests),
    ];
    if deep {
        let lines = quality.lines.filter(|lines| lines.lines > 0);
        let counted =
            [lines.map(|l| l.nodes), lines.map(|l| l.nodes_error), lines.map(|l| l.tests), lines.map(|l| l.tests_error)];
        let epo = [quality.epo.map(|epo| epo.value), quality.epo.map(|epo| epo.error), quality.blend];
        cells.extend(counted.into_iter().chain(epo).map(|value| or_missing(value, number)));
    }
    cells
}

/// The formulas.
fn legend(deep: bool) -> String {
    let mut text = format!(
        "SAH = {SAH_FORMULA}.\n\
         nodes/line = sum over nodes of A(n)/A(root), tests/line = sum over leaves of prims A(n)/A(root): expected of a random line.\n\
         overlap = sum over pairs of siblings of A(a and b) / sum over inner nodes of A(n). empty = 1 - volume of leaves/root.\n"
    );
    if deep {
        text += "counted: random lines that nothing cuts short, ± the standard error.\n\
                 EPO = sum over nodes of C(n) area(surface in n from outside its subtree)/area(surface); \
                 blend = (1 - alpha) SAH + alpha EPO.\n";
    }
    text
}

fn costs(report: &Report) -> String {
    let headers = ["structure", "C_trav ns", "±", "C_isect ns", "±", "C_0 ns", "±", "R²", "C_isect/C_trav", "expected ns/line"];
    let mut table = Table::new(&headers);
    for row in report.structures.iter().filter(|row| row.built.is_some()) {
        let mut cells = vec![report.label(row)];
        match &row.costs {
            Some(CostRow { costs: c, ratio, expected_ns }) => {
                let fitted = [c.c_trav_ns, c.c_trav_error_ns, c.c_isect_ns, c.c_isect_error_ns, c.c0_ns, c.c0_error_ns];
                cells.extend(fitted.into_iter().chain([c.r_squared]).map(number));
                cells.extend([or_missing(*ratio, number), number(*expected_ns)]);
            }
            None => cells.resize(headers.len(), MISSING.to_owned()),
        }
        table.row(cells);
    }
    let legend =
        "ns of a ray on one thread = C_trav nodes + C_isect tests + C_0, least squares over blocks of rays, none negative.\n";
    format!("\n{}{legend}", table.render())
}
