//! Hits at the very ends of the ray's interval.

use super::{Case, Trial, shapes};
use crate::geometry::Ray;
use crate::scene::builtin::Random;
use glam::Vec3;

pub const CASE: Case = Case {
    id: "ends",
    what: "Squares at round distances, and rays whose interval begins or ends exactly there, or one unit of the last place \
           before or beyond.",
    bites: "Open and closed ends: the hit at tmin or tmax is lost in one structure and found in another.",
    remedy: "Closed intervals everywhere, compared with t itself and never with a box.",
    make,
};

fn make(random: &mut Random, rays: usize) -> Trial {
    let distances = [1.0f32, 1.5, 2.0, 3.0];
    let square = |z: f32| shapes::quad([(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)].map(|(x, y)| Vec3::new(x, y, z)));
    let triangles: Vec<[Vec3; 3]> = distances.into_iter().flat_map(square).collect();
    let ray = |i: usize| {
        let origin = Vec3::new(random.unit() - 0.3, random.unit() - 0.6, 0.0);
        let end = |random: &mut Random| {
            let t = shapes::one(random, &distances) * 0.5;
            shapes::one(random, &[t, t.next_down(), t.next_up()])
        };
        let (a, b) = (end(random), end(random));
        let (tmin, tmax) = match i % 3 {
            0 => (a, f32::INFINITY),
            1 => (0.0, a),
            _ => (a.min(b), a.max(b)),
        };
        Ray { origin, dir: Vec3::Z * 2.0, tmin, tmax }
    };
    Trial { rays: (0..rays).map(ray).collect(), triangles, closed: false, ..Trial::default() }
}
