//! The tree of eights against brute force and against itself on the plain road; every other promise is
//! held by the conformance suite.

use std::sync::Arc;

use super::leaf::{Indexed, Patch, Plain};
use super::*;
use crate::accel::cell::walk;
use crate::accel::params::ParamValues;
use crate::accel::{Accel, Hit, Mode, registry};
use crate::geometry::Ray;
use crate::geometry::tri::{Fast, TestKind, Watertight};
use crate::scene::{LoadCx, open as open_scene};
use crate::simd::Road;
use crate::task::{Budget, Cancel, Pool, Progress};
use glam::Vec3;
use tree::Tree;

fn geometry(model: &str) -> Arc<Geometry> {
    let cx = LoadCx::new(Cancel::new(), Progress::new(), Budget::unlimited(), Pool::new("load", 1));
    let scene = open_scene(model, &cx).expect("a built-in scene");
    Arc::new(Geometry::new(&scene, &cx).expect("small"))
}

fn params(set: &[(&str, &str)]) -> ParamValues {
    let mut p = ParamValues::defaults(PARAMS);
    set.iter().for_each(|(id, value)| p.set(id, value).expect("a parameter"));
    p
}

/// Rays from all around the scene, and from inside it, some along the axes.
fn rays(geometry: &Geometry) -> Vec<Ray> {
    let b = geometry.world_bounds();
    let (centre, size) = (b.centre(), (b.max - b.min).max_element());
    (0..3000u16)
        .map(|i| {
            let a = f32::from(i) * 2.399_963;
            let z = 1.0 - 2.0 * (f32::from(i) + 0.5) / 3000.0;
            let r = (1.0 - z * z).sqrt();
            let away = Vec3::new(r * a.cos(), r * a.sin(), z);
            let aim = centre + 0.3 * size * Vec3::new((a * 3.0).sin(), (a * 5.0).sin(), (a * 7.0).sin());
            let origin = centre + away * size * if i % 3 == 0 { 0.2 } else { 1.5 };
            let dir = if i % 7 == 0 { Vec3::AXES[usize::from(i) % 3] } else { aim - origin };
            Ray { tmax: if i % 5 == 0 { 0.9 } else { f32::INFINITY }, ..Ray::new(origin, dir) }
        })
        .collect()
}

/// Rays of a camera, neighbours side by side, then shadow rays to one light.
fn coherent(geometry: &Geometry, hits: &[Option<Hit>], rays: &[Ray]) -> Vec<Ray> {
    let b = geometry.world_bounds();
    let (centre, size) = (b.centre(), (b.max - b.min).max_element());
    let eye = centre + size * Vec3::new(0.4, 1.1, 0.7);
    let (right, up) = (Vec3::new(0.8, 0.0, -0.6), Vec3::new(-0.3, 0.8, -0.5));
    let across = |i: u16| right * (f32::from(i % 80) / 80.0 - 0.5) + up * (f32::from(i / 80) / 80.0 - 0.5);
    let tmin = |i: u16| if i.is_multiple_of(11) { 0.8 } else { 0.0 };
    let camera = (0..6400).map(|i| Ray { tmin: tmin(i), ..Ray::new(eye, centre - eye + size * across(i)) });
    let light = centre + size * Vec3::new(0.1, 3.0, 0.2);
    let points = rays.iter().zip(hits).filter_map(|(ray, hit)| hit.map(|hit| ray.at(hit.t)));
    camera.chain(points.map(|p| Ray { tmin: 1e-4, ..Ray::segment(p, light) })).collect()
}

fn trace(accel: &dyn Accel, rays: &[Ray], mode: Mode) -> Vec<Option<Hit>> {
    let mut hits = vec![None; rays.len()];
    let traced = accel.trace(rays, mode, &mut hits, &Cancel::new()).expect("not cancelled");
    assert!(traced.in_beams <= rays.len() as u64);
    hits
}

fn in_beams(accel: &dyn Accel, rays: &[Ray]) -> u64 {
    accel.trace(rays, Mode::Any, &mut vec![None; rays.len()], &Cancel::new()).expect("not cancelled").in_beams
}

/// In batches and one by one, on every road, the hits are those of brute force.
fn equals_brute<T: TriTest, B: leaf::Pack>(model: &str, set: &[(&str, &str)], kind: TestKind) {
    let (geometry, cx) = (geometry(model), BuildCx::unattended(2));
    let brute = registry::find("brute").expect("registered");
    let brute = brute.build(&geometry, kind, &brute.defaults(), &cx).expect("small");
    let p = params(set);
    let scattered = rays(&geometry);
    let first = trace(&*brute, &scattered, Mode::Closest);
    let mut rays = coherent(&geometry, &first, &scattered);
    rays.extend(scattered);
    let expected = trace(&*brute, &rays, Mode::Closest);
    assert!(expected.iter().flatten().count() > 100, "{model}: most rays miss");
    let any = trace(&*brute, &rays, Mode::Any);
    for road in Road::all() {
        let drafted = bvh::draft(&geometry, &p, bvh::Auto::Whole, &cx).expect("small");
        let mut tree: Tree<T, B> = build::build(&geometry, drafted, &p, &cx).expect("small");
        tree.road = road;
        assert_eq!(trace(&tree, &rays, Mode::Closest), expected, "{model}, {}", road.id());
        if !matches!(road, Road::Portable(_)) {
            assert!(in_beams(&tree, &rays[..6400]) > 2000, "{model}: a camera's rays go as beams");
        }
        assert!(in_beams(&tree, &rays[rays.len() - 3000..]) < 300, "{model}: scattered rays go their own ways");
        let found = trace(&tree, &rays, Mode::Any);
        assert!(found.iter().zip(&any).all(|(a, b)| a.is_some() == b.is_some()), "{model}, {}, any hit", road.id());
        for (ray, expected) in rays.iter().zip(&expected).step_by(17) {
            assert_eq!(trace(&tree, &[*ray], Mode::Closest), [*expected]);
        }
    }
}

#[test]
fn patches_give_the_hits_of_brute_force_on_every_road() {
    equals_brute::<Watertight, Patch>("builtin:teapot", &[], TestKind::Watertight);
    equals_brute::<Fast, Patch>("builtin:teapot", &[("builder", "binned")], TestKind::Fast);
    equals_brute::<Watertight, Patch>("builtin:soup?triangles=3000", &[("wide_leaf", "32")], TestKind::Watertight);
}

#[test]
fn beams_are_no_wider_than_pays() {
    // The same rays, up to a fortieth of the extent apart: as wide as a leaf of the one, far wider than those of the other.
    let beams = |model: &str| {
        let geometry = geometry(model);
        let built = build::<Fast>(&geometry, &params(&[]), &BuildCx::unattended(2)).expect("small");
        let (b, i) = (*geometry.world_bounds(), |i: u16| f32::from(i % 8) * 0.03 / 8.0);
        let size = (b.max - b.min).max_element();
        let rays: Vec<Ray> =
            (0..800).map(|k| Ray::new(b.centre() + size * Vec3::new(i(k), 2.0, 0.0), Vec3::new(0.01, -1.0, 0.02))).collect();
        in_beams(&*built, &rays)
    };
    assert_eq!(beams("builtin:terrain?triangles=2000"), 800);
    assert_eq!(beams("builtin:terrain?triangles=1000000"), 0);
}

#[test]
fn rays_that_are_not_valid_are_counted_however_many_there_are() {
    let geometry = geometry("builtin:teapot");
    let built = build::<Watertight>(&geometry, &params(&[]), &BuildCx::unattended(1)).expect("small");
    let mut rays = vec![Ray::new(Vec3::ZERO, Vec3::ZERO); 5000];
    rays[4321] = Ray::new(geometry.world_bounds().centre() + Vec3::splat(50.0), Vec3::splat(-1.0));
    let mut hits = vec![Some(Hit { t: 0.0, u: 0.0, v: 0.0, instance: 0, primitive: 0 }); rays.len()];
    let traced = built.trace(&rays, Mode::Closest, &mut hits, &Cancel::new()).expect("not cancelled");
    assert_eq!((traced.invalid, traced.in_beams), (4999, 0));
    assert_eq!(hits.iter().flatten().count(), usize::from(trace(&*built, &rays[4321..4322], Mode::Closest)[0].is_some()));
    let cancelled = Cancel::new();
    cancelled.cancel();
    assert!(built.trace(&rays, Mode::Closest, &mut hits, &cancelled).is_err());
}

#[test]
fn plain_leaves_give_the_hits_of_brute_force_on_every_road() {
    equals_brute::<Watertight, Plain>("builtin:menger", &[], TestKind::Watertight);
    equals_brute::<Fast, Plain>("builtin:hair?triangles=20000", &[("wide_leaf", "20")], TestKind::Fast);
}

#[test]
fn auto_cuts_triangles_where_siblings_overlap_much() {
    for (model, expected) in [("builtin:terrain?triangles=2000", false), ("builtin:hair?triangles=100000", true)] {
        let remark = |set: &[(&str, &str)]| {
            let built = build::<Watertight>(&geometry(model), &params(set), &BuildCx::unattended(1)).expect("small");
            built.remarks().into_iter().find(|r| r.starts_with("Builder:"))
        };
        let cut = remark(&[]).expect("a remark").contains("took sbvh, as siblings overlap by ");
        assert_eq!(cut, expected, "{model}");
        assert!(!remark(&[("layout", "compressed")]).expect("a remark").contains("sbvh"), "cutting takes memory");
        assert_eq!(remark(&[("builder", "binned")]), None, "nothing is decided where a builder is named");
    }
}

#[test]
fn triangles_stay_whole_where_the_memory_does_not_suffice_to_cut_them() {
    let (geometry, p) = (geometry("builtin:hair?triangles=100000"), params(&[]));
    let whole = bvh::draft(&geometry, &p, bvh::Auto::Whole, &BuildCx::unattended(1)).expect("small");
    let cx = BuildCx { budget: Budget::new(whole.peak.bytes()), ..BuildCx::unattended(1) };
    let drafted = bvh::draft(&geometry, &p, bvh::Auto::MayCut, &cx).expect("as much as before");
    assert!(!drafted.splits && drafted.draft.nodes.len() == whole.draft.nodes.len());
    assert!(bvh::draft(&geometry, &p, bvh::Auto::MayCut, &BuildCx::unattended(1)).expect("small").splits);
}

#[test]
fn compressed_trees_give_the_hits_of_brute_force_on_every_road() {
    equals_brute::<Watertight, Indexed>("builtin:teapot", &[], TestKind::Watertight);
    equals_brute::<Fast, Indexed>("builtin:menger", &[("wide_leaf", "20")], TestKind::Fast);
    equals_brute::<Watertight, Indexed>("builtin:soup?triangles=3000", &[("wide_leaf", "32")], TestKind::Watertight);
}

#[test]
fn auto_takes_patches_for_meshes_and_plain_leaves_for_soups() {
    for (model, expected) in [("builtin:terrain?triangles=2000", "patches"), ("builtin:soup?triangles=2000", "plain")] {
        let built = build::<Watertight>(&geometry(model), &params(&[]), &BuildCx::unattended(1)).expect("small");
        let remark = built.remarks().into_iter().find(|r| r.starts_with("Leaves:")).expect("a remark");
        assert!(remark.contains(&format!("took {expected},")), "{model}: {remark}");
    }
}

#[test]
fn a_mesh_takes_no_more_bytes_than_promised() {
    let geometry = geometry("builtin:terrain?triangles=20000");
    for (layout, most) in [("full", 70), ("compressed", 36)] {
        let p = params(&[("layout", layout)]);
        let built = build::<Watertight>(&geometry, &p, &BuildCx::unattended(1)).expect("small");
        let bytes: u64 = built.memory().iter().map(|part| part.bytes).sum();
        assert!(bytes <= most * geometry.live_count() as u64, "{layout}: {bytes} bytes");
    }
}

#[test]
fn triangles_at_one_place_go_into_nodes_below_each_other() {
    // All of them in one leaf of the binary tree: more blocks than a leaf can refer to.
    let geometry = geometry("builtin:soup?triangles=400");
    let p = params(&[("wide_leaf", "32"), ("c_block", "0"), ("leaves", "patches")]);
    let cx = BuildCx::unattended(1);
    let drafted = bvh::draft(&geometry, &p, bvh::Auto::Whole, &cx).expect("small");
    let tree: Tree<Watertight, Patch> = build::build(&geometry, drafted, &p, &cx).expect("small");
    let mut prims = 0;
    walk(&tree, &mut |cell| {
        prims += cell.prims();
        std::ops::ControlFlow::Continue(crate::accel::cell::Descend::Yes)
    });
    assert_eq!(prims, 400);
}
