//! Draws without a window and looks at the pixels. Without a graphics adapter nothing is tested, and
//! each test says so. `BOXWOOD_SHOTS=DIR` saves every picture there, to be looked at.

mod device;
mod lines;
mod looks;
mod pictures;
mod rasters;
mod window;

use std::sync::Arc;

use glam::{Vec2, Vec3};

use super::{Base, BoxInstance, DrawList, Overlay, View};
use crate::geometry::Aabb;
use crate::render::Picture;
use crate::scene::Camera;

/// A view along -z onto the plane z = 0 from distance 2, which spans -1..1 there.
fn view(orthographic: bool) -> View {
    let half = if orthographic { 1.0 } else { 0.5 };
    View {
        eye: Vec3::new(0.0, 0.0, 2.0),
        right: Vec3::X,
        up: Vec3::Y,
        forward: Vec3::NEG_Z,
        half_size: Vec2::splat(half),
        orthographic,
        range: [0.5, 4.0],
        section: None,
    }
}

fn list(size: u32, base: Base) -> DrawList {
    DrawList {
        view: view(false),
        size_px: [size; 2],
        pixels_per_point: 1.0,
        background: [27, 30, 35, 255],
        base,
        overlay: None,
        begin: 0.0,
        hidden_lines: true,
    }
}

/// A grey wall that fills the view at z = 0.
fn wall(size: u32) -> Base {
    wall_at(size, 2.0)
}

fn wall_at(size: u32, depth: f32) -> Base {
    let pixels = (size * size) as usize;
    let rgba = [128, 128, 128, 255].repeat(pixels);
    Base::Picture(Arc::new(picture(1, size, size, rgba, vec![depth; pixels])))
}

/// A picture of which only what is seen matters.
fn picture(generation: u64, width: u32, height: u32, rgba: Vec<u8>, depth: Vec<f32>) -> Picture {
    let camera = Camera::framing(&Aabb::EMPTY, glam::Vec3::Z, glam::Vec3::Y, 1.0);
    let range = crate::render::Range { min: 0.0, max: 1.0 };
    Picture {
        generation,
        request: 1,
        camera,
        width,
        height,
        rgba,
        depth: Arc::new(depth),
        range,
        amounts: None,
        suits: range,
        progress: Default::default(),
        shots: Vec::new(),
    }
}

const YELLOW: [u8; 4] = [255, 230, 40, 255];

fn boxed(min: [f32; 3], max: [f32; 3]) -> BoxInstance {
    BoxInstance::new(&Aabb { min: min.into(), max: max.into() }, YELLOW)
}

fn overlay(boxes: Vec<BoxInstance>) -> Option<Arc<Overlay>> {
    Some(Arc::new(Overlay { generation: 1, boxes, ..Overlay::default() }))
}
