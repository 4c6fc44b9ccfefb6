//! What the shaders are given: the bind group layouts that the pipelines share, and the groups.

use eframe::wgpu;
use wgpu::util::DeviceExt;

/// The bind group layouts, and the one sampler.
pub(super) struct Layouts {
    /// Any small uniform buffer: the view, a line style.
    pub(super) uniform: wgpu::BindGroupLayout,
    /// Linear depth.
    pub(super) surface: wgpu::BindGroupLayout,
    /// Colour, sampler, linear depth.
    pub(super) picture: wgpu::BindGroupLayout,
    /// Colour, sampler.
    pub(super) blit: wgpu::BindGroupLayout,
    smooth: wgpu::Sampler,
}

impl Layouts {
    pub(super) fn new(device: &wgpu::Device) -> Self {
        let uniform =
            wgpu::BindingType::Buffer { ty: wgpu::BufferBindingType::Uniform, has_dynamic_offset: false, min_binding_size: None };
        let texture = |sample_type| wgpu::BindingType::Texture {
            sample_type,
            view_dimension: wgpu::TextureViewDimension::D2,
            multisampled: false,
        };
        let color = texture(wgpu::TextureSampleType::Float { filterable: true });
        let depth = texture(wgpu::TextureSampleType::Uint);
        let sampler = wgpu::BindingType::Sampler(wgpu::SamplerBindingType::Filtering);
        let smooth = device.create_sampler(&wgpu::SamplerDescriptor {
            label: Some("smooth"),
            mag_filter: wgpu::FilterMode::Linear,
            min_filter: wgpu::FilterMode::Linear,
            ..Default::default()
        });
        Self {
            uniform: layout(device, "uniform", &[uniform]),
            surface: layout(device, "surface", &[depth]),
            picture: layout(device, "picture", &[color, sampler, depth]),
            blit: layout(device, "blit", &[color, sampler]),
            smooth,
        }
    }

    /// A uniform buffer with its bind group.
    pub(super) fn uniform<T: bytemuck::Pod>(&self, device: &wgpu::Device, label: &str, value: &T) -> Uniform {
        let buffer = device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
            label: Some(label),
            contents: bytemuck::bytes_of(value),
            usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
        });
        let group = group(device, label, &self.uniform, &[buffer.as_entire_binding()]);
        Uniform { buffer, group }
    }

    pub(super) fn surface_group(&self, device: &wgpu::Device, surface: &wgpu::TextureView) -> wgpu::BindGroup {
        group(device, "surface", &self.surface, &[wgpu::BindingResource::TextureView(surface)])
    }

    pub(super) fn picture_group(
        &self,
        device: &wgpu::Device,
        color: &wgpu::TextureView,
        depth: &wgpu::TextureView,
    ) -> wgpu::BindGroup {
        let sampler = wgpu::BindingResource::Sampler(&self.smooth);
        let resources = [wgpu::BindingResource::TextureView(color), sampler, wgpu::BindingResource::TextureView(depth)];
        group(device, "picture", &self.picture, &resources)
    }

    pub(super) fn blit_group(&self, device: &wgpu::Device, color: &wgpu::TextureView) -> wgpu::BindGroup {
        let sampler = wgpu::BindingResource::Sampler(&self.smooth);
        group(device, "blit", &self.blit, &[wgpu::BindingResource::TextureView(color), sampler])
    }
}

/// A uniform buffer with its bind group.
pub(super) struct Uniform {
    buffer: wgpu::Buffer,
    pub(super) group: wgpu::BindGroup,
}

impl Uniform {
    /// Replaces the value; it must be of the type that the buffer was made for.
    pub(super) fn set<T: bytemuck::Pod>(&self, queue: &wgpu::Queue, value: &T) {
        queue.write_buffer(&self.buffer, 0, bytemuck::bytes_of(value));
    }
}

/// A layout with its bindings numbered from 0, seen by all stages.
fn layout(device: &wgpu::Device, label: &str, types: &[wgpu::BindingType]) -> wgpu::BindGroupLayout {
    let entry = |(binding, ty): (u32, &wgpu::BindingType)| wgpu::BindGroupLayoutEntry {
        binding,
        visibility: wgpu::ShaderStages::VERTEX_FRAGMENT,
        ty: *ty,
        count: None,
    };
    let entries: Vec<_> = (0..).zip(types).map(entry).collect();
    device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label: Some(label), entries: &entries })
}

fn group(
    device: &wgpu::Device,
    label: &str,
    layout: &wgpu::BindGroupLayout,
    resources: &[wgpu::BindingResource<'_>],
) -> wgpu::BindGroup {
    let entries: Vec<_> =
        (0..).zip(resources).map(|(binding, r)| wgpu::BindGroupEntry { binding, resource: r.clone() }).collect();
    device.create_bind_group(&wgpu::BindGroupDescriptor { label: Some(label), layout, entries: &entries })
}
