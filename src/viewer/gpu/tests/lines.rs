//! Boxes and planes over a picture.

use std::sync::Arc;

use image::RgbaImage;

use super::device::Headless;
use super::{YELLOW, boxed, list, overlay, picture, view, wall, wall_at};
use crate::viewer::gpu::{Base, BoxInstance, DrawList, Overlay};

/// How many pixels of a row or column near `at` are nearly yellow, and how many differ from the wall
/// at all.
fn along_row(image: &RgbaImage, y: u32) -> (usize, usize) {
    let (mut bright, mut touched) = (0, 0);
    for x in 0..image.width() {
        let [r, g, b, _] = image.get_pixel(x, y).0;
        bright += usize::from(r > 220 && g > 200 && b < 90);
        touched += usize::from(r.abs_diff(128) > 8 || b.abs_diff(128) > 8);
    }
    (bright, touched)
}

/// Half of 256 pixels reach from -1 to 1; this far from the middle, lines run through the middle of row 192.
const TO_ROW_192: f32 = 64.5 / 128.0;

/// A square around the middle at a height over the wall; its lower edge is in row 192.
fn square(z: f32) -> BoxInstance {
    let half = TO_ROW_192 * 0.5 * (2.0 - z);
    boxed([-half, -half, z], [half, half, z])
}

fn one_box(size: u32, instance: BoxInstance) -> DrawList {
    DrawList { overlay: overlay(vec![instance]), ..list(size, wall(size)) }
}

#[test]
fn in_front_is_bright_and_behind_is_faint_and_dashed() {
    let Some(mut gpu) = Headless::new("lines in front and behind") else { return };
    let front = gpu.shot("front", &one_box(256, square(0.5)));
    let (bright, _) = along_row(&front, 192);
    assert!(bright >= 120, "{bright} bright pixels of 128");

    let there = Overlay { generation: 2, boxes: vec![square(-0.5)], ..Overlay::default() };
    let behind = gpu.shot("behind", &DrawList { overlay: Some(Arc::new(there)), ..list(256, wall(256)) });
    let (bright, touched) = along_row(&behind, 192);
    assert_eq!(bright, 0);
    assert!((40..=100).contains(&touched), "dashes: {touched} of 128");
}

#[test]
fn hidden_lines_can_be_left_out_but_the_selected_box_stays() {
    let Some(mut gpu) = Headless::new("leaving hidden lines out") else { return };
    let mut hidden = one_box(256, square(-0.5));
    hidden.hidden_lines = false;
    assert_eq!(along_row(&gpu.shot("hidden_off", &hidden), 192), (0, 0));
    let selected = Overlay { generation: 2, selected: Some(square(-0.5)), ..Overlay::default() };
    hidden.overlay = Some(Arc::new(selected));
    assert!(along_row(&gpu.shot("hidden_selected", &hidden), 192).1 > 40);
}

#[test]
fn what_stands_out_does_so_in_its_own_colour() {
    let Some(mut gpu) = Headless::new("colours of what stands out") else { return };
    let [orange, blue] = [[255, 140, 105, 255], [120, 190, 255, 255]];
    for (generation, color) in [(2, orange), (3, blue)] {
        let lit = Overlay { generation, lit: vec![BoxInstance { color, ..square(0.5) }], ..Overlay::default() };
        let image = gpu.shot("lit", &DrawList { overlay: Some(Arc::new(lit)), ..list(256, wall(256)) });
        let drawn = image.pixels().filter(|p| p.0.iter().zip(color).all(|(a, b)| a.abs_diff(b) < 8)).count();
        assert!(drawn > 200, "{color:?}: {drawn}");
    }
}

#[test]
fn an_overlay_begins_where_it_is_said() {
    let Some(mut gpu) = Headless::new("an overlay over a part of the view") else { return };
    let mut drawn = one_box(256, square(0.5));
    let whole = gpu.shot("whole", &drawn);
    drawn.begin = 0.5;
    let half = gpu.shot("half", &drawn);
    drawn.overlay = None;
    let bare = gpu.shot("bare", &drawn);
    for (x, y, pixel) in half.enumerate_pixels() {
        assert_eq!(pixel, if x < 128 { bare.get_pixel(x, y) } else { whole.get_pixel(x, y) }, "{x}, {y}");
    }
    assert_ne!(whole, half);
}

#[test]
fn what_lies_on_the_surface_is_in_front() {
    let Some(mut gpu) = Headless::new("lines on the surface") else { return };
    for orthographic in [false, true] {
        let half = TO_ROW_192;
        let flat = boxed([-half, -half, 0.0], [half, half, 0.0]);
        let mut flat = one_box(256, flat);
        flat.view = view(orthographic);
        let image = gpu.shot(if orthographic { "flat_ortho" } else { "flat" }, &flat);
        let (bright, _) = along_row(&image, 192);
        assert!(bright >= 120, "orthographic {orthographic}: {bright}");
    }
}

#[test]
fn a_slanted_surface_does_not_swallow_the_lines_on_it() {
    let Some(mut gpu) = Headless::new("lines on a slanted surface") else { return };
    // A floor at y = -0.5 that runs away from the eye; the box stands on it.
    let size = 256u32;
    let floor = |row: u32| {
        let slope = (row as f32 + 0.5) / size as f32 - 0.5;
        if slope > 0.0 { 0.5 / slope } else { f32::INFINITY }
    };
    let depth: Vec<f32> = (0..size).flat_map(|row| std::iter::repeat_n(floor(row), size as usize)).collect();
    let rgba = [128, 128, 128, 255].repeat((size * size) as usize);
    let picture = picture(1, size, size, rgba, depth);
    let mut standing = list(size, Base::Picture(Arc::new(picture)));
    standing.overlay = overlay(vec![boxed([-0.2, -0.5, -1.0], [0.2, -0.1, 0.5])]);
    let image = gpu.shot("floor", &standing);
    // The edges that run away on the floor, half way.
    let at = standing.view.project(glam::Vec3::new(-0.2, -0.5, 0.0), standing.size_px).expect("in front").0;
    for step in -20i32..20 {
        let p = standing.view.project(glam::Vec3::new(-0.2, -0.5, step as f32 * 0.02), standing.size_px).expect("in front").0;
        let [r, _, b, _] = image.get_pixel(p.x as u32, p.y as u32).0;
        assert!(r > 190 && b < 110, "at {p}, around {at}: {r} {b}");
    }
}

#[test]
fn an_eye_inside_a_box_sees_its_edges_and_nothing_else() {
    let Some(mut gpu) = Headless::new("an eye inside a box") else { return };
    // The eye is at z = 2: four edges run past it; the far face is a square around the middle.
    let half = TO_ROW_192;
    let around = boxed([-half, -half, 0.0], [half, half, 3.0]);
    for orthographic in [false, true] {
        let mut inside = one_box(256, around);
        inside.base = wall_at(256, 10.0);
        inside.view = view(orthographic);
        let image = gpu.shot(if orthographic { "inside_ortho" } else { "inside" }, &inside);
        let touched = image.pixels().filter(|p| p.0[0].abs_diff(128) > 8).count();
        assert!((1500..9000).contains(&touched), "orthographic {orthographic}: {touched}");
        assert_eq!(image.get_pixel(128, 128).0, [128, 128, 128, 255]);
        assert_eq!(image.get_pixel(128, 20).0, [128, 128, 128, 255]);
        assert!(along_row(&image, 192).0 >= 120);
    }
}

#[test]
fn widths_follow_the_scale_and_a_halo_sets_lines_off() {
    let Some(mut gpu) = Headless::new("widths of lines") else { return };
    let height = |image: &RgbaImage| {
        let column = (150..240).map(|y| image.get_pixel(128, y).0);
        let bright = column.clone().filter(|p| p[0] > 220).count();
        (bright, column.filter(|p| p[0] < 100).count())
    };
    let mut list = one_box(256, square(0.5));
    let (bright, dark) = height(&gpu.shot("scale_1", &list));
    assert_eq!((bright, dark), (1, 2));
    list.pixels_per_point = 3.0;
    let (bright, dark) = height(&gpu.shot("scale_3", &list));
    assert!((3..=5).contains(&bright) && (2..=6).contains(&dark), "{bright} {dark}");
}

#[test]
fn planes_are_filled_faintly_and_fainter_behind() {
    let Some(mut gpu) = Headless::new("planes") else { return };
    let fill = |gpu: &mut Headless, name: &str, z: f32, generation: u64| {
        let planes = vec![square(z)];
        let overlay = Overlay { generation, planes, ..Overlay::default() };
        let image = gpu.shot(name, &DrawList { overlay: Some(Arc::new(overlay)), ..list(256, wall(256)) });
        assert_eq!(image.get_pixel(10, 10).0, [128, 128, 128, 255]);
        i32::from(image.get_pixel(128, 128).0[0]) - 128
    };
    let front = fill(&mut gpu, "plane", 0.5, 1);
    let behind = fill(&mut gpu, "plane_behind", -0.5, 2);
    let expected = (i32::from(YELLOW[0]) - 128) * 12 / 100;
    assert!((front - expected).abs() <= 2, "{front} for {expected}");
    assert!(behind > 0 && behind < front, "{behind}");
}

#[test]
fn a_line_is_one_edge_and_a_triangle_half_a_plane() {
    let Some(mut gpu) = Headless::new("lines and triangles") else { return };
    let half = TO_ROW_192 * 0.5 * (2.0 - 0.5);
    let corner = |x: f32, y: f32| glam::Vec3::new(x * half, y * half, 0.5);
    let mut shot =
        |name: &str, overlay: Overlay| gpu.shot(name, &DrawList { overlay: Some(Arc::new(overlay)), ..list(256, wall(256)) });
    let line = BoxInstance::line(corner(-1.0, -1.0), corner(1.0, -1.0), YELLOW);
    let image = shot("line", Overlay { generation: 1, lines: vec![line], ..Overlay::default() });
    assert!(along_row(&image, 192).0 >= 120);
    assert_eq!((along_row(&image, 64), along_row(&image, 128)), ((0, 0), (0, 0)));
    let fill = BoxInstance::triangle([corner(-1.0, -1.0), corner(1.0, -1.0), corner(-1.0, 1.0)], YELLOW);
    let image = shot("triangle", Overlay { generation: 2, fills: vec![fill], ..Overlay::default() });
    let expected = 128 + (i32::from(YELLOW[0]) - 128) * 12 / 100;
    assert!((i32::from(image.get_pixel(90, 170).0[0]) - expected).abs() <= 2);
    assert_eq!(image.get_pixel(170, 90).0, [128, 128, 128, 255]);
    let selected = Overlay { generation: 3, selected_lines: vec![line], ..Overlay::default() };
    let image = shot("selected_line", selected);
    assert!(along_row(&image, 192).0 >= 116, "in its own colour");
    assert_eq!(along_row(&image, 64), (0, 0));
}

#[test]
fn a_later_overlay_replaces_an_earlier_one() {
    let Some(mut gpu) = Headless::new("replacing an overlay") else { return };
    let mut list = one_box(64, square(0.5));
    gpu.frame(&list);
    let many = vec![boxed([5.0; 3], [6.0; 3]); 1000];
    list.overlay = Some(Arc::new(Overlay { generation: 2, boxes: many, ..Overlay::default() }));
    let image = gpu.shot("replaced", &list);
    assert!(image.pixels().all(|p| p.0 == [128, 128, 128, 255]));
    list.overlay = None;
    assert!(gpu.frame(&list));
}
