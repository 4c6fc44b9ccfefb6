//! Long thin triangles across the whole scene.

use super::{Case, Trial, shapes};
use crate::scene::builtin::Random;
use glam::Vec3;

pub const CASE: Case = Case {
    id: "diagonals",
    what: "A bundle of long thin triangles from corner to corner of the scene.",
    bites: "Boxes are as large as the scene, so every ray visits every leaf; cells hold each triangle hundreds of times.",
    remedy: "Cut triangles while building (sbvh), or planes of any direction (bsp).",
    make,
};

fn make(random: &mut Random, rays: usize) -> Trial {
    let thin = |_| {
        let (a, b) = (Vec3::NEG_ONE + random.in_ball() * 0.1, Vec3::ONE + random.in_ball() * 0.1);
        [a, b, b + random.in_ball() * 0.004]
    };
    let triangles: Vec<[Vec3; 3]> = (0..400).map(thin).collect();
    Trial { rays: shapes::aimed(random, &triangles, 3.0, rays), triangles, closed: false, ..Trial::default() }
}
