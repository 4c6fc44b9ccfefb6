//! The classic: the teapot in the stadium.

use super::{Case, Trial, shapes};
use crate::geometry::{Aabb, Ray};
use crate::scene::builtin::{self, Random};
use crate::scene::{Geometry, LoadCx};
use glam::Vec3;

const fn ratio(id: &'static str, make: fn(&mut Random, usize) -> Trial) -> Case {
    Case {
        id,
        what: "The Utah teapot at the middle of a room that is as many times as large, seen from beside it and from the walls.",
        bites: "As with the ball; and the teapot is open at its lid, its spout passes its body, and its triangles are slim.",
        remedy: "Structures that adapt (BVH, k-d tree, two-level grid); margins from the ray's origin.",
        make,
    }
}

pub const HUNDRED: Case = ratio("teapot-1e2", |random, rays| make(random, rays, 1e-2));
pub const HUNDRED_THOUSAND: Case = ratio("teapot-1e5", |random, rays| make(random, rays, 1e-5));
pub const HUNDRED_MILLION: Case = ratio("teapot-1e8", |random, rays| make(random, rays, 1e-8));

/// The teapot's triangles, coarsely: what is stiff is the room, and the oracle looks at all of them for each ray.
fn teapot() -> Vec<[Vec3; 3]> {
    let cx = LoadCx::unattended();
    let scene = builtin::generate("teapot?triangles=1000", &cx).ok();
    let geometry = scene.and_then(|scene| Geometry::new(&scene, &cx).ok());
    let triangles = |g: &Geometry| {
        let size = g.bounds().size().max_element();
        let middle = |b: &Aabb| (b.min + b.max) * 0.5;
        let at = middle(g.bounds());
        (0..g.live_count()).map(|i| g.corners(g.live(i)).map(|p| (p - at) * (1.6 / size))).collect()
    };
    geometry.as_ref().map(triangles).unwrap_or_default()
}

fn make(random: &mut Random, rays: usize, size: f32) -> Trial {
    let mut triangles: Vec<_> = teapot().into_iter().map(|tri| tri.map(|p| p * size)).collect();
    let teapot = triangles.clone();
    if teapot.is_empty() {
        return Trial::default();
    }
    triangles.extend(shapes::cube(4));
    let ray = |i: usize| {
        let origin = if i.is_multiple_of(2) { random.direction() * 3.0 * size } else { random.in_ball() * 0.9 };
        let at = if i % 4 < 3 { shapes::target(random, &teapot) } else { shapes::target(random, &triangles) };
        Ray::new(origin, at - origin)
    };
    let rays = (0..rays).map(ray).filter(|ray| ray.dir != Vec3::ZERO).collect();
    Trial { rays, triangles, ..Trial::default() }
}
