//! Rays that hardly touch.

use super::{Case, Trial, shapes};
use crate::geometry::Ray;
use crate::scene::builtin::Random;
use glam::Vec3;

pub const CASE: Case = Case {
    id: "grazing",
    what: "A tiled floor, not parallel to any axis, and rays at angles from a tenth of a radian down to a ten millionth.",
    bites: "The divisor of t cancels, so t is off by a large part of the scene; hits are found in the wrong order.",
    remedy: "Clamp t into the box of the triangle; sort by exact t where order matters.",
    make,
};

fn make(random: &mut Random, rays: usize) -> Trial {
    let (x, y) = (Vec3::new(1.0, 0.1, 0.2), Vec3::new(-0.2, 0.15, 1.0));
    let normal = x.cross(y).try_normalize().unwrap_or(Vec3::Y);
    let point = |i: u8, j: u8| x * (f32::from(i) * 0.1 - 0.8) + y * (f32::from(j) * 0.1 - 0.8);
    let mut triangles = Vec::new();
    for (i, j) in (0..16u8).flat_map(|i| (0..16u8).map(move |j| (i, j))) {
        triangles.extend(shapes::quad([point(i, j), point(i + 1, j), point(i + 1, j + 1), point(i, j + 1)]));
    }
    let ray = |i: i32| {
        let at = shapes::target(random, &triangles);
        let (sin, cos) = (random.unit() * std::f32::consts::TAU).sin_cos();
        let angle = 10.0f32.powi(-1 - i % 7);
        let origin = at - (x * cos + y * sin) * 1.5 + normal * (1.5 * angle);
        Ray::new(origin, at - origin)
    };
    let rays = (0..i32::try_from(rays).unwrap_or(i32::MAX)).map(ray).collect();
    Trial { rays, triangles, closed: false, ..Trial::default() }
}
