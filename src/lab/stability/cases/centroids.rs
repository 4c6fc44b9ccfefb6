//! All centres in one place.

use super::{Case, Trial, shapes};
use crate::scene::builtin::Random;
use glam::Vec3;

pub const CASE: Case = Case {
    id: "centroids",
    what: "Triangles of many sizes and directions around one point, in which the centres of all their boxes lie.",
    bites: "Builders that divide by centres find nothing to divide; leaves hold everything.",
    remedy: "Halve the list where centres are equal.",
    make,
};

fn make(random: &mut Random, rays: usize) -> Trial {
    let around = |i: u16| {
        let (x, y) = (random.direction(), random.direction());
        let size = 1.0 / (1.0 + f32::from(i) * 0.05);
        // The box of a, -a and a point between is centred.
        [x * size, -x * size, y * size * 0.2]
    };
    let triangles: Vec<[Vec3; 3]> = (0..500).map(around).collect();
    Trial { rays: shapes::aimed(random, &triangles, 2.0, rays), triangles, closed: false, ..Trial::default() }
}
