//! Boxes, planes and edges drawn over the picture: the data, and its copy on the GPU.
//!
//! All of it is instances of one kind: a line is a box that is flat along two axes, a triangle is half of a flat one.

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

    /// A line.
    pub fn line(from: Vec3, to: Vec3, color: [u8; 4]) -> Self {
        Self { corner: from.to_array(), edges: [(to - from).to_array(), [0.0; 3], [0.0; 3]], color }
    }

    /// A triangle, among those that are filled.
    pub fn triangle([a, b, c]: [Vec3; 3], color: [u8; 4]) -> Self {
        Self { corner: a.to_array(), edges: [(b - a).to_array(), (c - a).to_array(), [0.0; 3]], color }
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
    /// Lines: the edges of what is no box.
    pub lines: Vec<BoxInstance>,
    /// Triangles, filled as planes are: split planes that are no rectangles.
    pub fills: Vec<BoxInstance>,
    /// A plane more, which somebody tries.
    pub tried: Option<BoxInstance>,
    /// Lines of a volume that somebody compares with others.
    pub compared: Vec<BoxInstance>,
    /// The selected box, over everything else and in its own style.
    pub selected: Option<BoxInstance>,
    /// The same of what is no box: its lines.
    pub selected_lines: Vec<BoxInstance>,
    /// More boxes in that style.
    pub lit: Vec<BoxInstance>,
    /// More lines in that style.
    pub lit_lines: Vec<BoxInstance>,
}

impl Overlay {
    /// Whether the same stands out in both.
    pub fn is_lit_as(&self, other: &Self) -> bool {
        let lit = |o: &Self| (o.tried, o.selected);
        lit(self) == lit(other) && self.compared == other.compared && self.selected_lines == other.selected_lines
    }

    /// Everything that has ordinary edges.
    pub fn edged(&self) -> usize {
        self.boxes.len() + self.planes.len() + self.tried.iter().len() + self.lines.len() + self.compared.len()
    }
}

/// The instances of an overlay on the GPU, part after part.
pub(super) struct OverlayBuffer {
    buffer: wgpu::Buffer,
    generation: Option<u64>,
    /// Where each part ends.
    ends: [u32; PARTS],
}

/// Boxes; planes and the one that is tried; lines and those of the compared volume; triangles; boxes that stand out; lines that do.
const PARTS: usize = 6;

impl OverlayBuffer {
    pub(super) fn new(device: &wgpu::Device) -> Self {
        Self { buffer: instance_buffer(device, 1), generation: None, ends: [0; PARTS] }
    }

    /// Brings the overlay there if it is another one than before.
    pub(super) fn update(&mut self, device: &wgpu::Device, queue: &wgpu::Queue, overlay: &Overlay) {
        if self.generation == Some(overlay.generation) {
            return;
        }
        // Far more than can be told apart on any screen; what stands out goes first, boxes last.
        let mut most = num::floor_index(device.limits().max_buffer_size as f64, num::MAX_INDEX) / size_of::<BoxInstance>();
        let largest = most;
        let mut fitting = |part: &'_ [BoxInstance]| {
            let count = part.len().min(most);
            most -= count;
            count
        };
        let [selected, selected_lines] = [overlay.selected.as_slice(), &overlay.selected_lines].map(&mut fitting);
        let [lit, lit_lines] = [&overlay.lit, &overlay.lit_lines].map(|part| fitting(part));
        let [tried, compared] = [overlay.tried.as_slice(), &overlay.compared].map(&mut fitting);
        let [planes, fills, lines, boxes] = [&overlay.planes, &overlay.fills, &overlay.lines, &overlay.boxes].map(|p| fitting(p));
        let parts: [&[&[BoxInstance]]; PARTS] = [
            &[&overlay.boxes[..boxes]],
            &[&overlay.planes[..planes], &overlay.tried.as_slice()[..tried]],
            &[&overlay.lines[..lines], &overlay.compared[..compared]],
            &[&overlay.fills[..fills]],
            &[&overlay.lit[..lit], &overlay.selected.as_slice()[..selected]],
            &[&overlay.lit_lines[..lit_lines], &overlay.selected_lines[..selected_lines]],
        ];
        let count = parts.iter().flat_map(|part| part.iter()).map(|part| part.len()).sum::<usize>();
        if (count * size_of::<BoxInstance>()) as u64 > self.buffer.size() {
            self.buffer = instance_buffer(device, count.next_power_of_two().min(largest));
        }
        let mut end = 0;
        for (part, at) in parts.iter().zip(&mut self.ends) {
            for some in *part {
                let offset = (end * size_of::<BoxInstance>()) as u64;
                queue.write_buffer(&self.buffer, offset, bytemuck::cast_slice(some));
                end += some.len();
            }
            *at = num::index(end);
        }
        self.generation = Some(overlay.generation);
    }

    pub(super) fn buffer(&self) -> &wgpu::Buffer {
        &self.buffer
    }

    /// Boxes and planes, of which all edges are drawn.
    pub(super) fn edged(&self) -> Range<u32> {
        0..self.ends[1]
    }

    pub(super) fn planes(&self) -> Range<u32> {
        self.part(1)
    }

    pub(super) fn lines(&self) -> Range<u32> {
        self.part(2)
    }

    pub(super) fn fills(&self) -> Range<u32> {
        self.part(3)
    }

    pub(super) fn selected(&self) -> Range<u32> {
        self.part(4)
    }

    pub(super) fn selected_lines(&self) -> Range<u32> {
        self.part(5)
    }

    fn part(&self, at: usize) -> Range<u32> {
        self.ends[at - 1]..self.ends[at]
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
