//! `boxwood stability`: structures and triangle tests on scenes that break ray tracers, against exact arithmetic.

use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::str::FromStr;

use serde::Serialize;

use super::args::{MachineArgs, seconds};
use super::bar;
use super::context::Context;
use super::failure::Failure;
use super::npy;
use super::output::{OutFile, print, print_json};
use super::structures::{Many, each_once};
use super::table::{Table, facts};
use crate::accel::registry;
use crate::geometry::tri::TestKind;
use crate::lab::MachineFacts;
use crate::lab::format::{count, number, percent};
use crate::lab::plot::{Curve, Panel, svg_of};
use crate::lab::stability::cases::{self, Case, Trial};
use crate::lab::stability::{BoxRow, BoxTest, CaseRow, Options, Row, TestPrice, Verdict, check, check_case, prices, shrink};
use crate::scene::Reason;
use crate::task::{Cancel, Progress};

#[derive(Debug, clap::Args)]
pub struct Args {
    #[command(flatten)]
    machine: MachineArgs,
    /// The cases: ids between commas, or all.
    #[arg(long, value_name = "all|ID,ID", default_value = "all")]
    cases: Chosen,
    /// The structures: ids between commas, or all.
    #[arg(long, value_name = "all|ID,ID", default_value = "all")]
    structures: Many,
    /// The triangle tests, as far as a structure has them: ids between commas, or all. double and baldwin-weber stand in
    /// brute alone.
    #[arg(long, value_name = "all|ID,ID", default_value = "all")]
    tests: Tests,
    /// Makes scenes and rays: the same for the same number.
    #[arg(long, value_name = "S", default_value_t = 1)]
    seed: u64,
    /// About so many rays a case.
    #[arg(long, value_name = "N", default_value_t = 2000, value_parser = clap::value_parser!(u32).range(1..))]
    rays: u32,
    /// The least seconds timed of each structure with each test.
    #[arg(long, default_value = "0.01", value_parser = seconds)]
    secs: f64,
    /// A folder to write to: report.json, error-time.svg, and for each check that failed the smallest scene and the ray
    /// that still fail (.obj, .npy).
    #[arg(short, long, value_name = "DIR")]
    output: Option<PathBuf>,
    /// Print one JSON object.
    #[arg(long)]
    json: bool,
}

/// Cases by id.
#[derive(Clone, Debug)]
struct Chosen(Vec<&'static Case>);

impl FromStr for Chosen {
    type Err = String;

    fn from_str(s: &str) -> Result<Self, String> {
        if s == "all" {
            return Ok(Self(cases::ALL.iter().collect()));
        }
        let ids = || cases::ALL.iter().map(|case| case.id).collect::<Vec<_>>().join(", ");
        let find = |id: &str| cases::find(id.trim()).ok_or_else(|| format!("there is no case '{id}'; there are {}", ids()));
        s.split(',').map(find).collect::<Result<_, _>>().map(Self)
    }
}

/// Tests by id.
#[derive(Clone, Debug)]
struct Tests(Vec<TestKind>);

impl FromStr for Tests {
    type Err = String;

    fn from_str(s: &str) -> Result<Self, String> {
        if s == "all" {
            return Ok(Self(TestKind::ALL.into_iter().chain(TestKind::OTHERS).collect()));
        }
        s.split(',').map(|id| id.trim().parse()).collect::<Result<_, _>>().map(|tests| Self(each_once(tests)))
    }
}

/// What is printed as JSON.
#[derive(Serialize)]
struct Outcome {
    seed: u64,
    machine: MachineFacts,
    /// What the triangle tests cost by themselves.
    tests: Vec<TestPrice>,
    cases: Vec<CaseRow>,
}

pub fn run(args: &Args, cancel: Cancel) -> Result<(), Failure> {
    let (Chosen(chosen), Many(structures), Tests(tests)) = (&args.cases, &args.structures, &args.tests);
    let cx = Context::new(args.machine, cancel);
    // What can't be written to is told before the long work.
    if let Some(folder) = &args.output {
        std::fs::create_dir_all(folder).map_err(|error| Failure::of_output(folder, &error))?;
    }
    let options = Options {
        seed: args.seed,
        rays: args.rays as usize,
        structures: structures.clone(),
        tests: tests.clone(),
        secs: args.secs,
    };
    if options.pairs().next().is_none() {
        return Err(Failure::Input(NO_PAIR.to_owned()));
    }
    let progress = Progress::new();
    progress.start("cases", (chosen.len() * options.pairs().count()) as u64);
    let check = |case: &&'static Case| {
        check_case(case, &options, &cx.build_cx(), &|| progress.advance(1)).map_err(|reason| Failure::from(reason.of(case.id)))
    };
    let cases = bar::watch("stability", &progress, || chosen.iter().map(check).collect::<Result<Vec<_>, _>>())?;
    let outcome = Outcome { seed: args.seed, machine: cx.machine(), tests: prices(&cx.cancel)?, cases };
    if let Some(folder) = &args.output {
        write(folder, &outcome, &options, &cx)?;
    }
    if args.json { print_json(&outcome) } else { print(&text(&outcome)) }?;
    let failed = outcome.cases.iter().flat_map(|case| &case.structures).filter(|row| row.verdict == Verdict::Fail).count();
    if failed == 0 { Ok(()) } else { Err(Failure::Other(anyhow::anyhow!("{failed} of the checks failed"))) }
}

/// Writes everything into the folder.
fn write(folder: &Path, outcome: &Outcome, options: &Options, cx: &Context) -> Result<(), Failure> {
    let report = serde_json::to_vec_pretty(outcome).map_err(|error| Failure::Other(error.into()))?;
    OutFile::at(&folder.join("report.json"))?.write(&cx.cancel, |out| out.write_all(&report))?;
    let svg = svg_of(&[panel(outcome)]).map_err(|error| Failure::Other(anyhow::anyhow!("{error}")))?;
    OutFile::at(&folder.join("error-time.svg"))?.write(&cx.cancel, |out| out.write_all(svg.as_bytes()))?;
    for case in &outcome.cases {
        for row in case.structures.iter().filter(|row| row.verdict == Verdict::Fail) {
            reproduce(folder, case.id, row, options, cx)?;
        }
    }
    Ok(())
}

/// Writes the smallest scene in which the first wrong ray of a row is still answered wrongly, and the ray.
fn reproduce(folder: &Path, id: &str, row: &Row, options: &Options, cx: &Context) -> Result<(), Failure> {
    let (Some(case), Some(entry), Some(wrong)) = (cases::find(id), registry::find(row.id), row.wrong.first()) else {
        return Ok(());
    };
    let mut trial = case.trial(options.seed, options.rays);
    trial.rays = vec![trial.rays[wrong.ray]];
    let name = format!("{id}-{}-{}", row.id, row.test.id());
    let of = |reason: Reason| Failure::from(reason.of(id));
    let fails = |trial: &Trial| Ok(check(trial, entry, row.test, &cx.build_cx())?.is_some());
    // An answer that depends on the other rays of its batch does not show with one ray alone: then all is kept.
    let smallest = || if fails(&trial)? { shrink(trial.clone(), &fails) } else { Ok(trial.clone()) };
    let small = bar::watch(&format!("shrink {name}"), &Progress::new(), || smallest().map_err(of))?;
    let obj = folder.join(format!("{name}.obj"));
    OutFile::at(&obj)?.write(&cx.cancel, |out| write_obj(out, &small, &format!("{name}: {:?}", wrong.why)))?;
    OutFile::at(&obj.with_extension("npy"))?.write(&cx.cancel, |out| npy::write_rays(&small.rays, out))
}

/// Loose triangles, each coordinate with as many digits as it takes to read it back.
fn write_obj(out: &mut impl Write, trial: &Trial, what: &str) -> io::Result<()> {
    writeln!(out, "# {what}")?;
    for p in trial.triangles.iter().flatten() {
        writeln!(out, "v {:?} {:?} {:?}", p.x, p.y, p.z)?;
    }
    (0..trial.triangles.len()).try_for_each(|i| writeln!(out, "f {} {} {}", 3 * i + 1, 3 * i + 2, 3 * i + 3))
}

/// Error against time: a curve for each structure, a point for each test, means over the cases.
fn panel(outcome: &Outcome) -> Panel {
    /// What an error of nothing counts as, since means are geometric.
    const LEAST_ULPS: f64 = 0.01;
    let rows = || outcome.cases.iter().flat_map(|case| &case.structures);
    let mut ids: Vec<&str> = Vec::new();
    for row in rows().filter(|row| row.error.is_none()) {
        if !ids.contains(&row.id) {
            ids.push(row.id);
        }
    }
    let mean = |id: &str, test: TestKind, of: fn(&Row) -> f64| {
        let logs: Vec<f64> =
            rows().filter(|row| row.id == id && row.test == test && row.error.is_none()).map(|row| of(row).ln()).collect();
        (logs.iter().sum::<f64>() / logs.len() as f64).exp()
    };
    let point = |id: &str, test| (mean(id, test, |row| row.ns_per_ray), mean(id, test, |row| row.p999_ulps.max(LEAST_ULPS)));
    let order = [TestKind::Fast, TestKind::BaldwinWeber, TestKind::Watertight, TestKind::Double, TestKind::Exact];
    let tried = |id: &str, test| rows().any(|row| row.id == id && row.test == test && row.error.is_none());
    let points = |id: &str| order.into_iter().filter(|test| tried(id, *test)).map(|test| point(id, test)).collect::<Vec<_>>();
    let curve = |id: &&str| Curve::of(id, points(id));
    Panel {
        title: "Error of t against time, a point a triangle test".to_owned(),
        axes: ["nanoseconds of a ray, mean over cases", "ulps that one clear hit in a thousand exceeds"],
        curves: ids.iter().map(curve).collect(),
        ..Panel::default()
    }
}

fn text(outcome: &Outcome) -> String {
    let head = facts(&[
        ("seed", outcome.seed.to_string()),
        ("machine", format!("{}, {} threads", outcome.machine.cpu, outcome.machine.threads)),
    ]);
    let mut table = Table::new(&[
        "case",
        "structure",
        "test",
        "rays",
        "near",
        "boundary",
        "clear wrong",
        "boundary wrong",
        "max ulps",
        "99.9 %",
        "nodes",
        "astray",
        "ns/ray",
        "verdict",
    ]);
    let mut notes = String::new();
    for case in &outcome.cases {
        for row in &case.structures {
            table.row(cells(case, row));
            if let Some(error) = &row.error {
                let note = format!("{}, {}: {error}\n", case.id, row.id);
                // It is the same with every triangle test.
                notes += if notes.contains(&note) { "" } else { &note };
            }
        }
    }
    format!("{head}\n{}{notes}{LEGEND}\n{}\n{}{OF_BOXES}", table.render(), price_table(&outcome.tests), box_table(&outcome.cases))
}

/// What the triangle tests cost by themselves.
fn price_table(prices: &[TestPrice]) -> String {
    let mut table = Table::new(&["triangle test", "ns/test", "bytes/triangle"]);
    for price in prices {
        table.row(vec![price.id.id().to_owned(), number(price.ns_per_test), count(price.bytes as u64)]);
    }
    table.render()
}

/// The tests of boxes, summed up over the cases.
fn box_table(cases: &[CaseRow]) -> String {
    let mut table = Table::new(&["box test", "boxes", "met", "missed", "hits lost", "in vain", "ns/box"]);
    for id in BoxTest::ALL {
        let rows = || cases.iter().flat_map(|case| &case.boxes).filter(|row| row.id == id);
        let sum = |of: fn(&BoxRow) -> u64| rows().map(of).sum::<u64>();
        let asked = sum(|row| row.asked);
        let nanoseconds = rows().map(|row| row.ns_per_box * row.asked as f64).sum::<f64>() / asked as f64;
        table.row(vec![
            id.id().to_owned(),
            count(asked),
            count(sum(|row| row.met)),
            count(sum(|row| row.missed)),
            count(sum(|row| row.lost)),
            count(sum(|row| row.in_vain)),
            number(nanoseconds),
        ]);
    }
    table.render()
}

const OF_BOXES: &str = "\nmissed: boxes that the ray meets exactly, and that the test calls missed. hits lost: triangles that the watertight test \
    hits in a box of their own that is called missed. in vain: boxes that the ray misses exactly, and that are entered.\n";

const NO_PAIR: &str = "none of the structures has any of the tests: double and baldwin-weber stand in brute";

const LEGEND: &str = "\nnear: rays whose answer is a matter of rounding. boundary: rays through an edge or a corner, to the bit.\n\
    clear wrong: another answer than the exact one where no rounding is in the way. boundary wrong: an answer that no rounding \
    explains, or a ray that slipped through a closed surface.\n";

fn cells(case: &CaseRow, row: &Row) -> Vec<String> {
    let share = |n: usize| percent(n as f64 / row.rays.max(1) as f64);
    let verdict = match row.verdict {
        Verdict::Pass if row.error.is_some() => "refused",
        Verdict::Pass => "pass",
        Verdict::Warn => "warn",
        Verdict::Fail => "FAIL",
    };
    vec![
        case.id.to_owned(),
        row.id.to_owned(),
        row.test.id().to_owned(),
        count(row.rays as u64),
        share(row.near),
        share(row.boundary),
        count(row.clear_wrong as u64),
        count(row.boundary_wrong as u64),
        number(row.max_ulps),
        number(row.p999_ulps),
        count(row.max_nodes),
        count(row.astray),
        number(row.ns_per_ray),
        verdict.to_owned(),
    ]
}
