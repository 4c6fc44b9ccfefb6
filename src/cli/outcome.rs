//! The table of a race: one line for each structure, and one for the rasteriser.

use super::table::Table;
use crate::lab::format::{MISSING, count, number, or_missing, ratio};
use crate::lab::{Quality, RasterRow, Timing, is_tie};

const HEADERS: [&str; 12] =
    ["structure", "ms", "±", "rounds", "Mrays/s", "time", "hits", "nodes/ray", "expected", "tests/ray", "expected", "LCV"];

/// The table, why some traced fewer rays, and what was rasterised.
pub fn table(rows: &[(Timing, Quality)], raster: Option<&RasterRow>) -> String {
    // Times are told against the fastest structure, whoever else takes part.
    let fastest = rows.iter().map(|(timing, _)| timing).max_by(|a, b| a.mrays_per_sec.total_cmp(&b.mrays_per_sec));
    let mut table = Table::new(&HEADERS);
    let mut notes = String::new();
    for (row, quality) in rows {
        table.row(cells(row, Some(quality), fastest));
        if let Some(why) = &row.capped {
            notes += &format!("{}: {why}\n", row.id);
        }
    }
    if let Some(raster) = raster {
        table.row(cells(&raster.timing(), None, fastest));
        notes += &drawn(raster);
    }
    table.render() + &notes
}

fn cells(row: &Timing, quality: Option<&Quality>, fastest: Option<&Timing>) -> Vec<String> {
    let time = match fastest {
        Some(best) if best.id == row.id => "fastest".to_owned(),
        Some(best) if is_tie(best, row) => "tie".to_owned(),
        Some(best) => ratio(best.mrays_per_sec / row.mrays_per_sec),
        None => MISSING.to_owned(),
    };
    vec![
        row.id.clone(),
        number(row.secs_median * 1e3),
        number(row.secs_half_iqr * 1e3),
        count(row.rounds as u64),
        number(row.mrays_per_sec),
        time,
        count(row.hits),
        number(row.nodes_per_ray),
        or_missing(quality, |q| number(q.expected_nodes)),
        number(row.prims_per_ray),
        or_missing(quality, |q| number(q.expected_tests)),
        number(row.lcv),
    ]
}

/// What the rasteriser did, and how its picture compares with the traced one.
fn drawn(row: &RasterRow) -> String {
    let [covered, set_up, culled] = [row.covered, row.set_up, row.culled].map(count);
    let overdraw = number(row.overdraw);
    let [edge, other] = [row.differing.edge, row.differing.other].map(count);
    let others = if row.differing.other > 0 { format!(", {other} others differ") } else { String::new() };
    format!(
        "raster: {covered} pixels covered by {set_up} triangles ({culled} culled), overdraw {overdraw}; \
         {edge} edge pixels differ from the traced picture{others}.\n"
    )
}
