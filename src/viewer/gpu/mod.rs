//! The 3D viewports: a traced picture, or the mesh rasterised while there is none, with boxes and
//! planes over it that know what is in front of them.
//!
//! ```text
//! prepare (before egui's pass)                                    paint (in it)
//!   picture ─┐
//!            ├─► colour + linear depth ─► planes, lines over it ──► blit
//!   mesh ────┘
//! ```
//!
//! Everything is in the scaled space of [`crate::scene::Geometry`]. [`Renderer`] knows nothing of
//! egui; [`paint`] and [`install`] connect the two. What goes to the GPU carries a generation and
//! goes there once; a viewport in which nothing changed costs one blit a frame.

mod blit;
mod callback;
mod chunks;
mod cull;
mod layouts;
mod lines;
mod overlay;
mod pane;
mod picture;
mod pipeline;
mod planes;
mod raster;
mod renderer;
mod sources;
mod targets;
#[cfg(test)]
mod tests;
mod uniforms;
mod view;

use std::sync::Arc;

use crate::render::Picture;

pub use callback::{install, paint, size_px};
pub use cull::{Culled, Ruler, cull};
pub use overlay::{BoxInstance, Overlay};
pub use raster::{Raster, RasterMesh};
pub use renderer::{PaneId, Renderer};
pub use view::View;

/// What one viewport shows. Cheap to clone, made anew each frame.
#[derive(Clone, Debug)]
pub struct DrawList {
    /// From where.
    pub view: View,
    /// How large, in pixels; see [`size_px`].
    pub size_px: [u32; 2],
    /// The window's scale: widths of lines are in points.
    pub pixels_per_point: f32,
    /// Gamma-encoded.
    pub background: [u8; 4],
    /// What lies at the bottom.
    pub base: Base,
    /// What is drawn over it.
    pub overlay: Option<Arc<Overlay>>,
    /// From where on that is drawn, as a part of the width from the left side.
    pub begin: f32,
    /// Whether lines and planes show where the surface is in front of them. The selected box does
    /// in any case.
    pub hidden_lines: bool,
}

/// What a viewport shows under its overlay.
#[derive(Clone, Debug)]
pub enum Base {
    /// The background.
    Nothing,
    /// A traced picture. It should be of the same view: boxes are hidden by its depth.
    Picture(Arc<Picture>),
    /// The mesh, rasterised.
    Raster(Raster),
}
