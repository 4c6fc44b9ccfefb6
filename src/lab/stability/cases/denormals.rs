//! Numbers below the smallest with all their digits.

use super::{Case, Trial, shapes};
use crate::scene::builtin::Random;
use glam::Vec3;

pub const CASE: Case = Case {
    id: "denormals",
    what: "Triangles some of whose coordinates are denormal, beside others of size 1, and directions with denormal components.",
    bites: "Reciprocals of denormals are infinite; processors set to flush denormals make them zero.",
    remedy: "Treat components of the direction that are far below the greatest as zero in box tests.",
    make,
};

fn make(random: &mut Random, rays: usize) -> Trial {
    let tiny = |random: &mut Random| {
        f32::from_bits(
            1 + crate::geometry::num::index(crate::geometry::num::floor_index(f64::from(random.unit()) * 1e6, 999_999)),
        )
    };
    let triangle = |i: usize| {
        let mut tri = [random.in_ball(), random.in_ball(), random.in_ball()];
        for corner in &mut tri {
            corner[i % 3] = tiny(random) * if random.unit() < 0.5 { -1.0 } else { 1.0 };
        }
        tri
    };
    let triangles: Vec<[Vec3; 3]> = (0..120).map(triangle).collect();
    let mut rays = shapes::aimed(random, &triangles, 2.0, rays);
    for (i, ray) in rays.iter_mut().enumerate().filter(|(i, _)| i % 3 == 0) {
        ray.dir[i / 3 % 3] = tiny(random);
    }
    Trial { rays, triangles, closed: false, ..Trial::default() }
}
