//! Surfaces that nearly coincide.

use super::{Case, Trial, shapes};
use crate::scene::builtin::Random;
use glam::Vec3;

pub const CASE: Case = Case {
    id: "layers",
    what: "Squares one upon the other: equal ones, and ones that are one unit of the last place apart.",
    bites: "Which layer is in front is a matter of rounding: structures disagree, pictures flicker.",
    remedy: "Ties go to the lowest index; between different layers, exact t.",
    make,
};

fn make(random: &mut Random, rays: usize) -> Trial {
    let square = |z: f32| {
        let at = |x: f32, y: f32| Vec3::new(x, y, z + 0.25 * x);
        shapes::quad([at(-1.0, -1.0), at(1.0, -1.0), at(1.0, 1.0), at(-1.0, 1.0)])
    };
    let apart = (0..24).flat_map(|i| square(f32::from_bits(0.5f32.to_bits() + i)));
    let equal = (0..24).flat_map(|_| square(-0.5));
    let triangles: Vec<[Vec3; 3]> = apart.chain(equal).collect();
    Trial { rays: shapes::aimed(random, &triangles, 3.0, rays), triangles, closed: false, ..Trial::default() }
}
