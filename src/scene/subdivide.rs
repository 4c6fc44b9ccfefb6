//! The same surface in four times as many triangles: each is cut at the middles of its edges.

use std::collections::HashMap;

use super::{LoadCx, Mesh, Reason, Scene};
use crate::geometry::num;
use glam::Vec3;

/// Cuts every triangle into four. Neighbours share the middle of their edge, as they share its ends.
/// What only shading needs (normals, texture coordinates, colours) is left out.
///
/// # Errors
/// Cancelled, over the memory budget, or more vertices than 32 bits can index.
pub fn subdivide(scene: &Scene, cx: &LoadCx) -> Result<Scene, Reason> {
    let meshes: Result<Vec<Mesh>, Reason> = scene.meshes.iter().map(|mesh| subdivide_mesh(mesh, cx)).collect();
    Ok(Scene { meshes: meshes?, ..scene_without_meshes(scene) })
}

fn scene_without_meshes(scene: &Scene) -> Scene {
    Scene {
        name: scene.name.clone(),
        meshes: Vec::new(),
        instances: scene.instances.clone(),
        materials: scene.materials.clone(),
        images: scene.images.clone(),
        lights: scene.lights.clone(),
        up: scene.up,
        camera: scene.camera,
        warnings: Vec::new(),
    }
}

/// Bytes for each triangle at most: three middles in the map, three vertices, four triangles.
const BYTES: u64 = 3 * 2 * 16 + 3 * 12 + 4 * 12;

/// Triangles between two looks at the cancel flag.
const CHUNK: usize = 1 << 14;

fn subdivide_mesh(mesh: &Mesh, cx: &LoadCx) -> Result<Mesh, Reason> {
    let most = mesh.positions.len() as u64 + 3 * mesh.triangles.len() as u64;
    if most > num::MAX_INDEX as u64 {
        return Err(Reason::TooLarge(most, "vertices"));
    }
    let _memory = cx.budget.charge(mesh.triangles.len() as u64 * BYTES)?;
    let mut positions = mesh.positions.clone();
    let mut triangles = Vec::with_capacity(4 * mesh.triangles.len());
    let mut middles: HashMap<(u32, u32), u32> = HashMap::new();
    for chunk in mesh.triangles.chunks(CHUNK) {
        cx.cancel.check()?;
        for [a, b, c] in chunk {
            let [ab, bc, ca] = [[a, b], [b, c], [c, a]].map(|[from, to]| middle(*from, *to, &mut middles, &mut positions));
            triangles.extend([[*a, ab, ca], [ab, *b, bc], [ca, bc, *c], [ab, bc, ca]]);
        }
    }
    Ok(Mesh { name: mesh.name.clone(), positions, triangles, material: mesh.material, ..Mesh::default() })
}

fn middle(a: u32, b: u32, middles: &mut HashMap<(u32, u32), u32>, positions: &mut Vec<Vec3>) -> u32 {
    *middles.entry((a.min(b), a.max(b))).or_insert_with(|| {
        positions.push(positions[a as usize] * 0.5 + positions[b as usize] * 0.5);
        num::index(positions.len() - 1)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::polygon;
    use crate::scene::Geometry;

    #[test]
    fn four_triangles_for_one_cover_the_same_and_share_their_middles() {
        let cx = LoadCx::unattended();
        let scene = crate::scene::open("builtin:cornell-box", &cx).expect("made in code");
        let finer = subdivide(&scene, &cx).expect("small");
        assert_eq!(finer.triangle_count(), 4 * scene.triangle_count());
        let of = |scene: &Scene| Geometry::new(scene, &cx).expect("small");
        let area = |g: &Geometry| (0..g.live_count()).map(|i| polygon::area(&g.corners(g.live(i)))).sum::<f64>();
        let (before, after) = (of(&scene), of(&finer));
        assert_eq!(before.world_bounds(), after.world_bounds());
        assert!((area(&after) / area(&before) - 1.0).abs() < 1e-6);
        let mesh = Mesh {
            positions: vec![Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::ONE],
            triangles: vec![[0, 1, 2], [2, 1, 3]],
            ..Mesh::default()
        };
        let finer = subdivide_mesh(&mesh, &cx).expect("small");
        assert_eq!((finer.positions.len(), finer.triangles.len()), (4 + 5, 8), "five edges");
    }
}
