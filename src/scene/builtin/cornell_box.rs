//! The Cornell box, as measured (Cornell University Program of Computer Graphics, "Cornell Box
//! Data", 1998): no corner is quite square, and no wall quite flat. Here in metres.

use super::fill::{Sizes, extend};
use crate::geometry::num;
use crate::scene::{Camera, FirstView, Instance, LoadCx, Material, Mesh, Projection, Reason, Scene};
use glam::{DVec3, Vec3};

/// Four corners in tenths of millimetres, which is what the measurements come in: whole numbers,
/// with which points between are exact up to one rounding at the end.
type Quad = [[i32; 3]; 4];

struct Surface {
    name: &'static str,
    color: [f32; 4],
    quads: &'static [Quad],
}

/// The ceiling is stored as a whole and the light in its plane; here it is a frame around the
/// light, so that no two surfaces coincide.
#[rustfmt::skip]
static SURFACES: [Surface; 4] = [
    Surface { name: "white", color: [0.725, 0.710, 0.680, 1.0], quads: &[
        // Floor and back wall.
        [[5528, 0, 0], [0, 0, 0], [0, 0, 5592], [5496, 0, 5592]],
        [[5496, 0, 5592], [0, 0, 5592], [0, 5488, 5592], [5560, 5488, 5592]],
        // Ceiling: front, left, back, right.
        [[5560, 5488, 0], [3430, 5488, 2270], [2130, 5488, 2270], [0, 5488, 0]],
        [[5560, 5488, 5592], [3430, 5488, 3320], [3430, 5488, 2270], [5560, 5488, 0]],
        [[0, 5488, 5592], [2130, 5488, 3320], [3430, 5488, 3320], [5560, 5488, 5592]],
        [[0, 5488, 0], [2130, 5488, 2270], [2130, 5488, 3320], [0, 5488, 5592]],
        // Short block.
        [[1300, 1650, 650], [820, 1650, 2250], [2400, 1650, 2720], [2900, 1650, 1140]],
        [[2900, 0, 1140], [2900, 1650, 1140], [2400, 1650, 2720], [2400, 0, 2720]],
        [[1300, 0, 650], [1300, 1650, 650], [2900, 1650, 1140], [2900, 0, 1140]],
        [[820, 0, 2250], [820, 1650, 2250], [1300, 1650, 650], [1300, 0, 650]],
        [[2400, 0, 2720], [2400, 1650, 2720], [820, 1650, 2250], [820, 0, 2250]],
        // Tall block.
        [[4230, 3300, 2470], [2650, 3300, 2960], [3140, 3300, 4560], [4720, 3300, 4060]],
        [[4230, 0, 2470], [4230, 3300, 2470], [4720, 3300, 4060], [4720, 0, 4060]],
        [[4720, 0, 4060], [4720, 3300, 4060], [3140, 3300, 4560], [3140, 0, 4560]],
        [[3140, 0, 4560], [3140, 3300, 4560], [2650, 3300, 2960], [2650, 0, 2960]],
        [[2650, 0, 2960], [2650, 3300, 2960], [4230, 3300, 2470], [4230, 0, 2470]],
    ] },
    Surface { name: "red", color: [0.570, 0.043, 0.044, 1.0], quads: &[
        [[5528, 0, 0], [5496, 0, 5592], [5560, 5488, 5592], [5560, 5488, 0]],
    ] },
    Surface { name: "green", color: [0.105, 0.378, 0.076, 1.0], quads: &[
        [[0, 0, 5592], [0, 0, 0], [0, 5488, 0], [0, 5488, 5592]],
    ] },
    Surface { name: LIGHT, color: [1.0, 0.93, 0.78, 1.0], quads: &[
        [[3430, 5488, 2270], [3430, 5488, 3320], [2130, 5488, 3320], [2130, 5488, 2270]],
    ] },
];

/// The surface that shines.
const LIGHT: &str = "light";
/// What it sends out, as it is usually rendered: its measured spectrum, brought to red, green and blue.
const RADIANCE: [f32; 3] = [17.0, 12.0, 4.0];

const TENTHS_PER_METRE: f64 = 10_000.0;

/// The box with every quad cut into so many by so many.
pub(super) fn generate(triangles: usize, cx: &LoadCx) -> Result<Scene, Reason> {
    let quads: usize = SURFACES.iter().map(|surface| surface.quads.len()).sum();
    let cuts = num::floor_index((triangles as f64 / (2 * quads) as f64).sqrt() + 0.5, 1 << 12).max(1);
    let (vertices, triangles) = (quads * (cuts + 1) * (cuts + 1), quads * 2 * cuts * cuts);
    let _memory = Sizes { vertices, triangles, ..Sizes::default() }.begin(cx)?;
    let mut meshes = Vec::new();
    for (i, surface) in SURFACES.iter().enumerate() {
        meshes.push(surface.mesh(i, cuts, cx)?);
    }
    Ok(Scene {
        instances: (0..meshes.len()).map(Instance::identity).collect(),
        meshes,
        materials: SURFACES.iter().map(Surface::material).collect(),
        up: Vec3::Y,
        camera: Some(FirstView::From(camera())),
        ..Scene::default()
    })
}

/// As published: a lens of 35 mm before a square of 25 mm.
fn camera() -> Camera {
    let fov_y = 2.0 * (0.025f32 / 2.0 / 0.035).atan();
    let eye = Vec3::new(0.278, 0.273, -0.8);
    Camera { eye, target: eye.with_z(0.28), up: Vec3::Y, projection: Projection::Perspective { fov_y } }
}

impl Surface {
    fn mesh(&self, material: usize, cuts: usize, cx: &LoadCx) -> Result<Mesh, Reason> {
        let side = cuts + 1;
        let mut positions = Vec::with_capacity(self.quads.len() * side * side);
        let mut triangles = Vec::with_capacity(self.quads.len() * 2 * cuts * cuts);
        for (q, quad) in self.quads.iter().enumerate() {
            extend(&mut positions, side * side, cx, |k| between(quad, k % side, k / side, cuts))?;
            extend(&mut triangles, 2 * cuts * cuts, cx, |k| {
                let a = q * side * side + (k / 2 / cuts) * side + k / 2 % cuts;
                if k.is_multiple_of(2) { [a, a + 1, a + side + 1] } else { [a, a + side + 1, a + side] }.map(num::index)
            })?;
        }
        Ok(Mesh { name: self.name.into(), positions, triangles, material: Some(material), ..Mesh::default() })
    }

    fn material(&self) -> Material {
        let emission = if self.name == LIGHT { RADIANCE } else { [0.0; 3] };
        Material { name: self.name.into(), base_color: self.color, emission, ..Material::PLAIN }
    }
}

/// The point `i / n` along the first edge and `j / n` across. All products and sums are of whole
/// numbers below 2^53, hence exact: two quads with a common edge agree on it to the bit.
fn between(quad: &Quad, i: usize, j: usize, n: usize) -> Vec3 {
    let [a, b, c, d] = quad.map(|p| DVec3::from_array(p.map(f64::from)));
    let (i, j, n) = (i as f64, j as f64, n as f64);
    let near = a * (n - i) + b * i;
    let far = d * (n - i) + c * i;
    ((near * (n - j) + far * j) / (n * n * TENTHS_PER_METRE)).as_vec3()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The `n + 1` points of an edge of a quad, from corner `e` to the next.
    fn edge(quad: &Quad, e: usize, n: usize) -> Vec<Vec3> {
        let place = |k: usize| [(k, 0), (n, k), (n - k, n), (0, n - k)][e];
        (0..=n).map(place).map(|(i, j)| between(quad, i, j, n)).collect()
    }

    #[test]
    fn common_edges_agree_to_the_bit() {
        let quads: Vec<&Quad> = SURFACES.iter().flat_map(|surface| surface.quads).collect();
        let edges: Vec<(&Quad, usize)> = quads.iter().flat_map(|quad| (0..4).map(move |e| (*quad, e))).collect();
        let mut common = 0;
        for (i, (p, e)) in edges.iter().enumerate() {
            for (q, f) in &edges[i + 1..] {
                if [p[*e], p[(e + 1) % 4]] == [q[(f + 1) % 4], q[*f]] {
                    common += 1;
                    for n in [1, 3, 7, 100] {
                        let back: Vec<Vec3> = edge(q, *f, n).into_iter().rev().collect();
                        assert_eq!(edge(p, *e, n), back);
                    }
                }
            }
        }
        // Eight of each block (they stand open), of the walls, and of the frame around the light.
        assert_eq!(common, 32);
    }
}
