//! The tables for people.

use super::{Outcome, Run};
use crate::cli::table::{Table, facts};
use crate::lab::RayKind;
use crate::lab::format::{MISSING, count, number, or_missing};
use crate::lab::peers::{PeerRow, RayRow};

pub fn text(outcome: &Outcome) -> String {
    let (scene, machine) = (&outcome.scene, &outcome.machine);
    let [width, height] = outcome.size;
    let mut lines = vec![
        ("model", format!("{}: {} triangles", scene.path, count(scene.triangles))),
        ("machine", format!("{}, {} cores", machine.cpu, machine.cores)),
        ("rays", format!("of {width}x{height} pixels, order {}", outcome.order)),
    ];
    lines.extend(outcome.missing.iter().map(|why| ("left out", why.clone())));
    let mut out = facts(&lines);
    for run in &outcome.runs {
        let rows: Vec<&PeerRow> = outcome.structures.iter().filter(|row| row.threads == run.threads).collect();
        out += &format!("\n{} thread{}, Mrays/s\n", run.threads, if run.threads == 1 { "" } else { "s" });
        out += &table(&rows, outcome.scene.triangles);
        out += &format!("\n{}", ratios(run));
    }
    out + "\nbuild ms and Mrays/s are medians over rounds, ± half the interquartile range. differing: rays, of all sets, with\n\
           another hit than our watertight bvh, which equals brute force. ratios: our best over the best peer's; build: the\n\
           peer's seconds over ours where ours traces no fewer diffuse rays a second, the least over all peers.\n"
}

fn table(rows: &[&PeerRow], triangles: u64) -> String {
    let kinds: Vec<RayKind> =
        RayKind::ALL.into_iter().filter(|kind| rows.iter().any(|row| row.rays.contains_key(kind))).collect();
    let mut headers = vec!["structure", "library", "test", "call", "build ms", "±", "bytes/tri"];
    headers.extend(kinds.iter().flat_map(|kind| [kind.id(), "±"]));
    headers.push("differing");
    let mut table = Table::new(&headers);
    let mut notes = String::new();
    for row in rows {
        let mut cells = vec![row.id.clone(), row.library.clone(), row.test.to_owned(), row.call.id().to_owned()];
        let per_triangle = row.bytes.map(|bytes| bytes as f64 / triangles.max(1) as f64);
        cells.push(or_missing(row.build.as_ref(), |build| number(build.median * 1e3)));
        cells.push(or_missing(row.build.as_ref(), |build| number(build.half_iqr * 1e3)));
        cells.push(or_missing(per_triangle.as_ref(), |bytes| number(*bytes)));
        for kind in &kinds {
            cells.extend(rate(row.rays.get(kind)));
            notes += &capped(row, *kind);
        }
        cells.push(if row.rays.is_empty() { MISSING.to_owned() } else { count(row.differing_rays) });
        table.row(cells);
    }
    for row in rows.iter().filter(|row| row.error.is_some()) {
        let line = format!("{} is not there: {}\n", row.id, row.error.as_deref().unwrap_or_default());
        notes += if notes.ends_with(&line) { "" } else { &line };
    }
    table.render() + &notes
}

/// Rays a second, and by how much the rounds differ.
fn rate(row: Option<&RayRow>) -> [String; 2] {
    let Some(row) = row else { return [MISSING.to_owned(), MISSING.to_owned()] };
    [number(row.mrays_per_sec), number(row.mrays_per_sec * row.secs_spread / row.secs)]
}

fn capped(row: &PeerRow, kind: RayKind) -> String {
    match row.rays.get(&kind) {
        Some(timed) if timed.count < timed.of => {
            let (part, of) = (count(timed.count as u64), count(timed.of as u64));
            format!("{} {}: {part} of {of} {} rays, spread evenly\n", row.id, row.call.id(), kind.id())
        }
        _ => String::new(),
    }
}

fn ratios(run: &Run) -> String {
    let all = [("ratios", &run.ratios), ("ratios, watertight", &run.ratios_watertight)];
    let names: Vec<&str> = run.ratios.named().iter().map(|(name, _)| *name).collect();
    let mut table = Table::new(&[&["ours over the best peer's"][..], &names].concat());
    for (title, ratios) in all {
        let cells = ratios.named().map(|(_, ratio)| or_missing(ratio.as_ref(), |ratio| number(*ratio)));
        table.row([title.to_owned()].into_iter().chain(cells).collect());
    }
    let mut out = table.render();
    for (title, ratios) in all {
        let of = |(peer, ratio): (&String, &Option<f64>)| format!("{peer} {}", or_missing(ratio.as_ref(), |r| number(*r)));
        let peers: Vec<String> = ratios.build_against.iter().map(of).collect();
        if !peers.is_empty() {
            out += &format!("{title}, build against: {}\n", peers.join(", "));
        }
    }
    out
}
