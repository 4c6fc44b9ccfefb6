//! Rays, boxes and triangles, and the tests between them. Everything here is pure arithmetic on
//! 32-bit floats by the rules that ARCHITECTURE.md states; sums, areas and costs are 64-bit.

mod aabb;
mod clip;
mod degenerate;
pub mod eight;
pub mod expansion;
mod half_space;
pub mod hull;
pub mod kdop;
pub mod line;
pub mod num;
pub mod obb;
mod overlap;
pub mod polygon;
mod polyhedron;
pub mod polytope;
mod ray;
pub mod slabs;
pub mod space;
pub mod sphere;
pub mod tri;

pub use aabb::{Aabb, Axis};
pub use clip::Clipped;
pub use degenerate::has_zero_area;
pub use half_space::{HalfSpace, Side};
pub use line::Line;
pub use overlap::triangle_overlaps_box;
pub use polyhedron::Polyhedron;
pub use ray::Ray;
pub use slabs::{Along, EightSlabs, Slabs};
pub use space::Space;
