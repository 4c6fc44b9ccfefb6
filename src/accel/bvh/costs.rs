//! The weights of the surface area heuristic (Goldsmith and Salmon 1987; MacDonald and Booth 1990),
//! and what a node costs by them. Areas are half surface areas: only ratios matter.

use super::slice::Slice;

/// C_trav and C_isect.
#[derive(Clone, Copy, Debug)]
pub struct Costs {
    /// Cost of stepping into a node.
    pub c_trav: f64,
    /// Cost of testing a triangle.
    pub c_isect: f64,
}

impl Costs {
    /// Of a node divided into children with this sum of `area * count`.
    #[inline(always)]
    pub fn split(&self, area: f64, children: f64) -> f64 {
        self.c_trav * area + self.c_isect * children
    }

    /// Of a node that is not divided.
    pub fn leaf(&self, slice: &Slice<'_>) -> f64 {
        self.triangles(slice.bounds.half_area(), slice.prims.len())
    }

    /// Of so many triangles in a node of that area.
    #[inline(always)]
    pub fn triangles(&self, area: f64, count: usize) -> f64 {
        self.c_isect * area * count as f64
    }
}
