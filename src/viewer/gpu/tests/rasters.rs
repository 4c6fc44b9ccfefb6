//! The mesh by rasterisation.

use std::sync::Arc;

use glam::Vec3;

use super::device::Headless;
use super::{boxed, list, overlay, view};
use crate::geometry::{Axis, HalfSpace, Side};
use crate::scene::{Geometry, Instance, LoadCx, Mesh, Scene};
use crate::viewer::gpu::{Base, Raster, RasterMesh};

/// One triangle around the middle of the plane z = 0; the scaled space is the world.
fn triangle() -> Arc<Geometry> {
    let positions = vec![Vec3::new(-0.6, -0.5, 0.0), Vec3::new(0.6, -0.5, 0.0), Vec3::new(0.0, 0.7, 0.0)];
    geometry(positions, vec![[0, 1, 2]])
}

fn geometry(positions: Vec<Vec3>, triangles: Vec<[u32; 3]>) -> Arc<Geometry> {
    let mesh = Mesh { positions, triangles, ..Mesh::default() };
    let scene = Scene { meshes: vec![mesh], instances: vec![Instance::identity(0)], ..Scene::default() };
    Arc::new(Geometry::new(&scene, &LoadCx::unattended()).expect("small"))
}

fn raster(geometry: Arc<Geometry>) -> Raster {
    Raster { mesh: Arc::new(RasterMesh::new(1, geometry)), color: [180, 180, 180, 255], max_triangles: usize::MAX }
}

#[test]
fn a_triangle_covers_the_middle_from_both_sides() {
    let Some(mut gpu) = Headless::new("a raster triangle") else { return };
    let scale = triangle().space().scale();
    assert!(scale <= 1.0);
    for (name, orthographic, behind) in [("raster", false, false), ("raster_ortho", true, false), ("raster_back", false, true)] {
        let mut list = list(128, Base::Raster(raster(triangle())));
        list.view = view(orthographic);
        if behind {
            list.view.eye.z *= -1.0;
            list.view.forward *= -1.0;
            list.view.right *= -1.0;
        }
        let image = gpu.shot(name, &list);
        let [r, ..] = image.get_pixel(64, 64).0;
        assert!((150..=200).contains(&r), "{name}: lit from the eye, {r}");
        assert_eq!(image.get_pixel(4, 4).0, list.background);
    }
}

#[test]
fn its_depth_hides_lines() {
    let Some(mut gpu) = Headless::new("depth of the raster preview") else { return };
    for orthographic in [false, true] {
        let bright = |gpu: &mut Headless, z: f32| {
            let mut list = list(128, Base::Raster(raster(triangle())));
            list.view = view(orthographic);
            let mut over = overlay(vec![boxed([-0.1, 0.0, z], [0.1, 0.0, z])]).map(Arc::unwrap_or_clone);
            over.iter_mut().for_each(|o| o.generation = u64::from(z.to_bits()));
            list.overlay = over.map(Arc::new);
            let image = gpu.shot(if z > 0.0 { "raster_front" } else { "raster_behind" }, &list);
            image.pixels().filter(|p| p.0[0] > 170 && p.0[2] < 100).count()
        };
        assert!(bright(&mut gpu, 0.2) >= 8, "in front");
        assert!(bright(&mut gpu, 0.0) >= 8, "on it");
        assert_eq!(bright(&mut gpu, -0.2), 0, "behind");
    }
}

#[test]
fn the_nearer_of_two_triangles_is_seen_whatever_their_order() {
    let Some(mut gpu) = Headless::new("the depth buffer") else { return };
    // A wall, and a steep triangle before it: steeper is darker.
    let wall = [Vec3::new(-0.9, -0.9, -0.5), Vec3::new(0.9, -0.9, -0.5), Vec3::new(0.0, 0.9, -0.5)];
    let steep = [Vec3::new(-0.3, -0.3, 0.4), Vec3::new(0.3, -0.3, 0.4), Vec3::new(0.0, 0.3, -0.4)];
    for order in [[0, 1], [1, 0]] {
        let positions = [wall, steep].concat();
        let triangles = order.map(|k| [3 * k, 3 * k + 1, 3 * k + 2]).to_vec();
        for orthographic in [false, true] {
            let mut list = list(128, Base::Raster(raster(geometry(positions.clone(), triangles.clone()))));
            list.view = view(orthographic);
            let image = gpu.shot("nearer", &list);
            let (middle, beside) = (image.get_pixel(64, 64).0[0], image.get_pixel(64, 80).0[0]);
            assert!(middle + 20 < beside, "{order:?}: {middle} {beside}");
        }
    }
}

#[test]
fn what_a_section_cuts_away_is_not_drawn_and_hides_nothing() {
    let Some(mut gpu) = Headless::new("a section of the raster preview") else { return };
    // A wall, and another one before it that is cut at the middle.
    let wall = |z: f32| [Vec3::new(-0.9, -0.9, z), Vec3::new(0.9, -0.9, z), Vec3::new(0.0, 0.9, z)];
    let geometry = || geometry([wall(-0.5), wall(0.2)].concat(), vec![[0, 1, 2], [3, 4, 5]]);
    let scale = geometry().space().scale() as f32;
    for (axis, side) in [(Axis::X, Side::Below), (Axis::X, Side::Above), (Axis::Y, Side::Below)] {
        for orthographic in [false, true] {
            let mut list = list(128, Base::Raster(raster(geometry())));
            list.view = view(orthographic).within(Some(HalfSpace { axis, at: 0.0, side }));
            let image = gpu.shot("section", &list);
            let seen = |x: u32, y: u32| image.get_pixel(x, y).0 != list.background;
            // Left and right of the middle; above and below.
            let [left, right, above, below] = [seen(56, 72), seen(72, 72), seen(64, 56), seen(64, 72)];
            let expected = match (axis, side) {
                (Axis::X, Side::Below) => (true, false),
                (Axis::X, Side::Above) => (false, true),
                _ => (true, true),
            };
            assert_eq!((left, right), expected, "{axis:?} {side:?}, scale {scale}");
            assert!(axis == Axis::X || (below && !above));
        }
    }
    // A plane between the walls leaves the one behind, and its depth.
    let mut list = list(128, Base::Raster(raster(geometry())));
    list.view = list.view.within(Some(HalfSpace { axis: Axis::Z, at: 0.0, side: Side::Below }));
    list.overlay = overlay(vec![boxed([-0.2 * scale, -0.1 * scale, 0.0], [0.2 * scale, -0.1 * scale, 0.0])]);
    list.hidden_lines = false;
    let image = gpu.shot("section_between", &list);
    assert!(image.pixels().any(|p| p.0[0] > 170 && p.0[2] < 100), "nothing is before the line any more");
}

#[test]
fn a_large_mesh_arrives_over_several_frames() {
    let Some(mut gpu) = Headless::new("arriving over several frames") else { return };
    let n = 800u32;
    let at = |i: u32| i as f32 / n as f32 * 2.0 - 1.0;
    let positions = (0..=n).flat_map(|y| (0..=n).map(move |x| Vec3::new(at(x), at(y), 0.0))).collect();
    let row = n + 1;
    let cells = (0..n).flat_map(|y| (0..n).map(move |x| y * row + x));
    let triangles = cells.flat_map(|c| [[c, c + 1, c + row], [c + 1, c + row + 1, c + row]]).collect();
    let mut list = list(64, Base::Raster(raster(geometry(positions, triangles))));
    let Base::Raster(raster) = &list.base else { unreachable!() };
    let mesh = Arc::clone(&raster.mesh);
    let mut frames = 0;
    while frames == 0 || mesh.progress().0 < mesh.progress().1 {
        assert!(gpu.frame(&list), "more of it to draw");
        frames += 1;
    }
    assert!(frames > 1, "{frames}");
    let background = list.background;
    let covered = move |image: &image::RgbaImage| image.pixels().filter(|p| p.0 != background).count();
    let all = covered(&gpu.shot("large", &list));
    let Base::Raster(raster) = &mut list.base else { unreachable!() };
    raster.max_triangles = mesh.progress().1 / 2000;
    let some = covered(&gpu.shot("large_sampled", &list));
    assert!(all > 900 && some > 0 && some * 2 < all, "{all} {some}");
    assert!(!gpu.frame(&list));
}
