//! Boxes and planes drawn over the picture: the data, and its copy on the GPU.

use std::ops::Range;

use eframe::wgpu;
use glam::{DAffine3, DVec3, Vec3};

use crate::geometry::{Aabb, num};

/// A box whose edges are drawn, in the scaled space, turned or not. A flat one, if it is among the planes, is
/// filled as well.
#[derive(Clone, Copy, Debug, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct BoxInstance {
    /// The corner that is the least in the space of the cell.
    pub corner: [f32; 3],
    /// The three edges from there; zero along which it is flat.
    pub edges: [[f32; 3]; 3],
    /// Gamma-encoded colour, and opacity.
    pub color: [u8; 4],
}

impl BoxInstance {
    /// A box in a colour.
    pub fn new(cell: &Aabb, color: [u8; 4]) -> Self {
        let [x, y, z] = cell.size().to_array();
        Self { corner: cell.min.to_array(), edges: [[x, 0.0, 0.0], [0.0, y, 0.0], [0.0, 0.0, z]], color }
    }

    /// A box of another space, brought into the scaled one: a parallelepiped.
    pub fn turned(cell: &Aabb, scene_from_cell: &DAffine3, color: [u8; 4]) -> Self {
        let size = cell.size().as_dvec3();
        let edge = |axis: DVec3, length: f64| (axis * length).as_vec3().to_array();
        let m = &scene_from_cell.matrix3;
        let corner = scene_from_cell.transform_point3(cell.min.as_dvec3()).as_vec3().to_array();
        Self { corner, edges: [edge(m.x_axis, size.x), edge(m.y_axis, size.y), edge(m.z_axis, size.z)], color }
    }

    /// The point so far along each of its edges.
    pub fn at(&self, along: Vec3) -> Vec3 {
        let [x, y, z] = self.edges.map(Vec3::from_array);
        Vec3::from_array(self.corner) + x * along.x + y * along.y + z * along.z
    }

    /// How the GPU reads it.
    pub(super) const LAYOUT: wgpu::VertexBufferLayout<'static> = wgpu::VertexBufferLayout {
        array_stride: size_of::<Self>() as u64,
        step_mode: wgpu::VertexStepMode::Instance,
        attributes: &wgpu::vertex_attr_array![0 => Float32x3, 1 => Float32x3, 2 => Float32x3, 3 => Float32x3, 4 => Unorm8x4],
    };
}

/// What is drawn over the picture. Later boxes are drawn over earlier ones.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Overlay {
    /// Changes whenever the content does.
    pub generation: u64,
    /// Boxes, of which the edges are drawn.
    pub boxes: Vec<BoxInstance>,
    /// Flat boxes, filled and with edges: split planes.
    pub planes: Vec<BoxInstance>,
    /// A plane more, which somebody tries.
    pub tried: Option<BoxInstance>,
    /// The selected box, over everything else and in its own style; its colour is not used.
    pub selected: Option<BoxInstance>,
    /// More boxes in that style.
    pub lit: Vec<BoxInstance>,
}

/// The instances of an overlay on the GPU: boxes, then planes, then those that stand out.
pub(super) struct OverlayBuffer {
    buffer: wgpu::Buffer,
    generation: Option<u64>,
    boxes: u32,
    planes: u32,
    selected: u32,
}

impl OverlayBuffer {
    pub(super) fn new(device: &wgpu::Device) -> Self {
        Self { buffer: instance_buffer(device, 1), generation: None, boxes: 0, planes: 0, selected: 0 }
    }

    /// Brings the overlay there if it is another one than before.
    pub(super) fn update(&mut self, device: &wgpu::Device, queue: &wgpu::Queue, overlay: &Overlay) {
        if self.generation == Some(overlay.generation) {
            return;
        }
        // Far more than can be told apart on any screen; what is selected and the planes go first.
        let most = num::floor_index(device.limits().max_buffer_size as f64, num::MAX_INDEX) / size_of::<BoxInstance>();
        let (selected, tried) = (overlay.selected.as_slice(), overlay.tried.as_slice());
        let lit = &overlay.lit[..overlay.lit.len().min(most - 2)];
        let single = selected.len() + tried.len() + lit.len();
        let planes = &overlay.planes[..overlay.planes.len().min(most - single)];
        let boxes = &overlay.boxes[..overlay.boxes.len().min(most - single - planes.len())];

        let count = boxes.len() + planes.len() + single;
        if (count * size_of::<BoxInstance>()) as u64 > self.buffer.size() {
            self.buffer = instance_buffer(device, count.next_power_of_two().min(most));
        }
        let mut offset = 0;
        for part in [boxes, planes, tried, lit, selected] {
            let bytes: &[u8] = bytemuck::cast_slice(part);
            queue.write_buffer(&self.buffer, offset, bytes);
            offset += bytes.len() as u64;
        }
        let counts = [boxes.len(), planes.len() + tried.len(), lit.len() + selected.len()];
        [self.boxes, self.planes, self.selected] = counts.map(num::index);
        self.generation = Some(overlay.generation);
    }

    pub(super) fn buffer(&self) -> &wgpu::Buffer {
        &self.buffer
    }

    pub(super) fn planes(&self) -> Range<u32> {
        self.boxes..self.boxes + self.planes
    }

    /// Boxes and planes: all that have ordinary edges.
    pub(super) fn edged(&self) -> Range<u32> {
        0..self.boxes + self.planes
    }

    pub(super) fn selected(&self) -> Range<u32> {
        let first = self.boxes + self.planes;
        first..first + self.selected
    }
}

fn instance_buffer(device: &wgpu::Device, count: usize) -> wgpu::Buffer {
    device.create_buffer(&wgpu::BufferDescriptor {
        label: Some("boxes"),
        size: (count * size_of::<BoxInstance>()) as u64,
        usage: wgpu::BufferUsages::VERTEX | wgpu::BufferUsages::COPY_DST,
        mapped_at_creation: false,
    })
}
