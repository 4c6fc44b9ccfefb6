//! What the areas of cells predict of random lines, against counted lines: on every structure that
//! is registered. A count that is off, a wrong area or cells that do not nest show here.

mod common;

use boxwood::accel::cell::{Cells, Shape, walk};
use boxwood::accel::params::{Kind, ParamValues};
use boxwood::accel::probe::Counts;
use boxwood::accel::registry::{self, Entry};
use boxwood::accel::stats::{SahWeights, Stats};
use boxwood::accel::{BuildCx, Mode, cell::Descend};
use boxwood::geometry::Ray;
use boxwood::geometry::tri::TestKind;
use boxwood::lab::{Enough, UncutLines};
use boxwood::scene::{LoadCx, open};
use boxwood::task::{Cancel, Pool};
use common::{build, geometry_of, rays_for, scene_of, soup, watch};
use std::ops::ControlFlow;

/// Prediction and measurement agree to this share.
const AGREE: f64 = 0.05;

/// Small ones of every sort: even, flat and parallel to the axes, thin, far apart, a closed surface.
const SCENES: [&str; 6] = [
    "builtin:soup?triangles=1000",
    "builtin:cornell-box",
    "builtin:menger?triangles=2000",
    "builtin:hair?triangles=1000",
    "builtin:terrain?triangles=2000",
    "builtin:teapot?triangles=1500",
];

/// The defaults, but with nothing that remembers tests already made.
fn without_mailboxes(entry: &Entry) -> ParamValues {
    let mut params = entry.defaults();
    for param in entry.params.iter().filter(|param| param.id.starts_with("mailbox")) {
        if let Kind::Choice { options } = param.kind {
            assert!(options.contains(&"off"), "{} of {} cannot be turned off", param.id, entry.id);
            params.set(param.id, "off").expect("an option");
        }
    }
    params
}

/// Whether every cell lies in its parent, so that a line that meets it meets all above it. Boxes do,
/// which the conformance suite sees to; other volumes of a hierarchy need not.
fn nests(cells: &dyn Cells) -> bool {
    let mut boxes = true;
    walk(cells, &mut |cell| {
        boxes &= matches!(cell.shape, Shape::Box(_));
        if boxes { ControlFlow::Continue(Descend::Yes) } else { ControlFlow::Break(()) }
    });
    boxes || !cells.layout().nests()
}

#[test]
fn random_lines_do_what_areas_predict() {
    let pool = Pool::new("test", 2);
    // Not ended by the clock: a busy machine must not decide how much is proved.
    let enough = Enough { three_sigma: 0.01, secs: 600.0, lines: 4_000_000 };
    let mut compared = 0;
    for model in SCENES {
        let scene = open(model, &LoadCx::unattended()).expect("made in code");
        let geometry = geometry_of(&scene);
        for entry in registry::ALL {
            let params = without_mailboxes(entry);
            let accel = entry.build(&geometry, TestKind::Watertight, &params, &BuildCx::unattended(2)).expect("builds");
            let stats = Stats::of(accel.as_ref(), SahWeights::default(), &Cancel::new()).expect("not cancelled");
            let lines = UncutLines::count(accel.as_ref(), &enough, &pool, &Cancel::new()).expect("not cancelled");
            let what =
                format!("{} on {model}: {lines:?}, expected {} and {}", entry.id, stats.expected_nodes, stats.expected_tests);
            assert!(lines.is_within(0.01), "too few lines for {what}");
            for (expected, measured) in [(stats.expected_nodes, lines.nodes), (stats.expected_tests, lines.tests)] {
                let ratio = measured / expected;
                println!("{:6} {model:32} {expected:9.3} {measured:9.3} {ratio:.4} {} lines", entry.id, lines.lines);
                // Volumes that stick out of their parents are met less often than their areas say.
                let least = if nests(accel.as_ref()) { 1.0 - AGREE } else { 0.0 };
                assert!((least..1.0 + AGREE).contains(&ratio), "{ratio} for {what}");
                compared += 1;
            }
        }
    }
    assert_eq!(compared, SCENES.len() * registry::ALL.len() * 2);
}

#[test]
fn nothing_cuts_an_uncut_ray_short() {
    let triangles = soup(400, 0.4, 3);
    let geometry = geometry_of(&scene_of(&triangles));
    let rays: Vec<Ray> = rays_for(&triangles, 900, 4);
    for entry in registry::ALL {
        let accel = build(entry, &geometry, TestKind::Watertight);
        let (mut cut, mut uncut) = (Counts::default(), Counts::default());
        for ray in &rays {
            let before = (cut.nodes, uncut.nodes);
            watch(accel.as_ref(), ray, Mode::Closest, &mut cut);
            accel.count_uncut(ray, &mut uncut, &Cancel::new()).expect("not cancelled");
            assert!(uncut.nodes - before.1 >= cut.nodes - before.0, "{}: {ray:?}", entry.id);
        }
        assert!(uncut.prims >= cut.prims && uncut.leaves >= cut.leaves, "{}: {cut:?} {uncut:?}", entry.id);
        assert!(entry.family == registry::Family::Brute || uncut.prims > cut.prims, "{}", entry.id);
    }
}

/// The switch that shows what early termination is worth visits what an uncut ray does.
#[test]
fn a_bvh_without_early_out_is_never_cut() {
    let triangles = soup(300, 0.4, 5);
    let geometry = geometry_of(&scene_of(&triangles));
    let entry = registry::find("bvh").expect("registered");
    let mut params = entry.defaults();
    params.set("early_out", "off").expect("a switch");
    let accel = entry.build(&geometry, TestKind::Watertight, &params, &BuildCx::unattended(1)).expect("builds");
    let (mut whole, mut uncut) = (Counts::default(), Counts::default());
    for ray in rays_for(&triangles, 500, 6) {
        watch(accel.as_ref(), &ray, Mode::Closest, &mut whole);
        accel.count_uncut(&ray, &mut uncut, &Cancel::new()).expect("not cancelled");
    }
    assert_eq!(whole, uncut);
    assert!(uncut.nodes > 1000);
}
