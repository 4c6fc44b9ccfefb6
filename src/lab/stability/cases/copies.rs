//! Many times the same.

use super::{Case, Trial, shapes};
use crate::scene::builtin::Random;
use glam::Vec3;

pub const CASE: Case = Case {
    id: "copies",
    what: "A hundred thousand copies of one triangle; fewer in a short run.",
    bites: "No plane separates them, so builders that divide until leaves are small never end; ties in t everywhere.",
    remedy: "Stop where a division does not pay, and limit depth; settle ties by the lowest index.",
    make,
};

fn make(random: &mut Random, rays: usize) -> Trial {
    let tri = [Vec3::new(0.0, 0.1, 0.2), Vec3::new(1.0, 0.0, 0.3), Vec3::new(0.3, 0.9, -0.2)];
    // Each ray meets all of them: few rays, and in a short run fewer copies.
    let copies = (50 * rays).clamp(2_000, 100_000);
    Trial {
        rays: shapes::aimed(random, &[tri], 2.0, (rays / 100).max(20)),
        triangles: vec![tri; copies],
        closed: false,
        ..Trial::default()
    }
}
