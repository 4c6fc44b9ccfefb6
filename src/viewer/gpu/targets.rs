//! What the viewport is drawn into before it goes into the window: colour, linear depth, and a depth
//! buffer, by which triangles hide each other and then lines do. The window's own pass has no depth to offer.

use eframe::wgpu;

/// Colours are stored gamma-encoded, as the window wants them.
pub(super) const COLOR: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8Unorm;
/// Linear depth, read by everything that is drawn over the picture: the bits of a 32-bit float, since
/// OpenGL does not always draw into floats.
pub(super) const SURFACE: wgpu::TextureFormat = wgpu::TextureFormat::R32Uint;
/// Reversed z, from 1 at the near plane to 0.
pub(super) const DEPTH: wgpu::TextureFormat = wgpu::TextureFormat::Depth32Float;

/// Linear depth where nothing is: finite, since shaders need not honour infinities. The shaders
/// have the same number.
pub(super) const NOTHING: f32 = 1e30;

/// The textures of one viewport.
pub(super) struct Targets {
    pub(super) color: wgpu::Texture,
    pub(super) color_view: wgpu::TextureView,
    surface_view: wgpu::TextureView,
    depth_view: wgpu::TextureView,
    /// The linear depth, as the overlay's shaders read it.
    pub(super) surface_group: wgpu::BindGroup,
    /// The colour, as the window's pass reads it.
    pub(super) blit_group: wgpu::BindGroup,
}

impl Targets {
    /// Textures of a size that the device can make; see [`fitting`].
    pub(super) fn new(device: &wgpu::Device, layouts: &super::layouts::Layouts, size: [u32; 2]) -> Self {
        let make = |label, format, more| {
            let usage = wgpu::TextureUsages::RENDER_ATTACHMENT | more;
            let texture = texture(device, label, size, format, usage);
            let view = texture.create_view(&wgpu::TextureViewDescriptor::default());
            (texture, view)
        };
        let (color, color_view) =
            make("viewport colour", COLOR, wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_SRC);
        let (_, surface_view) =
            make("viewport linear depth", SURFACE, wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_SRC);
        let (_, depth_view) = make("viewport depth", DEPTH, wgpu::TextureUsages::empty());
        let surface_group = layouts.surface_group(device, &surface_view);
        let blit_group = layouts.blit_group(device, &color_view);
        Self { color, color_view, surface_view, depth_view, surface_group, blit_group }
    }

    pub(super) fn size(&self) -> [u32; 2] {
        [self.color.width(), self.color.height()]
    }

    /// The pass that draws the picture or the mesh: all three are cleared.
    pub(super) fn base_pass<'e>(&self, encoder: &'e mut wgpu::CommandEncoder, background: [u8; 4]) -> wgpu::RenderPass<'e> {
        let [r, g, b, _] = background.map(|v| f64::from(v) / 255.0);
        let far = f64::from(NOTHING.to_bits());
        encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("viewport base"),
            color_attachments: &[
                clear(&self.color_view, wgpu::Color { r, g, b, a: 1.0 }),
                clear(&self.surface_view, wgpu::Color { r: far, g: far, b: far, a: far }),
            ],
            depth_stencil_attachment: self.cleared_depth(),
            ..Default::default()
        })
    }

    /// The depth buffer, empty: each of the passes uses it for itself.
    fn cleared_depth(&self) -> Option<wgpu::RenderPassDepthStencilAttachment<'_>> {
        let ops = wgpu::Operations { load: wgpu::LoadOp::Clear(0.0), store: wgpu::StoreOp::Discard };
        Some(wgpu::RenderPassDepthStencilAttachment { view: &self.depth_view, depth_ops: Some(ops), stencil_ops: None })
    }

    /// The pass that draws over it, and reads the linear depth.
    pub(super) fn overlay_pass<'e>(&self, encoder: &'e mut wgpu::CommandEncoder) -> wgpu::RenderPass<'e> {
        encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("viewport overlay"),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: &self.color_view,
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations { load: wgpu::LoadOp::Load, store: wgpu::StoreOp::Store },
            })],
            depth_stencil_attachment: self.cleared_depth(),
            ..Default::default()
        })
    }
}

fn clear(view: &wgpu::TextureView, color: wgpu::Color) -> Option<wgpu::RenderPassColorAttachment<'_>> {
    let ops = wgpu::Operations { load: wgpu::LoadOp::Clear(color), store: wgpu::StoreOp::Store };
    Some(wgpu::RenderPassColorAttachment { view, depth_slice: None, resolve_target: None, ops })
}

/// The nearest size that the device can make textures of. A larger viewport is stretched.
pub(super) fn fitting(device: &wgpu::Device, size: [u32; 2]) -> [u32; 2] {
    size.map(|v| v.clamp(1, device.limits().max_texture_dimension_2d))
}

/// A plain two-dimensional texture.
pub(super) fn texture(
    device: &wgpu::Device,
    label: &str,
    [width, height]: [u32; 2],
    format: wgpu::TextureFormat,
    usage: wgpu::TextureUsages,
) -> wgpu::Texture {
    device.create_texture(&wgpu::TextureDescriptor {
        label: Some(label),
        size: wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format,
        usage,
        view_formats: &[],
    })
}
