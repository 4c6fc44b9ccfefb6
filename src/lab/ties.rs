//! Hits that are as good as each other: where rounding decides which of two structures finds.

use crate::accel::Hit;
use crate::geometry::Ray;
use crate::scene::Geometry;

/// Whether rounding explains that a structure of cells finds one hit of a ray and another structure the other: both are at
/// nearly the same t (the padding of cells along the ray), or one of them is on a triangle in whose plane the ray lies, so
/// that its t is noise.
pub fn rounding_explains(ray: &Ray, [a, b]: [Option<Hit>; 2], geometry: &Geometry) -> bool {
    match (a, b) {
        (Some(a), Some(b)) if (a.t - b.t).abs() <= near_tie(ray, b.t, geometry) => true,
        _ => [a, b].into_iter().flatten().any(|hit| grazes(ray, &hit, geometry)),
    }
}

fn near_tie(ray: &Ray, t: f32, geometry: &Geometry) -> f32 {
    let reach = (geometry.world_bounds().max - geometry.world_bounds().min).max_element() + ray.at(t).distance(ray.origin);
    16.0 * f32::EPSILON * reach / ray.dir.abs().max_element()
}

/// Whether the ray lies in the plane of the triangle it hits, within the rounding of 32 bits.
fn grazes(ray: &Ray, hit: &Hit, geometry: &Geometry) -> bool {
    let [a, b, c] = geometry.corners_of(hit.instance, hit.primitive).map(|p| p.as_dvec3());
    let (normal, dir) = ((b - a).cross(c - a), ray.dir.as_dvec3());
    normal.dot(dir).abs() <= 1e-5 * normal.length() * dir.length()
}
