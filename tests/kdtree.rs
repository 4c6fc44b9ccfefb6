//! What the k-d tree promises beyond what every structure does, shown by counts.

mod common;

use std::sync::Arc;

use boxwood::accel::probe::Counts;
use boxwood::accel::registry::find;
use boxwood::accel::stats::{SahWeights, Stats};
use boxwood::accel::{Accel, BuildCx, BuildError, Mode, Split, validate};
use boxwood::geometry::tri::TestKind;
use boxwood::geometry::{Axis, Ray};
use boxwood::scene::{self, Geometry, LoadCx};
use boxwood::task::{Budget, Cancel};
use common::{Random, ball, geometry_of, rays_for, scene_of, soup, trace, watch};
use glam::Vec3;

fn built(geometry: &Arc<Geometry>, set: &[(&str, &str)], cx: &BuildCx) -> Result<Box<dyn Accel>, BuildError> {
    let entry = find("kdtree").expect("registered");
    let mut params = entry.defaults();
    set.iter().for_each(|(k, v)| params.set(k, v).expect("valid"));
    entry.build(geometry, TestKind::Watertight, &params, cx)
}

fn build(geometry: &Arc<Geometry>, set: &[(&str, &str)]) -> Box<dyn Accel> {
    built(geometry, set, &BuildCx::unattended(2)).expect("builds")
}

fn stats(accel: &dyn Accel) -> Stats {
    let weights = SahWeights { c_trav: 1.0, c_isect: 1.5 };
    Stats::of(accel, weights, &Cancel::new()).expect("not cancelled")
}

fn watched(accel: &dyn Accel, rays: &[Ray]) -> Counts {
    let mut counts = Counts::default();
    for ray in rays {
        watch(accel, ray, Mode::Closest, &mut counts);
    }
    counts
}

/// Every place for a plane is tried, not 64 of them: on the whole that costs less. Each step takes what
/// is best for itself, so on one scene or another it may come out dearer, by a percent.
#[test]
fn the_exact_search_is_no_worse_than_bins() {
    let mut ratios = Vec::new();
    for model in [
        "teapot",
        "sphere-flake?triangles=30000",
        "menger",
        "terrain?triangles=30000",
        "hair?triangles=10000",
        "soup?triangles=20000",
    ] {
        let cx = LoadCx::unattended();
        let scene = scene::open(&format!("builtin:{model}"), &cx).expect("built in");
        let geometry = Arc::new(Geometry::new(&scene, &cx).expect("small"));
        let [sah, binned] = ["sah", "binned"].map(|builder| {
            let accel = build(&geometry, &[("builder", builder)]);
            assert_eq!(validate::defects(accel.as_ref(), &geometry, 3), [], "{builder} on {model}");
            stats(accel.as_ref()).sah
        });
        println!("{model}: sah {sah:.2}, binned {binned:.2}");
        assert!(sah <= 1.01 * binned, "{model}: {sah} is more than {binned}");
        ratios.push(sah / binned);
    }
    let product: f64 = ratios.iter().product();
    assert!(product < 1.0, "{ratios:?}");
}

/// A triangle in both halves, met in the far one: the near half finds the hit, and it is kept until
/// the far half has nothing closer.
#[test]
fn a_hit_outside_its_cell_is_kept_until_nothing_can_be_closer() {
    let slanted = [Vec3::new(-1.8, -0.9, -1.0), Vec3::new(1.8, 0.9, -1.0), Vec3::new(0.0, 0.0, 1.0)];
    let mut random = Random(3);
    let mut triangles = vec![slanted];
    for side in [-1.0f32, 1.0] {
        // Two heaps with a gap at x = 0, both above the ray.
        triangles.extend((0..60).map(|_| {
            let at = Vec3::new(side * (0.4 + 1.4 * random.unit()), 0.85 * random.point().y, 1.4 * random.unit() - 0.5);
            [at, at + 0.05 * random.point(), at + 0.05 * random.point()]
        }));
    }
    let geometry = geometry_of(&scene_of(&triangles));
    let accel = build(&geometry, &[("max_depth", "1")]);
    let Some(Split::Axis { axis: Axis::X, pos }) = accel.root().split else { panic!("{:?}", accel.root()) };
    let pos = geometry.space().world_point(Vec3::splat(pos)).x;
    assert!(pos.abs() < 0.5, "divided in the gap");

    let ray = Ray::new(Vec3::new(-3.0, 0.5, -0.8), Vec3::X);
    let mut counts = Counts::default();
    let hit = watch(accel.as_ref(), &ray, Mode::Closest, &mut counts).expect("a hit");
    assert_eq!((hit.primitive, counts.outside, counts.leaves), (0, 1, 2));
    assert!(ray.at(hit.t).x > pos, "in the far half");
    let mut any = Counts::default();
    assert!(watch(accel.as_ref(), &ray, Mode::Any, &mut any).is_some());
    assert_eq!((any.outside, any.leaves), (0, 1), "any hit will do at once");

    // Something closer in the far half wins over the hit that was kept.
    let blocker = [Vec3::new(0.8, 0.4, -0.9), Vec3::new(0.8, 0.6, -0.9), Vec3::new(0.8, 0.5, -0.5)];
    triangles.push(blocker);
    let geometry = geometry_of(&scene_of(&triangles));
    let accel = build(&geometry, &[("max_depth", "1")]);
    let mut counts = Counts::default();
    let hit = watch(accel.as_ref(), &ray, Mode::Closest, &mut counts).expect("a hit");
    assert_eq!((hit.primitive as usize, counts.outside), (triangles.len() - 1, 1));
}

#[test]
fn a_mailbox_saves_tests_and_changes_no_hit() {
    let triangles = soup(2000, 0.6, 8);
    let geometry = geometry_of(&scene_of(&triangles));
    let rays = rays_for(&triangles, 900, 9);
    let [with, without] = ["on", "off"].map(|mailbox| build(&geometry, &[("mailbox", mailbox)]));
    assert_eq!(trace(with.as_ref(), &rays, Mode::Closest), trace(without.as_ref(), &rays, Mode::Closest));
    let (with, without) = (watched(with.as_ref(), &rays), watched(without.as_ref(), &rays));
    assert_eq!((with.nodes, with.leaves, with.outside), (without.nodes, without.leaves, without.outside));
    assert!(with.prims * 10 < without.prims * 9, "{} of {} tests", with.prims, without.prims);
}

/// Clipped triangles are in fewer cells than their boxes are: long thin ones show it best.
#[test]
fn a_triangle_is_only_in_leaves_that_it_overlaps() {
    let triangles: Vec<_> = soup(300, 1.5, 17).into_iter().map(|[a, b, _]| [a, b, b + Vec3::splat(1e-3)]).collect();
    let geometry = geometry_of(&scene_of(&triangles));
    for builder in ["sah", "binned"] {
        let accel = build(&geometry, &[("builder", builder)]);
        let (mut references, mut apart) = (0, 0);
        boxwood::accel::cell::walk(accel.as_ref(), &mut |cell| {
            accel.prims(cell, &mut |prim| {
                references += 1;
                let overlaps = boxwood::geometry::triangle_overlaps_box(&geometry.corners(prim), cell.shape.bounds());
                apart += usize::from(!overlaps);
            });
            std::ops::ControlFlow::Continue(boxwood::accel::cell::Descend::Yes)
        });
        // Outward rounding to 32 bits may leave one that misses its cell by an ulp.
        assert!(references > 1000 && apart * 1000 <= references, "{builder}: {apart} of {references}");
    }
}

#[test]
fn builders_do_not_depend_on_the_number_of_threads() {
    let mut triangles = soup(60_000, 0.02, 70);
    triangles.extend(ball(30));
    let geometry = geometry_of(&scene_of(&triangles));
    let rays = rays_for(&triangles, 500, 71);
    for builder in ["sah", "binned"] {
        let of = |threads| built(&geometry, &[("builder", builder)], &BuildCx::unattended(threads)).expect("builds");
        let (one, three) = (of(1), of(3));
        assert_eq!(validate::defects(one.as_ref(), &geometry, 3), [], "{builder}");
        assert_eq!(stats(one.as_ref()), stats(three.as_ref()), "{builder}");
        assert_eq!(trace(one.as_ref(), &rays, Mode::Closest), trace(three.as_ref(), &rays, Mode::Closest), "{builder}");
    }
}

#[test]
fn both_builders_stop_when_asked_and_keep_to_a_budget() {
    let geometry = geometry_of(&scene_of(&soup(60_000, 0.05, 72)));
    for builder in ["sah", "binned"] {
        let set = &[("builder", builder)];
        let needed = {
            let cx = BuildCx { budget: Budget::new(1 << 32), ..BuildCx::unattended(2) };
            let accel = built(&geometry, set, &cx).expect("fits");
            let bytes: u64 = accel.memory().iter().map(|part| part.bytes).sum();
            assert!(cx.budget.used() >= bytes, "{builder}");
            bytes
        };
        // Enough to begin, too little to end.
        for limit in [needed / 4, needed] {
            let cx = BuildCx { budget: Budget::new(limit), ..BuildCx::unattended(2) };
            assert!(matches!(built(&geometry, set, &cx), Err(BuildError::Memory { .. })), "{builder} in {limit}");
            assert_eq!(cx.budget.used(), 0, "{builder} keeps memory");
        }
        let cx = BuildCx::unattended(2);
        let stopped = std::thread::scope(|scope| {
            let building = scope.spawn(|| built(&geometry, set, &cx).err());
            while cx.progress.snapshot().phase != "split" && !building.is_finished() {
                std::thread::yield_now();
            }
            cx.cancel.cancel();
            building.join().expect("no panic")
        });
        assert!(matches!(stopped, Some(BuildError::Cancelled(_))), "{builder}");
    }
}

#[test]
fn auto_says_what_it_took() {
    let geometry = geometry_of(&scene_of(&soup(50, 0.5, 73)));
    assert!(build(&geometry, &[]).remarks().iter().any(|remark| remark.contains("sah")));
    assert!(build(&geometry, &[("builder", "binned")]).remarks().is_empty());
}
