//! A scene as users see it: for the eye (see `BOXWOOD_SHOTS`), and for the clock.

use std::sync::Arc;
use std::time::Instant;

use glam::Vec3;

use super::device::Headless;
use crate::geometry::{Aabb, Axis};
use crate::scene::{Camera, Geometry, Instance, LoadCx, Mesh, Projection, Scene};
use crate::viewer::gpu::{Base, BoxInstance, DrawList, Overlay, Raster, RasterMesh, View};
use crate::viewer::theme::{Palette, depth_color};

const SIZE: [u32; 2] = [1000, 700];

/// A floor with a dented ball on it.
fn scene() -> Arc<Geometry> {
    let (rows, columns) = (96u32, 192u32);
    let at = |row: u32, column: u32| {
        let (a, b) = (row as f32 / rows as f32 * std::f32::consts::PI, column as f32 / columns as f32 * std::f32::consts::TAU);
        let radius = 1.0 + 0.12 * (5.0 * b).sin() * (4.0 * a).sin();
        Vec3::new(a.sin() * b.cos(), a.cos(), a.sin() * b.sin()) * radius + Vec3::Y
    };
    let mut positions: Vec<Vec3> = (0..=rows).flat_map(|r| (0..=columns).map(move |c| (r, c))).map(|(r, c)| at(r, c)).collect();
    let wide = columns + 1;
    let mut triangles: Vec<[u32; 3]> = (0..rows)
        .flat_map(|r| (0..columns).map(move |c| r * wide + c))
        .flat_map(|i| [[i, i + 1, i + wide], [i + 1, i + wide + 1, i + wide]])
        .collect();
    let floor = positions.len() as u32;
    positions.extend([(-2.0, -2.0), (2.0, -2.0), (2.0, 2.0), (-2.0, 2.0)].map(|(x, z)| Vec3::new(x, 0.0, z)));
    triangles.extend([[floor, floor + 1, floor + 2], [floor, floor + 2, floor + 3]]);
    let mesh = Mesh { positions, triangles, ..Mesh::default() };
    let scene = Scene { meshes: vec![mesh], instances: vec![Instance::identity(0)], ..Scene::default() };
    Arc::new(Geometry::new(&scene, &LoadCx::unattended()).expect("small"))
}

/// The boxes of a tree split at the median, those of one level only.
fn level(geometry: &Geometry, prims: &mut [u32], depth: u32, boxes: &mut Vec<Aabb>) {
    let bounds = prims.iter().fold(Aabb::EMPTY, |b, p| b.union(Aabb::of_triangle(&geometry.corners(*p))));
    if depth == 0 || prims.len() < 2 {
        boxes.push(bounds);
        return;
    }
    let axis: Axis = bounds.longest_axis();
    let key = |p: &u32| Aabb::of_triangle(&geometry.corners(*p)).centre_twice()[axis.index()];
    prims.sort_by(|a, b| key(a).total_cmp(&key(b)));
    let (below, above) = prims.split_at_mut(prims.len() / 2);
    level(geometry, below, depth - 1, boxes);
    level(geometry, above, depth - 1, boxes);
}

fn boxes(geometry: &Geometry, depth: u32) -> Vec<Aabb> {
    let mut prims: Vec<u32> = (0..geometry.live_count()).map(|i| geometry.live(i)).collect();
    let mut boxes = Vec::new();
    level(geometry, &mut prims, depth, &mut boxes);
    boxes
}

fn list(geometry: &Arc<Geometry>, palette: &Palette) -> DrawList {
    let projection = Projection::Perspective { fov_y: Camera::DEFAULT_FOV_Y };
    let camera = Camera { eye: Vec3::new(3.4, 3.0, 5.2), target: Vec3::new(0.0, 0.9, 0.0), up: Vec3::Y, projection };
    let mesh = Arc::new(RasterMesh::new(1, Arc::clone(geometry)));
    DrawList {
        view: View::new(&camera, geometry.space(), SIZE[0] as f32 / SIZE[1] as f32),
        size_px: SIZE,
        pixels_per_point: 1.0,
        background: palette.background.to_array(),
        base: Base::Raster(Raster { mesh, color: palette.preview.to_array(), max_triangles: usize::MAX }),
        overlay: None,
        begin: 0.0,
        hidden_lines: true,
    }
}

fn colored(boxes: &[Aabb], level: u32, shown: std::ops::RangeInclusive<u32>) -> Vec<BoxInstance> {
    boxes.iter().map(|b| BoxInstance::new(b, depth_color(level, &shown).to_array())).collect()
}

#[test]
fn a_scene_with_boxes_at_several_levels() {
    use eframe::egui::Theme;
    let Some(mut gpu) = Headless::new("a scene with boxes") else { return };
    let geometry = scene();
    for (generation, name, theme, levels, scale) in [
        (1, "look_dark", Theme::Dark, 0..=3, 1.0),
        (2, "look_light", Theme::Light, 0..=3, 1.0),
        (3, "look_scaled", Theme::Dark, 2..=2, 2.0),
        (4, "look_deep", Theme::Dark, 6..=6, 1.0),
    ] {
        let mut list = list(&geometry, Palette::of(theme));
        let mut overlay = Overlay { generation, ..Overlay::default() };
        for at in levels.clone() {
            overlay.boxes.extend(colored(&boxes(&geometry, at), at, 0..=6));
        }
        let half = boxes(&geometry, 1)[0];
        let plane = Aabb { min: Vec3::new(half.max.x, half.min.y, half.min.z), ..half };
        overlay.planes = vec![BoxInstance::new(&plane, Palette::of(theme).kd.color.to_array())];
        overlay.selected = Some(BoxInstance::new(&boxes(&geometry, 3)[5], [255; 4]));
        list.overlay = Some(Arc::new(overlay));
        list.pixels_per_point = scale;
        let image = gpu.shot(name, &list);
        assert!(image.pixels().any(|p| p.0 != list.background));
    }
}

/// The lecture's figure: flat triangles seen from above, and the boxes around them.
#[test]
fn flat_boxes_around_flat_triangles() {
    let Some(mut gpu) = Headless::new("flat boxes") else { return };
    let corner = |i: usize| {
        let (x, y) = ((i * 37 % 16) as f32, (i * 23 % 11) as f32);
        [Vec3::new(x, y, 0.0), Vec3::new(x + 1.1, y + 0.3, 0.0), Vec3::new(x + 0.4, y + 1.3, 0.0)]
    };
    let positions: Vec<Vec3> = (0..16).flat_map(corner).collect();
    let mesh = Mesh { positions, triangles: (0..16).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect(), ..Mesh::default() };
    let scene = Scene { meshes: vec![mesh], instances: vec![Instance::identity(0)], ..Scene::default() };
    let geometry = Arc::new(Geometry::new(&scene, &LoadCx::unattended()).expect("small"));

    let palette = Palette::of(eframe::egui::Theme::Dark);
    let mut list = list(&geometry, palette);
    let aspect = SIZE[0] as f32 / SIZE[1] as f32;
    let projection = Projection::Orthographic { height: 1.0 };
    let camera = Camera { eye: Vec3::Z, target: Vec3::ZERO, up: Vec3::Y, projection };
    list.view = View::new(&camera.reframed(geometry.world_bounds(), aspect), geometry.space(), aspect);
    let boxes = (0..=4).flat_map(|at| colored(&boxes(&geometry, at), at, 0..=4)).collect();
    let selected = Some(BoxInstance::new(&self::boxes(&geometry, 2)[1], [255; 4]));
    list.overlay = Some(Arc::new(Overlay { generation: 1, boxes, selected, ..Overlay::default() }));
    let image = gpu.shot("look_lecture", &list);
    // The root's box is whole: its upper edge has one colour all along.
    let root = geometry.bounds();
    let along = (1..40).map(|i| {
        let x = root.min.x + root.size().x * i as f32 / 40.0;
        let at = list.view.project(Vec3::new(x, root.max.y, 0.0), SIZE).expect("in front").0;
        image.get_pixel(at.x as u32, at.y as u32).0
    });
    let background = list.background;
    assert!(along.clone().all(|p| p[1].abs_diff(background[1]) > 40), "{:?}", along.collect::<Vec<_>>());
}

/// Not a test of speed; prints what a frame costs: `cargo test viewer::gpu -- --ignored --nocapture`.
#[test]
#[ignore = "measures"]
fn what_a_frame_costs() {
    let Some(mut gpu) = Headless::new("the cost of a frame") else { return };
    let geometry = scene();
    let mut list = list(&geometry, Palette::of(eframe::egui::Theme::Dark));
    gpu.shot("cost", &list);
    let cells = boxes(&geometry, 15);
    for count in [0, 2000, 20_000, cells.len()] {
        let boxes = colored(&cells[..count], 6, 0..=6);
        list.overlay = Some(Arc::new(Overlay { generation: count as u64 + 1, boxes, ..Overlay::default() }));
        gpu.shot(&format!("cost_{count}"), &list);
        let begin = Instant::now();
        for i in 0..5 {
            list.view.eye.x += 1e-4 * i as f32;
            gpu.frame(&list);
            gpu.wait();
        }
        eprintln!("{count} boxes: {:.1} ms a frame", begin.elapsed().as_secs_f64() * 200.0);
    }
    let begin = Instant::now();
    let many: Vec<Aabb> = cells.iter().copied().cycle().take(100_000).collect();
    let culled = crate::viewer::gpu::cull(&many, &list.view, SIZE, 1.0, 5000);
    eprintln!("cull of {}: {:.1} ms, {} left", many.len(), begin.elapsed().as_secs_f64() * 1e3, culled.visible.len());
}
