//! The same scene, tiny and huge.

use super::{Case, Trial, shapes};
use crate::geometry::Ray;
use crate::scene::builtin::Random;

const fn scaled(id: &'static str, make: fn(&mut Random, usize) -> Trial) -> Case {
    Case {
        id,
        what: "A closed ball of that size, hit through corners, edges and faces.",
        bites: "Fixed epsilons are larger than the scene, or smaller than a rounding; products of lengths over- or underflow.",
        remedy: "Work in a space scaled by a power of two to about 1, and derive every margin from the numbers at hand.",
        make,
    }
}

pub const TINY: Case = scaled("scale-1e-30", |random, rays| make(random, rays, 1e-30));
pub const SMALL: Case = scaled("scale-1e-6", |random, rays| make(random, rays, 1e-6));
pub const LARGE: Case = scaled("scale-1e6", |random, rays| make(random, rays, 1e6));
pub const HUGE: Case = scaled("scale-1e30", |random, rays| make(random, rays, 1e30));

fn make(random: &mut Random, rays: usize, scale: f32) -> Trial {
    let triangles: Vec<_> = shapes::ball(10).into_iter().map(|tri| tri.map(|p| p * scale)).collect();
    let far = shapes::one(random, &[2.0f32, 3.0]) * scale;
    let rays = shapes::aimed(random, &triangles, far, rays);
    let rays = rays.into_iter().map(|ray| Ray { dir: ray.dir / scale, ..ray }).collect();
    Trial { rays, triangles, closed: true, ..Trial::default() }
}
