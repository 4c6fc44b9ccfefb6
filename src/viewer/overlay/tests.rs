//! Overlays of structures of every kind, in view and out of it.

use super::found::size_class;
use super::*;
use crate::accel::cell::walk;
use crate::accel::stats::SahWeights;
use crate::accel::volumes::KINDS;
use crate::accel::{BuildCx, CellId, registry};
use crate::geometry::Side;
use crate::geometry::tri::TestKind;
use crate::scene::{Camera, Geometry, LoadCx, Projection, open};
use crate::task::{Budget, Progress};
use glam::Vec3;

/// A structure over a built-in scene, with a parameter set if one is named.
fn built(model: &str, id: &str, set: Option<(&str, &str)>) -> Box<dyn Accel> {
    let cx = LoadCx::unattended();
    let scene = open(model, &cx).expect("built in");
    let geometry = Arc::new(Geometry::with_instances(&scene, &cx).expect("fits"));
    let entry = registry::find(id).expect("registered");
    let mut params = entry.defaults();
    if let Some((name, value)) = set {
        params.set(name, value).expect("in range");
    }
    entry.build(&geometry, TestKind::Watertight, &params, &BuildCx::unattended(1)).expect("builds")
}

/// What is drawn of a structure with all of it in view.
fn collected(accel: &dyn Accel, settings: OverlaySettings, projection: Projection, limit: usize) -> Collected {
    let camera = Camera { eye: Vec3::new(0.3, 0.4, 1.0), target: Vec3::ZERO, up: Vec3::Y, projection };
    let geometry = accel.geometry();
    let view = View::new(&camera.reframed(geometry.world_bounds(), 1.0), geometry.space(), 1.0);
    let wanted = Wanted::new(settings, view, [1000, 1000], limit);
    collect(accel, &Known::default(), &wanted, &Cancel::new()).expect("not cancelled")
}

const PERSPECTIVE: Projection = Projection::Perspective { fov_y: 0.6 };

/// Boxes of one depth, no planes.
fn at_depth(depth: u32) -> OverlaySettings {
    OverlaySettings { boxes: true, planes: false, depth, from_depth: depth, ..OverlaySettings::default() }
}

/// At most `limit` cells of a grid of many, all of it in view.
fn cells_of_a_grid(projection: Projection, limit: usize) -> (Collected, Aabb) {
    let accel = built("builtin:soup?triangles=20000", "grid", None);
    let settings = OverlaySettings { boxes: true, planes: false, empty_cells: true, slice: 0, ..OverlaySettings::default() };
    (collected(accel.as_ref(), settings, projection, limit), *accel.geometry().bounds())
}

#[test]
fn a_few_cells_of_a_grid_are_from_everywhere() {
    const LIMIT: usize = 1000;
    for projection in [Projection::Orthographic { height: 1.0 }, Projection::Perspective { fov_y: 0.1 }] {
        let (collected, bounds) = cells_of_a_grid(projection, LIMIT);
        assert_eq!(collected.shown, LIMIT);
        assert!(collected.total > 10 * LIMIT, "{}", collected.total);
        // Of four by four by four parts, how many cells are in each.
        let mut parts = [0; 64];
        for cell in &collected.overlay.boxes {
            let at = (cell.at(Vec3::splat(0.5)) - bounds.min) / bounds.size();
            let [x, y, z] = at.to_array().map(|x| (x * 4.0) as usize);
            parts[x + 4 * y + 16 * z] += 1;
        }
        assert!(parts.iter().all(|n| (4..=36).contains(n)), "{projection:?}: about 16 in each: {parts:?}");
    }
}

#[test]
fn emptier_cells_of_a_grid_are_left_out() {
    let accel = built("builtin:soup?triangles=20000", "grid", None);
    let mut sizes = Vec::new();
    walk(accel.as_ref(), &mut |cell| {
        sizes.extend(cell.is_leaf().then_some(cell.prims()));
        ControlFlow::Continue(Descend::Yes)
    });
    let most = sizes.iter().copied().max().expect("cells");
    assert!(most > 2);
    for occupancy in [0, 1, 2, most, most + 1] {
        let settings = OverlaySettings { planes: false, empty_cells: true, occupancy, ..OverlaySettings::default() };
        let total = collected(accel.as_ref(), settings, PERSPECTIVE, 1).total;
        assert_eq!(total, sizes.iter().filter(|prims| **prims >= occupancy).count(), "{occupancy}");
    }
}

#[test]
fn the_larger_go_first() {
    let root =
        Cell { id: CellId { instance: 0, node: 0 }, depth: 0, shape: Shape::Box(Aabb::EMPTY), split: None, kind: CellKind::Void };
    let cell = |px: f32, rank: u32| Found { rank, ..Found::new(&root, 0, px) };
    assert!(cell(20.0, 9).order() < cell(9.0, 1).order() && cell(10.0, 9).order() > cell(11.0, 1).order());
    assert_eq!(size_class(64.0_f32.next_down()), size_class(64.0_f32.next_up()));
}

#[test]
fn volumes_of_every_kind_are_drawn_as_what_they_are() {
    const DEPTH: u32 = 3;
    for kind in KINDS {
        let accel = built("builtin:teapot?triangles=1000", "volumes", Some(("volume", kind.id)));
        let mut bounds = Vec::new();
        walk(accel.as_ref(), &mut |cell| {
            if cell.depth == DEPTH {
                bounds.push(*cell.shape.bounds());
            }
            ControlFlow::Continue(if cell.depth < DEPTH { Descend::Yes } else { Descend::No })
        });
        let c = collected(accel.as_ref(), at_depth(DEPTH), PERSPECTIVE, 1000);
        assert_eq!((c.shown, c.total), (bounds.len(), bounds.len()), "{}", kind.id);
        let (boxes, lines) = (&c.overlay.boxes, &c.overlay.lines);
        if matches!(kind.id, "aabb" | "kdop6") {
            assert!(boxes.len() == c.shown && lines.is_empty() && !c.other_forms, "{}", kind.id);
            continue;
        }
        assert!(boxes.is_empty() && lines.len() >= 6 * c.shown && c.other_forms, "{}", kind.id);
        let near = Vec3::splat(1e-4);
        let holds =
            |p: Vec3| bounds.iter().any(|b| Aabb { min: b.min - near, max: b.max + near }.contains_box(&Aabb { min: p, max: p }));
        for line in lines {
            assert!(holds(line.at(Vec3::ZERO)) && holds(line.at(Vec3::X)), "{}: {line:?}", kind.id);
        }
    }
}

#[test]
fn shapes_of_many_edges_are_fewer() {
    let accel = built("builtin:teapot?triangles=1000", "volumes", Some(("volume", "sphere")));
    let drawn = |limit| collected(accel.as_ref(), at_depth(6), PERSPECTIVE, limit);
    let (one, some, all) = (drawn(1), drawn(200), drawn(10_000));
    assert_eq!((one.shown, all.shown), (1, all.total));
    assert!(some.shown > 1 && some.shown < all.shown && some.total == all.total, "{} of {}", some.shown, some.total);
    assert!(some.overlay.lines.len() <= 200 * BOX_EDGES);
}

#[test]
fn a_bsp_shows_its_cells_and_its_planes_within_them() {
    let accel = built("builtin:teapot?triangles=1000", "bsp", None);
    let c = collected(accel.as_ref(), OverlaySettings { planes: true, ..at_depth(4) }, PERSPECTIVE, 1000);
    assert!(c.overlay.boxes.is_empty() && c.overlay.planes.is_empty() && c.other_forms);
    let o = &c.overlay;
    assert!(!o.fills.is_empty() && !o.lines.is_empty());
    let bounds = accel.geometry().bounds();
    let near = Vec3::splat(1e-4);
    let whole = Aabb { min: bounds.min - near, max: bounds.max + near };
    let corners = o.fills.iter().flat_map(|fill| [Vec3::ZERO, Vec3::X, Vec3::Y].map(|at| fill.at(at)));
    assert!(corners.into_iter().all(|p| whole.contains_box(&Aabb { min: p, max: p })));
}

#[test]
fn both_levels_can_be_drawn_or_either() {
    let accel = built("builtin:sphere-flake?triangles=100000", "bvh", None);
    assert!(accel.levels().is_some());
    let mut instances = 0;
    let mut uppers = [0; 128];
    let mut lowers = [0; 128];
    let mut root = (0, 0);
    walk(accel.as_ref(), &mut |cell| {
        if cell.id.instance == 0 {
            uppers[cell.depth as usize] += 1;
        } else {
            if root.0 != cell.id.instance {
                root = (cell.id.instance, cell.depth);
                instances += 1;
            }
            lowers[(cell.depth - root.1) as usize] += 1;
        }
        ControlFlow::Continue(Descend::Yes)
    });
    let total = |levels, leaves_only, depth| {
        let settings = OverlaySettings { levels, leaves_only, ..at_depth(depth) };
        collected(accel.as_ref(), settings, PERSPECTIVE, 1).total
    };
    // Out of the tiny ones some are not counted: what is in view is asked for near the root.
    assert_eq!(total(Levels::Upper, false, 2), uppers[2]);
    assert!(total(Levels::Upper, true, 0) <= instances && total(Levels::Lower, false, 0) <= instances);
    assert!(total(Levels::Both, false, 2) <= instances + lowers[2]);
    assert!(total(Levels::Both, false, 2) > total(Levels::Lower, false, 2));
    assert!(total(Levels::Lower, false, 2) > 0 && lowers[0] == instances);
}

#[test]
fn boxes_that_are_cut_away_are_left_out_and_the_plane_is_drawn() {
    let cx = LoadCx::unattended();
    let scene = open("builtin:teapot?triangles=1000", &cx).expect("built in");
    let geometry = Arc::new(Geometry::new(&scene, &cx).expect("fits"));
    for id in ["bvh", "kdtree"] {
        let entry = registry::find(id).expect("registered");
        let accel = entry.build(&geometry, TestKind::Watertight, &entry.defaults(), &BuildCx::unattended(1)).expect("builds");
        let settings = OverlaySettings { depth: 6, from_depth: 0, ..OverlaySettings::default() };
        let camera = scene.first_camera(geometry.world_bounds(), 1.0);
        let whole = View::new(&camera, geometry.space(), 1.0);
        let collected = |view: View| {
            let wanted = Wanted::new(settings, view, [1000, 1000], 10_000);
            collect(accel.as_ref(), &Known::default(), &wanted, &Cancel::new()).expect("not cancelled").overlay
        };
        let all = collected(whole);
        // No plane of a cell, so that rounding decides nothing.
        let at = |place: f32| geometry.bounds().min.x + place * geometry.bounds().size().x;
        for side in [Side::Below, Side::Above] {
            let section = HalfSpace { axis: Axis::X, at: at(0.5123), side };
            let left = collected(whole.within(Some(section)));
            let bounds = |b: &BoxInstance| Aabb { min: b.at(Vec3::ZERO), max: b.at(Vec3::ONE) };
            let expected: Vec<&BoxInstance> = all.boxes.iter().filter(|b| !section.misses(&bounds(b))).collect();
            assert_eq!(left.boxes.len(), expected.len(), "{id}");
            assert!(left.boxes.len() < all.boxes.len());
            let plane = bounds(left.planes.last().expect("drawn"));
            assert_eq!((plane.min.x, plane.max.x), (section.at, section.at));
            let planes = all.planes.iter().filter(|plane| !section.misses(&bounds(plane))).count();
            assert_eq!(left.planes.len(), planes + 1, "{id}");
        }
    }
}

#[test]
fn colours_of_amounts_go_over_the_range_that_pictures_share() {
    let accel = built("builtin:teapot?triangles=1000", "bvh", None);
    let weights = SahWeights::of(&registry::find("bvh").expect("registered").defaults());
    let outline = Outline::of(accel.as_ref(), weights, (&Budget::new(1 << 30), &Cancel::new(), &Progress::new())).expect("fits");
    let known = Known { outline: Some(Arc::new(outline)), ..Known::default() };
    let geometry = accel.geometry();
    let camera = Camera { eye: Vec3::new(0.3, 0.4, 1.0), target: Vec3::ZERO, up: Vec3::Y, projection: PERSPECTIVE };
    let view = View::new(&camera.reframed(geometry.world_bounds(), 1.0), geometry.space(), 1.0);
    let settings = OverlaySettings { color: BoxColor::Triangles, ..at_depth(4) };
    let over = |range: Option<[f32; 2]>| {
        let wanted = Wanted { range, numbered: true, ..Wanted::new(settings, view, [1000, 1000], 10_000) };
        collect(accel.as_ref(), &known, &wanted, &Cancel::new()).expect("not cancelled")
    };
    let alone = over(None);
    let [low, high] = alone.amounts.expect("triangles are known");
    assert!(alone.range == Some([low, high]) && low < high, "{low} {high}");
    let wide = [low, 4.0 * high];
    let shared = over(Some(wide));
    assert_eq!((shared.amounts, shared.range, shared.shown), (alone.amounts, Some(wide), alone.shown));
    let has = |collected: &Collected, color: [u8; 4]| collected.overlay.boxes.iter().any(|b| b.color == color);
    let fullest = |range| theme::amount_color(high, range).to_array();
    assert!(has(&alone, fullest([low, high])) && has(&shared, fullest(wide)));
    assert!(!has(&shared, fullest([low, high])), "the brightest is another's");
}
