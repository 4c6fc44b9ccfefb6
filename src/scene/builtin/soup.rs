//! Triangles thrown into a cube: no surface, no order, the worst case that still is even. Each is
//! about as large as the space it has, so that any number of them fills the cube alike.

use super::fill::{Sizes, fill};
use super::random::Random;
use super::view;
use crate::geometry::num;
use crate::scene::{Instance, LoadCx, Material, Mesh, Reason, Scene};
use glam::Vec3;

const SEED: u64 = 0x736F_7570;

/// Exactly so many triangles in the cube from -1 to 1 (a little over its sides).
pub(super) fn generate(triangles: usize, cx: &LoadCx) -> Result<Scene, Reason> {
    let _memory = Sizes { vertices: 3 * triangles, triangles, ..Sizes::default() }.begin(cx)?;
    let radius = num::narrow(2.0 / (triangles as f64).cbrt());
    let positions = fill(triangles, cx, |i| triangle(i, radius))?.into_flattened();
    let triangles = fill(triangles, cx, |i| [3 * i, 3 * i + 1, 3 * i + 2].map(num::index))?;
    Ok(Scene {
        meshes: vec![Mesh { name: "soup".into(), positions, triangles, material: Some(0), ..Mesh::default() }],
        instances: vec![Instance::identity(0)],
        materials: vec![Material { name: "ochre".into(), base_color: [0.58, 0.43, 0.24, 1.0], ..Material::PLAIN }],
        up: Vec3::Z,
        camera: Some(view(Vec3::ZERO, Vec3::new(2.6, -4.2, 2.2))),
        ..Scene::default()
    })
}

/// Three corners within `radius` of a random point of the cube.
fn triangle(i: usize, radius: f32) -> [Vec3; 3] {
    let mut random = Random::new(SEED, i);
    let centre = Vec3::from_array(std::array::from_fn(|_| random.between(-1.0, 1.0)));
    std::array::from_fn(|_| centre + radius * random.in_ball())
}
