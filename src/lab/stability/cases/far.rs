//! The same scene far from the origin of coordinates.

use super::{Case, Trial, shapes};
use crate::geometry::Ray;
use crate::scene::builtin::Random;
use glam::Vec3;

const fn moved(id: &'static str, make: fn(&mut Random, usize) -> Trial) -> Case {
    Case {
        id,
        what: "A ball as many of its sizes away from the origin of coordinates; its corners are what 32 bits hold there.",
        bites: "Coordinates have few digits left for the shape, and margins made from the scene's size are too small.",
        remedy: "Derive margins from the coordinates, not from the extent; better, move the scene to the origin.",
        make,
    }
}

pub const NEAR: Case = moved("far-1e3", |random, rays| make(random, rays, 1e3));
pub const FAR: Case = moved("far-1e5", |random, rays| make(random, rays, 1e5));
pub const FARTHEST: Case = moved("far-1e7", |random, rays| make(random, rays, 1e7));

fn make(random: &mut Random, rays: usize, away: f32) -> Trial {
    let by = Vec3::new(1.0, -0.7, 0.4) * away;
    let triangles: Vec<_> = shapes::ball(10).into_iter().map(|tri| tri.map(|p| p + by)).collect();
    let ray = |_| {
        let origin = by + random.direction() * 3.0;
        Ray::new(origin, shapes::target(random, &triangles) - origin)
    };
    let rays = (0..rays).map(ray).filter(|ray| ray.dir != Vec3::ZERO).collect();
    // Corners that fall together leave edges without a second triangle.
    Trial { rays, triangles, closed: false, ..Trial::default() }
}
