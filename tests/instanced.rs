//! Scenes of two levels: every structure below the upper level answers as `brute` does over the same
//! instances, and as the flattened scene does where a ray passes no edge closely.

mod common;

use std::collections::HashSet;
use std::ops::ControlFlow;
use std::sync::Arc;

use boxwood::accel::cell::{Descend, bounds_in_scene, walk};
use boxwood::accel::probe::Counts;
use boxwood::accel::{Filter, Hit, Mode, Step, cell, registry, validate};
use boxwood::geometry::tri::TestKind;
use boxwood::geometry::{Aabb, Ray};
use boxwood::scene::{Geometry, Instance, LoadCx, Mesh, Scene};
use boxwood::task::Cancel;
use common::{Random, ball, build, meet_in_f64, rays_for, scene_of, soup, trace, watch};
use glam::{Affine3A, Mat3A, Quat, Vec3, Vec3A};

fn mesh_of(triangles: &[[Vec3; 3]]) -> Mesh {
    scene_of(triangles).meshes.remove(0)
}

/// Turned, mirrored, sheared, stretched, tiny, huge, flat and vanished.
fn transforms(n: usize, seed: u64) -> Vec<Affine3A> {
    let mut random = Random(seed);
    let mut transform = |i: usize| {
        let turn = Quat::from_euler(glam::EulerRot::XYZ, random.unit() * 6.0, random.unit() * 6.0, random.unit() * 6.0);
        let at = random.point() * 4.0;
        let stretch = match i % 9 {
            0 => Vec3::ONE,
            1 => Vec3::new(-1.0, 1.0, 1.0),
            2 => Vec3::new(1.0, 10.0, 0.1),
            3 => Vec3::splat(1e-3),
            4 => Vec3::new(-2.0, -0.5, -1.0),
            5 => Vec3::new(1.0, 0.0, 1.0),
            6 => Vec3::ZERO,
            7 => Vec3::new(0.0, 0.0, 3.0),
            _ => Vec3::splat(0.5),
        };
        let shear = if i % 9 == 8 { Vec3::new(0.7, -1.3, 0.4) } else { Vec3::ZERO };
        let shear = Mat3A::from_cols(Vec3A::X, Vec3A::new(shear.x, 1.0, 0.0), Vec3A::new(shear.y, shear.z, 1.0));
        let mut placed = Affine3A::from_scale_rotation_translation(stretch, turn, at);
        placed.matrix3 *= shear;
        placed
    };
    (0..n).map(&mut transform).collect()
}

/// Three meshes, the first and the last in many places, and one in one.
fn scene() -> Scene {
    let meshes = vec![mesh_of(&ball(12)), mesh_of(&soup(150, 0.5, 3)), mesh_of(&soup(60, 1.5, 5))];
    let mut instances: Vec<Instance> =
        transforms(45, 7).into_iter().map(|world_from_object| Instance { mesh: 0, world_from_object }).collect();
    instances.insert(20, Instance::identity(1));
    instances.extend(transforms(9, 11).into_iter().map(|world_from_object| Instance { mesh: 2, world_from_object }));
    Scene { name: "instances".into(), meshes, instances, up: Vec3::Y, ..Scene::default() }
}

fn two_levels(scene: &Scene) -> Arc<Geometry> {
    Arc::new(Geometry::with_instances(scene, &LoadCx::unattended()).expect("small"))
}

/// The triangles of all instances in the world.
fn flattened(scene: &Scene) -> Vec<[Vec3; 3]> {
    let triangles = |i: &Instance| {
        let (mesh, map) = (&scene.meshes[i.mesh], i.world_from_object);
        mesh.triangles.iter().map(move |t| t.map(|v| map.transform_point3(mesh.positions[v as usize]))).collect::<Vec<_>>()
    };
    scene.instances.iter().flat_map(triangles).collect()
}

#[test]
fn every_structure_answers_as_brute_force_over_the_same_instances() {
    let scene = scene();
    let geometry = two_levels(&scene);
    let rays = rays_for(&flattened(&scene), 2000, 17);
    for test in TestKind::ALL {
        let brute = build(&registry::ALL[0], &geometry, test);
        let expected = trace(brute.as_ref(), &rays, Mode::Closest);
        assert!(expected.iter().flatten().count() > 500);
        for entry in registry::ALL {
            let accel = build(entry, &geometry, test);
            let what = format!("{} {}", entry.id, test.id());
            assert!(accel.levels().is_some());
            let hits = trace(accel.as_ref(), &rays, Mode::Closest);
            let differ = |(ray, a, b): &(&Ray, &Option<Hit>, &Option<Hit>)| a != b && !near(&geometry, ray, a, b);
            let wrong = rays.iter().zip(&hits).zip(&expected).map(|((r, a), b)| (r, a, b)).find(differ);
            assert_eq!(wrong, None, "{what}");
            if accel.layout() == cell::Layout::Hierarchy {
                assert!(hits == expected, "{what}: to the bit");
            }
            let mut plain = vec![None; rays.len()];
            accel.trace_like_for_like(&rays, Mode::Closest, &mut plain, &Cancel::new()).expect("not cancelled");
            assert!(plain == hits, "{what}: on every road");
            let any = trace(accel.as_ref(), &rays, Mode::Any);
            for ((ray, hit), any) in rays.iter().zip(&hits).zip(any) {
                let watched = watch(accel.as_ref(), ray, Mode::Closest, &mut Counts::default());
                assert_eq!(watched, *hit, "{what}: watched");
                assert!(any.is_some() == hit.is_some() || near(&geometry, ray, hit, &any), "{what}: any hit of {ray:?}");
            }
        }
    }
}

/// Whether two answers differ by no more than structures of cells may: nearly one t, or a ray in the plane of a triangle.
fn near(geometry: &Geometry, ray: &Ray, a: &Option<Hit>, b: &Option<Hit>) -> bool {
    let tie = matches!((a, b), (Some(a), Some(b)) if (a.t - b.t).abs() <= 1e-5 * (1.0 + a.t.abs()));
    let grazes = |hit: &Hit| {
        let [p, q, r] = geometry.corners_of(hit.instance, hit.primitive).map(|p| p.as_dvec3());
        let (normal, dir) = ((q - p).cross(r - p), ray.dir.as_dvec3());
        normal.dot(dir).abs() <= 1e-4 * normal.length() * dir.length()
    };
    tie || [a, b].into_iter().flatten().any(grazes)
}

#[test]
fn hits_are_those_of_the_flattened_scene() {
    let scene = scene();
    let (geometry, triangles) = (two_levels(&scene), flattened(&scene));
    let placed = geometry.placed().expect("two levels");
    assert_eq!(placed.parts().len(), 2);
    let vanished: usize = 2 * 5 * 12 * 12 * 4 + 2 * 60;
    assert_eq!(geometry.counts().triangles as usize, triangles.len());
    assert!(geometry.counts().degenerate as usize >= vanished);
    let first: Vec<usize> = scene
        .instances
        .iter()
        .scan(0, |at, i| {
            let first = *at;
            *at += scene.meshes[i.mesh].triangles.len();
            Some(first)
        })
        .collect();
    let accel = build(registry::find("bvh").expect("registered"), &geometry, TestKind::Watertight);
    let mut random = Random(23);
    let (mut clear, mut met) = (0, 0);
    for _ in 0..3000 {
        let ray = Ray::new(random.point() * 9.0, random.point());
        let hit = trace(accel.as_ref(), &[ray], Mode::Closest)[0];
        let passing: Vec<(usize, f64, f64)> = triangles
            .iter()
            .enumerate()
            .filter_map(|(i, tri)| meet_in_f64(&ray, tri).map(|(t, inside)| (i, t, inside)))
            .filter(|(_, t, inside)| *t > -1e-3 && *inside > -1e-3)
            .collect();
        let nearest = passing.iter().copied().min_by(|a, b| a.1.total_cmp(&b.1));
        // Only rays of which there is no doubt.
        if passing.iter().any(|p| p.2 < 1e-3 || p.1 < 1e-3) {
            continue;
        }
        clear += 1;
        match (hit, nearest) {
            (None, None) => {}
            (Some(hit), Some((i, t, _))) => {
                met += 1;
                let found = first[hit.instance as usize] + hit.primitive as usize;
                let close = (f64::from(hit.t) - t).abs() <= 1e-4 * (1.0 + t);
                assert!(close, "{ray:?}: {hit:?}, 64 bits say {i} at {t}, it says {found}");
            }
            other => panic!("{ray:?}: {other:?}"),
        }
    }
    assert!(clear > 1500 && met > 100, "{clear} {met}");
}

#[test]
fn places_bound_their_meshes_and_each_is_reached_once() {
    let scene = scene();
    let geometry = two_levels(&scene);
    let placed = geometry.placed().expect("two levels");
    for place in placed.places() {
        let part = &placed.parts()[place.part as usize];
        let (map, mut tight) = (place.scene_from_part(), Aabb::EMPTY);
        for i in 0..part.live_count() {
            tight = part.corners(part.live(i)).iter().fold(tight, |b, p| b.with(map.transform_point3(p.as_dvec3()).as_vec3()));
        }
        assert!(place.bounds.contains_box(&tight));
        let (room, size) = (place.bounds.size() - tight.size(), tight.size().max_element());
        assert!(room.max_element() < 2e-4 * size + 1e-6, "{room} of {size}");
        assert_eq!(placed.of_instance(place.instance).map(|p| p.instance), Some(place.instance));
    }
    for entry in registry::ALL {
        let accel = build(entry, &geometry, TestKind::Watertight);
        let levels = accel.levels().expect("two levels");
        for part in levels.parts().iter().map(|part| &**part).chain(levels.rest()) {
            assert_eq!(validate::defects(part, part.geometry(), 3), [], "{}", entry.id);
        }
        let (mut seen, mut instances, mut refs) = (HashSet::new(), HashSet::new(), 0u64);
        walk(accel.as_ref(), &mut |cell| {
            assert!(seen.insert(cell.id), "{}: {:?} twice", entry.id, cell.id);
            instances.insert(cell.id.instance);
            let around = bounds_in_scene(accel.as_ref(), cell);
            if accel.layout() == cell::Layout::Hierarchy {
                // The box around a turned mesh is tighter than what is around its turned box.
                let same_level = |child: &cell::Cell| child.id.instance == cell.id.instance;
                accel.children(cell, &mut |child| {
                    let slack = Vec3::splat(2e-6);
                    let inside = bounds_in_scene(accel.as_ref(), &child);
                    let room = Aabb { min: around.min - slack, max: around.max + slack };
                    assert!(!same_level(&child) || room.contains_box(&inside), "{}: {around:?} {inside:?}", entry.id);
                    ControlFlow::Continue(())
                });
            }
            if cell.is_leaf() {
                accel.prims(cell, &mut |_| refs += 1);
            }
            ControlFlow::Continue(Descend::Yes)
        });
        // The upper level, the places, and what was flattened.
        assert_eq!(instances.len(), 1 + placed.places().len() + 1, "{}", entry.id);
        assert!(refs >= geometry.counts().live, "{}: {refs} references of {:?}", entry.id, geometry.counts());
    }
}

#[test]
fn bytes_are_those_of_meshes_not_of_copies() {
    let bytes = |copies: usize| {
        let meshes = vec![mesh_of(&ball(40))];
        let instances = transforms(9 * copies, 3).into_iter().step_by(9);
        let instances = instances.map(|world_from_object| Instance { mesh: 0, world_from_object }).collect();
        let geometry = two_levels(&Scene { meshes, instances, up: Vec3::Y, ..Scene::default() });
        let accel = build(registry::find("wide").expect("registered"), &geometry, TestKind::Watertight);
        let structure: u64 = accel.memory().iter().map(|part| part.bytes).sum();
        (geometry.bytes() + structure, geometry.counts().live)
    };
    let ((few, triangles), (many, all)) = (bytes(4), bytes(404));
    assert_eq!(all, 101 * triangles);
    assert!((many - few) / 400 < 300, "a place takes {} bytes", (many - few) / 400);
}

#[test]
fn a_mesh_in_one_place_has_no_upper_level() {
    let mut scene = scene();
    scene.instances.retain(|i| i.mesh == 1);
    let geometry = two_levels(&scene);
    assert!(geometry.placed().is_none());
    assert!(build(&registry::ALL[2], &geometry, TestKind::Fast).levels().is_none());
}

/// Every other triangle of every other instance.
struct Halved;

impl Filter for Halved {
    fn accepts(&self, hit: &Hit) -> bool {
        (hit.instance + hit.primitive).is_multiple_of(2)
    }
}

#[test]
fn a_filter_leaves_out_the_same_hits_in_every_structure() {
    let scene = scene();
    let rays = rays_for(&flattened(&scene), 600, 29);
    let flat = Arc::new(Geometry::new(&scene, &LoadCx::unattended()).expect("small"));
    for geometry in [two_levels(&scene), flat] {
        let sifted = |entry: &registry::Entry, mode| {
            let (accel, mut hits) = (build(entry, &geometry, TestKind::Watertight), vec![None; rays.len()]);
            accel.trace_filtered(&rays, mode, &Halved, &mut hits, &Cancel::new()).expect("not cancelled");
            hits
        };
        let expected = sifted(&registry::ALL[0], Mode::Closest);
        let all = trace(build(&registry::ALL[0], &geometry, TestKind::Watertight).as_ref(), &rays, Mode::Closest);
        let changed = all.iter().zip(&expected).filter(|(a, b)| a != b).count();
        assert!(changed > 50 && expected.iter().flatten().all(|hit| Halved.accepts(hit)), "{changed}");
        for entry in registry::ALL {
            let (closest, any) = (sifted(entry, Mode::Closest), sifted(entry, Mode::Any));
            for (i, ray) in rays.iter().enumerate() {
                let same = closest[i] == expected[i] || near(&geometry, ray, &closest[i], &expected[i]);
                assert!(same, "{}: {:?}, brute {:?}", entry.id, closest[i], expected[i]);
                let some = any[i].is_some() == expected[i].is_some() || near(&geometry, ray, &any[i], &expected[i]);
                assert!(some && any[i].is_none_or(|hit| Halved.accepts(&hit)), "{}: {ray:?}", entry.id);
            }
        }
    }
}

#[test]
fn a_listener_hears_both_levels() {
    let scene = scene();
    let geometry = two_levels(&scene);
    let accel = build(registry::find("bvh").expect("registered"), &geometry, TestKind::Watertight);
    let ray = Ray::new(Vec3::new(-9.0, 0.1, 0.2), Vec3::new(1.0, 0.01, 0.0));
    let (mut counts, mut levels, mut entered) = (Counts::default(), Vec::new(), 0);
    let mut listener = |step| match step {
        Step::Level(level) => levels.push(level),
        Step::Entered(_) => entered += 1,
        _ => {}
    };
    let mut watched = boxwood::accel::probe::Watched { counts: &mut counts, listener: Some(&mut listener) };
    accel.trace_heard(&ray, Mode::Closest, &mut watched, &Cancel::new()).expect("not cancelled");
    assert!(levels.len() >= 2 && levels.chunks(2).all(|pair| pair[0] > 0 && pair[1] == 0), "{levels:?}");
    assert_eq!(counts.nodes, entered);
}
