//! The view as the shaders read it.

use super::targets::NOTHING;
use super::{Base, DrawList};

/// Laid out as `View` in view.wgsl.
#[derive(Clone, Copy, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub(super) struct ViewUniform {
    eye: [f32; 3],
    near: f32,
    right: [f32; 3],
    half_width: f32,
    up: [f32; 3],
    half_height: f32,
    forward: [f32; 3],
    far: f32,
    background: [f32; 4],
    mesh_color: [f32; 4],
    size: [f32; 2],
    texel: [f32; 2],
    depth_step: f32,
    pixels_per_point: f32,
    orthographic: f32,
    hidden: f32,
    boxes: f32,
    padding: [f32; 3],
    section: [f32; 4],
}

impl ViewUniform {
    /// `size` is that of the target, and `depth_size` that of what its linear depth comes from.
    pub(super) fn new(list: &DrawList, size: [u32; 2], depth_size: [u32; 2]) -> Self {
        let view = &list.view;
        let (size, depth_size) = (size.map(|v| v as f32), depth_size.map(|v| v.max(1) as f32));
        let flag = |on| if on { 1.0 } else { 0.0 };
        Self {
            eye: view.eye.to_array(),
            near: view.range[0],
            right: view.right.to_array(),
            half_width: view.half_size.x,
            up: view.up.to_array(),
            half_height: view.half_size.y,
            forward: view.forward.to_array(),
            far: view.range[1].min(NOTHING),
            background: list.background.map(|v| f32::from(v) / 255.0),
            mesh_color: mesh_color(&list.base),
            size,
            texel: [size[0] / depth_size[0], size[1] / depth_size[1]],
            depth_step: view.row_span(depth_size[1].min(size[1])),
            pixels_per_point: list.pixels_per_point,
            orthographic: flag(view.orthographic),
            hidden: flag(list.hidden_lines),
            boxes: list.overlay.as_ref().map_or(1, |o| o.edged().max(1)) as f32,
            padding: [0.0; 3],
            section: view.section.map_or([0.0; 4], |section| {
                let (normal, offset) = section.plane();
                normal.extend(offset).to_array()
            }),
        }
    }
}

/// The colour of the mesh, if there is one: decoded, since light adds up linearly.
fn mesh_color(base: &Base) -> [f32; 4] {
    match base {
        Base::Raster(raster) => raster.color.map(|v| (f32::from(v) / 255.0).powf(2.2)),
        Base::Nothing | Base::Picture(_) => [0.0; 4],
    }
}
