//! Whether a structure is well formed: cells lie in their parents, triangles in their leaves, no
//! cell is met twice, and every live triangle can be reached.
//!
//! Of bounding volumes that are no boxes a child's may stick out of its parent's, as a sphere around a
//! half does out of the sphere around the whole: there the triangles below must lie in the parent. The
//! cells of a partition always lie in each other, and triangles reach beyond them.

use std::collections::HashSet;
use std::ops::ControlFlow;

use super::cell::{Cell, Cells, Descend, Layout, Shape, walk};
use crate::geometry::Aabb;
use crate::scene::Geometry;

/// What is wrong with a structure.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Defect {
    /// A cell is met twice on one walk.
    #[error("cell {0} is reached more than once")]
    Shared(u32),
    /// A child sticks out of its parent.
    #[error("cell {child} is not inside its parent {parent}")]
    Outside {
        /// The child.
        child: u32,
        /// The parent.
        parent: u32,
    },
    /// A leaf holds a triangle that it does not bound (hierarchies), or overlap (partitions).
    #[error("leaf {leaf} holds triangle {prim}, which is not there")]
    Misplaced {
        /// The leaf.
        leaf: u32,
        /// The triangle.
        prim: u32,
    },
    /// A triangle is in no leaf, or in a hierarchy in several.
    #[error("triangle {prim} is in {times} leaves")]
    Coverage {
        /// The triangle.
        prim: u32,
        /// How often it is found.
        times: u32,
    },
}

/// Every defect found, at most `limit`.
pub fn defects(cells: &dyn Cells, geometry: &Geometry, limit: usize) -> Vec<Defect> {
    let mut found = Vec::new();
    let mut seen = HashSet::new();
    let mut times = vec![0u32; geometry.triangle_count()];
    let hierarchy = cells.layout() == Layout::Hierarchy;
    walk(cells, &mut |cell| {
        if !seen.insert(cell.id) {
            found.push(Defect::Shared(cell.id.node));
            return ControlFlow::Break(());
        }
        let bounds = *cell.shape.bounds();
        // A grid is a little larger than what it was made for.
        if cells.layout().slack().is_none() || cell.depth > 0 {
            cells.children(cell, &mut |child| {
                let inside = match cell.shape {
                    Shape::Convex { .. } if cells.layout().nests() => triangles_below(cells, &child, geometry),
                    _ => *child.shape.bounds(),
                };
                if !taken_in(bounds, cells.layout()).contains_box(&inside) {
                    found.push(Defect::Outside { child: child.id.node, parent: cell.id.node });
                }
                ControlFlow::Continue(())
            });
        }
        if cell.is_leaf() {
            cells.prims(cell, &mut |prim| {
                times[prim as usize] += 1;
                let tri = Aabb::of_triangle(&geometry.corners(prim));
                let there = if hierarchy {
                    bounds.contains_box(&tri)
                } else {
                    !taken_in(bounds, cells.layout()).intersection(tri).is_empty()
                };
                if !there {
                    found.push(Defect::Misplaced { leaf: cell.id.node, prim });
                }
            });
        }
        if found.len() < limit { ControlFlow::Continue(Descend::Yes) } else { ControlFlow::Break(()) }
    });
    if found.is_empty() {
        let live = (0..geometry.live_count()).map(|i| geometry.live(i));
        let wrong = live.filter(|prim| times[*prim as usize] == 0 || (hierarchy && times[*prim as usize] > 1));
        found.extend(wrong.take(limit).map(|prim| Defect::Coverage { prim, times: times[prim as usize] }));
    }
    found
}

/// The tightest box around all triangles in the leaves below and including a cell.
fn triangles_below(cells: &dyn Cells, cell: &Cell, geometry: &Geometry) -> Aabb {
    let mut bounds = Aabb::EMPTY;
    let mut open = vec![*cell];
    while let Some(cell) = open.pop() {
        cells.prims(&cell, &mut |prim| bounds = bounds.union(Aabb::of_triangle(&geometry.corners(prim))));
        cells.children(&cell, &mut |child| {
            open.push(child);
            ControlFlow::Continue(())
        });
    }
    bounds
}

/// The cell with what its layout says it takes in, and the rounding of its box to 32 bits.
fn taken_in(b: Aabb, layout: Layout) -> Aabb {
    let Some(slack) = layout.slack() else { return b };
    let room = glam::Vec3::splat(slack * 1.01) + 2.0 * f32::EPSILON * b.min.abs().max(b.max.abs());
    Aabb { min: b.min - room, max: b.max + room }
}
