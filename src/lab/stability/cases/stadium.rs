//! Something small in something large.

use super::{Case, Trial, shapes};
use crate::geometry::Ray;
use crate::scene::builtin::Random;
use glam::Vec3;

const fn ratio(id: &'static str, make: fn(&mut Random, usize) -> Trial) -> Case {
    Case {
        id,
        what: "A small ball at the middle of a room that is as many times as large, seen from beside the ball and from the walls.",
        bites: "Grids put the whole ball into one cell; margins made from the room are larger than the ball.",
        remedy: "Structures that adapt (BVH, k-d tree, two-level grid); margins from the ray's origin.",
        make,
    }
}

pub const HUNDRED: Case = ratio("stadium-1e2", |random, rays| make(random, rays, 1e-2));
pub const HUNDRED_THOUSAND: Case = ratio("stadium-1e5", |random, rays| make(random, rays, 1e-5));
pub const HUNDRED_MILLION: Case = ratio("stadium-1e8", |random, rays| make(random, rays, 1e-8));

fn make(random: &mut Random, rays: usize, size: f32) -> Trial {
    let mut triangles: Vec<_> = shapes::ball(8).into_iter().map(|tri| tri.map(|p| p * size)).collect();
    let ball = triangles.clone();
    triangles.extend(shapes::cube(4));
    let ray = |i: usize| {
        let origin = if i.is_multiple_of(2) { random.direction() * 3.0 * size } else { random.in_ball() * 0.9 };
        let at = if i % 4 < 3 { shapes::target(random, &ball) } else { shapes::target(random, &triangles) };
        Ray::new(origin, at - origin)
    };
    let rays = (0..rays).map(ray).filter(|ray| ray.dir != Vec3::ZERO).collect();
    Trial { rays, triangles, closed: true, ..Trial::default() }
}
