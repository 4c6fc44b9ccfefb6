//! The tightest box around a mesh that was moved, without moving each of its vertices: what many
//! instances of one mesh ask for.
//!
//! Triangles that follow each other in a file mostly lie side by side. So they are taken in groups, each
//! with a box; the farthest point along an axis of the world is looked for only in groups whose box
//! reaches farther than the best point so far.

use glam::{DAffine3, DVec3};

use super::Geometry;
use crate::geometry::Aabb;

/// The groups of one mesh's triangles.
pub(super) struct Extremes<'a> {
    geometry: &'a Geometry,
    size: usize,
    groups: Vec<Aabb>,
}

impl<'a> Extremes<'a> {
    /// Of the triangles that structures hold.
    pub fn new(geometry: &'a Geometry) -> Self {
        let n = geometry.live_count();
        // As many groups as triangles in one, so that both loops are short.
        let size = n.isqrt().clamp(8, 1024);
        let group = |from: usize| {
            let triangles = from..n.min(from + size);
            triangles.fold(Aabb::EMPTY, |b, i| b.union(Aabb::of_triangle(&geometry.corners(geometry.live(i)))))
        };
        Self { geometry, size, groups: (0..n).step_by(size).map(group).collect() }
    }

    /// The box around all triangles once they were moved, in 64 bits; empty (least above greatest) if there are none.
    /// `map` takes the mesh's scaled space to wherever the box is to be.
    pub fn bounds(&self, map: &DAffine3) -> (DVec3, DVec3) {
        let rows = map.matrix3.transpose();
        let mut bounds = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        for axis in 0..3 {
            let row = rows.col(axis);
            bounds.1[axis] = self.farthest(row) + map.translation[axis];
            bounds.0[axis] = -self.farthest(-row) + map.translation[axis];
        }
        bounds
    }

    /// The greatest of `row . p` over all corners p.
    fn farthest(&self, row: DVec3) -> f64 {
        let reach = |b: &Aabb| {
            let (min, max) = (b.min.as_dvec3() * row, b.max.as_dvec3() * row);
            min.max(max).element_sum()
        };
        let first = self.groups.iter().enumerate().max_by(|a, b| reach(a.1).total_cmp(&reach(b.1)));
        let Some((first, _)) = first else { return f64::NEG_INFINITY };
        let mut best = self.farthest_in(first, row);
        for (group, b) in self.groups.iter().enumerate() {
            if reach(b) > best {
                best = best.max(self.farthest_in(group, row));
            }
        }
        best
    }

    fn farthest_in(&self, group: usize, row: DVec3) -> f64 {
        let from = group * self.size;
        let triangles = from..self.geometry.live_count().min(from + self.size);
        let corners = triangles.flat_map(|i| self.geometry.corners(self.geometry.live(i)));
        corners.fold(f64::NEG_INFINITY, |best, p| best.max((p.as_dvec3() * row).element_sum()))
    }
}
