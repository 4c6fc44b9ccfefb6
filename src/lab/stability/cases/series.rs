//! A geometric series of boxes.

use super::{Case, Trial, shapes};
use crate::geometry::Ray;
use crate::scene::builtin::Random;
use glam::Vec3;

pub const CASE: Case = Case {
    id: "series",
    what: "Three hundred triangles, each five sixths as large and as far from a corner as the one before.",
    bites: "Trees that halve space or take the best division get as deep as there are triangles; a stack of 64 overflows.",
    remedy: "A limit of depth that falls back on halving the list.",
    make,
};

fn make(random: &mut Random, rays: usize) -> Trial {
    let triangles: Vec<[Vec3; 3]> = (0..300)
        .map(|i| {
            let s = (5.0f32 / 6.0).powi(i);
            [Vec3::new(s, 0.0, 0.1 * s), Vec3::new(0.1 * s, s, 0.0), Vec3::new(0.0, 0.1 * s, s)]
        })
        .collect();
    let ray = |i: usize| {
        let origin = if i.is_multiple_of(2) { Vec3::splat(-1.0) + random.in_ball() } else { Vec3::splat(2.0) + random.in_ball() };
        Ray::new(origin, shapes::target(random, &triangles) - origin)
    };
    Trial { rays: (0..rays).map(ray).collect(), triangles, closed: false, ..Trial::default() }
}
