//! Rays exactly on the planes that structures divide space at.

use super::{Case, Trial, shapes};
use crate::geometry::Ray;
use crate::scene::builtin::Random;
use glam::Vec3;

pub const CASE: Case = Case {
    id: "grid-lines",
    what: "Walls on the planes of eighths of a cube, and rays in 26 directions along the lines where those planes meet; \
           origins and hits lie on the planes of grids, octrees, k-d trees and BSPs.",
    bites: "Structures that divide space: what lies on a plane belongs to both sides, and is lost if each leaves it to the \
            other.",
    remedy: "Close cells on both sides, or widen them by the error of a plane's t.",
    make,
};

fn make(random: &mut Random, rays: usize) -> Trial {
    let eighth = |random: &mut Random| shapes::one(random, &[-1.0f32, -0.75, -0.5, -0.25, 0.0, 0.25, 0.5, 0.75, 1.0]);
    let mut triangles = shapes::cube(2);
    for axis in 0..3 {
        for _ in 0..12 {
            let (at, u, v) = (eighth(random), eighth(random), eighth(random));
            let point = |a: f32, b: f32| {
                let mut p = Vec3::splat(at);
                (p[(axis + 1) % 3], p[(axis + 2) % 3]) = (a, b);
                p
            };
            triangles.extend(shapes::quad([point(u, v), point(u + 0.25, v), point(u + 0.25, v + 0.25), point(u, v + 0.25)]));
        }
    }
    let directions: Vec<Vec3> = shapes::directions().collect();
    let ray = |i: usize| {
        let at = Vec3::new(eighth(random), eighth(random), eighth(random));
        let dir = directions[i % directions.len()];
        let scale = shapes::one(random, &[1.0f32, 0.25, 3.0]);
        Ray::new(at - dir * shapes::one(random, &[0.0f32, 0.5, 4.0]), dir * scale)
    };
    Trial { rays: (0..rays).map(ray).collect(), triangles, closed: false, ..Trial::default() }
}
