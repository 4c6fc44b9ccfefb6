//! What draws the window, and what follows from it.

use std::time::Duration;

use eframe::egui_wgpu::RenderState;
use eframe::wgpu::DeviceType;

/// What draws the window.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Graphics {
    /// A GPU.
    Gpu,
    /// A program on the processor, as fast as the processor is.
    Software,
    /// Nothing: tests without a GPU.
    None,
}

impl Graphics {
    /// That of a window.
    pub fn of(state: Option<&RenderState>) -> Self {
        match state.map(|state| state.adapter.get_info().device_type) {
            None => Self::None,
            Some(DeviceType::Cpu) => Self::Software,
            Some(_) => Self::Gpu,
        }
    }

    /// How many boxes a viewport can show and still be redrawn fluently while the camera moves.
    pub const fn comfortable_boxes(self) -> usize {
        match self {
            Self::Gpu => 100_000,
            Self::Software | Self::None => 1000,
        }
    }

    /// The most triangles that are rasterised fluently.
    pub const fn comfortable_triangles(self) -> usize {
        match self {
            Self::Gpu => usize::MAX,
            Self::Software | Self::None => 200_000,
        }
    }

    /// How long a frame that asks for a picture holds on for it. A program on two cores takes 60 to 90 ms
    /// to draw a frame, several times what the first, coarse picture takes: a frame that went ahead
    /// without it would show an old view and keep the new one waiting. A GPU draws the next frame at once.
    pub const fn patience(self) -> Duration {
        match self {
            Self::Software => Duration::from_millis(24),
            Self::Gpu | Self::None => Duration::ZERO,
        }
    }
}
