//! What `converge` says to people.

use std::path::Path;

use super::Outcome;
use crate::cli::table::{Table, facts};
use crate::lab::Metric;
use crate::lab::converge::{Convergence, Curve, StructureAgreement, Tables};
use crate::lab::format::{count, duration, number, or_missing, percent, rate};

/// Everything; what is drawn and written is in that folder.
pub fn of(folder: &Path, outcome: &Outcome) -> String {
    let Convergence { curves, coincide, agreements, tables, .. } = &outcome.convergence;
    let verdict = if *coincide { "coincide" } else { "DO NOT coincide" };
    let flip = curves.iter().flat_map(|c| &c.points).any(|p| p.errors.flip.is_some());
    let metrics = Metric::ALL.into_iter().filter(|metric| flip || *metric != Metric::Flip);
    let formulas: String = metrics.map(|metric| format!("{}: {}\n", metric.label(), metric.formula())).collect();
    format!(
        "{}\n{}\n{}\nAgainst samples all curves {verdict}.\n{}\nAt the same time, and at the same error:\n{}{}\n{formulas}\
         Over all pixels and red, green and blue of linear light, black where nothing is. Plots and data: {}\n",
        head(outcome),
        errors(curves),
        speeds(curves, outcome.size),
        same(agreements),
        equal(curves, tables),
        break_evens(tables),
        folder.display()
    )
}

fn head(outcome: &Outcome) -> String {
    let (reference, machine) = (&outcome.convergence.reference, &outcome.machine);
    let [width, height] = outcome.size;
    let sure = format!("{} spp, noise {:.2e}", count(reference.spp.into()), reference.noise);
    let mut lines = vec![
        ("model", format!("{}: {} triangles, {width}x{height}", outcome.scene.path, count(outcome.scene.triangles))),
        ("machine", format!("{}, {} cores, {} threads", machine.cpu, machine.cores, machine.threads)),
        ("reference", format!("{sure}; points below 4 times that are hollow, and left out of slopes")),
        ("samples", format!("seed {}, {} runs in turns", outcome.seed, outcome.runs)),
    ];
    if outcome.adaptive {
        lines.push(("adaptive", "converged pixels got no more samples: every error is that of a biased picture".to_owned()));
    }
    if let Some(most) = outcome.transport.clamp {
        lines.push(("clamped", format!("light over two and more surfaces to {most} a sample, in the reference too")));
    }
    facts(&lines)
}

/// An error.
fn error(x: f64) -> String {
    format!("{x:.3e}")
}

fn errors(curves: &[Curve]) -> String {
    let figures = ["RMSE", "relMSE", "MAE", "SMAPE", "FLIP", "slope", "95 %", "1/(MSE s)"];
    let mut table = Table::new(&[&["structure", "sampler", "build", "spp", "seconds", "min", "max"][..], &figures].concat());
    for curve in curves {
        let Some(last) = curve.points.last() else { continue };
        let [secs, min, max] = [last.secs, last.secs_min, last.secs_max].map(duration);
        let [rmse, relmse, mae, smape] = [last.errors.rmse, last.errors.relmse, last.errors.mae, last.errors.smape].map(error);
        table.row(vec![
            curve.structure.clone(),
            curve.sampler.id().to_owned(),
            duration(curve.build_secs),
            last.spp.to_string(),
            secs,
            min,
            max,
            rmse,
            relmse,
            mae,
            smape,
            or_missing(last.errors.flip, |flip| format!("{flip:.3}")),
            or_missing(curve.slope, |slope| format!("{:.3}", slope.value)),
            or_missing(curve.slope, |slope| format!("{:.3} to {:.3}", slope.low, slope.high)),
            or_missing(curve.efficiency, number),
        ]);
    }
    table.render()
}

fn speeds(curves: &[Curve], [width, height]: [u32; 2]) -> String {
    let pixels = f64::from(width) * f64::from(height);
    let mut table = Table::new(&["structure", "sampler", "rays/s", "rays/sample", "tracing", "shading", "the rest"]);
    for curve in curves {
        let figures = [rate(curve.rays_per_sec), number(curve.rays_per_sample / pixels)];
        let names = [curve.structure.clone(), curve.sampler.id().to_owned()];
        table.row(names.into_iter().chain(figures).chain(curve.shares.map(percent)).collect());
    }
    table.render()
}

fn same(agreements: &[StructureAgreement]) -> String {
    let mut table = Table::new(&["structure", "same as the first", "pixels", "RMSE by", "rays", "near ties", "wrong"]);
    for a in agreements {
        let verdict = match (a.identical, a.coincides) {
            (true, _) => "to the bit",
            (false, true) => "but for near ties",
            (false, false) => "NO",
        };
        let counts = [a.rays.rays, a.rays.near_ties, a.rays.wrong].map(count);
        let head = [a.structure.clone(), verdict.to_owned(), count(a.pixels), percent(a.rmse_difference)];
        table.row(head.into_iter().chain(counts).collect());
    }
    table.render()
}

fn equal(curves: &[Curve], tables: &Tables) -> String {
    let mut table = Table::new(&["structure", "sampler", "at", "RMSE", "down to", "takes", "with the build"]);
    for curve in curves {
        let its = |structure: &str, sampler| (structure, sampler) == (curve.structure.as_str(), curve.sampler);
        let at_time = tables.equal_time.iter().find(|row| its(&row.structure, row.sampler));
        let at_error = tables.equal_error.iter().find(|row| its(&row.structure, row.sampler));
        table.row(vec![
            curve.structure.clone(),
            curve.sampler.id().to_owned(),
            or_missing(at_time, |row| duration(row.secs)),
            or_missing(at_time, |row| error(row.rmse)),
            or_missing(at_error, |row| error(row.rmse)),
            or_missing(at_error, |row| duration(row.secs)),
            or_missing(at_error, |row| duration(row.secs_with_build)),
        ]);
    }
    table.render()
}

/// Nothing where no slower build pays.
fn break_evens(tables: &Tables) -> String {
    if tables.break_even.is_empty() {
        return String::new();
    }
    let mut table = Table::new(&["better", "than", "after rays", "samples", "seconds"]);
    for b in &tables.break_even {
        table.row(vec![b.better.clone(), b.quick.clone(), number(b.rays), number(b.spp), duration(b.secs)]);
    }
    format!("\nFrom when on a slower build pays, build and all:\n{}", table.render())
}
