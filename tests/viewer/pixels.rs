//! What is really on the screen. Needs a graphics driver, a software one will do.

use boxwood::viewer::gpu::View;
use boxwood::viewer::theme::depth_color;
use eframe::egui::{Role, vec2};
use glam::Vec3;
use image::RgbaImage;

use crate::common;
use crate::window::{Setup, Window};

fn window(model: &str, check: &str) -> Option<Window> {
    if !common::has_gpu(check) {
        return None;
    }
    let mut setup = Setup { gpu: true, size: vec2(1100.0, 700.0), ..Setup::default() };
    setup.options.model = Some(model.to_owned());
    Some(Window::new(setup).settled())
}

/// The window once everything in it has been drawn.
fn shot(w: &mut Window) -> RgbaImage {
    w.settle();
    w.harness.remove_cursor();
    w.step();
    w.step();
    w.harness.render().expect("drawn")
}

/// Where a point of the scaled space is in the window, in pixels.
fn place(w: &Window, p: Vec3) -> (u32, u32) {
    let state = w.state();
    let view = View::new(&state.camera, state.model.as_ref().expect("open").geometry.space(), state.aspect());
    let (at, _) = view.project(p, state.size_px).expect("in front");
    let corner = w.viewport().min;
    ((corner.x + at.x) as u32, (corner.y + at.y) as u32)
}

fn differ(a: &RgbaImage, b: &RgbaImage, w: &Window) -> usize {
    let area = w.viewport();
    let inside = |x: u32, y: u32| area.contains(eframe::egui::pos2(x as f32, y as f32));
    let pixels = a.enumerate_pixels().zip(b.pixels());
    pixels.filter(|((x, y, p), q)| inside(*x, *y) && p.0.iter().zip(q.0).any(|(p, q)| p.abs_diff(q) > 12)).count()
}

#[test]
fn boxes_begin_where_it_is_said() {
    let Some(mut w) = window("builtin:lecture", "boxes over half of the view") else { return };
    let boxed = shot(&mut w);
    w.click(Role::CheckBox, "Node boxes");
    let bare = shot(&mut w);
    w.click(Role::CheckBox, "Node boxes");
    w.set_number("Drawn from", "50");
    let half = shot(&mut w);
    // Between the captions, and beside the line between both halves.
    let (middle, area) = (w.viewport().center().x, w.viewport().shrink2(vec2(0.0, 90.0)));
    let unlike = |a: &RgbaImage, right: bool| {
        let pixels = half.enumerate_pixels().zip(a.pixels()).filter(|((x, y, _), _)| {
            let at = eframe::egui::pos2(*x as f32, *y as f32);
            area.contains(at) && (at.x - middle).abs() > 4.0 && (at.x > middle) == right
        });
        pixels.filter(|((_, _, p), q)| p.0.iter().zip(q.0).any(|(p, q)| p.abs_diff(q) > 12)).count()
    };
    assert!(unlike(&bare, true) > 100 && unlike(&boxed, false) > 100, "each half is of one kind");
    assert_eq!(unlike(&bare, false), 0, "no boxes at the left");
    assert_eq!(unlike(&boxed, true), 0, "boxes at the right");
}

#[test]
fn the_lecture_is_drawn_with_its_boxes() {
    let Some(mut w) = window("builtin:lecture", "the lecture on the screen") else { return };
    w.click(Role::CheckBox, "Node boxes");
    let bare = shot(&mut w);

    // Each triangle's middle has its material's colour: what is more in one is more in the other.
    let model = w.state().model.as_ref().expect("open").clone();
    let background = bare.get_pixel(w.viewport().min.x as u32 + 3, w.viewport().min.y as u32 + 3).0;
    let mut seen = 0;
    for prim in 0..model.geometry.triangle_count() as u32 {
        let mesh = &model.scene.meshes[model.scene.instances[model.geometry.locate(prim).0 as usize].mesh];
        let base = model.scene.materials[mesh.material.expect("coloured")].base_color;
        let (x, y) = place(&w, model.geometry.corners(prim).into_iter().sum::<Vec3>() / 3.0);
        let [r, g, b, _] = bare.get_pixel(x, y).0;
        let rgb = [r, g, b];
        for (i, k) in [(0, 1), (1, 0), (0, 2), (2, 0), (1, 2), (2, 1)].into_iter().filter(|(i, k)| base[*i] > 1.2 * base[*k]) {
            assert!(rgb[i] > rgb[k], "{} at {x}, {y}: {rgb:?} for {base:?}", mesh.name);
        }
        assert!(r.abs_diff(background[0]).max(g.abs_diff(background[1])).max(b.abs_diff(background[2])) > 24);
        seen += 1;
    }
    assert_eq!(seen, 16);

    // The upper edge of each box, halfway, has the colour of its depth; a caption hides some lower edges.
    w.click(Role::CheckBox, "Node boxes");
    let boxed = shot(&mut w);
    let overlay = w.state().overlay.clone().expect("collected");
    let depth = w.state().settings.overlay.depth;
    let line = depth_color(depth, &(depth..=depth));
    assert!(overlay.boxes.len() > 1);
    for b in &overlay.boxes {
        let (x, y) = place(&w, b.at(Vec3::new(0.5, 1.0, 1.0)));
        let near = (y.saturating_sub(2)..=y + 2).map(|y| boxed.get_pixel(x, y).0);
        // A line of 1.5 pixels covers three quarters of some pixel at least; the rest is the dark halo.
        let close = |p: [u8; 4]| p.iter().zip(line.to_array()).all(|(p, q)| p.abs_diff(q) <= q / 4 + 4);
        assert!(near.clone().any(close), "no line at {x}, {y}: {:?}, not {line:?}", near.collect::<Vec<_>>());
    }
    assert!(differ(&bare, &boxed, &w) > 500);
}

#[test]
fn hidden_lines_can_be_seen_or_not() {
    let Some(mut w) = window("builtin:menger?triangles=3000", "hidden lines on the screen") else { return };
    let all = shot(&mut w);
    w.click(Role::CheckBox, "Hidden lines");
    let front = shot(&mut w);
    w.click(Role::CheckBox, "Node boxes");
    let bare = shot(&mut w);
    let (all, front) = (differ(&all, &bare, &w), differ(&front, &bare, &w));
    assert!(front > 200 && all > front + 200, "{front} pixels of lines in front, {all} of all lines");
}

#[test]
fn the_mesh_is_there_before_the_picture() {
    let Some(mut w) = window("builtin:lecture", "the view before the first structure") else { return };
    // While nothing is built the mesh is rasterised: never an empty view.
    w.open_path("builtin:teapot?triangles=50000");
    w.until("the model", |s| s.model.as_ref().is_some_and(|m| m.scene.name.contains("teapot")));
    if w.state().picture.is_none() {
        let image = w.harness.render().expect("drawn");
        let (corner, middle) = (w.viewport().min + vec2(3.0, 3.0), w.viewport().center());
        let at = |p: eframe::egui::Pos2| image.get_pixel(p.x as u32, p.y as u32).0;
        assert_ne!(at(corner), at(middle));
    }
}
