//! Other libraries' structures beside ours: their hits are those of brute force, and `boxwood peers`
//! prints what it promises.

mod common;

use std::process::Command;
use std::sync::Arc;

use boxwood::accel::registry;
use boxwood::geometry::tri::TestKind;
use boxwood::lab::peers::{Ours, PeerRace, RayPairs, Recipe, peers, race};
use boxwood::lab::{MeasureOptions, PixelOrder, RayKind, RaySet};
use boxwood::render::{self, Job};
use boxwood::scene::Camera;
use boxwood::task::{Budget, Cancel, Pool, Progress};
use common::{ball, build, geometry_of, left_out, scene_of, soup};
use glam::Vec3;
use serde_json::Value;

/// Rounds enough to have some.
const QUICK: MeasureOptions =
    MeasureOptions { min_rounds: 1, min_secs: 1e-9, cap_secs: 10.0, fairness: boxwood::lab::Fairness::LikeForLike };

fn ours(id: &str, test: TestKind) -> Box<dyn Recipe> {
    let entry = registry::find(id).expect("registered");
    let (budget, cancel) = (Budget::unlimited(), Cancel::new());
    Box::new(Ours { id: id.to_owned(), entry, params: entry.defaults(), test, budget, cancel })
}

/// Races everybody on the rays of a picture; the reference is brute force.
fn raced(triangles: &[[Vec3; 3]], threads: usize) -> Vec<boxwood::lab::peers::PeerRow> {
    let scene = Arc::new(scene_of(triangles));
    let geometry = geometry_of(&scene);
    let brute = build(registry::find("brute").expect("registered"), &geometry, TestKind::Watertight);
    let (pool, cancel) = (Pool::new("test", threads), Cancel::new());
    let accel: Arc<dyn boxwood::accel::Accel> = Arc::from(brute);
    let camera = Camera::framing(geometry.world_bounds(), Vec3::new(1.0, 0.7, 2.0), Vec3::Y, 1.5);
    let job = Job::new(scene, Arc::clone(&accel), camera, render::Mode::Shaded, Arc::default());
    let kinds = [RayKind::Primary, RayKind::Diffuse, RayKind::Shuffled, RayKind::Shadow];
    let sets = kinds.map(|kind| {
        let set = RaySet::ordered(kind, PixelOrder::Morton, &job, (61, 43), &pool, &cancel).expect("not cancelled");
        RayPairs::of(&set, accel.as_ref(), &pool, &cancel).expect("not cancelled")
    });
    assert!(sets.iter().all(|set| set.len() > 300), "rays of every kind");
    let mut recipes = vec![ours("bvh", TestKind::Watertight), ours("bvh", TestKind::Fast)];
    recipes.extend(peers().0);
    let what = PeerRace { recipes: &recipes, geometry: &geometry, sets: &sets, options: &QUICK, builds: 2 };
    race(&what, &pool, &cancel, &Progress::new()).expect("not cancelled")
}

#[test]
fn the_hits_of_every_peer_are_those_of_brute_force() {
    for (triangles, threads) in [(ball(16), 1), (soup(3000, 0.1, 7), 2)] {
        let rows = raced(&triangles, threads);
        for row in &rows {
            let name = format!("{} {}", row.id, row.call.id());
            assert_eq!(row.error, None, "{name}");
            assert_eq!((row.rays.len(), row.threads), (4, threads), "{name}");
            let count: usize = row.rays.values().map(|set| set.count).sum();
            // Rays through an edge may slip by, and reciprocals may be approximate.
            let allowed = if row.watertight && !row.peer { 0 } else { count as u64 / 500 };
            assert!(row.differing_rays <= allowed, "{name}: {} of {count} differ", row.differing_rays);
            assert!(row.rays.values().all(|set| set.hits > 0 || set.differing_rays == 0), "{name}");
            let known = row.bytes.map_or(row.library.starts_with("tinybvh"), |bytes| bytes > 1000);
            assert!(known && row.build.is_some_and(|b| b.builds == 2), "{name}");
            assert!(row.rays.values().all(|set| set.rounds >= 1 && set.mrays_per_sec > 0.0), "{name}");
        }
        assert!(rows.iter().all(|row| row.rays[&RayKind::Primary].hits > 300));
    }
}

#[test]
fn nothing_to_build_over_is_told_in_the_rows() {
    let flat = [[Vec3::ZERO, Vec3::X, Vec3::X * 2.0]];
    let scene = Arc::new(scene_of(&flat));
    let geometry = geometry_of(&scene);
    let (pool, cancel) = (Pool::new("test", 1), Cancel::new());
    let recipes = peers().0;
    let what = PeerRace { recipes: &recipes, geometry: &geometry, sets: &[], options: &QUICK, builds: 1 };
    let rows = race(&what, &pool, &cancel, &Progress::new()).expect("not cancelled");
    assert!(!rows.is_empty() && rows.iter().all(|row| row.error.as_deref() == Some("there are no triangles")));
}

fn run(args: &[&str]) -> (Option<i32>, String, String) {
    let output = Command::new(env!("CARGO_BIN_EXE_boxwood")).args(args).output().expect("it runs");
    let text = |bytes| String::from_utf8(bytes).expect("UTF-8");
    (output.status.code(), text(output.stdout), text(output.stderr))
}

#[test]
fn the_command_prints_a_row_for_everybody_and_the_ratios() {
    let quick = ["--rays", "4096", "--repeat", "1", "--secs", "0.001", "--builds", "1"];
    let args = |more: &[&'static str]| [&["peers", "builtin:teapot"], &quick[..], more].concat();
    let (code, text, errors) = run(&args(&["--json", "--threads", "1,2"]));
    assert_eq!(code, Some(0), "{errors}");
    let object: Value = serde_json::from_str(&text).expect("one JSON value");
    for key in ["scene", "machine", "size", "order", "structures", "ratios", "ratios_watertight", "runs", "missing"] {
        assert!(object.get(key).is_some(), "no {key}");
    }
    assert_eq!(object["size"], serde_json::json!([64, 64]));
    let rows = object["structures"].as_array().expect("a list");
    for row in rows {
        for key in ["id", "library", "peer", "watertight", "call", "threads", "build_secs", "differing_rays"] {
            assert!(!row[key].is_null(), "no {key} in {row}");
        }
        for kind in ["primary", "diffuse", "shuffled", "shadow"] {
            assert!(row["rays"][kind]["mrays_per_sec"].as_f64().is_some_and(|rate| rate > 0.0), "{row}");
            assert!(row["rays"][kind]["differing_rays"].is_u64(), "{row}");
        }
    }
    for expected in [("bvh", false, "single"), ("bvh", false, "batch"), ("obvhs", true, "single"), ("parry3d", true, "single")] {
        let (id, peer, call) = expected;
        let there = rows.iter().filter(|row| row["id"] == id && row["peer"] == peer && row["call"] == call).count();
        assert_eq!(there, if peer { 2 } else { 4 }, "{expected:?} for each number of threads and test");
    }
    let embree = rows.iter().filter(|row| row["library"].as_str().is_some_and(|name| name.starts_with("Embree "))).count();
    let told = object["missing"].to_string().contains("embree");
    assert!(embree == 16 || (embree == 0 && told), "four scenes, two calls, two numbers of threads: {embree}");
    for ratios in [&object["ratios"], &object["runs"][1]["ratios"]] {
        for key in ["primary", "primary_single", "diffuse", "shuffled", "shadow", "build"] {
            let ratio = &ratios[key];
            assert!(ratio.as_f64().is_some_and(|x| x > 0.0) || (key == "build" && ratio.is_null()), "{key}: {ratio}");
        }
    }

    let (code, text, errors) = run(&args(&["--peers", "obvhs", "--structures", "bvh:builder=median"]));
    assert_eq!(code, Some(0), "{errors}");
    assert!(text.contains("bvh:builder=median") && text.contains("obvhs") && text.contains("ratios"), "{text}");
    assert!(!text.contains("parry"), "{text}");
}

/// Where the environment names a library it must be used.
#[test]
fn embree_is_found_where_it_is_expected() {
    let (recipes, missing) = peers();
    let named = std::env::var_os(boxwood::sys::embree::PATH_VARIABLE).is_some();
    let found = recipes.iter().any(|recipe| recipe.label().id == "embree-robust");
    assert!(found || !named, "{missing:?}");
    if !found {
        left_out("Embree", "its hits beside ours", "Install libembree3-3 to run it.");
    }
}

#[test]
fn wrong_arguments_are_told_in_a_line() {
    let wrong = [
        &["--peers", "oak"][..],
        &["--structures", "oak"],
        &["--structures", "bvh:builder=oak"],
        &["--rays", "sideways"],
        &["--threads", "5000"],
        &["--peers", "none", "--structures", "bvh", "--set", "oak=1"],
    ];
    for args in wrong {
        let (code, text, errors) = run(&[&["peers", "builtin:teapot"], args].concat());
        assert_eq!((code, text.as_str(), errors.lines().count()), (Some(2), "", 1), "{args:?}: {errors}");
    }
}
