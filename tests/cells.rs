//! What the structures that divide space owe to their scenes, in counts: how a grid in two levels
//! copes with what a uniform one fails at, and how an octree divides.

mod common;

use std::sync::Arc;

use boxwood::accel::probe::Counts;
use boxwood::accel::stats::{SahWeights, Stats};
use boxwood::accel::{Accel, BuildCx, Mode, cell, registry};
use boxwood::geometry::Ray;
use boxwood::geometry::tri::TestKind;
use boxwood::lab::follow::follow;
use boxwood::scene::{Geometry, LoadCx, Scene, builtin};
use boxwood::task::Cancel;
use common::{geometry_of, scene_of, soup, watch};
use glam::{Vec2, Vec3};

fn built(id: &str, set: &[(&str, &str)], geometry: &Arc<Geometry>) -> Box<dyn Accel> {
    let entry = registry::find(id).expect("registered");
    let mut params = entry.defaults();
    set.iter().for_each(|(k, v)| params.set(k, v).expect("valid"));
    entry.build(geometry, TestKind::Watertight, &params, &BuildCx::unattended(2)).expect("builds")
}

fn stats(accel: &dyn Accel) -> Stats {
    Stats::of(accel, SahWeights::default(), &Cancel::new()).expect("not cancelled")
}

/// Rays of the scene's own view.
fn primary(scene: &Scene, geometry: &Geometry, side: u16) -> Vec<Ray> {
    let camera = scene.first_camera(geometry.world_bounds(), 1.5);
    let frame = camera.frame();
    let ndc = |i: u16| (f32::from(i) + 0.5) / f32::from(side) * 2.0 - 1.0;
    let pixels = (0..side).flat_map(|y| (0..side).map(move |x| (x, y)));
    pixels.map(|(x, y)| camera.ray(&frame, Vec2::new(ndc(x), ndc(y)), 1.5)).collect()
}

fn counts(accel: &dyn Accel, rays: &[Ray]) -> Counts {
    let mut counts = Counts::default();
    rays.iter().for_each(|ray| {
        watch(accel, ray, Mode::Closest, &mut counts);
    });
    counts
}

#[test]
fn a_second_level_cures_the_teapot_in_the_stadium() {
    let scene = builtin::generate("teapot-in-stadium", &LoadCx::unattended()).expect("fits");
    let geometry = geometry_of(&scene);
    let rays = primary(&scene, &geometry, 16);
    let tests = |id, set: &[_]| counts(built(id, set, &geometry).as_ref(), &rays).prims as f64 / rays.len() as f64;
    // As many cells a triangle in either, so that what differs is the second level.
    let (grid, grid2) = (tests("grid", &[("density", "4")]), tests("grid2", &[("leaf_density", "4")]));
    let octree = tests("octree", &[]);
    println!("tests a ray: grid {grid:.0}, grid2 {grid2:.0}, octree {octree:.1}");
    assert!(grid > 5_000.0, "the teapot should fall into one cell: {grid} tests a ray");
    assert!(grid >= 5.0 * grid2, "{grid} tests a ray in the grid, {grid2} in two levels");
    assert!(grid2 >= 5.0 * octree, "{grid2} tests a ray in two levels, {octree} in as many as it takes");
}

#[test]
fn a_two_level_grid_cuts_where_there_is_something() {
    let mut triangles = soup(3_000, 0.01, 7).into_iter().map(|t| t.map(|p| p * 0.01)).collect::<Vec<_>>();
    triangles.extend(soup(300, 0.05, 8));
    let accel = built("grid2", &[], &geometry_of(&scene_of(&triangles)));
    let (mut whole, mut cut, mut finest) = (0, 0, 0);
    cell::walk(accel.as_ref(), &mut |cell| {
        let mut parts = 0;
        accel.children(cell, &mut |_| {
            parts += 1;
            std::ops::ControlFlow::Continue(())
        });
        if cell.depth == 1 {
            (whole, cut) = if cell.is_leaf() { (whole + 1, cut) } else { (whole, cut + 1) };
            assert_eq!(cell.is_leaf(), parts == 0);
            finest = finest.max(parts);
        }
        std::ops::ControlFlow::Continue(cell::Descend::Yes)
    });
    assert!(whole > cut && cut > 0, "{whole} whole, {cut} cut");
    assert!(finest > 1_000, "the cell that holds nearly all has {finest} parts");
}

#[test]
fn an_octree_of_a_flat_scene_is_a_quadtree() {
    let parts = |flat: bool| {
        let on_plane = |p: Vec3| if flat { Vec3::new(p.x, 0.0, p.z) } else { p };
        let triangles: Vec<_> = soup(2_000, 0.05, 3).into_iter().map(|t| t.map(on_plane)).collect();
        let accel = built("octree", &[], &geometry_of(&scene_of(&triangles)));
        let mut most = 0;
        cell::walk(accel.as_ref(), &mut |cell| {
            let mut children = 0;
            accel.children(cell, &mut |_| {
                children += 1;
                std::ops::ControlFlow::Continue(())
            });
            most = most.max(children);
            std::ops::ControlFlow::Continue(cell::Descend::Yes)
        });
        (most, stats(accel.as_ref()).max_depth)
    };
    assert!(matches!(parts(true), (4, 4..)));
    assert!(matches!(parts(false), (8, 3..)));
}

/// Many triangles cross the middle of the scene: the first division gives all of them to all eight
/// parts, and only the next one pays.
#[test]
fn an_octree_gets_over_a_bad_division() {
    let mut triangles: Vec<_> = (0..40)
        .map(|i| {
            let s = 0.01 * (1.0 + i as f32 / 40.0);
            [Vec3::splat(-s), Vec3::splat(s) + Vec3::X * s, Vec3::splat(s) - Vec3::X * s]
        })
        .collect();
    triangles.extend([-1.0f32, 1.0].map(|c| [Vec3::splat(c), Vec3::splat(c * 0.99), Vec3::new(c, c, c * 0.99)]));
    let geometry = geometry_of(&scene_of(&triangles));
    let stats = stats(built("octree", &[], &geometry).as_ref());
    assert!(stats.sah < 0.5 * triangles.len() as f64 && stats.max_depth > 2, "{stats:?}");
}

#[test]
fn an_octree_keeps_to_its_references() {
    let triangles = soup(3_000, 0.1, 17);
    let geometry = geometry_of(&scene_of(&triangles));
    let references = |most| stats(built("octree", &[("max_leaf", "2"), ("max_refs", most)], &geometry).as_ref()).references;
    assert_eq!(references("1"), 3_000, "no triangle is in two leaves");
    for (most, limit) in [("2", 6_000), ("4", 12_000), ("8", 24_000)] {
        let taken = references(most);
        assert!(limit / 2 < taken && taken <= limit, "{taken} references where {limit} may be");
    }
}

/// Found by the stability lab: each of the copies asked for as many cells as all of them, and was sorted into those.
#[test]
fn a_two_level_grid_of_copies_keeps_to_its_references() {
    let tri = [Vec3::new(0.0, 0.1, 0.2), Vec3::new(1.0, 0.0, 0.3), Vec3::new(0.3, 0.9, -0.2)];
    let copies = 2_000;
    let geometry = geometry_of(&scene_of(&vec![tri; copies]));
    let references = stats(built("grid2", &[], &geometry).as_ref()).references;
    assert!(references < 300 * copies as u64, "{references} references");
}

#[test]
fn stacks_are_as_deep_as_trees_at_most_and_grids_have_none() {
    let scene = scene_of(&soup(3000, 0.1, 5));
    let geometry = geometry_of(&scene);
    let rays = primary(&scene, &geometry, 24);
    for entry in registry::ALL {
        let accel = built(entry.id, &[], &geometry);
        let deepest = u64::from(stats(accel.as_ref()).max_depth);
        let most = counts(accel.as_ref(), &rays).stack;
        match entry.id {
            _ if !entry.family.has_stack() => assert_eq!(most, 0, "{}", entry.id),
            // Of eight children seven wait.
            "wide" => assert!(most > 0 && most <= 7 * deepest, "{most}"),
            id => assert!(most > 0 && most <= deepest, "{id}: {most} at depth {deepest}"),
        }
    }
}

#[test]
fn the_stack_holds_what_waits_at_a_step() {
    let scene = scene_of(&soup(800, 0.2, 9));
    let geometry = geometry_of(&scene);
    let accel = built("bvh", &[], &geometry);
    for ray in primary(&scene, &geometry, 12) {
        let followed = follow(accel.as_ref(), &ray, Mode::Closest, &Cancel::new()).expect("not cancelled");
        // At the step into a node both of its children wait; the nearer one is never put on the stack.
        let most = followed.steps.iter().map(|step| u64::from(step.waiting)).max().unwrap_or(0);
        let stack = followed.counts.stack;
        assert!(stack <= most && most <= stack + 1, "{stack} on the stack, {most} wait: {ray:?}");
    }
}
