//! Hardly any triangles.

use super::{Case, Trial, shapes};
use crate::geometry::Ray;
use crate::scene::builtin::Random;
use glam::Vec3;

const fn of(id: &'static str, make: fn(&mut Random, usize) -> Trial) -> Case {
    Case {
        id,
        what: "That many triangles.",
        bites: "Empty lists, trees of one node, divisions by a count less one.",
        remedy: "Build a leaf where there is nothing to divide, and an empty one where there is nothing.",
        make,
    }
}

pub const NONE: Case = of("few-0", |random, rays| make(random, rays, 0));
pub const ONE: Case = of("few-1", |random, rays| make(random, rays, 1));
pub const TWO: Case = of("few-2", |random, rays| make(random, rays, 2));
pub const THREE: Case = of("few-3", |random, rays| make(random, rays, 3));
pub const FIVE: Case = of("few-5", |random, rays| make(random, rays, 5));

fn make(random: &mut Random, rays: usize, count: usize) -> Trial {
    let triangles: Vec<[Vec3; 3]> = (0..count).map(|_| [random.in_ball(), random.in_ball(), random.in_ball()]).collect();
    let rays = if count == 0 {
        (0..rays).map(|_| Ray::new(random.in_ball(), random.direction())).collect()
    } else {
        shapes::aimed(random, &triangles, 2.0, rays)
    };
    Trial { rays, triangles, closed: false, ..Trial::default() }
}
