//! A Menger sponge (Karl Menger, 1926): a cube of 3 x 3 x 3 of which the middle of each face and of
//! the whole is taken away, and so on in the cubes that are left. All faces are parallel to the
//! axes and exactly on planes where trees would like to split.

use super::fill::Sizes;
use super::view;
use crate::geometry::num;
use crate::scene::{Instance, LoadCx, Material, Mesh, Reason, Scene};
use glam::Vec3;

/// The sponge of the level that comes nearest, from a plain cube (12 triangles) to the fifth
/// (13 million); each level has about twenty times the triangles of the one before.
pub(super) fn generate(triangles: usize, cx: &LoadCx) -> Result<Scene, Reason> {
    let off = |level: &u32| (faces(*level) as f64 * 2.0 / triangles as f64).ln().abs();
    let level = (0..=5).min_by(|a, b| off(a).total_cmp(&off(b))).unwrap_or(0);
    let memory = Sizes { vertices: vertices(level), triangles: 2 * faces(level), ..Sizes::default() }.begin(cx)?;
    Ok(Scene {
        meshes: vec![Sponge::new(level).mesh(memory.bytes(), cx)?],
        instances: vec![Instance::identity(0)],
        materials: vec![Material { name: "sandstone".into(), base_color: [0.60, 0.47, 0.32, 1.0], ..Material::PLAIN }],
        up: Vec3::Z,
        camera: Some(view(Vec3::new(0.0, 0.0, -0.1), Vec3::new(2.3, -4.2, 2.6))),
        ..Scene::default()
    })
}

/// Unit faces between what is there and what is not. Each cube leaves 20; of the faces of a flat
/// side 8 in 9 stay. The recurrence has this solution.
fn faces(level: u32) -> usize {
    2 * 20usize.pow(level) + 4 * 8usize.pow(level)
}

/// At most so many vertices: a face brings one of its own at the most, except in a single cube.
fn vertices(level: u32) -> usize {
    faces(level) + 2
}

struct Sponge {
    level: u32,
    /// Unit cubes along an edge: 3^level.
    side: usize,
    /// For each coordinate, bit k says that its k-th ternary digit is 1, a middle.
    middles: Vec<u8>,
}

impl Sponge {
    fn new(level: u32) -> Self {
        let side = 3usize.pow(level);
        let digit = |x: usize, k: u32| x / 3usize.pow(k) % 3;
        let middles = |x: usize| (0..level).fold(0, |bits, k| bits | u8::from(digit(x, k) == 1) << k);
        Self { level, side, middles: (0..side).map(middles).collect() }
    }

    /// Whether the unit cube is there: at no scale is it in the middle of two axes. Coordinates
    /// are one more than the cube's, so that 0 and `side + 1` are outside.
    fn solid(&self, at: [usize; 3]) -> bool {
        let inside = |x: usize| x.checked_sub(1).and_then(|x| self.middles.get(x)).copied();
        match at.map(inside) {
            [Some(x), Some(y), Some(z)] => (x & y) | (y & z) | (z & x) == 0,
            _ => false,
        }
    }

    /// The faces of one layer of cubes after the other. Progress runs to `bytes`.
    fn mesh(&self, bytes: u64, cx: &LoadCx) -> Result<Mesh, Reason> {
        let mut mesh = Mesh { name: "sponge".into(), material: Some(0), ..Mesh::default() };
        mesh.positions.reserve_exact(vertices(self.level));
        mesh.triangles.reserve_exact(2 * faces(self.level));
        let mut corners = Corners::new(self.side);
        for z in 1..=self.side {
            cx.cancel.check()?;
            for (y, x) in (1..=self.side).flat_map(|y| (1..=self.side).map(move |x| (y, x))) {
                if self.solid([x, y, z]) {
                    self.cube([x, y, z], &mut corners, &mut mesh);
                }
            }
            corners.next_layer();
            cx.progress.advance(bytes / self.side as u64);
        }
        Ok(mesh)
    }

    /// Adds the faces of a cube that nothing stands before.
    fn cube(&self, at: [usize; 3], corners: &mut Corners, mesh: &mut Mesh) {
        for axis in 0..3 {
            for side in 0..2 {
                let mut before = at;
                before[axis] = at[axis] + 2 * side - 1;
                if self.solid(before) {
                    continue;
                }
                let quad = FACE.map(|[i, j]| {
                    let mut corner = at.map(|x| x - 1);
                    corner[axis] += side;
                    corner[(axis + 1) % 3] += i;
                    corner[(axis + 2) % 3] += j;
                    corners.vertex(corner, &mut mesh.positions)
                });
                let [a, b, c, d] = if side == 1 { quad } else { [quad[0], quad[3], quad[2], quad[1]] };
                mesh.triangles.extend([[a, b, c], [a, c, d]]);
            }
        }
    }
}

/// The corners of a face along the two other axes, anticlockwise seen from outside the upper side.
const FACE: [[usize; 2]; 4] = [[0, 0], [1, 0], [1, 1], [0, 1]];

/// The vertices made so far that the present layer of cubes can share: those of its lower and its
/// upper side. Two layers are enough, as cubes are visited in the order of z.
struct Corners {
    side: usize,
    /// The z of the lower side.
    z: usize,
    layers: [Vec<Option<u32>>; 2],
}

impl Corners {
    fn new(side: usize) -> Self {
        let layer = || vec![None; (side + 1) * (side + 1)];
        Self { side, z: 0, layers: [layer(), layer()] }
    }

    /// The upper side becomes the lower.
    fn next_layer(&mut self) {
        self.z += 1;
        self.layers.swap(0, 1);
        self.layers[1].fill(None);
    }

    /// The vertex at these whole coordinates, in the cube from -1 to 1.
    fn vertex(&mut self, [x, y, z]: [usize; 3], positions: &mut Vec<Vec3>) -> u32 {
        let side = self.side;
        *self.layers[z - self.z][y * (side + 1) + x].get_or_insert_with(|| {
            let place = |i: usize| num::narrow(2.0 * i as f64 / side as f64 - 1.0);
            positions.push(Vec3::new(place(x), place(y), place(z)));
            num::index(positions.len() - 1)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_level_has_as_many_faces_as_foretold() {
        for level in 0..4 {
            let cx = LoadCx::unattended();
            let mesh = Sponge::new(level).mesh(0, &cx).expect("nothing stands against it");
            assert_eq!(mesh.triangles.len(), 2 * faces(level));
            assert!(mesh.positions.len() <= vertices(level), "{level}: {}", mesh.positions.len());
            // Closed and outward: by the divergence theorem the faces give the volume.
            let volume = |t: &[u32; 3]| {
                let [a, b, c] = t.map(|i| mesh.positions[i as usize].as_dvec3());
                a.dot(b.cross(c)) / 6.0
            };
            let whole: f64 = mesh.triangles.iter().map(volume).sum();
            assert!((whole / 8.0 - (20.0f64 / 27.0).powi(level.cast_signed())).abs() < 1e-5, "{level}: {whole}");
        }
    }
}
