//! Large triangles among many small ones.

use super::{Case, Trial, shapes};
use crate::scene::builtin::Random;
use glam::Vec3;

pub const CASE: Case = Case {
    id: "spanning",
    what: "A few triangles as large as the scene among two thousand small ones.",
    bites: "The large ones are in every cell, are tested again and again, and are hit outside the cell that a ray is in.",
    remedy: "Keep a hit that lies outside its cell, and go on; a mailbox saves the repeated tests.",
    make,
};

fn make(random: &mut Random, rays: usize) -> Trial {
    let small = |_| {
        let at = random.in_ball();
        [at, at + random.in_ball() * 0.05, at + random.in_ball() * 0.05]
    };
    let mut triangles: Vec<[Vec3; 3]> = (0..2000).map(small).collect();
    triangles.extend((0..30).map(|_| [random.direction() * 2.0, random.direction() * 2.0, random.direction() * 2.0]));
    Trial { rays: shapes::aimed(random, &triangles, 4.0, rays), triangles, closed: false, ..Trial::default() }
}
