//! Rays along the axes and the diagonals, in the planes of boxes.

use super::{Case, Trial, shapes};
use crate::geometry::Ray;
use crate::scene::builtin::Random;
use glam::Vec3;

pub const CASE: Case = Case {
    id: "zero-directions",
    what: "A cube, and rays in all 26 directions of faces, edges and corners, zeros of either sign, that start on its \
           planes, faces, edges and corners, and two units before them.",
    bites: "Box tests that divide by zero: 0 times infinity is no number, and a comparison with it is false. Pixels along \
            lines through the scene are black.",
    remedy: "Settle zero components when the ray is made ready, closed on both sides.",
    make,
};

fn make(random: &mut Random, rays: usize) -> Trial {
    let triangles = shapes::cube(4);
    let steps = [-1.0f32, -0.5, 0.0, 0.25, 0.3, 1.0];
    let directions: Vec<Vec3> = shapes::directions().collect();
    let ray = |i: usize| {
        let mut one = || shapes::one(random, &steps);
        let at = Vec3::new(one(), one(), one());
        let dir = directions[i % directions.len()];
        Ray::new(if (i / directions.len()).is_multiple_of(2) { at } else { at - dir * 2.0 }, dir)
    };
    Trial { rays: (0..rays).map(ray).collect(), triangles, closed: true, ..Trial::default() }
}
