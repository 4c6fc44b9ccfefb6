//! The edges of boxes, and single lines, in the styles of [`LineStyle`].

use std::ops::Range;

use eframe::wgpu;
use wgpu::util::DeviceExt;

use super::layouts::{Layouts, Uniform};
use super::overlay::{BoxInstance, OverlayBuffer};
use super::pipeline::{Pass, Recipe};
use crate::viewer::theme::{DASH_PT, LineStyle};

/// Draws the edges of boxes.
pub(super) struct LinePipeline {
    pipeline: wgpu::RenderPipeline,
    corners: wgpu::Buffer,
    line: Uniform,
    selected: Uniform,
}

/// Two triangles for each of twelve edges; the shader makes the corners from their numbers.
const CORNERS: u32 = 12 * 6;
/// Those of the one edge that a line has.
const LINE: u32 = 6;

impl LinePipeline {
    pub(super) fn new(device: &wgpu::Device, layouts: &Layouts) -> Self {
        let recipe = Recipe {
            label: "lines",
            source: concat!(include_str!("view.wgsl"), include_str!("occlusion.wgsl"), include_str!("lines.wgsl")),
            groups: &[&layouts.uniform, &layouts.surface, &layouts.uniform],
            vertices: &[Some(BoxInstance::LAYOUT)],
            pass: Pass::Lines,
            ..Recipe::default()
        };
        let corners: Vec<u16> = (0..12).flat_map(|edge| [0, 1, 2, 2, 1, 3].map(|corner| edge * 4 + corner)).collect();
        let style = |style: LineStyle| layouts.uniform(device, "line style", &StyleUniform::from(style));
        Self {
            pipeline: recipe.make(device),
            corners: device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
                label: Some("edge corners"),
                contents: bytemuck::cast_slice(&corners),
                usage: wgpu::BufferUsages::INDEX,
            }),
            line: style(LineStyle::BOX),
            selected: style(LineStyle::SELECTED),
        }
    }

    /// Draws all edges of an overlay; the view and the surface are groups 0 and 1.
    pub(super) fn draw(&self, pass: &mut wgpu::RenderPass<'_>, overlay: &OverlayBuffer) {
        pass.set_pipeline(&self.pipeline);
        pass.set_index_buffer(self.corners.slice(..), wgpu::IndexFormat::Uint16);
        pass.set_vertex_buffer(0, overlay.buffer().slice(..));
        for (style, corners, instances) in [
            (&self.line, CORNERS, overlay.edged()),
            (&self.line, LINE, overlay.lines()),
            (&self.selected, CORNERS, overlay.selected()),
            (&self.selected, LINE, overlay.selected_lines()),
        ] {
            draw_styled(pass, style, corners, instances);
        }
    }
}

fn draw_styled(pass: &mut wgpu::RenderPass<'_>, style: &Uniform, corners: u32, instances: Range<u32>) {
    if !instances.is_empty() {
        pass.set_bind_group(2, &style.group, &[]);
        pass.draw_indexed(0..corners, 0, instances);
    }
}

/// A style as the shader reads it.
#[derive(Clone, Copy, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
struct StyleUniform {
    halo: [f32; 4],
    width: f32,
    halo_width: f32,
    hidden_width: f32,
    hidden_alpha: f32,
    dash: [f32; 2],
    hidden_halo_alpha: f32,
    on_top: f32,
}

impl From<LineStyle> for StyleUniform {
    fn from(style: LineStyle) -> Self {
        let with = |rgb: [u8; 3], last: f32| {
            let [r, g, b] = rgb.map(|v| f32::from(v) / 255.0);
            [r, g, b, last]
        };
        Self {
            halo: with(style.halo, style.halo_alpha),
            width: style.width,
            halo_width: style.halo_width,
            hidden_width: style.hidden_width,
            hidden_alpha: style.hidden_alpha,
            dash: DASH_PT,
            hidden_halo_alpha: style.hidden_halo_alpha,
            on_top: if style.on_top { 1.0 } else { 0.0 },
        }
    }
}
