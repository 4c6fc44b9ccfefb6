//! The Utah teapot (Martin Newell, 1975): 32 bicubic Bezier patches, z up.
//!
//! The data hold ten patches. Rim, body, lid and bottom are solids of revolution, of which a
//! quarter is stored; handle and spout are stored by half. Neighbouring patches share the control
//! points of their common edge, so their vertices there are equal to the bit ([`Patch::point`]).

use super::bezier::{Fraction, Patch};
use super::fill::{Sizes, extend, fill};
use super::view;
use crate::geometry::num;
use crate::scene::{Instance, LoadCx, Material, Mesh, Reason, Scene};
use glam::{DVec3, Vec3};

const DATA: &str = include_str!("../../../assets/utah_teapot.txt");

/// The teapot alone.
pub(super) fn generate(triangles: usize, cx: &LoadCx) -> Result<Scene, Reason> {
    let cuts = cuts(triangles);
    let _memory = sizes(cuts).begin(cx)?;
    Ok(Scene {
        meshes: vec![mesh(cuts, cx)?],
        instances: vec![Instance::identity(0)],
        materials: vec![material()],
        up: Vec3::Z,
        camera: Some(view(Vec3::new(0.2, 0.0, 1.4), Vec3::new(3.2, -7.2, 3.4))),
        ..Scene::default()
    })
}

/// Glazed stoneware.
pub(super) fn material() -> Material {
    Material { name: "stoneware".into(), base_color: [0.42, 0.55, 0.56, 1.0], ..Material::PLAIN }
}

/// Into how many pieces to cut each edge of a patch, to come nearest to this number of triangles. At
/// least two: with one, handle and spout fall flat.
pub(super) fn cuts(triangles: usize) -> u32 {
    let below = num::floor_index((triangles as f64 / 64.0).sqrt(), 1 << 12).max(2);
    let nearest = (below..below + 2).min_by_key(|n| count(*n).abs_diff(triangles));
    num::index(nearest.unwrap_or(below))
}

/// Two triangles for each cell of each patch; one where lid and bottom (eight patches) come to a
/// point.
fn count(cuts: usize) -> usize {
    64 * cuts * cuts - 8 * cuts
}

/// What [`mesh`] will hold.
pub(super) fn sizes(cuts: u32) -> Sizes {
    let cuts = cuts as usize;
    let vertices = 32 * (cuts + 1) * (cuts + 1);
    Sizes { vertices, normals: vertices, triangles: count(cuts), ..Sizes::default() }
}

/// The teapot, 6.4 units long, standing on z = 0; material 0.
pub(super) fn mesh(cuts: u32, cx: &LoadCx) -> Result<Mesh, Reason> {
    let patches = patches();
    let side = cuts as usize + 1;
    let fraction = |i: usize| Fraction { i: num::index(i), n: cuts };
    let place = |k: usize| (&patches[k / (side * side)], fraction(k / side % side), fraction(k % side));
    let vertices = patches.len() * side * side;
    let positions = fill(vertices, cx, |k| {
        let (patch, u, v) = place(k);
        patch.point(u, v)
    })?;
    let normals = fill(vertices, cx, |k| {
        let (patch, u, v) = place(k);
        patch.normal(u, v)
    })?;
    let mut triangles = Vec::with_capacity(count(side - 1));
    for (p, patch) in patches.iter().enumerate() {
        // In the first row of cells of a patch that begins in a point, the upper triangle of each
        // has no area.
        let skipped = if patch.begins_in_a_point() { side - 1 } else { 0 };
        let number = 2 * (side - 1) * (side - 1) - skipped;
        extend(&mut triangles, number, cx, |k| {
            let k = if k < skipped { 2 * k } else { k + skipped };
            triangle(p * side * side, side, k)
        })?;
    }
    Ok(Mesh { name: "teapot".into(), positions, triangles, normals, material: Some(0), ..Mesh::default() })
}

/// The `k`-th triangle of a patch: the even ones are the lower halves of the cells.
///
/// ```text
///     first + i*side + j      a---b      v to the right, u down
///                             | \ |
///                             c---d
/// ```
fn triangle(first: usize, side: usize, k: usize) -> [u32; 3] {
    let (i, j) = (k / 2 / (side - 1), k / 2 % (side - 1));
    let a = first + i * side + j;
    let (b, c, d) = (a + 1, a + side, a + side + 1);
    if k.is_multiple_of(2) { [a, c, d] } else { [a, d, b] }.map(num::index)
}

/// All 32 patches, each with its outer side where [`Patch::normal`] points.
fn patches() -> Vec<Patch> {
    let mut all = Vec::new();
    for (name, patch) in stored() {
        if name == "handle" || name == "spout" {
            all.extend([patch, patch.map(|p| DVec3::new(p.x, -p.y, p.z)).turned_over()]);
        } else {
            let quarters = std::iter::successors(Some(patch), |q| Some(q.map(|p| DVec3::new(-p.y, p.x, p.z))));
            all.extend(quarters.take(4));
        }
    }
    all
}

/// The ten patches of the data. In Newell's numbers the lid begins in a loop 0.002 across rather
/// than in a point, and four loops cannot meet; it is drawn together here. His rows run clockwise,
/// which puts the outside where [`Patch::normal`] does not point, so they are turned over.
fn stored() -> Vec<(&'static str, Patch)> {
    let rows = |kind: &'static str| DATA.lines().filter_map(move |line| line.strip_prefix(kind));
    let number = |word: &str| word.parse::<f64>().unwrap_or(f64::NAN);
    let points: Vec<DVec3> = rows("v ")
        .map(|line| {
            let mut words = line.split_whitespace().map(number);
            DVec3::from_array(std::array::from_fn(|_| words.next().unwrap_or(f64::NAN)))
        })
        .collect();
    rows("p ")
        .map(|line| {
            let (name, indices) = line.split_once(' ').unwrap_or((line, ""));
            let mut indices = indices.split_whitespace().filter_map(|word| word.parse::<usize>().ok());
            let mut next = || indices.next().and_then(|i| points.get(i)).copied().unwrap_or(DVec3::NAN);
            let mut patch = std::array::from_fn(|_| std::array::from_fn(|_| next()));
            if patch[0][0] == patch[0][3] {
                patch[0] = [patch[0][0]; 4];
            }
            (name, Patch(patch).turned_over())
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Aabb;
    use std::collections::HashMap;

    fn made(cuts: u32) -> Mesh {
        mesh(cuts, &LoadCx::unattended()).expect("nothing stands against it")
    }

    #[test]
    fn the_data_are_whole() {
        let patches = patches();
        assert_eq!(patches.len(), 32);
        assert!(patches.iter().flat_map(|p| p.0.as_flattened()).all(|p| p.is_finite()));
        assert_eq!(patches.iter().filter(|p| p.begins_in_a_point()).count(), 8);
        let bounds = Aabb::of_points(made(10).positions);
        assert_eq!((bounds.min.z, bounds.max.z), (0.0, 3.15));
    }

    #[test]
    fn the_number_of_triangles_is_the_nearest() {
        assert_eq!([1, 56, 6_320, 10_000_000].map(cuts), [2, 2, 10, 395]);
        for n in [2, 3, 9] {
            assert_eq!(made(n).triangles.len(), count(n as usize));
        }
    }

    /// Each edge inside is used once in either direction; what is left are the open borders: lid
    /// and rim (a circle each), and both ends of handle and spout. So it is for edges as bits.
    #[test]
    fn it_is_open_only_where_the_teapot_is() {
        let n = 9;
        let mesh = made(n);
        let mut edges: HashMap<[[u32; 3]; 2], i32> = HashMap::new();
        for triangle in &mesh.triangles {
            let p = triangle.map(|i| mesh.positions[i as usize].to_array().map(f32::to_bits));
            for (a, b) in [(0, 1), (1, 2), (2, 0)] {
                *edges.entry([p[a], p[b]]).or_default() += 1;
                *edges.entry([p[b], p[a]]).or_default() -= 1;
            }
        }
        let open = edges.values().filter(|balance| **balance > 0).count();
        assert!(edges.values().all(|balance| balance.abs() <= 1));
        assert_eq!(open, (4 + 4 + 4 * 2) * n as usize);
    }

    #[test]
    fn normals_are_unit_smooth_and_outward() {
        let mesh = made(10);
        assert!(mesh.normals.iter().all(|n| (n.length() - 1.0).abs() < 1e-5));
        for triangle in &mesh.triangles {
            let [a, b, c] = triangle.map(|i| mesh.positions[i as usize]);
            let flat = (b - a).cross(c - a).normalize_or_zero();
            for i in triangle {
                assert!(flat.dot(mesh.normals[*i as usize]) > 0.3, "{a} {b} {c}: {}", mesh.normals[*i as usize]);
            }
        }
        // Four patches each: rim, body (two), lid (two), bottom, handle, spout. None is closed,
        // but all bulge away from the middle of the pot.
        let middle = Vec3::Z;
        for part in mesh.triangles.chunk_by(|a, b| a[0] / (4 * 121) == b[0] / (4 * 121)) {
            let corners = part.iter().map(|t| t.map(|i| mesh.positions[i as usize] - middle));
            assert!(corners.map(|[a, b, c]| a.dot(b.cross(c))).sum::<f32>() > 0.0);
        }
    }
}
