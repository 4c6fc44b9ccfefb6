//! glTF materials, as far as the shaded mode needs them.

use gltf::json::material::{AlphaMode, Material as Json};
use gltf::json::{Root, validation::Checked};

use super::textures;
use crate::scene::texture::Channel;
use crate::scene::{Alpha, AlphaTexture, Material};

/// Every material of the document, in its order. Images are still given by their index in the
/// document.
pub(super) fn all(root: &Root) -> Vec<Material> {
    root.materials.iter().map(|json| material(root, json)).collect()
}

fn material(root: &Root, json: &Json) -> Material {
    let glossy = json.extensions.as_ref().and_then(|e| e.pbr_specular_glossiness.as_ref());
    let [r, g, b, a] = glossy.map_or(json.pbr_metallic_roughness.base_color_factor.0, |glossy| glossy.diffuse_factor.0);
    let (texture, alpha) = (textures::base_color(root, json), alpha(json));
    let seen_through = alpha != Alpha::Opaque;
    Material {
        name: json.name.clone().unwrap_or_default(),
        base_color: [r, g, b, if seen_through { a } else { 1.0 }],
        double_sided: json.double_sided,
        base_color_texture: texture,
        alpha_texture: texture.filter(|_| seen_through).map(|texture| AlphaTexture { texture, channel: Channel::Alpha }),
        alpha,
    }
}

/// What opacity does (glTF 2.0, section 3.9.4).
fn alpha(json: &Json) -> Alpha {
    match json.alpha_mode {
        Checked::Valid(AlphaMode::Mask) => Alpha::Mask { cutoff: json.alpha_cutoff.unwrap_or_default().0 },
        Checked::Valid(AlphaMode::Blend) => Alpha::Blend,
        _ => Alpha::Opaque,
    }
}

/// Whether alpha is to be passed over, in the factor as in vertex colours.
pub(super) fn is_opaque(json: &Json) -> bool {
    alpha(json) == Alpha::Opaque
}
