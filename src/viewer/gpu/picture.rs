//! A traced picture, and its copy on the GPU.

use std::sync::Arc;

use eframe::wgpu;

use super::layouts::Layouts;
use super::pipeline::{Pass, Recipe};
use super::targets::{COLOR, SURFACE, texture};
use crate::render::Picture;

/// Whether the lists are as long as the size says.
fn is_consistent(picture: &Picture) -> bool {
    let pixels = picture.width as usize * picture.height as usize;
    pixels > 0 && picture.rgba.len() == pixels * 4 && picture.depth.len() == pixels
}

/// Draws pictures.
pub(super) struct PicturePipeline(wgpu::RenderPipeline);

impl PicturePipeline {
    pub(super) fn new(device: &wgpu::Device, layouts: &Layouts) -> Self {
        let recipe = Recipe {
            label: "picture",
            source: concat!(include_str!("view.wgsl"), include_str!("picture.wgsl")),
            groups: &[&layouts.uniform, &layouts.picture],
            pass: Pass::Fill,
            ..Recipe::default()
        };
        Self(recipe.make(device))
    }

    /// Stretches the picture over the target; the view is group 0.
    pub(super) fn draw(&self, pass: &mut wgpu::RenderPass<'_>, picture: &PictureTextures) {
        pass.set_pipeline(&self.0);
        pass.set_bind_group(1, &picture.group, &[]);
        pass.draw(0..3, 0..1);
    }
}

/// A picture on the GPU.
pub(super) struct PictureTextures {
    color: wgpu::Texture,
    depth: wgpu::Texture,
    group: wgpu::BindGroup,
    generation: Option<u64>,
    /// Kept so that the same allocation cannot be taken for another list.
    uploaded_depth: Option<Arc<Vec<f32>>>,
}

impl PictureTextures {
    /// Brings the picture there, in place of an earlier one if there is one; only what changed.
    ///
    /// `None` for a picture that does not hold what its size says, or is larger than textures of
    /// this device can be.
    pub(super) fn update(
        earlier: Option<Self>,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        layouts: &Layouts,
        picture: &Picture,
    ) -> Option<Self> {
        let most = device.limits().max_texture_dimension_2d;
        if !is_consistent(picture) || picture.width.max(picture.height) > most {
            return None;
        }
        let fits = earlier.filter(|e| [e.color.width(), e.color.height()] == [picture.width, picture.height]);
        let mut there = fits.unwrap_or_else(|| Self::new(device, layouts, [picture.width, picture.height]));
        if there.generation != Some(picture.generation) {
            write(queue, &there.color, &picture.rgba);
            if !there.uploaded_depth.as_ref().is_some_and(|d| Arc::ptr_eq(d, &picture.depth)) {
                write(queue, &there.depth, bytemuck::cast_slice(&picture.depth));
                there.uploaded_depth = Some(Arc::clone(&picture.depth));
            }
            there.generation = Some(picture.generation);
        }
        Some(there)
    }

    fn new(device: &wgpu::Device, layouts: &Layouts, size: [u32; 2]) -> Self {
        let usage = wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST;
        let color = texture(device, "picture colour", size, COLOR, usage);
        let depth = texture(device, "picture depth", size, SURFACE, usage);
        let view = |t: &wgpu::Texture| t.create_view(&wgpu::TextureViewDescriptor::default());
        let group = layouts.picture_group(device, &view(&color), &view(&depth));
        Self { color, depth, group, generation: None, uploaded_depth: None }
    }
}

/// Fills a texture of four bytes a texel.
fn write(queue: &wgpu::Queue, texture: &wgpu::Texture, bytes: &[u8]) {
    let layout = wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(texture.width() * 4), rows_per_image: None };
    queue.write_texture(texture.as_image_copy(), bytes, layout, texture.size());
}
