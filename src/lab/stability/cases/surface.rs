//! Rays that start on a surface.

use super::{Case, Trial, shapes};
use crate::geometry::Ray;
use crate::scene::builtin::Random;

pub const CASE: Case = Case {
    id: "surface",
    what: "Rays that start in corners, on edges and in faces of a closed ball, with no room left between.",
    bites: "Whether the surface that a ray leaves is hit at t = 0 is a matter of rounding: acne.",
    remedy: "Start secondary rays as far off as the hit's own error bound says.",
    make,
};

fn make(random: &mut Random, rays: usize) -> Trial {
    let triangles = shapes::ball(10);
    let ray = |i: usize| {
        let at = shapes::target(random, &triangles);
        let dir = if i.is_multiple_of(2) { random.direction() } else { shapes::target(random, &triangles) - at };
        Ray::new(at, dir)
    };
    let rays = (0..rays).map(ray).filter(Ray::is_valid).collect();
    Trial { rays, triangles, closed: true, ..Trial::default() }
}
