//! One viewport's own textures and buffers, and what was drawn into them last.

use eframe::wgpu;

use super::layouts::{Layouts, Uniform};
use super::overlay::OverlayBuffer;
use super::picture::PictureTextures;
use super::raster::MeshBuffers;
use super::targets::Targets;
use super::uniforms::ViewUniform;
use super::{Base, DrawList, View};

/// One viewport.
pub(super) struct Pane {
    pub(super) targets: Targets,
    pub(super) view: Uniform,
    pub(super) picture: Option<PictureTextures>,
    pub(super) overlay: OverlayBuffer,
    pub(super) drawn: Option<Drawn>,
    /// When it was last asked for.
    pub(super) used: u64,
}

impl Pane {
    pub(super) fn new(device: &wgpu::Device, layouts: &Layouts, size: [u32; 2]) -> Self {
        Self {
            targets: Targets::new(device, layouts, size),
            view: layouts.uniform(device, "view", &<ViewUniform as bytemuck::Zeroable>::zeroed()),
            picture: None,
            overlay: OverlayBuffer::new(device),
            drawn: None,
            used: 0,
        }
    }
}

/// Everything that a finished viewport depends on.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Drawn {
    view: View,
    size: [u32; 2],
    pixels_per_point: f32,
    background: [u8; 4],
    hidden_lines: bool,
    overlay: Option<u64>,
    begin: f32,
    base: DrawnBase,
}

#[derive(Clone, Debug, PartialEq)]
enum DrawnBase {
    Nothing,
    Picture(u64),
    Raster { generation: u64, chunks: usize, color: [u8; 4], max_triangles: usize },
}

impl Drawn {
    pub(super) fn new(list: &DrawList, size: [u32; 2], mesh: Option<&MeshBuffers>) -> Self {
        Self {
            view: list.view,
            size,
            pixels_per_point: list.pixels_per_point,
            background: list.background,
            hidden_lines: list.hidden_lines,
            overlay: list.overlay.as_ref().map(|o| o.generation),
            begin: list.begin,
            base: match &list.base {
                Base::Nothing => DrawnBase::Nothing,
                Base::Picture(picture) => DrawnBase::Picture(picture.generation),
                Base::Raster(raster) => DrawnBase::Raster {
                    generation: raster.mesh.generation(),
                    chunks: mesh.map_or(0, MeshBuffers::chunk_count),
                    color: raster.color,
                    max_triangles: raster.max_triangles,
                },
            },
        }
    }
}
