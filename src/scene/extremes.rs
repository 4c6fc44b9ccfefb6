//! The tightest box around a mesh that was moved, without moving each of its vertices: what many
//! instances of one mesh ask for.
//!
//! Triangles that follow each other in a file mostly lie side by side. So they are taken in groups, each
//! with a box; the farthest point along an axis of the world is looked for only in groups whose box
//! reaches farther than the best point so far.

use std::ops::Range;

use glam::{DAffine3, DVec3, Vec3};

use super::{Geometry, LoadCx, Reason};
use crate::geometry::Aabb;
use crate::task::Charge;

/// The groups of one mesh's triangles.
pub(super) struct Extremes {
    groups: Vec<Group>,
    /// The corners of each group, each once.
    points: Vec<Vec3>,
    _memory: Charge,
}

struct Group {
    bounds: Aabb,
    points: Range<usize>,
}

/// Triangles between two looks at the cancel flag.
const CHUNK: usize = 1 << 14;

impl Extremes {
    /// Of the triangles that structures hold.
    ///
    /// # Errors
    /// Cancelled, or over the memory budget.
    pub fn new(geometry: &Geometry, cx: &LoadCx) -> Result<Self, Reason> {
        let n = geometry.live_count();
        // As many groups as triangles in one, so that both loops are short.
        let size = n.isqrt().clamp(8, 1024);
        let (positions, triangles) = geometry.indexed();
        let mut memory = cx.budget.charge((n.div_ceil(size) * size_of::<Group>()) as u64)?;
        let (mut groups, mut points) = (Vec::with_capacity(n.div_ceil(size)), Vec::new());
        let mut corners: Vec<u32> = Vec::new();
        for from in (0..n).step_by(size) {
            if from % CHUNK < size {
                cx.cancel.check()?;
            }
            corners.clear();
            corners.extend((from..n.min(from + size)).flat_map(|i| triangles[geometry.live(i) as usize]));
            corners.sort_unstable();
            corners.dedup();
            memory.grow((corners.len() * size_of::<Vec3>()) as u64)?;
            let first = points.len();
            points.extend(corners.iter().map(|i| positions[*i as usize]));
            let bounds = Aabb::of_points(points[first..].iter().copied());
            groups.push(Group { bounds, points: first..points.len() });
        }
        Ok(Self { groups, points, _memory: memory })
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
        let farther = |(best, far): (Option<usize>, f64), (i, group): (usize, &Group)| {
            let reach = reach(&group.bounds);
            if best.is_none() || reach > far { (Some(i), reach) } else { (best, far) }
        };
        let (Some(first), _) = self.groups.iter().enumerate().fold((None, 0.0), farther) else { return f64::NEG_INFINITY };
        let mut best = self.farthest_in(&self.groups[first], row);
        for group in &self.groups {
            if reach(&group.bounds) > best {
                best = best.max(self.farthest_in(group, row));
            }
        }
        best
    }

    fn farthest_in(&self, group: &Group, row: DVec3) -> f64 {
        self.points[group.points.clone()].iter().fold(f64::NEG_INFINITY, |best, p| best.max((p.as_dvec3() * row).element_sum()))
    }
}
