//! A closed surface, hit exactly where its triangles meet.

use super::{Case, Trial, shapes};
use crate::geometry::Ray;
use crate::scene::builtin::Random;
use glam::Vec3;

pub const CASE: Case = Case {
    id: "shared-edges",
    what: "A closed bumpy ball, and rays from outside and from inside through its corners, its edges and its faces.",
    bites: "Triangle tests that work out a shared edge differently for its two triangles: rays slip through and light leaks.",
    remedy: "The watertight test (Woop, Benthin and Wald 2013), or exact signs.",
    make,
};

fn make(random: &mut Random, rays: usize) -> Trial {
    let triangles = shapes::ball(14);
    let ray = |i: usize| {
        let at = shapes::target(random, &triangles);
        let origin = match i % 3 {
            0 => random.direction() * 3.0,
            // On a short grid, so that directions and edge functions are exact numbers now and then.
            1 => (random.in_ball() * 4.0).round() * 0.75,
            _ => random.in_ball() * 0.3,
        };
        Ray::new(origin, at - origin)
    };
    let rays = (0..rays).map(ray).filter(|ray| ray.dir != Vec3::ZERO).collect();
    Trial { rays, triangles, closed: true, ..Trial::default() }
}
