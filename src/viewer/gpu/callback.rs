//! The thin layer between egui's painting and the [`Renderer`].

use eframe::egui::epaint::ViewportInPixels;
use eframe::egui::{PaintCallbackInfo, Painter, Rect};
use eframe::egui_wgpu::{Callback, CallbackResources, CallbackTrait, RenderState, ScreenDescriptor};
use eframe::wgpu;

use super::{DrawList, PaneId, Renderer};

/// Makes viewports possible in a window; called once, when it opens. Where it was not called, as in
/// tests without a GPU, [`paint`] draws nothing.
pub fn install(state: &RenderState) {
    let renderer = Renderer::new(&state.device, state.target_format);
    state.renderer.write().callback_resources.insert(renderer);
}

/// The size of a viewport in pixels, rounded as egui rounds it.
pub fn size_px(rect: Rect, pixels_per_point: f32) -> [u32; 2] {
    let any_screen = [u32::MAX >> 8; 2];
    let viewport = ViewportInPixels::from_points(&rect, pixels_per_point, any_screen);
    [viewport.width_px, viewport.height_px].map(|v| v.max(1).unsigned_abs())
}

/// Paints a viewport into `rect`. Viewports that are shown side by side have different ids.
pub fn paint(painter: &Painter, rect: Rect, pane: PaneId, list: DrawList) {
    painter.add(Callback::new_paint_callback(rect, ViewportCallback { pane, list }));
}

struct ViewportCallback {
    pane: PaneId,
    list: DrawList,
}

impl CallbackTrait for ViewportCallback {
    fn prepare(
        &self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        _screen: &ScreenDescriptor,
        encoder: &mut wgpu::CommandEncoder,
        resources: &mut CallbackResources,
    ) -> Vec<wgpu::CommandBuffer> {
        if let Some(renderer) = resources.get_mut::<Renderer>() {
            renderer.prepare(device, queue, encoder, self.pane, &self.list);
        }
        Vec::new()
    }

    fn paint(&self, _info: PaintCallbackInfo, pass: &mut wgpu::RenderPass<'static>, resources: &CallbackResources) {
        if let Some(renderer) = resources.get::<Renderer>() {
            renderer.paint(pass, self.pane);
        }
    }
}
