//! A render pipeline from the few things in which the viewport's differ.

use eframe::wgpu;

use super::targets::{COLOR, DEPTH, SURFACE};

/// A pipeline of the viewport: WGSL source with the entry points `vertex` and `fragment`.
pub(super) struct Recipe<'a> {
    pub(super) label: &'a str,
    pub(super) source: &'a str,
    pub(super) groups: &'a [&'a wgpu::BindGroupLayout],
    pub(super) vertices: &'a [Option<wgpu::VertexBufferLayout<'a>>],
    pub(super) topology: wgpu::PrimitiveTopology,
    pub(super) constants: &'a [(&'a str, f64)],
    pub(super) pass: Pass,
}

/// The pass that a pipeline belongs to.
#[derive(Clone, Copy)]
pub(super) enum Pass {
    /// Writes colour and linear depth, everywhere.
    Fill,
    /// Writes colour and linear depth where it is nearest.
    Solid,
    /// Blends premultiplied colour over what is there.
    Over,
    /// The same, and hides by depth what comes later.
    Lines,
    /// Writes colour into the window.
    Window(wgpu::TextureFormat),
}

impl Default for Recipe<'_> {
    fn default() -> Self {
        Self {
            label: "",
            source: "",
            groups: &[],
            vertices: &[],
            topology: wgpu::PrimitiveTopology::TriangleList,
            constants: &[],
            pass: Pass::Fill,
        }
    }
}

impl Recipe<'_> {
    pub(super) fn make(&self, device: &wgpu::Device) -> wgpu::RenderPipeline {
        let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some(self.label),
            source: wgpu::ShaderSource::Wgsl(self.source.into()),
        });
        let groups: Vec<_> = self.groups.iter().map(|g| Some(*g)).collect();
        let layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some(self.label),
            bind_group_layouts: &groups,
            immediate_size: 0,
        });
        let options = wgpu::PipelineCompilationOptions { constants: self.constants, ..Default::default() };
        device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: Some(self.label),
            layout: Some(&layout),
            vertex: wgpu::VertexState {
                module: &module,
                entry_point: Some("vertex"),
                compilation_options: options.clone(),
                buffers: self.vertices,
            },
            primitive: wgpu::PrimitiveState { topology: self.topology, ..Default::default() },
            depth_stencil: self.pass.depth(),
            multisample: wgpu::MultisampleState::default(),
            fragment: Some(wgpu::FragmentState {
                module: &module,
                entry_point: Some("fragment"),
                compilation_options: options,
                targets: &self.pass.colors(),
            }),
            multiview_mask: None,
            cache: None,
        })
    }
}

impl Pass {
    fn colors(self) -> Vec<Option<wgpu::ColorTargetState>> {
        match self {
            Self::Fill | Self::Solid => vec![Some(COLOR.into()), Some(SURFACE.into())],
            Self::Over | Self::Lines => {
                let blend = Some(wgpu::BlendState::PREMULTIPLIED_ALPHA_BLENDING);
                vec![Some(wgpu::ColorTargetState { blend, ..COLOR.into() })]
            }
            Self::Window(format) => vec![Some(format.into())],
        }
    }

    fn depth(self) -> Option<wgpu::DepthStencilState> {
        let (write, compare) = match self {
            Self::Fill | Self::Over => (false, wgpu::CompareFunction::Always),
            Self::Solid => (true, wgpu::CompareFunction::Greater),
            Self::Lines => (true, wgpu::CompareFunction::GreaterEqual),
            Self::Window(_) => return None,
        };
        Some(wgpu::DepthStencilState {
            format: DEPTH,
            depth_write_enabled: Some(write),
            depth_compare: Some(compare),
            stencil: wgpu::StencilState::default(),
            bias: wgpu::DepthBiasState::default(),
        })
    }
}
