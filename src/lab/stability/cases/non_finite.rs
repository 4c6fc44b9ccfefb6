//! Corners that are no numbers.

use super::{Case, Trial, shapes};
use crate::scene::builtin::Random;
use glam::Vec3;

pub const CASE: Case = Case {
    id: "non-finite",
    what: "A closed ball, and among its triangles others with a corner that is infinite or not a number.",
    bites: "One such corner makes the box of the whole scene infinite or undefined; builders sort by numbers that do not compare.",
    remedy: "Drop such triangles when the model is loaded, count them, and say so.",
    make,
};

fn make(random: &mut Random, rays: usize) -> Trial {
    let good = shapes::ball(8);
    let rays = shapes::aimed(random, &good, 3.0, rays);
    let bad = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY];
    let mut triangles = Vec::new();
    for (i, tri) in good.into_iter().enumerate() {
        triangles.push(tri);
        if i % 7 == 0 {
            let mut tri = tri;
            tri[i % 3][i / 3 % 3] = bad[i / 7 % 3];
            triangles.push(tri);
        }
        if i % 50 == 0 {
            triangles.push([Vec3::NAN; 3]);
        }
    }
    Trial { rays, triangles, closed: true, ..Trial::default() }
}
