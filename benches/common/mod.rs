//! Rays that several benchmarks trace.

use boxwood::geometry::Ray;
use boxwood::scene::Geometry;
use glam::Vec3;

/// From all around to the middle, in the world.
pub fn rays(geometry: &Geometry) -> Vec<Ray> {
    let b = geometry.world_bounds();
    let (centre, size) = (b.centre(), (b.max - b.min).max_element());
    (0..256u16)
        .map(|i| {
            let a = f32::from(i) * 2.399_963;
            let from = centre + size * Vec3::new(a.cos(), (a * 0.7).sin(), a.sin());
            Ray::new(from, centre + 0.2 * size * Vec3::new((a * 3.0).sin(), (a * 5.0).cos(), (a * 7.0).sin()) - from)
        })
        .collect()
}
