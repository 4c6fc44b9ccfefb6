//! Draws viewports: the picture or the mesh first, then what lies over it, each into textures of its
//! own, and only when something changed.

use std::collections::HashMap;

use eframe::wgpu;

use super::blit::BlitPipeline;
use super::layouts::Layouts;
use super::lines::LinePipeline;
use super::pane::{Drawn, Pane};
use super::picture::{PicturePipeline, PictureTextures};
use super::planes::PlanePipeline;
use super::raster::{MeshBuffers, Raster, RasterPipeline};
use super::targets::{Targets, fitting};
use super::uniforms::ViewUniform;
use super::{Base, DrawList};

/// Tells the viewports of a window apart.
pub type PaneId = u64;

/// The most viewports whose textures are kept; the one unused for longest makes room.
const MOST_PANES: usize = 8;

/// Everything on the GPU that viewports need.
pub struct Renderer {
    layouts: Layouts,
    picture: PicturePipeline,
    raster: RasterPipeline,
    lines: LinePipeline,
    planes: PlanePipeline,
    blit: BlitPipeline,
    mesh: Option<MeshBuffers>,
    panes: HashMap<PaneId, Pane>,
    /// Counts calls of [`Self::prepare`], to know which pane is unused for longest.
    clock: u64,
}

impl Renderer {
    /// `target` is the format of the window, or of whatever [`Self::paint`] draws into.
    pub fn new(device: &wgpu::Device, target: wgpu::TextureFormat) -> Self {
        let layouts = Layouts::new(device);
        Self {
            picture: PicturePipeline::new(device, &layouts),
            raster: RasterPipeline::new(device, &layouts),
            lines: LinePipeline::new(device, &layouts),
            planes: PlanePipeline::new(device, &layouts),
            blit: BlitPipeline::new(device, &layouts, target),
            layouts,
            mesh: None,
            panes: HashMap::new(),
            clock: 0,
        }
    }

    /// Brings what changed to the GPU, and draws the viewport if anything did. Whether it did.
    pub fn prepare(
        &mut self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        encoder: &mut wgpu::CommandEncoder,
        id: PaneId,
        list: &DrawList,
    ) -> bool {
        if id == 0 {
            // Viewports that were not drawn since the first one was are closed.
            let before = self.panes.get(&id).map_or(0, |pane| pane.used);
            self.panes.retain(|_, pane| pane.used >= before);
        }
        self.clock += 1;
        let mut pane = self.take_pane(device, id, fitting(device, list.size_px));
        if let Base::Raster(raster) = &list.base {
            self.bring_mesh(device, raster);
        }
        if let Some(overlay) = &list.overlay {
            pane.overlay.update(device, queue, overlay);
        }
        if let Base::Picture(picture) = &list.base {
            pane.picture = PictureTextures::update(pane.picture.take(), device, queue, &self.layouts, picture);
        }
        let drawn = Drawn::new(list, pane.targets.size(), self.mesh.as_ref());
        let changed = pane.drawn.as_ref() != Some(&drawn);
        if changed {
            self.draw(queue, encoder, &pane, list);
            pane.drawn = Some(drawn);
        }
        self.panes.insert(id, pane);
        changed
    }

    /// Draws what [`Self::prepare`] finished into the viewport of a pass of the window.
    pub fn paint(&self, pass: &mut wgpu::RenderPass<'_>, id: PaneId) {
        if let Some(pane) = self.panes.get(&id) {
            self.blit.draw(pass, &pane.targets.blit_group);
        }
    }

    /// The finished colours of a viewport: rgba8, gamma-encoded, and copyable.
    pub fn finished(&self, id: PaneId) -> Option<&wgpu::Texture> {
        self.panes.get(&id).map(|pane| &pane.targets.color)
    }

    /// Takes the pane out, made or resized where needed, making room for it.
    fn take_pane(&mut self, device: &wgpu::Device, id: PaneId, size: [u32; 2]) -> Pane {
        if !self.panes.contains_key(&id) && self.panes.len() >= MOST_PANES {
            let oldest = self.panes.iter().min_by_key(|(_, pane)| pane.used).map(|(id, _)| *id);
            oldest.map(|id| self.panes.remove(&id));
        }
        let mut pane = self.panes.remove(&id).unwrap_or_else(|| Pane::new(device, &self.layouts, size));
        if pane.targets.size() != size {
            pane.targets = Targets::new(device, &self.layouts, size);
            pane.drawn = None;
        }
        pane.used = self.clock;
        pane
    }

    /// Brings some more of the mesh to the GPU, which holds one at a time.
    fn bring_mesh(&mut self, device: &wgpu::Device, raster: &Raster) {
        let same = self.mesh.take().filter(|there| there.generation() == raster.mesh.generation());
        let mut there = same.unwrap_or_else(|| MeshBuffers::new(&raster.mesh));
        there.advance(device);
        self.mesh = Some(there);
    }

    fn draw(&self, queue: &wgpu::Queue, encoder: &mut wgpu::CommandEncoder, pane: &Pane, list: &DrawList) {
        let size = pane.targets.size();
        let depth_size = match &list.base {
            Base::Picture(picture) => [picture.width, picture.height],
            _ => size,
        };
        pane.view.set(queue, &ViewUniform::new(list, size, depth_size));
        self.draw_base(encoder, pane, list);
        if list.overlay.is_some() {
            let mut pass = pane.targets.overlay_pass(encoder);
            let [width, height] = size;
            let begin = ((list.begin * width as f32).round() as u32).min(width);
            pass.set_scissor_rect(begin, 0, width - begin, height);
            pass.set_bind_group(0, &pane.view.group, &[]);
            pass.set_bind_group(1, &pane.targets.surface_group, &[]);
            self.planes.draw(&mut pass, &pane.overlay);
            self.lines.draw(&mut pass, &pane.overlay);
        }
    }

    fn draw_base(&self, encoder: &mut wgpu::CommandEncoder, pane: &Pane, list: &DrawList) {
        let mut pass = pane.targets.base_pass(encoder, list.background);
        pass.set_bind_group(0, &pane.view.group, &[]);
        match (&list.base, &pane.picture, &self.mesh) {
            (Base::Picture(_), Some(picture), _) => self.picture.draw(&mut pass, picture),
            (Base::Raster(raster), _, Some(mesh)) => {
                self.raster.draw(&mut pass, mesh, raster.max_triangles, list.view.section.is_some());
            }
            _ => {}
        }
    }
}
