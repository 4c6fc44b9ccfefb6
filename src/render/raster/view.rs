//! A camera as the rasteriser sees it: what turns a corner into a place on the screen, and where
//! the samples of a picture lie there.

use crate::geometry::Aabb;
use crate::render::sampler::on_screen;
use crate::scene::{Camera, Geometry, Projection};
use glam::{DMat3, DVec3, Vec2, Vec3};

/// A view of a scene, in 64 bits and in the scaled space.
///
/// A point is `eye + x right + y up + z forward`, with `right` and `up` as long as half the picture.
/// Solving for (x, y, z) with the very axes that primary rays are made of, rather than taking dot
/// products, is exact where these axes are not quite perpendicular.
#[derive(Clone, Debug)]
pub struct View {
    eye: DVec3,
    into: DMat3,
    /// Rays are parallel.
    pub parallel: bool,
    /// Depths are kept from here on, so that far eyes cost them no digits (compare `Space::enter`).
    pub near: f64,
    /// x of each column's samples, -1 to 1 from left to right.
    pub columns: Vec<f64>,
    /// y of each row's samples, 1 to -1 from top to bottom.
    pub rows: Vec<f64>,
}

impl View {
    /// Of a picture of `width` by `height` pixels. `None` if there is none to be seen: a camera that
    /// is not finite, or a picture of no extent.
    pub fn new(geometry: &Geometry, camera: &Camera, width: u32, height: u32) -> Option<Self> {
        let (scale, frame) = (geometry.space().scale(), camera.frame());
        let size = Vec2::new(width as f32, height as f32);
        let half = camera.half_size(size.x / size.y).as_dvec2();
        let parallel = matches!(camera.projection, Projection::Orthographic { .. });
        // A perspective view is half so wide at unit distance, in any unit.
        let half = if parallel { half * scale } else { half };
        let [right, up, forward] = [frame.right, frame.up, frame.forward].map(Vec3::as_dvec3);
        let into = DMat3::from_cols(right * half.x, up * half.y, forward).inverse();
        let eye = camera.eye.as_dvec3() * scale;
        let sized = width > 0 && height > 0 && half.is_finite() && half.x != 0.0 && half.y != 0.0;
        let seen = sized && eye.is_finite() && into.is_finite();
        // The samples are those of the first pass of a picture, to the bit.
        let at = |x: u32, y: u32| on_screen(Vec2::new(x as f32, y as f32) + 0.5, size);
        let columns = (0..width).map(|x| f64::from(at(x, 0).x)).collect();
        let rows = (0..height).map(|y| f64::from(at(0, y).y)).collect();
        let view = Self { eye, into, parallel, near: 0.0, columns, rows };
        let near = view.before(geometry.bounds());
        seen.then_some(Self { near, ..view })
    }

    /// A depth that lies well before all of the box; 0 unless the eye is far away.
    fn before(&self, bounds: &Aabb) -> f64 {
        let depths = bounds.corners().map(|p| self.place(p).z);
        let first = depths.iter().copied().fold(f64::INFINITY, f64::min);
        let before = first - 4.0 * f64::from(bounds.size().max_element());
        if before.is_finite() { before.max(0.0) } else { 0.0 }
    }

    /// (x, y, z) of a point of the scaled space; z is the t of a primary ray that passes through it.
    #[inline]
    pub fn place(&self, p: Vec3) -> DVec3 {
        self.into * (p.as_dvec3() - self.eye)
    }

    /// The same as homogeneous coordinates (x, y, w) of the screen.
    #[inline]
    pub fn homogeneous(&self, place: DVec3) -> DVec3 {
        if self.parallel { place.with_z(1.0) } else { place }
    }

    /// The column, not rounded, of an x.
    #[inline]
    pub fn column(&self, x: f64) -> f64 {
        0.5 * ((x + 1.0) * self.columns.len() as f64 - 1.0)
    }

    /// The row, not rounded, of a y.
    #[inline]
    pub fn row(&self, y: f64) -> f64 {
        0.5 * ((1.0 - y) * self.rows.len() as f64 - 1.0)
    }
}
