//! glTF 2.0 (Khronos Group, ISO/IEC 12113:2022), as text and as GLB.
//!
//! The JSON is read into the types of the `gltf` crate, but nothing else of it is used: its
//! validation and its readers index with numbers from the file before they are checked, and panic
//! on a wrong one; they also refuse files that lack what we do not need. So every reference is
//! followed here with `get`, and every accessor is measured against the bytes that are there.

mod accessor;
mod buffers;
mod cameras;
mod container;
mod document;
mod extensions;
mod images;
mod lights;
mod materials;
mod nodes;
mod picked;
mod primitive;
mod repeats;
mod textures;
mod uri;

use std::ops::Range;

use super::{Loader, Siblings, mesh_bytes};
use crate::scene::texture::shown_materials;
use crate::scene::{FirstView, Instance, Keep, LoadCx, Material, Reason, Scene};
use buffers::Buffers;
use glam::Vec3;
use gltf::json::Root;
use primitive::Primitives;

/// The reader of `.gltf` and `.glb` files; which of the two it is, the bytes say.
pub(super) struct Gltf;

impl Loader for Gltf {
    fn id(&self) -> &'static str {
        "gltf"
    }

    fn extensions(&self) -> &'static [&'static str] {
        &["gltf", "glb"]
    }

    fn load(&self, bytes: &[u8], files: &dyn Siblings, cx: &LoadCx) -> Result<Scene, Reason> {
        let parts = container::open(bytes)?;
        let (root, _memory) = document::parse(parts.json, cx)?;
        let mut warnings = extensions::check(&root)?;
        let buffers = Buffers::new(&root, parts.bin, files, cx)?;
        let nodes::Walked { placements, camera, lights, _memory } = nodes::walk(&root, &buffers, &mut warnings, cx)?;
        let camera = camera.map(FirstView::Stored);
        let _materials = cx.budget.charge((root.materials.len() * size_of::<Material>()) as u64)?;
        let mut scene = Scene { materials: materials::all(&root), lights, up: Vec3::Y, camera, warnings, ..Scene::default() };
        let meshes = meshes(&root, &buffers, &placements, &mut scene, cx)?;
        let mut memory = cx.budget.charge(0)?;
        for (mesh, world_from_object) in placements {
            let of_mesh = meshes.get(mesh).cloned().unwrap_or_default();
            // Many nodes times many primitives are more than the file is long.
            memory.grow((of_mesh.len() * size_of::<Instance>()) as u64)?;
            scene.instances.extend(of_mesh.map(|mesh| Instance { mesh, world_from_object }));
        }
        if root.nodes.is_empty() && !scene.instances.is_empty() {
            scene.warnings.push("The file places its meshes nowhere; each is shown once, where it is.".to_owned());
        }
        scene.warnings.extend(textures::sentence(&root, &shown_materials(&scene)));
        images::Images { root: &root, buffers: &buffers, files, cx }.take(&mut scene)?;
        Ok(scene)
    }
}

/// Reads the meshes that are placed anywhere, unless all are to be kept. Returns which meshes of the scene each glTF mesh
/// became: one for each primitive that has triangles.
fn meshes(
    root: &Root,
    buffers: &Buffers,
    placements: &[nodes::Placement],
    scene: &mut Scene,
    cx: &LoadCx,
) -> Result<Vec<Range<usize>>, Reason> {
    let mut placed = vec![cx.keep == Keep::All; root.meshes.len()];
    for (mesh, _) in placements {
        placed[*mesh] = true;
    }
    let mut memory = cx.budget.charge(0)?;
    cx.progress.start("meshes", vertices_and_corners(root, &placed).saturating_mul(12));
    let mut primitives = Primitives::new(root, buffers, cx);
    let mut ranges = Vec::with_capacity(root.meshes.len());
    for (index, mesh) in root.meshes.iter().enumerate() {
        let first = scene.meshes.len();
        for (p, primitive) in mesh.primitives.iter().enumerate().filter(|_| placed[index]) {
            cx.cancel.check()?;
            if let Some(mesh) = primitives.load(index, p, primitive)? {
                memory.grow(mesh_bytes(&mesh))?;
                scene.meshes.push(mesh);
            }
        }
        ranges.push(first..scene.meshes.len());
    }
    scene.warnings.extend(primitives.warnings());
    Ok(ranges)
}

/// How much there is to do, for the progress: as the file claims it.
fn vertices_and_corners(root: &Root, placed: &[bool]) -> u64 {
    let meshes = root.meshes.iter().zip(placed).filter(|(_, placed)| **placed);
    let accessors = meshes.flat_map(|(m, _)| &m.primitives).flat_map(|p| p.attributes.values().chain(&p.indices));
    accessors.filter_map(|index| root.get(*index)).fold(0, |sum: u64, accessor| sum.saturating_add(accessor.count.0))
}

#[cfg(test)]
mod tests;
