//! Rays in the planes that builders choose to divide space at.

use super::{Case, Trial, shapes};
use crate::geometry::Ray;
use crate::scene::builtin::Random;
use glam::Vec3;

pub const CASE: Case = Case {
    id: "planes",
    what: "Scattered triangles, and rays in 26 directions whose origins take each coordinate from a corner of some triangle: they \
           start on, and run in, the planes where boxes end and k-d trees divide.",
    bites: "k-d trees and BSPs: a ray in a plane belongs to both sides, and a triangle that ends there may be in only one.",
    remedy: "Visit both sides where the ray is as close to the plane as rounding reaches; sort flat triangles to both.",
    make,
};

fn make(random: &mut Random, rays: usize) -> Trial {
    let triangle = |random: &mut Random| {
        let at = random.in_ball();
        [0; 3].map(|_| at + random.in_ball() * 0.2)
    };
    let mut triangles: Vec<[Vec3; 3]> = (0..240).map(|_| triangle(random)).collect();
    // Some lie in planes of their own.
    for (i, tri) in triangles.iter_mut().enumerate().filter(|(i, _)| i % 3 == 0) {
        let axis = i / 3 % 3;
        let at = tri[0][axis];
        tri.iter_mut().for_each(|p| p[axis] = at);
    }
    let directions: Vec<Vec3> = shapes::directions().collect();
    let ray = |i: usize| {
        let mut corner = || {
            let tri = shapes::one(random, &triangles);
            shapes::one(random, &tri)
        };
        let at = Vec3::new(corner().x, corner().y, corner().z);
        let dir = directions[i % directions.len()];
        Ray::new(if i.is_multiple_of(2) { at } else { at - dir * 2.0 }, dir)
    };
    let rays = (0..rays).map(ray).collect();
    Trial { rays, triangles, ..Trial::default() }
}
