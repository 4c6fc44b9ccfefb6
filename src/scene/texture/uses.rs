//! What of a scene's images is seen at all.

use super::pack::Wanted;
use super::texels::Channel;
use crate::scene::{Alpha, Material, Mesh, Scene};

/// How much of the looks of surfaces is read from images.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Detail {
    /// Colour and opacity: enough for a picture shaded by the direction that surfaces face.
    #[default]
    Colors,
    /// What paths of light need besides: where surfaces are metallic, rough or clear, which way they face, what they
    /// send out.
    Light,
}

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

/// How many images are decoded for colour and opacity.
pub(in crate::scene) fn color_images(scene: &Scene) -> usize {
    wanted(scene, Detail::Colors).iter().flatten().count()
}

/// For each image, what is read of it; `None` if nothing is.
pub(super) fn wanted(scene: &Scene, detail: Detail) -> Vec<Option<Wanted>> {
    let mut reads = Reads(vec![None; scene.images.len()]);
    let shown = shown_materials(scene);
    for (material, _) in scene.materials.iter().zip(shown).filter(|(_, shown)| *shown) {
        reads.colors(material);
        if detail == Detail::Light {
            reads.light(material);
        }
    }
    reads.0
}

/// What is read, by image.
struct Reads(Vec<Option<Wanted>>);

impl Reads {
    fn of(&mut self, image: usize) -> Option<&mut Wanted> {
        Some(self.0.get_mut(image)?.get_or_insert_default())
    }

    fn color(&mut self, image: usize) {
        if let Some(wanted) = self.of(image) {
            wanted.color = true;
        }
    }

    fn channel(&mut self, image: usize, channel: Channel) {
        if let Some(wanted) = self.of(image).filter(|wanted| !wanted.channels.contains(&channel)) {
            wanted.channels.push(channel);
        }
    }

    fn colors(&mut self, material: &Material) {
        if let Some(texture) = material.base_color_texture {
            self.color(texture.image);
        }
        if let Some(alpha) = material.alpha_texture.filter(|_| material.alpha != Alpha::Opaque) {
            self.channel(alpha.texture.image, alpha.channel);
        }
    }

    fn light(&mut self, material: &Material) {
        if let Some(texture) = material.emission_texture {
            self.color(texture.image);
        }
        for value in material.surface_values() {
            self.channel(value.texture.image, value.channel);
        }
        if let Some(normal) = material.normal_texture {
            for channel in [Channel::Red, Channel::Green, Channel::Blue] {
                self.channel(normal.texture.image, channel);
            }
        }
    }
}
