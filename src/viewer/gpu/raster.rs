//! The mesh by rasterisation: what the viewport shows while nothing is traced yet. It goes to the
//! GPU a few chunks a frame, so that the window never waits for it.

use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

use eframe::wgpu;
use glam::Vec3;
use wgpu::util::DeviceExt;

use super::chunks::{Chunk, sampled};
use super::layouts::Layouts;
use super::pipeline::{Pass, Recipe};
use super::sources::{Piece, Rows, Sources};
use crate::geometry::num;
use crate::scene::Geometry;

/// The most bytes that go to the GPU in one frame: about a millisecond of work, more in software.
const BYTES_PER_FRAME: usize = 1 << 20;

/// A scene to be rasterised. Made once a scene, and shared by all viewports.
#[derive(Debug)]
pub struct RasterMesh {
    generation: u64,
    geometry: Arc<Geometry>,
    uploaded: AtomicUsize,
    /// How many triangles there are to draw, each counted as often as it stands somewhere.
    drawn: usize,
}

impl RasterMesh {
    /// The triangles that structures hold of a scene; `generation` tells it from every other.
    pub fn new(generation: u64, geometry: Arc<Geometry>) -> Self {
        let drawn = usize::try_from(geometry.counts().live).unwrap_or(usize::MAX);
        Self { generation, geometry, uploaded: AtomicUsize::new(0), drawn }
    }

    /// How many triangles are on the GPU, and how many there are, those of a mesh counted once. Where the two differ
    /// another frame is needed: triangles that are not there yet are not drawn.
    pub fn progress(&self) -> (usize, usize) {
        (self.uploaded.load(Ordering::Relaxed), self.geometry.stored_live())
    }

    pub(super) fn generation(&self) -> u64 {
        self.generation
    }
}

/// A mesh and how it is drawn.
#[derive(Clone, Debug)]
pub struct Raster {
    /// The mesh.
    pub mesh: Arc<RasterMesh>,
    /// Gamma-encoded, before shading.
    pub color: [u8; 4],
    /// Draw about so many triangles, evenly sampled; `usize::MAX` for all.
    pub max_triangles: usize,
}

/// Draws meshes.
pub(super) struct RasterPipeline {
    whole: wgpu::RenderPipeline,
    /// Where a part of the scene is cut away: that takes the graphics the chance to leave out what is hidden early.
    cut: wgpu::RenderPipeline,
}

impl RasterPipeline {
    pub(super) fn new(device: &wgpu::Device, layouts: &Layouts) -> Self {
        let vertices = wgpu::VertexBufferLayout {
            array_stride: size_of::<Vec3>() as u64,
            step_mode: wgpu::VertexStepMode::Vertex,
            attributes: &wgpu::vertex_attr_array![0 => Float32x3],
        };
        let places = wgpu::VertexBufferLayout {
            array_stride: size_of::<Rows>() as u64,
            step_mode: wgpu::VertexStepMode::Instance,
            attributes: &wgpu::vertex_attr_array![1 => Float32x4, 2 => Float32x4, 3 => Float32x4],
        };
        let vertices = [Some(vertices), Some(places)];
        let pipeline = |constants: &[(&str, f64)]| {
            let recipe = Recipe {
                label: "raster",
                source: concat!(include_str!("view.wgsl"), include_str!("raster.wgsl")),
                groups: &[&layouts.uniform],
                vertices: &vertices,
                constants,
                pass: Pass::Solid,
                ..Recipe::default()
            };
            recipe.make(device)
        };
        Self { whole: pipeline(&[("CUT", 0.0)]), cut: pipeline(&[("CUT", 1.0)]) }
    }

    /// Draws what is there of the mesh; the view is group 0, and says whether a part is cut away.
    pub(super) fn draw(&self, pass: &mut wgpu::RenderPass<'_>, buffers: &MeshBuffers, max_triangles: usize, cut: bool) {
        pass.set_pipeline(if cut { &self.cut } else { &self.whole });
        let total = buffers.mesh.drawn;
        for chunk in &buffers.chunks {
            pass.set_vertex_buffer(0, chunk.positions.slice(..));
            pass.set_index_buffer(chunk.indices.slice(..), wgpu::IndexFormat::Uint16);
            let triangles = sampled(chunk.triangles, total, max_triangles);
            for places in &buffers.places[chunk.source] {
                // Where even one triangle a place is too much, some places are left out.
                let most = sampled(places.count * chunk.triangles, total, max_triangles).div_ceil(triangles.max(1));
                pass.set_vertex_buffer(1, places.rows.slice(..));
                pass.draw_indexed(0..3 * triangles, 0, 0..most.min(num::index(places.count)));
            }
        }
    }
}

/// A mesh on the GPU, as far as it is there.
pub(super) struct MeshBuffers {
    mesh: Arc<RasterMesh>,
    chunks: Vec<ChunkBuffers>,
    /// Where the meshes stand, by source.
    places: Vec<Vec<Places>>,
    /// What is still to come; `None` once all is there.
    rest: Option<Sources>,
}

struct ChunkBuffers {
    source: usize,
    positions: wgpu::Buffer,
    indices: wgpu::Buffer,
    triangles: usize,
}

/// Some of the places of a mesh.
struct Places {
    rows: wgpu::Buffer,
    count: usize,
}

impl MeshBuffers {
    pub(super) fn new(mesh: &Arc<RasterMesh>) -> Self {
        mesh.uploaded.store(0, Ordering::Relaxed);
        let rest = Some(Sources::new(Arc::clone(&mesh.geometry)));
        Self { mesh: Arc::clone(mesh), chunks: Vec::new(), places: Vec::new(), rest }
    }

    pub(super) fn generation(&self) -> u64 {
        self.mesh.generation
    }

    /// How much of it is there: changes as long as there is something to redraw for.
    pub(super) fn chunk_count(&self) -> usize {
        self.chunks.len()
    }

    /// Brings some more of it there.
    pub(super) fn advance(&mut self, device: &wgpu::Device) {
        let Some(rest) = &mut self.rest else { return };
        let mut bytes = 0;
        while bytes < BYTES_PER_FRAME {
            match rest.next() {
                None => {
                    self.rest = None;
                    return;
                }
                Some(Piece::Places { source, rows }) => {
                    bytes += size_of_val(&rows[..]);
                    self.places.resize_with(self.places.len().max(source + 1), Vec::new);
                    let (contents, usage) = (bytemuck::cast_slice(&rows), wgpu::BufferUsages::VERTEX);
                    self.places[source].push(Places { rows: filled(device, "places", contents, usage), count: rows.len() });
                }
                Some(Piece::Triangles { source, chunk }) => {
                    bytes += chunk.bytes();
                    self.mesh.uploaded.fetch_add(chunk.triangles.len(), Ordering::Relaxed);
                    self.chunks.push(ChunkBuffers::new(device, source, &chunk));
                }
            }
        }
    }
}

impl ChunkBuffers {
    fn new(device: &wgpu::Device, source: usize, chunk: &Chunk) -> Self {
        Self {
            source,
            positions: filled(device, "mesh positions", bytemuck::cast_slice(&chunk.positions), wgpu::BufferUsages::VERTEX),
            indices: filled(device, "mesh indices", bytemuck::cast_slice(&chunk.triangles), wgpu::BufferUsages::INDEX),
            triangles: chunk.triangles.len(),
        }
    }
}

fn filled(device: &wgpu::Device, label: &str, contents: &[u8], usage: wgpu::BufferUsages) -> wgpu::Buffer {
    device.create_buffer_init(&wgpu::util::BufferInitDescriptor { label: Some(label), contents, usage })
}
