//! What several cases are made of.

use crate::geometry::Ray;
use crate::scene::builtin::Random;
use glam::Vec3;

/// A closed bumpy ball around the origin, of `4 n^2` triangles less the poles' empty ones, radius about 0.8.
pub fn ball(n: u16) -> Vec<[Vec3; 3]> {
    let at = |i: u16, j: u16| {
        let turn = |k: u16| f32::from(k) / f32::from(n) * std::f32::consts::PI;
        let (a, b) = (turn(i % (2 * n)), turn(j));
        let r = 0.8 + 0.1 * (5.0 * a).sin() * (4.0 * b).sin();
        // The poles are one point each.
        let s = if j == 0 || j == n { 0.0 } else { b.sin() };
        Vec3::new(r * s * a.cos(), r * b.cos(), r * s * a.sin())
    };
    let mut triangles = Vec::new();
    for (i, j) in (0..2 * n).flat_map(|i| (0..n).map(move |j| (i, j))) {
        let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
        triangles.extend([[a, b, c], [a, c, d]].into_iter().filter(|t| t[0] != t[1] && t[1] != t[2] && t[2] != t[0]));
    }
    triangles
}

/// The surface of a cube from -1 to 1, `n` by `n` squares a face.
pub fn cube(n: u8) -> Vec<[Vec3; 3]> {
    let mut triangles = Vec::new();
    let at = |i: u8| f32::from(i) / f32::from(n) * 2.0 - 1.0;
    for axis in 0..3 {
        for side in [-1.0, 1.0] {
            let point = |i: u8, j: u8| {
                let mut p = Vec3::splat(side);
                (p[(axis + 1) % 3], p[(axis + 2) % 3]) = (at(i), at(j));
                p
            };
            for (i, j) in (0..n).flat_map(|i| (0..n).map(move |j| (i, j))) {
                let [a, b, c, d] = [point(i, j), point(i + 1, j), point(i + 1, j + 1), point(i, j + 1)];
                triangles.extend([[a, b, c], [a, c, d]]);
            }
        }
    }
    triangles
}

/// Two triangles.
pub fn quad(corners: [Vec3; 4]) -> [[Vec3; 3]; 2] {
    let [a, b, c, d] = corners;
    [[a, b, c], [a, c, d]]
}

/// One of a list.
pub fn one<T: Copy>(random: &mut Random, of: &[T]) -> T {
    of[crate::geometry::num::floor_index(f64::from(random.unit()) * of.len() as f64, of.len() - 1)]
}

/// A corner, a point of an edge or a point inside of one of the triangles.
pub fn target(random: &mut Random, triangles: &[[Vec3; 3]]) -> Vec3 {
    let [a, b, c] = one(random, triangles);
    match random.unit() {
        x if x < 0.34 => a,
        x if x < 0.5 => a.midpoint(b),
        x if x < 0.67 => a.lerp(b, random.unit()),
        _ => {
            let (u, v) = (random.unit(), random.unit());
            let (u, v) = if u + v > 1.0 { (1.0 - u, 1.0 - v) } else { (u, v) };
            a + (b - a) * u + (c - a) * v
        }
    }
}

/// Rays from points around the origin, `far` away, towards [`target`]s.
pub fn aimed(random: &mut Random, triangles: &[[Vec3; 3]], far: f32, rays: usize) -> Vec<Ray> {
    let ray = |_| {
        let origin = random.direction() * far;
        let at = target(random, triangles);
        Ray::new(origin, at - origin)
    };
    (0..rays).map(ray).filter(|ray| ray.dir != Vec3::ZERO).collect()
}

/// The 26 directions of a cube's faces, edges and corners, with zeros of either sign.
pub fn directions() -> impl Iterator<Item = Vec3> {
    let signs = [-1.0f32, 0.0, 1.0];
    let all = signs
        .into_iter()
        .flat_map(move |x| signs.into_iter().flat_map(move |y| signs.into_iter().map(move |z| Vec3::new(x, y, z))));
    let zero = |d: Vec3, zero: f32| Vec3::from_array(d.to_array().map(|c| if c == 0.0 { zero } else { c }));
    all.filter(|d| *d != Vec3::ZERO).flat_map(move |d| [zero(d, 0.0), zero(d, -0.0)])
}
