//! A ball of hair: long thin triangles in all directions. Their boxes are large and mostly empty
//! and overlap, which is what cutting primitives (spatial splits) is for.

use super::fill::{Sizes, extend, fill};
use super::random::Random;
use super::sphere;
use super::view;
use crate::geometry::num;
use crate::scene::{Instance, LoadCx, Material, Mesh, Reason, Scene};
use glam::Vec3;

const SEED: u64 = 0x6861_6972;

/// Quads along a strand.
const SEGMENTS: usize = 5;
const VERTICES: usize = 2 * (SEGMENTS + 1);
const TRIANGLES: usize = 2 * SEGMENTS;

/// The strands are dealt out to so many shades.
#[rustfmt::skip]
const SHADES: [(&str, [f32; 4]); 3] = [
    ("chestnut", [0.165, 0.085, 0.045, 1.0]),
    ("auburn", [0.255, 0.120, 0.055, 1.0]),
    ("straw", [0.400, 0.255, 0.125, 1.0]),
];

/// About so many triangles: a sphere of a fiftieth of them, and strands of ten.
pub(super) fn generate(triangles: usize, cx: &LoadCx) -> Result<Scene, Reason> {
    // In fives, so that the strands can make up any multiple of ten.
    let cuts = 5 * num::floor_index((triangles as f64 / 50.0 / 8.0).sqrt() / 5.0, 100);
    let scalp = sphere::triangles(cuts);
    let strands = ((triangles - scalp + TRIANGLES / 2) / TRIANGLES).max(1);
    let scalp_vertices = if cuts == 0 { 0 } else { sphere::vertices(cuts) };
    let sizes =
        Sizes { vertices: strands * VERTICES + scalp_vertices, triangles: strands * TRIANGLES + scalp, ..Sizes::default() };
    let _memory = sizes.begin(cx)?;
    let mut meshes = Vec::new();
    for shade in 0..SHADES.len().min(strands) {
        meshes.push(strands_of(shade, strands, cx)?);
    }
    if cuts > 0 {
        meshes.push(skin(num::index(cuts)));
    }
    let mut materials: Vec<Material> = SHADES.iter().map(|(name, color)| material(name, *color)).collect();
    materials.push(material("skin", [0.15, 0.085, 0.055, 1.0]));
    Ok(Scene {
        instances: (0..meshes.len()).map(Instance::identity).collect(),
        meshes,
        materials,
        up: Vec3::Z,
        camera: Some(view(Vec3::new(0.0, 0.0, -0.15), Vec3::new(2.2, -4.4, 1.9))),
        ..Scene::default()
    })
}

fn material(name: &str, base_color: [f32; 4]) -> Material {
    Material { name: name.into(), base_color, ..Material::PLAIN }
}

fn skin(cuts: u32) -> Mesh {
    let sphere::Sphere { points, triangles } = sphere::unit(cuts);
    Mesh { name: "skin".into(), positions: points, triangles, material: Some(SHADES.len()), ..Mesh::default() }
}

/// Every third strand.
fn strands_of(shade: usize, strands: usize, cx: &LoadCx) -> Result<Mesh, Reason> {
    let number = (strands - shade).div_ceil(SHADES.len());
    let width = (0.25 * spacing(strands)).min(0.02);
    let positions = fill(number, cx, |i| strand(i * SHADES.len() + shade, width))?.into_flattened();
    let mut triangles = Vec::with_capacity(number);
    extend(&mut triangles, number, cx, ribbon)?;
    let triangles = triangles.into_flattened();
    Ok(Mesh { name: SHADES[shade].0.into(), positions, triangles, material: Some(shade), ..Mesh::default() })
}

/// The distance between neighbouring roots on the unit sphere: each has 4 pi / n to itself.
fn spacing(strands: usize) -> f32 {
    num::narrow((4.0 * std::f64::consts::PI / strands as f64).sqrt())
}

/// A ribbon that leaves the sphere upright, whirls around the axis and hangs down: a parabola.
fn strand(i: usize, width: f32) -> [Vec3; VERTICES] {
    let mut random = Random::new(SEED, i);
    let root = random.direction();
    let length = random.between(0.55, 0.95);
    let stray = 0.35 * random.in_ball();
    let bend = (0.5 * Vec3::Z.cross(root) + stray) * length - Vec3::Z * 0.45 * length * length;
    let side = root.cross(random.direction()).normalize_or(root.any_orthonormal_vector());
    std::array::from_fn(|k| {
        let s = (k / 2) as f32 / SEGMENTS as f32;
        let middle = root * (0.995 + length * s * (1.0 - 0.35 * s)) + bend * s * s;
        let half = 0.5 * width * (1.0 - 0.85 * s);
        middle + side * if k.is_multiple_of(2) { -half } else { half }
    })
}

/// The triangles of the `i`-th ribbon of a mesh.
///
/// ```text
///     0---2---4--
///     | \ | \ |       root on the left
///     1---3---5--
/// ```
fn ribbon(i: usize) -> [[u32; 3]; TRIANGLES] {
    let first = num::index(i * VERTICES);
    std::array::from_fn(|k| {
        let a = first + 2 * num::index(k / 2);
        if k.is_multiple_of(2) { [a, a + 1, a + 3] } else { [a, a + 3, a + 2] }
    })
}
