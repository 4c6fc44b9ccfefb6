//! Translucent rectangles and triangles: split planes.

use eframe::wgpu;

use super::layouts::Layouts;
use super::overlay::{BoxInstance, OverlayBuffer};
use super::pipeline::{Pass, Recipe};
use crate::viewer::theme::{PLANE_FILL, PLANE_FILL_HIDDEN};

/// Fills planes; their edges are drawn with those of the boxes.
pub(super) struct PlanePipeline(wgpu::RenderPipeline);

impl PlanePipeline {
    pub(super) fn new(device: &wgpu::Device, layouts: &Layouts) -> Self {
        let recipe = Recipe {
            label: "planes",
            source: concat!(include_str!("view.wgsl"), include_str!("occlusion.wgsl"), include_str!("planes.wgsl")),
            groups: &[&layouts.uniform, &layouts.surface],
            vertices: &[Some(BoxInstance::LAYOUT)],
            topology: wgpu::PrimitiveTopology::TriangleStrip,
            constants: &[("FILL", PLANE_FILL.into()), ("FILL_HIDDEN", PLANE_FILL_HIDDEN.into())],
            pass: Pass::Over,
        };
        Self(recipe.make(device))
    }

    /// Fills the planes of an overlay; the view and the surface are groups 0 and 1.
    pub(super) fn draw(&self, pass: &mut wgpu::RenderPass<'_>, overlay: &OverlayBuffer) {
        if overlay.planes().is_empty() && overlay.fills().is_empty() {
            return;
        }
        pass.set_pipeline(&self.0);
        pass.set_vertex_buffer(0, overlay.buffer().slice(..));
        pass.draw(0..4, overlay.planes());
        // Half of a parallelogram.
        pass.draw(0..3, overlay.fills());
    }
}
