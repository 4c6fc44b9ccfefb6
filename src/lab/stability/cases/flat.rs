//! Flat scenes, and rays in their plane.

use super::{Case, Trial, shapes};
use crate::geometry::Ray;
use crate::scene::builtin::Random;
use glam::Vec3;

pub const CASE: Case = Case {
    id: "flat",
    what: "A tiled floor, all of whose boxes are flat, and rays straight down, through corners of tiles, and within the \
           floor's plane.",
    bites: "Boxes without thickness: strict comparisons lose them. Rays within the plane meet a box, and no triangle.",
    remedy: "Closed intervals, and boxes a little wider than they are.",
    make,
};

fn make(random: &mut Random, rays: usize) -> Trial {
    let mut triangles = Vec::new();
    let at = |i: u8| f32::from(i) * 0.125 - 1.0;
    for (i, j) in (0..16u8).flat_map(|i| (0..16u8).map(move |j| (i, j))) {
        let point = |i, j| Vec3::new(at(i), 0.25, at(j));
        triangles.extend(shapes::quad([point(i, j), point(i + 1, j), point(i + 1, j + 1), point(i, j + 1)]));
    }
    let ray = |i: usize| {
        let at = shapes::target(random, &triangles);
        match i % 4 {
            0 => Ray::new(at + Vec3::Y, Vec3::NEG_Y),
            1 => Ray::new(at - Vec3::Y * random.unit(), Vec3::Y),
            2 => Ray::new(at + random.direction(), Vec3::ZERO),
            _ => Ray::new(
                at - Vec3::X * 4.0,
                shapes::one(random, &[Vec3::X, Vec3::new(1.0, 0.0, 0.5), Vec3::new(1.0, -0.0, -0.25)]),
            ),
        }
    };
    let mut all: Vec<Ray> = (0..rays).map(ray).collect();
    for ray in all.iter_mut().filter(|ray| ray.dir == Vec3::ZERO) {
        ray.dir = shapes::target(random, &triangles) - ray.origin;
    }
    Trial { rays: all, triangles, closed: false, ..Trial::default() }
}
