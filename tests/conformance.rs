//! The one suite that every registered structure goes through: on every small scene and ray set it
//! must answer as `brute` does with the same triangle test, and as 64-bit arithmetic does where a
//! ray passes no edge closely; it must be well formed, count honestly, and stop when asked to.

mod common;

use boxwood::accel::params::{Kind, ParamValues};
use boxwood::accel::probe::{Counts, Watched};
use boxwood::accel::registry::{self, Entry};
use boxwood::accel::stats::{SahWeights, Stats};
use boxwood::accel::{Accel, BuildCx, BuildError, Hit, Mode, Step, cell, validate};
use boxwood::geometry::Ray;
use boxwood::geometry::tri::TestKind;
use boxwood::lab::rounding_explains;
use boxwood::task::{Budget, Cancel, Cancelled};
use common::{Random, ball, build, geometry_of, meet_in_f64, rays_for, scene_of, soup, trace, watch};
use glam::Vec3;
use proptest::prelude::*;

/// Hits of a cell structure may differ from `brute`'s where two triangles are hit at nearly one t, and
/// where the ray lies in the plane of the triangle, so that rounding alone decides t.
/// Returns how many do, and fails on any other difference.
fn compare(entry: &Entry, accel: &dyn Accel, brute: &[Option<Hit>], rays: &[Ray], what: &str) -> usize {
    let hits = trace(accel, rays, Mode::Closest);
    let mut near_ties = 0;
    for ((ray, hit), expected) in rays.iter().zip(&hits).zip(brute) {
        if hit == expected {
            continue;
        }
        let hierarchy = accel.layout() == cell::Layout::Hierarchy;
        let tie = rounding_explains(ray, [*hit, *expected], accel.geometry());
        assert!(tie && !hierarchy, "{} on {what}: {ray:?} gives {hit:?}, brute {expected:?}", entry.id);
        near_ties += 1;
    }
    let mut plain = vec![None; rays.len()];
    accel.trace_like_for_like(rays, Mode::Closest, &mut plain, &Cancel::new()).expect("not cancelled");
    assert_eq!(plain, hits, "{} on {what}: every road gives the same hits", entry.id);
    let any = trace(accel, rays, Mode::Any);
    for ((ray, hit), expected) in rays.iter().zip(&any).zip(brute) {
        let noise = hit.is_some() == expected.is_some() || rounding_explains(ray, [*hit, *expected], accel.geometry());
        assert!(noise, "{} any hit on {what}: {ray:?}", entry.id);
    }
    near_ties
}

/// Every structure as it comes, and with each choice that it offers: every builder, every switch.
fn variants() -> Vec<(&'static Entry, ParamValues, String)> {
    let mut variants = Vec::new();
    for entry in registry::ALL {
        variants.push((entry, entry.defaults(), String::new()));
        for param in entry.params {
            let Kind::Choice { options } = param.kind else { continue };
            for option in &options[1..] {
                let mut params = entry.defaults();
                params.set(param.id, option).expect("an option");
                variants.push((entry, params, format!("with {} = {option}", param.id)));
            }
        }
    }
    variants
}

/// Every variant of every structure and both triangle tests on one scene.
fn conforms(triangles: &[[Vec3; 3]], rays: &[Ray], what: &str) -> usize {
    let geometry = geometry_of(&scene_of(triangles));
    let mut near_ties = 0;
    for test in TestKind::ALL {
        let brute = build(&registry::ALL[0], &geometry, test);
        let expected = trace(brute.as_ref(), rays, Mode::Closest);
        for (entry, params, variant) in variants() {
            let accel = entry.build(&geometry, test, &params, &BuildCx::unattended(2)).expect("builds");
            let what = format!("{what} {variant}");
            assert_eq!(validate::defects(accel.as_ref(), &geometry, 3), [], "{} on {what}", entry.id);
            near_ties += compare(entry, accel.as_ref(), &expected, rays, &what);
        }
    }
    near_ties
}

fn small_scenes() -> Vec<(&'static str, Vec<[Vec3; 3]>)> {
    let quad = |z: f32| {
        let c = [Vec3::new(-1.0, -1.0, z), Vec3::new(1.0, -1.0, z), Vec3::new(1.0, 1.0, z), Vec3::new(-1.0, 1.0, z)];
        [[c[0], c[1], c[2]], [c[0], c[2], c[3]]]
    };
    let flat = |k: usize| soup(60, 0.3, 5).into_iter().map(|t| t.map(|mut p| (p[k] = 0.25, p).1)).collect();
    let fans = (0..200).map(|i| {
        let a = i as f32 * 0.1;
        [Vec3::new(a.cos(), a.sin(), -1.0), Vec3::new(a.cos(), a.sin(), 1.0), Vec3::new(a.cos() * 1.001, a.sin(), 1.0)]
    });
    let series = (0..40).map(|i| {
        let s = 0.5f32.powi(i);
        [Vec3::X * s, Vec3::Y * s, Vec3::Z * s]
    });
    vec![
        ("nothing", vec![]),
        ("one triangle", soup(1, 1.0, 1)),
        ("two triangles", soup(2, 1.0, 2)),
        ("three triangles", soup(3, 1.0, 3)),
        ("a soup", soup(700, 0.2, 4)),
        ("a dense soup", soup(300, 2.0, 9)),
        ("a closed ball", ball(12)),
        ("coplanar layers", (0..6).flat_map(|i| quad(i as f32 * 0.25)).collect()),
        ("equal layers", (0..40).flat_map(|_| quad(0.5)).collect()),
        ("layers an ulp apart", (0..9).flat_map(|i| quad(f32::from_bits(0.5f32.to_bits() + i))).collect()),
        ("flat in x", flat(0)),
        ("flat in y", flat(1)),
        ("flat in z", flat(2)),
        ("slivers", fans.collect()),
        ("a geometric series", series.collect()),
        (
            "degenerate among good",
            soup(50, 0.4, 6).into_iter().flat_map(|t| [t, [t[0], t[0], t[1]], [t[0], t[1], Vec3::splat(f32::NAN)]]).collect(),
        ),
    ]
}

#[test]
fn every_structure_answers_as_brute_does() {
    let mut random = Random(77);
    let (mut rays_traced, mut near_ties) = (0, 0);
    for (name, triangles) in small_scenes() {
        let rays = rays_for(&triangles, 1800, u64::from(random.bits()));
        near_ties += conforms(&triangles, &rays, name);
        rays_traced += rays.len() * 2 * (variants().len() - 1);
    }
    println!("near ties: {near_ties} of {rays_traced} rays");
    assert!(near_ties * 10_000 <= rays_traced, "{near_ties} near ties of {rays_traced} rays");
}

/// In the plane of a triangle rounding alone decides t, and with the fast test even whether there is
/// a hit: there a volume that trusts either loses hits that a box does not.
#[test]
fn every_volume_gives_the_same_hits_on_every_scene() {
    let entry = registry::find("volumes").expect("registered");
    for (name, triangles) in small_scenes() {
        let geometry = geometry_of(&scene_of(&triangles));
        let rays = rays_for(&triangles, 1800, 91);
        for test in TestKind::ALL {
            let expected = trace(build(&registry::ALL[0], &geometry, test).as_ref(), &rays, Mode::Closest);
            for kind in boxwood::accel::volumes::KINDS {
                let mut params = entry.defaults();
                params.set("volume", kind.id).expect("a volume");
                let accel = entry.build(&geometry, test, &params, &BuildCx::unattended(2)).expect("builds");
                assert_eq!(validate::defects(accel.as_ref(), &geometry, 3), [], "{} on {name}", kind.id);
                assert_eq!(compare(entry, accel.as_ref(), &expected, &rays, &format!("{}, {name}", kind.id)), 0);
            }
        }
    }
}

#[test]
fn scaling_and_moving_a_scene_keeps_structures_equal() {
    for scale in [1e-30f32, 1e-6, 1e6, 1e30] {
        let triangles: Vec<_> = ball(8).into_iter().map(|t| t.map(|p| p * scale)).collect();
        let rays: Vec<Ray> =
            rays_for(&ball(8), 900, 8).into_iter().map(|r| Ray { origin: r.origin * scale, dir: r.dir * scale, ..r }).collect();
        conforms(&triangles, &rays, "a scaled ball");
    }
    for far in [1e2f32, 1e4, 1e6] {
        let triangles: Vec<_> = ball(8).into_iter().map(|t| t.map(|p| p + Vec3::splat(far))).collect();
        let rays: Vec<Ray> =
            rays_for(&ball(8), 900, 8).into_iter().map(|r| Ray { origin: r.origin + Vec3::splat(far), ..r }).collect();
        conforms(&triangles, &rays, "a ball far from the origin");
    }
}

#[test]
fn a_scale_by_a_power_of_two_gives_the_same_hits() {
    let triangles = soup(300, 0.3, 21);
    let rays = rays_for(&triangles, 500, 22);
    for entry in registry::ALL {
        let here = trace(build(entry, &geometry_of(&scene_of(&triangles)), TestKind::Watertight).as_ref(), &rays, Mode::Closest);
        for exponent in [-60, 60] {
            let s = 2f32.powi(exponent);
            let scaled: Vec<_> = triangles.iter().map(|t| t.map(|p| p * s)).collect();
            let moved: Vec<Ray> = rays.iter().map(|r| Ray { origin: r.origin * s, dir: r.dir * s, ..*r }).collect();
            let there =
                trace(build(entry, &geometry_of(&scene_of(&scaled)), TestKind::Watertight).as_ref(), &moved, Mode::Closest);
            assert_eq!(here, there, "{} at 2^{exponent}", entry.id);
        }
    }
}

#[test]
fn clear_rays_agree_with_64_bits() {
    for (name, triangles) in small_scenes() {
        if ["degenerate among good", "slivers", "layers an ulp apart"].contains(&name) {
            continue; // every ray there is close to an edge or to another hit
        }
        let geometry = geometry_of(&scene_of(&triangles));
        let rays: Vec<Ray> = rays_for(&triangles, 1800, 31).into_iter().filter(|r| r.is_valid()).collect();
        let mut clear = 0;
        for test in TestKind::ALL {
            let accels: Vec<_> = registry::ALL
                .iter()
                .map(|entry| (entry.id, trace(build(entry, &geometry, test).as_ref(), &rays, Mode::Closest)))
                .collect();
            for (i, ray) in rays.iter().enumerate() {
                let Some(expected) = clear_answer(ray, &triangles) else { continue };
                clear += 1;
                for (id, hits) in &accels {
                    assert_eq!(hits[i].map(|h| h.primitive), expected, "{id} {test:?} on {name}: {ray:?}");
                }
            }
        }
        assert!(triangles.is_empty() || clear > 300, "only {clear} clear rays on {name} prove little");
    }
}

/// The primitive that is hit, if no edge, no other hit and no end of the interval is near.
fn clear_answer(ray: &Ray, triangles: &[[Vec3; 3]]) -> Option<Option<u32>> {
    let mut best: Option<(f64, u32)> = None;
    let mut second = f64::INFINITY;
    let scale = f64::from(ray.origin.length() + 1.0) / f64::from(ray.dir.length());
    for (i, tri) in triangles.iter().enumerate() {
        if boxwood::geometry::has_zero_area(tri) || passes_far(ray, tri) {
            continue;
        }
        let normal = (tri[1] - tri[0]).as_dvec3().cross((tri[2] - tri[0]).as_dvec3());
        let grazing = ray.dir.as_dvec3().dot(normal).abs() <= 1e-3 * f64::from(ray.dir.length()) * normal.length();
        let (t, inside) = meet_in_f64(ray, tri)?;
        // How far the ray passes from the nearest edge, in the units of the scene.
        let height =
            normal.length() / [0, 1, 2].map(|k| f64::from(tri[k].distance(tri[(k + 1) % 3]))).into_iter().fold(0.0, f64::max);
        if grazing || inside.abs() * height < 2e-6 * f64::from(ray.origin.length() + 1.0) {
            return None;
        }
        let ends = [f64::from(ray.tmin), f64::from(ray.tmax)];
        if inside > 0.0 && ends.iter().any(|end| (t - end).abs() < 1e-4 * scale) {
            return None;
        }
        if inside < 0.0 || t < ends[0] || t > ends[1] {
            continue;
        }
        match best {
            Some((closest, _)) if t >= closest => second = second.min(t),
            _ => {
                second = best.map_or(second, |b| b.0.min(second));
                best = Some((t, i as u32));
            }
        }
    }
    match best {
        Some((t, _)) if second - t < 1e-4 * scale => None,
        _ => Some(best.map(|b| b.1)),
    }
}

/// Whether the ray's line stays clear of the ball around the triangle.
fn passes_far(ray: &Ray, tri: &[Vec3; 3]) -> bool {
    let centre = tri.iter().map(|p| p.as_dvec3()).sum::<glam::DVec3>() / 3.0;
    let radius = tri.iter().map(|p| p.as_dvec3().distance(centre)).fold(0.0, f64::max);
    let (to_centre, dir) = (centre - ray.origin.as_dvec3(), ray.dir.as_dvec3());
    to_centre.reject_from(dir).length() > 1.1 * radius + 1e-5 * (100.0 + f64::from(ray.origin.length()))
}

#[test]
fn no_ray_slips_through_a_closed_mesh() {
    let triangles = ball(16);
    let geometry = geometry_of(&scene_of(&triangles));
    let mut random = Random(5);
    let rays: Vec<Ray> = (0..20_000)
        .map(|_| {
            let inside = random.point() * 0.1;
            let tri = triangles[random.bits() as usize % triangles.len()];
            let along = random.unit();
            Ray::new(inside, tri[0].lerp(tri[1], along) - inside)
        })
        .collect();
    for entry in registry::ALL {
        let hits = trace(build(entry, &geometry, TestKind::Watertight).as_ref(), &rays, Mode::Closest);
        assert_eq!(hits.iter().filter(|h| h.is_none()).count(), 0, "{} lets rays through edges", entry.id);
    }
}

#[test]
fn rays_that_make_no_sense_miss_and_are_counted() {
    let triangles = soup(20, 1.0, 3);
    let geometry = geometry_of(&scene_of(&triangles));
    let good = Ray::new(Vec3::ZERO, Vec3::X);
    let bad = [
        Ray { dir: Vec3::ZERO, ..good },
        Ray { dir: Vec3::new(f32::NAN, 0.0, 1.0), ..good },
        Ray { origin: Vec3::splat(f32::INFINITY), ..good },
        Ray { tmin: -1.0, ..good },
        Ray { tmin: 2.0, tmax: 1.0, ..good },
        Ray { tmax: f32::NAN, ..good },
    ];
    for entry in registry::ALL {
        let accel = build(entry, &geometry, TestKind::Watertight);
        let mut hits = [None; 6];
        let traced = accel.trace(&bad, Mode::Closest, &mut hits, &Cancel::new()).expect("not cancelled");
        assert_eq!((traced.invalid, hits), (6, [None; 6]), "{}", entry.id);
    }
}

#[test]
fn watched_rays_hit_the_same_and_count_what_statistics_predict() {
    let triangles = soup(500, 0.2, 12);
    let geometry = geometry_of(&scene_of(&triangles));
    let rays = rays_for(&triangles, 900, 13);
    for entry in registry::ALL {
        let accel = build(entry, &geometry, TestKind::Watertight);
        let hits = trace(accel.as_ref(), &rays, Mode::Closest);
        let mut counts = Counts::default();
        for (ray, hit) in rays.iter().zip(&hits) {
            assert_eq!(watch(accel.as_ref(), ray, Mode::Closest, &mut counts), *hit, "{}", entry.id);
        }
        assert!(counts.prims > 0 && counts.nodes >= counts.leaves && counts.leaves > 0, "{}: {counts:?}", entry.id);
        let stats = Stats::of(accel.as_ref(), SahWeights::default(), &Cancel::new()).expect("not cancelled");
        assert_eq!(stats.leaf_sizes.iter().sum::<u64>(), stats.leaves);
        assert_eq!(stats.leaf_depths.iter().sum::<u64>(), stats.leaves);
        assert!(stats.references >= geometry.live_count() as u64 && stats.sah > 0.0, "{}: {stats:?}", entry.id);
    }
}

#[test]
fn a_watched_ray_stops_when_asked() {
    let geometry = geometry_of(&scene_of(&soup(1000, 0.2, 14)));
    let ray = Ray::new(Vec3::new(-3.0, 0.0, 0.0), Vec3::X);
    let cancel = Cancel::new();
    cancel.cancel();
    for entry in registry::ALL {
        let accel = build(entry, &geometry, TestKind::Watertight);
        let mut counts = Counts::default();
        assert_eq!(accel.trace_watched(&ray, Mode::Any, &mut counts, &cancel), Err(Cancelled), "{}", entry.id);
        assert_eq!(accel.count_uncut(&ray, &mut counts, &cancel), Err(Cancelled), "{}", entry.id);
        assert_eq!(counts.prims, 0, "{}", entry.id);
    }
}

/// Where there is no structure one ray takes long: it stops on its way.
#[test]
fn a_ray_through_no_structure_stops_on_its_way() {
    let n = 300_000;
    let geometry = geometry_of(&scene_of(&soup(n, 0.2, 15)));
    let ray = Ray::new(Vec3::new(-3.0, 0.0, 0.0), Vec3::X);
    for entry in registry::ALL.iter().filter(|e| e.family == registry::Family::Brute) {
        let accel = build(entry, &geometry, TestKind::Watertight);
        let (cancel, mut counts) = (Cancel::new(), Counts::default());
        let mut at_the_first_test = |step| {
            if matches!(step, Step::Tested(..)) {
                cancel.cancel()
            }
        };
        let mut watched = Watched { counts: &mut counts, listener: Some(&mut at_the_first_test) };
        assert_eq!(accel.trace_heard(&ray, Mode::Closest, &mut watched, &cancel), Err(Cancelled), "{}", entry.id);
        assert!(counts.prims > 0 && counts.prims <= n as u64 / 4, "{}: {} of {n}", entry.id, counts.prims);
    }
}

#[test]
fn builds_do_not_depend_on_the_number_of_threads() {
    let triangles = soup(20_000, 0.02, 40);
    let geometry = geometry_of(&scene_of(&triangles));
    let rays = rays_for(&triangles, 500, 41);
    for (entry, params, variant) in variants().into_iter().filter(|v| v.0.family != registry::Family::Brute) {
        let of = |threads| entry.build(&geometry, TestKind::Watertight, &params, &BuildCx::unattended(threads)).expect("builds");
        let (one, three) = (of(1), of(3));
        let stats = |a: &dyn Accel| Stats::of(a, SahWeights::default(), &Cancel::new()).expect("not cancelled");
        assert_eq!(stats(one.as_ref()), stats(three.as_ref()), "{} {variant}", entry.id);
        assert_eq!(trace(one.as_ref(), &rays, Mode::Closest), trace(three.as_ref(), &rays, Mode::Closest), "{}", entry.id);
    }
}

#[test]
fn every_switch_gives_the_same_hits() {
    let triangles = soup(400, 0.3, 50);
    let geometry = geometry_of(&scene_of(&triangles));
    let rays = rays_for(&triangles, 900, 51);
    let expected = trace(build(&registry::ALL[0], &geometry, TestKind::Watertight).as_ref(), &rays, Mode::Closest);
    let settings: &[(&str, &[(&str, &str)])] = &[
        ("bvh", &[("order", "fixed")]),
        ("bvh", &[("early_out", "off")]),
        ("bvh", &[("order", "fixed"), ("early_out", "off")]),
        ("bvh", &[("bins", "2"), ("max_leaf", "1")]),
        ("bvh", &[("max_depth", "3")]),
        ("bvh", &[("builder", "binned"), ("bins", "2"), ("max_leaf", "1")]),
        ("bvh", &[("builder", "ploc"), ("max_depth", "5"), ("radius", "1")]),
        ("bvh", &[("builder", "lbvh"), ("max_depth", "9"), ("max_leaf", "64")]),
        ("bvh", &[("builder", "sbvh"), ("alpha", "0"), ("duplication", "8")]),
        ("bvh", &[("builder", "sbvh"), ("alpha", "0"), ("reinsertion", "on"), ("reinsertion_gain", "0")]),
        ("bvh", &[("builder", "median"), ("reinsertion", "on"), ("reinsertion_gain", "0"), ("max_depth", "11")]),
        ("kdtree", &[("builder", "binned"), ("bins", "2"), ("mailbox", "off")]),
        ("kdtree", &[("builder", "sah"), ("mailbox", "off")]),
        ("kdtree", &[("builder", "sah"), ("max_leaf", "1"), ("empty_bonus", "0"), ("c_isect", "20")]),
        ("volumes", &[("volume", "kdop8"), ("max_leaf", "1")]),
        ("volumes", &[("volume", "hull"), ("max_leaf", "1"), ("max_depth", "3")]),
        ("kdtree", &[("max_depth", "4"), ("bins", "2")]),
        ("kdtree", &[("max_leaf", "1"), ("empty_bonus", "0.9"), ("c_isect", "20")]),
        ("grid", &[("density", "0.01")]),
        ("grid", &[("density", "64")]),
        ("grid2", &[("density", "0.001"), ("leaf_density", "64")]),
        ("grid2", &[("density", "16"), ("leaf_density", "0.01")]),
        ("grid2", &[("density", "1"), ("leaf_density", "1")]),
        ("octree", &[("max_depth", "0")]),
        ("octree", &[("max_depth", "3"), ("max_leaf", "1")]),
        ("octree", &[("max_leaf", "1"), ("max_refs", "256"), ("c_trav", "0.01")]),
        ("octree", &[("max_refs", "1"), ("c_isect", "100")]),
    ];
    for (id, set) in settings {
        let entry = registry::find(id).expect("registered");
        let mut params = entry.defaults();
        set.iter().for_each(|(k, v)| params.set(k, v).expect("valid"));
        let accel = entry.build(&geometry, TestKind::Watertight, &params, &BuildCx::unattended(2)).expect("builds");
        assert_eq!(validate::defects(accel.as_ref(), &geometry, 3), [], "{id} {set:?}");
        compare(entry, accel.as_ref(), &expected, &rays, &format!("{set:?}"));
        if let Some((_, depth)) = set.iter().find(|(k, _)| *k == "max_depth") {
            let stats = Stats::of(accel.as_ref(), SahWeights::default(), &Cancel::new()).expect("not cancelled");
            assert!(stats.max_depth <= depth.parse().expect("a number"), "{id}");
        }
    }
}

#[test]
fn a_build_stops_when_asked_and_keeps_to_its_budget() {
    let geometry = geometry_of(&scene_of(&soup(20_000, 0.05, 60)));
    for entry in registry::ALL {
        let cx = BuildCx::unattended(2);
        cx.cancel.cancel();
        let stopped = entry.build(&geometry, TestKind::Watertight, &entry.defaults(), &cx).err();
        assert!(matches!(stopped, Some(BuildError::Cancelled(_))), "{}: {stopped:?}", entry.id);

        let cx = BuildCx { budget: Budget::new(100_000), ..BuildCx::unattended(2) };
        let small = entry.build(&geometry, TestKind::Watertight, &entry.defaults(), &cx);
        if entry.family != registry::Family::Brute {
            let error = small.err().unwrap_or_else(|| panic!("{} fits into nothing", entry.id));
            assert!(error.to_string().contains("MiB"), "{error}");
        }
        assert_eq!(cx.budget.used(), 0, "{} keeps memory after a refusal", entry.id);

        let cx = BuildCx { budget: Budget::new(1 << 30), ..BuildCx::unattended(2) };
        let accel = entry.build(&geometry, TestKind::Watertight, &entry.defaults(), &cx).expect("fits");
        let bytes: u64 = accel.memory().iter().map(|m| m.bytes).sum();
        assert!(cx.budget.used() >= bytes, "{}: charged {} of {bytes}", entry.id, cx.budget.used());
        drop(accel);
        assert_eq!(cx.budget.used(), 0, "{}", entry.id);
    }
}

/// Found by made-up scenes: the ray misses the triangle by 1e-20 behind its origin; a box taken as it
/// is held only the part in front, and clamping t into it made a hit at the origin.
#[test]
fn a_near_miss_behind_the_origin_is_no_hit_at_it() {
    let triangles = [[Vec3::new(0.0, 0.25, -0.0), Vec3::new(-0.5, -0.0, -1.0), Vec3::new(0.25, 0.0, 0.0)]];
    let geometry = geometry_of(&scene_of(&triangles));
    let ray = Ray::new(Vec3::new(0.0, 0.0, -1.0), Vec3::new(0.25, 1e-20, -0.0));
    for (entry, test) in registry::ALL.iter().flat_map(|e| TestKind::ALL.map(|t| (e, t))) {
        assert_eq!(trace(build(entry, &geometry, test).as_ref(), &[ray], Mode::Closest), [None], "{} {test:?}", entry.id);
    }
}

fn coordinate() -> impl Strategy<Value = f32> {
    // Few distinct values, so that corners, edges and planes coincide; some ordinary ones.
    prop_oneof![3 => (-4i8..=4).prop_map(|i| f32::from(i) * 0.25), 2 => -1.0f32..1.0, 1 => Just(-0.0f32), 1 => Just(1e-20f32)]
}

fn vector() -> impl Strategy<Value = Vec3> {
    (coordinate(), coordinate(), coordinate()).prop_map(|(x, y, z)| Vec3::new(x, y, z))
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 300, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn made_up_scenes_conform(
        triangles in proptest::collection::vec((vector(), vector(), vector()).prop_map(|(a, b, c)| [a, b, c]), 0..40),
        rays in proptest::collection::vec((vector(), vector()), 1..40),
    ) {
        let rays: Vec<Ray> = rays.into_iter().map(|(origin, dir)| Ray::new(origin * 2.0, dir)).collect();
        conforms(&triangles, &rays, "a made-up scene");
    }
}
