//! The points that a node's volume must hold.

use crate::accel::bvh::{Node, Packed};
use std::ops::Range;

use crate::geometry::{Aabb, num::index};
use crate::task::{Cancel, Cancelled};
use glam::{DVec3, Vec3};

/// The corners of a node's triangles, or of the boxes around them, relative to the scene's centre.
#[derive(Clone, Copy, Debug)]
pub struct Points<'a> {
    /// The triangles.
    pub triangles: &'a [Packed],
    /// The box around them, in the coordinates of the scene.
    pub bounds: Aabb,
    /// The centre of the scene.
    pub centre: Vec3,
    /// Whether the boxes of the triangles count, rather than the triangles: what a triangle test
    /// needs whose hits may lie anywhere in those.
    pub boxes: bool,
    /// Looked at now and then.
    pub cancel: &'a Cancel,
}

/// Triangles between two looks at the cancel flag.
const CHUNK: usize = 1 << 10;
/// Nodes of no more triangles are fitted to all of their points.
pub const SMALL: usize = 32;

impl Points<'_> {
    /// Calls `each` for every point.
    pub fn each(&self, mut each: impl FnMut(DVec3)) -> Result<(), Cancelled> {
        let centre = self.centre.as_dvec3();
        for chunk in self.triangles.chunks(CHUNK) {
            self.cancel.check()?;
            for triangle in chunk {
                if self.boxes {
                    Aabb::of_triangle(&triangle.corners).corners().iter().for_each(|p| each(p.as_dvec3() - centre));
                } else {
                    triangle.corners.iter().for_each(|p| each(p.as_dvec3() - centre));
                }
            }
        }
        Ok(())
    }

    /// Points to choose a volume by: all of them in a small node, in a large one what the children
    /// handed up.
    pub fn for_choosing(&self, below: Option<[Vec<DVec3>; 2]>) -> Result<Vec<DVec3>, Cancelled> {
        match below {
            Some([mut left, right]) if self.triangles.len() > SMALL => {
                left.extend(right);
                Ok(left)
            }
            _ => self.all(),
        }
    }

    /// All points.
    pub fn all(&self) -> Result<Vec<DVec3>, Cancelled> {
        let mut all = Vec::with_capacity(self.triangles.len() * if self.boxes { 8 } else { 3 });
        self.each(|p| all.push(p))?;
        Ok(all)
    }
}

/// For each node of a tree its triangles, as places in the packed list: those of a subtree are side
/// by side, since the leaves are in the order of the nodes. A node is given by its left child or its
/// first triangle, and the number of triangles, which is 0 for an inner one.
pub fn ranges(nodes: impl Iterator<Item = (u32, u32)>) -> Vec<Range<u32>> {
    let mut ranges: Vec<Range<u32>> = nodes.map(|(first, count)| first..first + count).collect();
    for i in (0..ranges.len()).rev() {
        if ranges[i].is_empty() {
            let left = ranges[i].start as usize;
            ranges[i] = ranges[left].start..ranges[left + 1].end;
        }
    }
    ranges
}

/// The nodes at each depth, the root's first. Children come after their parents in the list.
pub fn levels(nodes: &[Node]) -> Vec<Vec<u32>> {
    let mut levels: Vec<Vec<u32>> = Vec::new();
    let mut depths = vec![0usize; nodes.len()];
    for (i, node) in nodes.iter().enumerate() {
        let depth = depths[i];
        if levels.len() <= depth {
            levels.push(Vec::new());
        }
        levels[depth].push(index(i));
        if let Some(left) = node.left() {
            depths[left as usize] = depth + 1;
            depths[left as usize + 1] = depth + 1;
        }
    }
    levels
}
