//! Triangles without area.

use super::{Case, Trial, shapes};
use crate::scene::builtin::Random;

pub const CASE: Case = Case {
    id: "degenerate",
    what: "A closed ball, and among its triangles others that are a line or a point.",
    bites: "Normals of length zero, divisions by an area of zero, hits that are no numbers.",
    remedy: "Decide exactly whether the area is zero, and keep such triangles out of the structure.",
    make,
};

fn make(random: &mut Random, rays: usize) -> Trial {
    let good = shapes::ball(8);
    let mut triangles = Vec::new();
    for (i, tri) in good.iter().enumerate() {
        let [a, b, c] = *tri;
        triangles.push(*tri);
        match i % 6 {
            0 => triangles.push([a, a, a]),
            1 => triangles.push([a, b, a]),
            2 => triangles.push([b, c, c.midpoint(b)]),
            _ => {}
        }
    }
    Trial { rays: shapes::aimed(random, &good, 3.0, rays), triangles, closed: true, ..Trial::default() }
}
