//! Triangles far longer than wide.

use super::{Case, Trial, shapes};
use crate::scene::builtin::Random;
use glam::Vec3;

pub const CASE: Case = Case {
    id: "slivers",
    what: "Needles and caps, a thousand to a million million times as long as wide, in all directions.",
    bites: "Edge functions that cancel: the weights of the corners are noise, and t with them.",
    remedy: "Clamp t into the box of the triangle, or test exactly; best, mesh without slivers.",
    make,
};

fn make(random: &mut Random, rays: usize) -> Trial {
    let sliver = |i: i32| {
        let aspect = 10.0f32.powi(3 + i % 10);
        let (a, along) = (random.in_ball() * 0.5, random.direction());
        let across = along.any_orthonormal_vector() / aspect;
        let cap = if i % 2 == 0 { 1.0 } else { 0.5 };
        [a, a + along, a + along * cap + across]
    };
    let triangles: Vec<[Vec3; 3]> = (0..400).map(sliver).collect();
    Trial { rays: shapes::aimed(random, &triangles, 2.5, rays), triangles, closed: false, ..Trial::default() }
}
