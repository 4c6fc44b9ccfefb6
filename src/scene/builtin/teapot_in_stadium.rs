//! The teapot in a stadium: the classic that a uniform grid fails at, since the whole teapot falls
//! into one of its cells (Haines 1988, "Spline surface rendering, and what's wrong with octrees",
//! Ray Tracing News 1). The stadium is about a thousand times as large as the teapot.

use super::stadium::{self, Stadium};
use super::teapot;
use crate::scene::{Camera, FirstView, Instance, LoadCx, Material, Mesh, Projection, Reason, Scene};
use glam::{Affine3A, Vec3};

/// Metres from the field to the top of the plinth on which the teapot stands.
const PLINTH: f32 = 0.9;

/// Metres in a unit of the teapot: 0.29 from handle to spout.
const SCALE: f32 = 0.045;

/// A fifth of the triangles, but not more than these, make the stadium.
const STADIUM: usize = 4_000;

/// About so many triangles.
pub(super) fn generate(triangles: usize, cx: &LoadCx) -> Result<Scene, Reason> {
    let stadium = Stadium::of((triangles / 5).min(STADIUM));
    let around = stadium.triangles() + 2 * PLINTH_FACES.len();
    let cuts = teapot::cuts(triangles.saturating_sub(around));
    let mut sizes = teapot::sizes(cuts);
    sizes.triangles += around;
    sizes.vertices += stadium.vertices() + 4 * PLINTH_FACES.len();
    let _memory = sizes.begin(cx)?;
    let mut meshes = vec![teapot::mesh(cuts, cx)?, plinth()];
    meshes.extend(stadium.meshes(2));
    let mut instances: Vec<Instance> = (0..meshes.len()).map(Instance::identity).collect();
    // A millimetre above the plinth: they would touch in a single point.
    let foot = Vec3::Z * (PLINTH + 0.001);
    instances[0].world_from_object = Affine3A::from_translation(foot) * Affine3A::from_scale(Vec3::splat(SCALE));
    let marble = Material { name: "marble".into(), base_color: [0.62, 0.60, 0.56, 1.0], ..Material::PLAIN };
    Ok(Scene {
        meshes,
        instances,
        materials: [teapot::material(), marble].into_iter().chain(Stadium::materials()).collect(),
        up: Vec3::Z,
        camera: Some(FirstView::From(camera())),
        ..Scene::default()
    })
}

/// Close to the teapot, low enough to have the terraces behind it.
fn camera() -> Camera {
    let target = Vec3::new(0.0, 0.0, PLINTH + 0.09);
    let projection = Projection::Perspective { fov_y: 45f32.to_radians() };
    Camera { eye: target + Vec3::new(0.22, -0.50, 0.07), target, up: Vec3::Z, projection }
}

/// The four sides and the top, as corners of the unit cube: bit k picks the upper end of axis k.
const PLINTH_FACES: [[u8; 4]; 5] = [[0, 1, 5, 4], [1, 3, 7, 5], [3, 2, 6, 7], [2, 0, 4, 6], [4, 5, 7, 6]];

fn plinth() -> Mesh {
    let mut mesh = Mesh { name: "plinth".into(), material: Some(1), ..Mesh::default() };
    let pick = |bits: u8, k: u8| f32::from(bits >> k & 1);
    let corner = |bits: u8| Vec3::new(pick(bits, 0) - 0.5, pick(bits, 1) - 0.5, pick(bits, 2)) * Vec3::new(0.4, 0.4, PLINTH);
    for face in PLINTH_FACES {
        stadium::quad(&mut mesh, face.map(corner));
    }
    mesh
}
