//! Puts a finished viewport into the window.

use eframe::wgpu;

use super::layouts::Layouts;
use super::pipeline::{Pass, Recipe};

/// Draws a finished viewport into the pass of the window.
pub(super) struct BlitPipeline(wgpu::RenderPipeline);

impl BlitPipeline {
    /// For windows of a format. The window blends gamma-encoded colours; only a format that encodes
    /// by itself is given linear ones.
    pub(super) fn new(device: &wgpu::Device, layouts: &Layouts, target: wgpu::TextureFormat) -> Self {
        let recipe = Recipe {
            label: "blit",
            source: include_str!("blit.wgsl"),
            groups: &[&layouts.blit],
            constants: &[("TARGET_IS_LINEAR", if target.is_srgb() { 1.0 } else { 0.0 })],
            pass: Pass::Window(target),
            ..Recipe::default()
        };
        Self(recipe.make(device))
    }

    /// Fills the pass's viewport.
    pub(super) fn draw(&self, pass: &mut wgpu::RenderPass<'_>, finished: &wgpu::BindGroup) {
        pass.set_pipeline(&self.0);
        pass.set_bind_group(0, finished, &[]);
        pass.draw(0..3, 0..1);
    }
}
