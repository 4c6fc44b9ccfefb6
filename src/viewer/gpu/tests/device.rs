//! A device without a window, and pixels read back from it.

use std::io::Write;
use std::sync::{Mutex, MutexGuard, PoisonError};

use eframe::wgpu;

use crate::viewer::gpu::targets::{COLOR, texture};
use crate::viewer::gpu::{DrawList, Renderer};

/// Some drivers wait for ever where several threads of a program make devices at the same time: one test after another has one.
static TURN: Mutex<()> = Mutex::new(());

/// A renderer on a device of its own.
pub(super) struct Headless {
    pub(super) device: wgpu::Device,
    queue: wgpu::Queue,
    pub(super) renderer: Renderer,
    /// Dropped last.
    _turn: MutexGuard<'static, ()>,
}

/// Says that a check was left out, and what it takes. Straight to standard error: what tests print is
/// kept back when they pass.
fn left_out(check: &str) {
    let remedy = "Install mesa-vulkan-drivers libvulkan1 to run it.";
    let _ = writeln!(std::io::stderr(), "LEFT OUT for want of a GPU driver: {check}. {remedy}");
}

impl Headless {
    /// `None`, said aloud, where there is no adapter. The limits are those that eframe asks for at
    /// least, so that what passes here also runs there.
    pub(super) fn new(test: &str) -> Option<Self> {
        let turn = TURN.lock().unwrap_or_else(PoisonError::into_inner);
        let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle_from_env());
        let adapter = match pollster::block_on(instance.request_adapter(&wgpu::RequestAdapterOptions::default())) {
            Ok(adapter) => adapter,
            Err(_) => {
                left_out(test);
                return None;
            }
        };
        let limits = wgpu::Limits { max_texture_dimension_2d: 4096, ..wgpu::Limits::downlevel_webgl2_defaults() };
        let description = wgpu::DeviceDescriptor { required_limits: limits, ..Default::default() };
        let (device, queue) = pollster::block_on(adapter.request_device(&description)).expect("a device");
        let renderer = Renderer::new(&device, COLOR);
        Some(Self { device, queue, renderer, _turn: turn })
    }

    /// Prepares one frame of viewport 0. Whether it was drawn anew.
    pub(super) fn frame(&mut self, list: &DrawList) -> bool {
        let mut encoder = self.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        let changed = self.renderer.prepare(&self.device, &self.queue, &mut encoder, 0, list);
        self.queue.submit([encoder.finish()]);
        changed
    }

    /// Until everything submitted is done.
    pub(super) fn wait(&self) {
        self.device.poll(wgpu::PollType::wait_indefinitely()).expect("finished");
    }

    /// What the viewport looks like.
    pub(super) fn shot(&mut self, name: &str, list: &DrawList) -> image::RgbaImage {
        self.frame(list);
        let finished = self.renderer.finished(0).expect("drawn").clone();
        let image = self.read(&finished);
        if let Some(dir) = std::env::var_os("BOXWOOD_SHOTS") {
            image.save(std::path::Path::new(&dir).join(name).with_extension("png")).expect("saved");
        }
        image
    }

    /// What [`Renderer::paint`] draws into a window of a size.
    pub(super) fn painted(&mut self, list: &DrawList, size: [u32; 2]) -> image::RgbaImage {
        self.frame(list);
        let usage = wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::COPY_SRC;
        let window = texture(&self.device, "window", size, COLOR, usage);
        let view = window.create_view(&wgpu::TextureViewDescriptor::default());
        let mut encoder = self.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        {
            let attachment = wgpu::RenderPassColorAttachment {
                view: &view,
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations::default(),
            };
            let description = wgpu::RenderPassDescriptor { color_attachments: &[Some(attachment)], ..Default::default() };
            self.renderer.paint(&mut encoder.begin_render_pass(&description), 0);
        }
        self.queue.submit([encoder.finish()]);
        self.read(&window)
    }

    fn read(&self, texture: &wgpu::Texture) -> image::RgbaImage {
        let (width, height) = (texture.width(), texture.height());
        let row = (width * 4).next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT);
        let buffer = self.device.create_buffer(&wgpu::BufferDescriptor {
            label: None,
            size: u64::from(row * height),
            usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
            mapped_at_creation: false,
        });
        let mut encoder = self.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        let layout = wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(row), rows_per_image: None };
        let into = wgpu::TexelCopyBufferInfo { buffer: &buffer, layout };
        encoder.copy_texture_to_buffer(texture.as_image_copy(), into, texture.size());
        self.queue.submit([encoder.finish()]);
        buffer.map_async(wgpu::MapMode::Read, .., |result| result.expect("mapped"));
        self.wait();
        let bytes = buffer.get_mapped_range(..).expect("mapped");
        let rows = bytes.chunks(row as usize).flat_map(|r| &r[..width as usize * 4]).copied().collect();
        image::RgbaImage::from_raw(width, height, rows).expect("the size fits")
    }
}
