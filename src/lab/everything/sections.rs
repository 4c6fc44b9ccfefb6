//! The sections of the page, and a line a structure for spreadsheets.

use super::html::Page;
use super::{Everything, Shown, said_of};
use crate::lab::converge;
use crate::lab::format::{bytes, count, duration, number, or_missing, percent, rate, ratio, signed_percent, spread};
use crate::lab::plot::{Curve, Panel, svg_of};
use crate::lab::prediction::{self, Agreement};
use crate::lab::tradeoffs::{Erring, TradeoffRow, front};
use crate::lab::{Metric, RayKind, StructureRow};

const KINDS: [RayKind; 3] = [RayKind::Primary, RayKind::Shadow, RayKind::Diffuse];

/// The page, or why a plot could not be drawn.
pub fn page(all: &Everything, pictures: &[Shown]) -> Result<String, String> {
    let scene = &all.report.scene;
    let about = format!(
        "{} triangles, {} dropped, {} without area; extent {}.",
        count(scene.triangles),
        count(scene.dropped),
        count(scene.degenerate),
        scene.extent.map(number).join(" x ")
    );
    let mut page = Page::new(&scene.path, &about);
    page.section("Pictures");
    pictures.iter().for_each(|shown| page.picture(&shown.png, &shown.caption));
    page.section("Used and left out");
    let row = |left: &super::LeftOut| {
        vec![left.feature.to_owned(), if left.used { "used" } else { "left out" }.to_owned(), left.why.clone()]
    };
    page.table(&["what", "", "why."], &all.left_out.iter().map(row).collect::<Vec<_>>());
    structures(&mut page, all);
    timings(&mut page, all);
    image_error(&mut page, all)?;
    intersection_error(&mut page, all)?;
    model_error(&mut page, all)?;
    stability(&mut page, all);
    page.section("Machine, seeds, commands");
    let machine = &all.report.machine;
    page.text(&format!(
        "{}, {} cores, {} threads. Times are wall-clock; the machine may have been doing other things.",
        machine.cpu, machine.cores, machine.threads
    ));
    let reference = &all.convergence.convergence.reference;
    page.text(&format!(
        "Seed 0 for pictures, {} and the next for the reference. Everything in numbers: report.json, version {}.",
        reference.seed, all.version
    ));
    page.commands(&all.commands);
    Ok(page.finish())
}

fn structures(page: &mut Page, all: &Everything) {
    page.section("Structures");
    let headers = ["structure", "build", "bytes", "B a triangle", "nodes", "leaves", "depth", "SAH cost", "EPO", "overlap"];
    let row = |row: &StructureRow| {
        let Some(b) = &row.built else {
            let why = row.error.clone().unwrap_or_default();
            return vec![row.id.clone(), why];
        };
        let quality = row.quality.as_ref();
        vec![
            row.id.clone(),
            duration(b.build_secs),
            bytes(b.bytes),
            number(b.bytes as f64 / all.report.scene.triangles.max(1) as f64),
            count(b.nodes),
            count(b.leaves),
            count(b.max_depth.into()),
            number(b.sah),
            or_missing(quality.and_then(|q| q.epo).map(|epo| epo.value), number),
            or_missing(quality.and_then(|q| q.overlap), number),
        ]
    };
    page.table(&headers, &all.report.structures.iter().map(row).collect::<Vec<_>>());
    page.text("SAH costs are comparable within one family of structures only.");
}

fn timings(page: &mut Page, all: &Everything) {
    page.section("Timings");
    page.text("Like for like: plain code, one ray at a time, the same triangle test; the same rays for all, in turns. Median and half the interquartile range.");
    let headers = ["structure", "primary", "Mrays/s", "shadow", "Mrays/s", "diffuse", "Mrays/s", "nodes/ray", "tests/ray"];
    let row = |row: &StructureRow| {
        let mut cells = vec![row.id.clone()];
        for kind in KINDS {
            let timing = row.rays.get(&kind);
            cells.push(or_missing(timing, |t| spread(t.secs_median, t.secs_half_iqr, t.rounds)));
            cells.push(or_missing(timing, |t| number(t.mrays_per_sec)));
        }
        let diffuse = row.rays.get(&RayKind::Diffuse);
        cells.push(or_missing(diffuse, |t| number(t.nodes_per_ray)));
        cells.push(or_missing(diffuse, |t| number(t.prims_per_ray)));
        cells
    };
    let built: Vec<Vec<String>> = all.report.structures.iter().filter(|row| row.built.is_some()).map(row).collect();
    page.table(&headers, &built);
    page.section("Predicted and measured");
    page.text("What the areas of cells predict of a random line that nothing cuts short, with what a node and a test cost on this machine; and what rays of each kind took on one thread. Rays that end early take less than predicted.");
    let headers =
        ["structure", "C_trav ns", "C_isect ns", "predicted ns", "primary ns", "off", "shadow ns", "off", "diffuse ns", "off"];
    let threads = all.report.machine.threads as f64;
    let row = |row: &StructureRow| {
        let costs = row.costs.as_ref();
        let mut cells = vec![
            row.id.clone(),
            or_missing(costs, |c| number(c.costs.c_trav_ns)),
            or_missing(costs, |c| number(c.costs.c_isect_ns)),
            or_missing(costs, |c| number(c.expected_ns)),
        ];
        for kind in KINDS {
            let measured = row.rays.get(&kind).map(|t| t.secs_median * 1e9 / t.rays.max(1) as f64 * threads);
            cells.push(or_missing(measured, number));
            cells.push(or_missing(costs.zip(measured), |(c, measured)| signed_percent(c.expected_ns / measured - 1.0)));
        }
        cells
    };
    let built: Vec<Vec<String>> = all.report.structures.iter().filter(|row| row.built.is_some()).map(row).collect();
    page.table(&headers, &built);
}

fn image_error(page: &mut Page, all: &Everything) -> Result<(), String> {
    let measured = &all.convergence.convergence;
    page.section("Image error");
    page.text(&format!(
        "Against a reference of {} samples a pixel, whose own noise is {:.2e}; points below 4 times that are hollow, and left out of slopes. A curve begins at the end of its build.",
        count(measured.reference.spp.into()),
        measured.reference.noise
    ));
    for (_, panel) in converge::panels(&all.convergence) {
        let caption = format!("RMSE against {}.", panel.axes[0]);
        page.plot(&svg_of(&[panel]).map_err(|error| error.to_string())?, &caption);
    }
    if measured.coincide {
        page.text("Against samples all curves coincide: to the bit, or but for counted near ties.");
    } else {
        page.warning("Against samples the curves do not coincide: a structure answers rays otherwise than rounding explains.");
    }
    let headers = [
        "structure",
        "sampler",
        "spp",
        "seconds",
        "RMSE",
        "relMSE",
        "slope",
        "95 %",
        "1/(MSE s)",
        "rays/s",
        "tracing",
        "shading",
        "rest",
    ];
    let row = |curve: &crate::lab::converge::Curve| {
        let last = curve.points.last();
        let slope = curve.slope;
        let [tracing, shading, rest] = curve.shares.map(percent);
        vec![
            curve.structure.clone(),
            curve.sampler.id().to_owned(),
            or_missing(last, |p| count(p.spp.into())),
            or_missing(last, |p| duration(p.secs)),
            or_missing(last, |p| format!("{:.3e}", p.errors.rmse)),
            or_missing(last, |p| format!("{:.3e}", p.errors.relmse)),
            or_missing(slope, |s| format!("{:.3}", s.value)),
            or_missing(slope, |s| format!("{:.3} to {:.3}", s.low, s.high)),
            or_missing(curve.efficiency, number),
            rate(curve.rays_per_sec),
            tracing,
            shading,
            rest,
        ]
    };
    page.table(&headers, &measured.curves.iter().map(row).collect::<Vec<_>>());
    let formulas: Vec<Vec<String>> =
        Metric::ALL[..4].iter().map(|metric| vec![metric.label().to_owned(), metric.formula().to_owned()]).collect();
    page.table(&["measure", "formula."], &formulas);
    if !measured.tables.break_even.is_empty() {
        page.text("From when on a structure that is built more slowly and traces faster is ahead, build and all:");
        let row = |b: &crate::lab::converge::BreakEven| {
            vec![b.better.clone(), b.quick.clone(), number(b.rays), number(b.spp), duration(b.secs)]
        };
        let rows: Vec<Vec<String>> = measured.tables.break_even.iter().map(row).collect();
        page.table(&["better", "than", "after rays", "samples", "seconds"], &rows);
    }
    Ok(())
}

/// Points that nobody beats at both are joined.
fn pareto(title: &str, axes: [&'static str; 2], points: Vec<(String, String, (f64, f64))>) -> Panel {
    let at: Vec<(f64, f64)> = points.iter().map(|point| point.2).collect();
    let mut best: Vec<(f64, f64)> = at.iter().zip(front(&at)).filter(|(_, best)| *best).map(|(at, _)| *at).collect();
    best.sort_by(|a, b| a.0.total_cmp(&b.0));
    let front = Curve { name: String::new(), dash: 1, ..Curve::of("", best) };
    let point = |(id, name, at): (String, String, (f64, f64))| Curve { name, ..Curve::of(&id, [at]) };
    let curves = std::iter::once(front).chain(points.into_iter().map(point)).collect();
    Panel { title: title.to_owned(), axes, curves, labelled: true, ..Panel::default() }
}

fn intersection_error(page: &mut Page, all: &Everything) -> Result<(), String> {
    page.section("Intersection error");
    page.text("Rays to the corners and the middles of edges of what is seen, judged by exact arithmetic. Wrong answers are those that no rounding explains, or rays that slipped through a closed surface; rounded ones meet another triangle than they do exactly, or none. t is compared with that of the exact test. Tests of boxes are those of a plain tree of the boxes of bvh, with the watertight test of triangles.");
    let mut tests: Vec<(&str, String, &str, &Erring)> = Vec::new();
    for row in &all.tradeoffs {
        tests.extend(row.tests.iter().map(|test| (&row.structure[..], row.name.clone(), test.test.id(), &test.erring)));
        tests.extend(row.boxes.iter().map(|test| (&row.structure[..], "boxes".to_owned(), test.test.id(), &test.erring)));
    }
    let points = |of: fn(&Erring) -> f64| {
        let point = |(structure, name, test, erring): &(&str, String, &str, &Erring)| {
            // What is nothing has no logarithm.
            let error = of(erring);
            let drawn = if error.is_nan() { error } else { error.max(0.1) };
            ((*structure).to_owned(), format!("{name} {test}"), (erring.ns, drawn))
        };
        tests.iter().map(point).collect::<Vec<_>>()
    };
    let wrong = pareto("Wrong answers", ["ns a hard ray", "in a million (0 is drawn at 0.1)"], points(|t| t.wrong_per_million));
    let rounded = pareto(
        "Answers that rounding decides",
        ["ns a hard ray", "in a million (0 is drawn at 0.1)"],
        points(|t| t.rounded_per_million),
    );
    let ulps =
        pareto("Error of t", ["ns a hard ray", "ulps, one hit in a thousand (0 is drawn at 0.1)"], points(|t| t.p999_ulps));
    for panel in [wrong, rounded, ulps] {
        let caption = format!("{}: those joined are beaten by nobody at both.", panel.title);
        page.plot(&svg_of(&[panel]).map_err(|error| error.to_string())?, &caption);
    }
    let cells = |(_, name, test, erring): &(&str, String, &str, &Erring)| {
        let numbers = [erring.ns, erring.wrong_per_million, erring.rounded_per_million, erring.p999_ulps].map(number);
        [vec![name.clone(), (*test).to_owned(), count(erring.rays as u64)], numbers.into()].concat()
    };
    let headers = ["structure", "test", "rays", "ns/ray", "wrong per million", "rounded per million", "ulps of t"];
    page.table(&headers, &tests.iter().map(cells).collect::<Vec<_>>());
    Ok(())
}

fn model_error(page: &mut Page, all: &Everything) -> Result<(), String> {
    page.section("Model error");
    let points = |of: &dyn Fn(&TradeoffRow) -> Option<f64>| {
        let row = |row| Some((of(row)?, row));
        let rows = all.tradeoffs.iter().filter_map(row);
        rows.map(|(y, row)| (row.structure.clone(), row.name.clone(), (row.build_secs, y))).collect::<Vec<_>>()
    };
    let measured =
        pareto("Measured", ["seconds of the build", "ns a diffuse ray"], points(&|row| row.ns.get(&RayKind::Diffuse).copied()));
    let sah = pareto("Predicted", ["seconds of the build", "ns a random line"], points(&|row| row.predicted_ns));
    for panel in [measured, sah] {
        let caption = format!("{} cost against the time of the build: those joined are beaten by nobody at both.", panel.title);
        page.plot(&svg_of(&[panel]).map_err(|error| error.to_string())?, &caption);
    }
    agreement(page, &all.tradeoffs)?;
    let headers = [
        "structure",
        "build",
        "SAH cost",
        "EPO",
        "predicted ns",
        "lines ns",
        "off",
        "primary ns",
        "off",
        "shadow ns",
        "off",
        "diffuse ns",
        "off",
    ];
    let row = |row: &TradeoffRow| {
        if let Some(error) = &row.error {
            return vec![row.name.clone(), error.clone()];
        }
        let mut cells = vec![
            row.name.clone(),
            duration(row.build_secs),
            number(row.sah),
            or_missing(row.epo, number),
            or_missing(row.predicted_ns, number),
        ];
        for kind in prediction::KINDS {
            cells.push(or_missing(row.ns.get(&kind).copied(), number));
            cells.push(or_missing(row.prediction_error(kind), signed_percent));
        }
        cells
    };
    page.table(&headers, &all.tradeoffs.iter().map(row).collect::<Vec<_>>());
    Ok(())
}

/// Predicted against measured, and by how much that is off.
fn agreement(page: &mut Page, rows: &[TradeoffRow]) -> Result<(), String> {
    let points = prediction::points(rows);
    if let Some(all) = Agreement::of(&points) {
        let panel = prediction::plot::panel(rows, "Predicted against measured".to_owned());
        let caption = "A mark for each structure and kind of ray. Predicted is what the areas of cells promise a random line that nothing cuts short, with what a node and a test cost, fitted to rays of all four kinds that were timed and counted in the same structure: rays that end early take less. Measured is the time of all threads together, times their number, over the rays, while costs are fitted to one thread with the others idle: where threads share cores, or the machine has other work, all marks may lie above the line for that alone.";
        page.plot(&svg_of(&[panel]).map_err(|error| error.to_string())?, caption);
        let kind = |kind: RayKind| {
            let of = Agreement::of(points.iter().filter(|point| point.kind == kind))?;
            Some(format!("{} {}", kind.id(), ratio(of.factor)))
        };
        let kinds: Vec<String> = prediction::KINDS.into_iter().filter_map(kind).collect();
        page.text(&format!(
            "Predicted and measured differ by {} in the geometric mean of {} marks ({}); the correlation of their logarithms is {}. A prediction took {} in the mean.",
            ratio(all.factor),
            count(all.points as u64),
            kinds.join(", "),
            number(all.correlation),
            or_missing(prediction::cost(rows), duration)
        ));
    }
    for missing in prediction::missing(rows) {
        page.text(&format!("Not among them: {missing}"));
    }
    Ok(())
}

fn stability(page: &mut Page, all: &Everything) {
    page.section("Stability");
    let mesh = &all.check.mesh;
    page.text(&format!(
        "Surface: {}. {} slivers, worst aspect {}; {} copies; {} open edges.",
        mesh.surface(),
        count(mesh.slivers),
        number(mesh.worst_aspect),
        count(mesh.duplicates),
        count(mesh.boundary_edges)
    ));
    for (grave, said) in said_of(mesh) {
        if grave { page.warning(&said) } else { page.text(&said) }
    }
    page.text("Rays of the view, and diffuse ones from what it sees, held against exact arithmetic:");
    let rows: Vec<Vec<String>> = all
        .check
        .structures
        .iter()
        .map(|row| {
            let counts = [row.rays, row.rounded, row.wrong].map(|n| count(n as u64));
            [row.id.clone(), row.test.id().to_owned()].into_iter().chain(counts).collect()
        })
        .collect();
    page.table(&["structure", "test", "rays", "rounded", "wrong"], &rows);
}

/// A line a structure.
pub fn csv(all: &Everything) -> String {
    let mut out =
        "structure,build_secs,bytes,nodes,depth,sah,epo,primary_mrays,shadow_mrays,diffuse_mrays,predicted_ns\n".to_owned();
    for row in &all.report.structures {
        let Some(b) = &row.built else { continue };
        let some = |x: Option<f64>| x.map_or_else(String::new, |x| x.to_string());
        let rays = KINDS.map(|kind| some(row.rays.get(&kind).map(|t| t.mrays_per_sec))).join(",");
        let epo = some(row.quality.as_ref().and_then(|q| q.epo).map(|epo| epo.value));
        let predicted = some(row.costs.as_ref().map(|c| c.expected_ns));
        out +=
            &format!("{},{},{},{},{},{},{epo},{rays},{predicted}\n", row.id, b.build_secs, b.bytes, b.nodes, b.max_depth, b.sah);
    }
    out
}
