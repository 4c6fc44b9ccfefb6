//! What of a scene's images is seen at all.

use super::pack::Wanted;
use crate::scene::{Alpha, Mesh, Scene};

/// For each material, whether its textures show: whether a mesh of it is placed and has texture
/// coordinates.
pub(in crate::scene) fn shown_materials(scene: &Scene) -> Vec<bool> {
    let mut shown = vec![false; scene.materials.len()];
    for instance in &scene.instances {
        let mesh: Option<&Mesh> = scene.meshes.get(instance.mesh).filter(|mesh| !mesh.uvs.is_empty());
        if let Some(shown) = mesh.and_then(|mesh| mesh.material).and_then(|m| shown.get_mut(m)) {
            *shown = true;
        }
    }
    shown
}

/// For each image, what is read of it; `None` if nothing is.
pub(super) fn wanted(scene: &Scene) -> Vec<Option<Wanted>> {
    let mut wanted: Vec<Option<Wanted>> = vec![None; scene.images.len()];
    let shown = shown_materials(scene);
    for (material, _) in scene.materials.iter().zip(shown).filter(|(_, shown)| *shown) {
        let of_color = material.base_color_texture.and_then(|texture| wanted.get_mut(texture.image));
        if let Some(image) = of_color {
            image.get_or_insert_default().color = true;
        }
        let Some(of_alpha) = material.alpha_texture.filter(|_| material.alpha != Alpha::Opaque) else { continue };
        if let Some(image) = wanted.get_mut(of_alpha.texture.image) {
            let channels = &mut image.get_or_insert_default().channels;
            if !channels.contains(&of_alpha.channel) {
                channels.push(of_alpha.channel);
            }
        }
    }
    wanted
}
