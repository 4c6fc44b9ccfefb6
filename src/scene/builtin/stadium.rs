//! A stadium in metres: a mown field, a track, and terraces around it, all of large quads.
//!
//! ```text
//!                              ___|  wall
//!                          ___|
//!                      ___|  steps
//!                  ___|
//!     field  track|
//!     ======_______  fence
//! ```

use crate::geometry::num;
use crate::scene::{Material, Mesh};
use glam::{DVec2, Vec3};

/// Half the length and half the width of the field.
const FIELD: DVec2 = DVec2::new(56.0, 38.0);
const TRACK_WIDTH: f64 = 8.0;
const FENCE: f64 = 1.4;
/// From the fence to the wall, and from the lowest step to the highest.
const STAND: f64 = 42.0;
const RISE: f64 = 24.0;

/// The materials, in the order of the meshes.
#[rustfmt::skip]
const MATERIALS: [(&str, [f32; 4]); 6] = [
    ("grass", [0.110, 0.200, 0.060, 1.0]),
    ("mown grass", [0.150, 0.250, 0.080, 1.0]),
    ("track", [0.330, 0.130, 0.085, 1.0]),
    ("concrete", [0.440, 0.425, 0.390, 1.0]),
    ("lower seats", [0.290, 0.095, 0.070, 1.0]),
    ("upper seats", [0.130, 0.200, 0.285, 1.0]),
];
const GRASS: usize = 0;
const MOWN: usize = 1;
const TRACK: usize = 2;
const CONCRETE: usize = 3;
const AISLE: usize = CONCRETE;
const LOWER: usize = 4;
const UPPER: usize = 5;

/// How finely it is built.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Stadium {
    /// Pieces around; a multiple of eight.
    segments: usize,
    steps: usize,
}

/// An oval at some distance from the field, and its height.
#[derive(Clone, Copy)]
struct Oval {
    out: f64,
    z: f64,
}

impl Stadium {
    /// About so many triangles, with six times as many pieces around as there are steps.
    pub fn of(triangles: usize) -> Self {
        let steps = num::floor_index((triangles as f64 / 28.0).sqrt() + 0.5, 1 << 10).max(1);
        let around = triangles as f64 / (4 * steps + 7) as f64;
        Self { segments: 8 * num::floor_index(around / 8.0 + 0.5, 1 << 10).max(1), steps }
    }

    /// Strips of the field, and bands of two triangles a piece: a track, a fence, a wall, and two
    /// for each step.
    pub fn triangles(&self) -> usize {
        self.segments - 2 + 2 * self.segments * (3 + 2 * self.steps)
    }

    /// At most so many: every strip and every piece of a band has four of its own.
    pub fn vertices(&self) -> usize {
        4 * (self.segments / 2) + 4 * self.segments * (3 + 2 * self.steps)
    }

    pub fn materials() -> impl Iterator<Item = Material> {
        MATERIALS.iter().map(|(name, color)| Material { name: (*name).into(), base_color: *color, ..Material::PLAIN })
    }

    /// One mesh for each material that is used; the first of the materials is the scene's `first`.
    pub fn meshes(&self, first: usize) -> Vec<Mesh> {
        let mesh =
            |(i, (name, _)): (usize, &(&str, _))| Mesh { name: (*name).into(), material: Some(first + i), ..Mesh::default() };
        let mut meshes: Vec<Mesh> = MATERIALS.iter().enumerate().map(mesh).collect();
        self.field(&mut meshes);
        let at = |out: f64, z: f64| Oval { out, z };
        self.band(&mut meshes, at(0.0, 0.0), at(TRACK_WIDTH, 0.0), |_| TRACK);
        self.band(&mut meshes, at(TRACK_WIDTH, 0.0), at(TRACK_WIDTH, FENCE), |_| CONCRETE);
        for step in 0..self.steps {
            let (foot, top) = (self.step(step), self.step(step + 1));
            let edge = at(top.out, foot.z);
            let tier = if 2 * step < self.steps { LOWER } else { UPPER };
            self.band(&mut meshes, foot, edge, |_| CONCRETE);
            self.band(&mut meshes, edge, top, |s| if s % 9 == 4 { AISLE } else { tier });
        }
        let top = self.step(self.steps);
        self.band(&mut meshes, top, at(top.out, 0.0), |_| CONCRETE);
        meshes.retain(|mesh| !mesh.triangles.is_empty());
        meshes
    }

    /// The inner border of a step; one past the last is the top of the wall.
    fn step(&self, step: usize) -> Oval {
        let share = step as f64 / self.steps as f64;
        Oval { out: TRACK_WIDTH + STAND * share, z: FENCE + RISE * share }
    }

    /// Strips from side to side, between the pieces of its border above and below the long axis.
    fn field(&self, meshes: &mut [Mesh]) {
        let edge = Oval { out: 0.0, z: 0.0 };
        let half = self.segments / 2;
        for s in 0..half {
            let [a, b] = [s, s + 1].map(|s| self.point(edge, s));
            let [c, d] = [self.segments - s - 1, self.segments - s].map(|s| self.point(edge, s));
            let mesh = &mut meshes[if s / 2 % 2 == 0 { GRASS } else { MOWN }];
            // The outermost strips are triangles: the ends of the oval are single points.
            if s == 0 {
                push(mesh, [a, b, c]);
            } else if s == half - 1 {
                push(mesh, [a, b, d]);
            } else {
                quad(mesh, [a, b, c, d]);
            }
        }
    }

    /// The quads from one oval to the next, seen from the inside or from above if it goes out or
    /// up, each in a material of its own choice.
    fn band(&self, meshes: &mut [Mesh], from: Oval, to: Oval, material: impl Fn(usize) -> usize) {
        for s in 0..self.segments {
            let corners = [(from, s), (to, s), (to, s + 1), (from, s + 1)].map(|(oval, s)| self.point(oval, s));
            quad(&mut meshes[material(s)], corners);
        }
    }

    /// The `s`-th point of an oval, anticlockwise from the x axis: a point of an octagon blown up
    /// to the circle, which is even enough and needs no trigonometry, whose last bit differs
    /// between systems.
    fn point(&self, oval: Oval, s: usize) -> Vec3 {
        const D: f64 = std::f64::consts::FRAC_1_SQRT_2;
        const OCTAGON: [(f64, f64); 8] = [(1.0, 0.0), (D, D), (0.0, 1.0), (-D, D), (-1.0, 0.0), (-D, -D), (0.0, -1.0), (D, -D)];
        let eighth = self.segments / 8;
        let corner = |k: usize| DVec2::from(OCTAGON[k % 8]);
        let flat = corner(s / eighth).lerp(corner(s / eighth + 1), (s % eighth) as f64 / eighth as f64);
        let p = flat / flat.length() * (FIELD + oval.out);
        p.extend(oval.z).as_vec3()
    }
}

fn push(mesh: &mut Mesh, corners: [Vec3; 3]) {
    let first = num::index(mesh.positions.len());
    mesh.positions.extend(corners);
    mesh.triangles.push([first, first + 1, first + 2]);
}

/// Adds two triangles with four vertices of their own.
pub(super) fn quad(mesh: &mut Mesh, corners: [Vec3; 4]) {
    let first = num::index(mesh.positions.len());
    mesh.positions.extend(corners);
    mesh.triangles.extend([[first, first + 1, first + 2], [first, first + 2, first + 3]]);
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::HashMap;

    #[test]
    fn it_is_open_only_below_the_wall() {
        for size in [1, 100, 4_000] {
            let stadium = Stadium::of(size);
            let meshes = stadium.meshes(0);
            let mut edges: HashMap<[[u32; 3]; 2], i32> = HashMap::new();
            for (mesh, triangle) in meshes.iter().flat_map(|mesh| mesh.triangles.iter().map(move |t| (mesh, t))) {
                let p = triangle.map(|i| (mesh.positions[i as usize] + Vec3::ZERO).to_array().map(f32::to_bits));
                for (a, b) in [(0, 1), (1, 2), (2, 0)] {
                    *edges.entry([p[a], p[b]]).or_default() += 1;
                    *edges.entry([p[b], p[a]]).or_default() -= 1;
                }
            }
            assert_eq!(edges.values().filter(|balance| **balance > 0).count(), stadium.segments);
            assert_eq!(meshes.iter().map(|mesh| mesh.triangles.len()).sum::<usize>(), stadium.triangles());
            assert!(meshes.iter().map(|mesh| mesh.positions.len()).sum::<usize>() <= stadium.vertices());
        }
    }
}
