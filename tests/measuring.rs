//! What the lab measures: the right rays, everybody's turn, honest caps, and an end when asked.

mod common;

use std::sync::Arc;
use std::time::{Duration, Instant};

use boxwood::accel::{Accel, Mode, registry};
use boxwood::geometry::tri::TestKind;
use boxwood::lab::format::count;
use boxwood::lab::{Contestant, MeasureOptions, RayKind, RaySet, measure};
use boxwood::render::{self, Job};
use boxwood::scene::Camera;
use boxwood::task::{Cancel, Pool, Progress};
use common::{ball, build, geometry_of, scene_of, soup, trace};
use glam::Vec3;

fn contestants(triangles: &[[Vec3; 3]], ids: &[&str]) -> Vec<Contestant> {
    let geometry = geometry_of(&scene_of(triangles));
    let one = |id: &&str| {
        let entry = registry::find(id).expect("registered");
        Contestant { id: (*id).to_owned(), accel: Arc::from(build(entry, &geometry, TestKind::Watertight)) }
    };
    ids.iter().map(one).collect()
}

fn rays(triangles: &[[Vec3; 3]], kind: RayKind, id: &str, threads: usize) -> RaySet {
    let scene = Arc::new(scene_of(triangles));
    let geometry = geometry_of(&scene);
    let accel: Arc<dyn Accel> = Arc::from(build(registry::find(id).expect("registered"), &geometry, TestKind::Watertight));
    let camera = Camera::framing(geometry.world_bounds(), Vec3::new(1.0, 0.7, 2.0), Vec3::Y, 1.5);
    let job = Job::new(scene, accel, camera, render::Mode::Shaded, Arc::default());
    RaySet::generate(kind, &job, 90, 61, &Pool::new("test", threads), &Cancel::new()).expect("not cancelled")
}

#[test]
fn ray_sets_are_the_same_for_every_structure_and_thread_count() {
    let triangles = ball(12);
    for kind in RayKind::ALL {
        let set = rays(&triangles, kind, "brute", 1);
        assert_eq!((set.kind, set.mode == Mode::Any), (kind, kind == RayKind::Shadow));
        for entry in registry::ALL {
            assert!(rays(&triangles, kind, entry.id, 3) == set, "{} {}", entry.id, kind.id());
        }
    }
}

#[test]
fn rays_leave_where_primary_rays_hit() {
    let triangles = ball(12);
    let [primary, shadow, diffuse] =
        [RayKind::Primary, RayKind::Shadow, RayKind::Diffuse].map(|kind| rays(&triangles, kind, "bvh", 2));
    assert_eq!(primary.rays.len(), 90 * 61);
    let accel = &contestants(&triangles, &["bvh"])[0].accel;
    let hits = trace(accel.as_ref(), &primary.rays, Mode::Closest);
    let points: Vec<Vec3> = primary.rays.iter().zip(&hits).filter_map(|(ray, hit)| Some(ray.at(hit.as_ref()?.t))).collect();
    assert!(points.len() > 500 && points.len() < primary.rays.len());
    for set in [&shadow, &diffuse] {
        assert_eq!(set.rays.len(), points.len());
        assert!(set.rays.iter().zip(&points).all(|(ray, p)| ray.is_valid() && ray.origin.distance(*p) < 1e-4));
    }
    let lit = trace(accel.as_ref(), &shadow.rays, Mode::Any).iter().filter(|hit| hit.is_none()).count();
    assert!(lit * 4 > points.len() && lit < points.len(), "most of a ball is lit, not all: {lit}");
    let out = trace(accel.as_ref(), &diffuse.rays, Mode::Closest).iter().filter(|hit| hit.is_none()).count();
    assert!(out * 10 > points.len() * 8, "few bounces meet a nearly convex ball again: {out}");
}

#[test]
fn everybody_gets_enough_rounds_and_is_counted() {
    let triangles = soup(2000, 0.2, 5);
    let set = rays(&triangles, RayKind::Primary, "bvh", 2);
    let options = MeasureOptions { min_rounds: 3, min_secs: 0.05, ..MeasureOptions::default() };
    let all = contestants(&triangles, &["bvh", "kdtree", "brute"]);
    let progress = Progress::new();
    let rows = measure(&all, &set, &options, &Pool::new("test", 2), &Cancel::new(), &progress).expect("not cancelled");
    assert_eq!(rows.iter().map(|row| row.id.as_str()).collect::<Vec<_>>(), ["bvh", "kdtree", "brute"]);
    for row in &rows {
        assert!(row.rounds >= 3 && row.secs_median > 0.0, "{row:?}");
        assert_eq!((row.rays, row.of, &row.capped), (set.rays.len(), set.rays.len(), &None));
        assert!(row.counted > 0 && row.counted <= row.rays);
        assert!((row.mrays_per_sec * row.secs_median * 1e6 - row.rays as f64).abs() < 1.0);
        assert_eq!(row.hits, rows[0].hits);
    }
    assert_eq!((rows[2].nodes_per_ray, rows[2].prims_per_ray), (1.0, 2000.0));
    assert!(rows[0].prims_per_ray < 100.0 && rows[0].nodes_per_ray > 2.0);
    assert_eq!(progress.finish().iter().map(|phase| phase.name).collect::<Vec<_>>(), ["warm up", "measure", "count"]);
}

#[test]
fn a_slow_row_is_capped_and_says_so() {
    let triangles = soup(100_000, 0.1, 5);
    let set = rays(&triangles, RayKind::Diffuse, "bvh", 2);
    let options = MeasureOptions { min_rounds: 2, min_secs: 0.01, cap_secs: 0.3, ..MeasureOptions::default() };
    let all = contestants(&triangles, &["brute", "bvh"]);
    let rows = measure(&all, &set, &options, &Pool::new("test", 2), &Cancel::new(), &Progress::new()).expect("not cancelled");
    assert!(rows[0].rays < set.rays.len() && rows[0].of == set.rays.len());
    let why = rows[0].capped.as_deref().expect("capped");
    assert!(why.starts_with(&format!("{} of {} rays", count(rows[0].rays as u64), count(set.rays.len() as u64))), "{why}");
    assert!(rows[1].rays > rows[0].rays, "on a busy machine the fast one may be capped too, but later");
}

#[test]
fn no_rays_is_a_row_with_a_reason() {
    let triangles = soup(10, 0.1, 5);
    let set = RaySet { rays: Vec::new(), ..rays(&triangles, RayKind::Shadow, "bvh", 1) };
    let all = contestants(&triangles, &["bvh"]);
    let options = MeasureOptions::default();
    let rows = measure(&all, &set, &options, &Pool::new("test", 1), &Cancel::new(), &Progress::new()).expect("not cancelled");
    assert!(rows[0].rounds == 0 && rows[0].secs_median.is_nan() && rows[0].capped.is_some());
}

#[test]
fn measuring_stops_soon_after_it_is_asked_to() {
    let triangles = soup(100_000, 0.05, 5);
    let set = rays(&triangles, RayKind::Primary, "bvh", 2);
    let all = contestants(&triangles, &["brute", "bvh"]);
    for wait in [3, 150, 700] {
        let cancel = Cancel::new();
        let asked = std::thread::scope(|scope| {
            let run = || {
                let pool = Pool::new("test", 2);
                measure(&all, &set, &MeasureOptions::default(), &pool, &cancel, &Progress::new())
            };
            let worker = std::thread::Builder::new().spawn_scoped(scope, run).expect("a thread");
            std::thread::sleep(Duration::from_millis(wait));
            cancel.cancel();
            let asked = Instant::now();
            assert!(worker.join().expect("no panic").is_err());
            asked.elapsed()
        });
        assert!(asked < Duration::from_millis(300), "{asked:?} after {wait} ms");
    }
}
