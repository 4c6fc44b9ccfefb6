//! A sphere of triangles of nearly even size: the faces of an octahedron, each cut into `n * n`,
//! blown up.

use glam::{DVec3, Vec3};

/// Points on the unit sphere (which are the normals too) and triangles, outward.
pub(super) struct Sphere {
    pub points: Vec<Vec3>,
    pub triangles: Vec<[u32; 3]>,
}

/// The number of vertices of [`unit`]; those on the edges of the octahedron are there once for each
/// face, equal to the bit.
pub(super) const fn vertices(n: usize) -> usize {
    4 * (n + 1) * (n + 2)
}

/// The number of triangles of [`unit`].
pub(super) const fn triangles(n: usize) -> usize {
    8 * n * n
}

/// The unit sphere, each edge of the octahedron cut into `n`.
pub(super) fn unit(n: u32) -> Sphere {
    let mut sphere = Sphere { points: Vec::new(), triangles: Vec::new() };
    for face in 0..8u32 {
        let sign = |axis: u32| if face >> axis & 1 == 0 { 1.0 } else { -1.0 };
        let signs = DVec3::new(sign(0), sign(1), sign(2));
        sphere.face(n, signs, face.count_ones() % 2 == 1);
    }
    sphere
}

impl Sphere {
    /// Adds the octant with these signs. Row `i` holds `i + 1` points:
    ///
    /// ```text
    ///        x        the corner on the x axis
    ///       / \
    ///      *---*
    ///     / \ / \
    ///    y---*---z
    /// ```
    fn face(&mut self, n: u32, signs: DVec3, mirrored: bool) {
        let first = crate::geometry::num::index(self.points.len());
        for i in 0..=n {
            for j in 0..=i {
                let flat = DVec3::new(f64::from(n - i), f64::from(i - j), f64::from(j));
                // Adding 0 turns -0 into 0, so that the octants agree on their edges to the bit.
                self.points.push((signs * flat / flat.length() + DVec3::ZERO).as_vec3());
            }
        }
        let at = |i: u32, j: u32| first + i * (i + 1) / 2 + j;
        let mut add = |[a, b, c]: [u32; 3]| self.triangles.push(if mirrored { [a, c, b] } else { [a, b, c] });
        for i in 0..n {
            for j in 0..=i {
                add([at(i, j), at(i + 1, j), at(i + 1, j + 1)]);
                if j < i {
                    add([at(i, j), at(i + 1, j + 1), at(i, j + 1)]);
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::HashMap;

    #[test]
    fn it_is_closed_and_faces_outward() {
        for n in 1..6 {
            let sphere = unit(n);
            assert_eq!(sphere.points.len(), vertices(n as usize));
            assert_eq!(sphere.triangles.len(), triangles(n as usize));
            let mut edges: HashMap<[[u32; 3]; 2], i32> = HashMap::new();
            for triangle in &sphere.triangles {
                let p = triangle.map(|i| sphere.points[i as usize]);
                assert!((p[1] - p[0]).cross(p[2] - p[0]).dot(p[0]) > 0.0);
                let bits = p.map(|p| p.to_array().map(f32::to_bits));
                for (a, b) in [(0, 1), (1, 2), (2, 0)] {
                    *edges.entry([bits[a], bits[b]]).or_default() += 1;
                    *edges.entry([bits[b], bits[a]]).or_default() -= 1;
                }
            }
            assert!(edges.values().all(|balance| *balance == 0));
        }
    }
}
