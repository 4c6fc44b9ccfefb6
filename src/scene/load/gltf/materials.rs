//! glTF materials.

use gltf::json::material::{AlphaMode, Material as Json};
use gltf::json::{Root, validation::Checked};

use super::textures::Maps;
use crate::scene::load::unit;
use crate::scene::texture::{Channel, TextureUse};
use crate::scene::{Alpha, Material, NormalTexture, ValueTexture};

/// Every material of the document, in its order. Images are still given by their index in the
/// document.
pub(super) fn all(root: &Root) -> Vec<Material> {
    root.materials.iter().map(|json| material(root, json)).collect()
}

fn material(root: &Root, json: &Json) -> Material {
    let glossy = json.extensions.as_ref().and_then(|e| e.pbr_specular_glossiness.as_ref());
    let [r, g, b, a] = glossy.map_or(json.pbr_metallic_roughness.base_color_factor.0, |glossy| glossy.diffuse_factor.0);
    let (maps, alpha) = (Maps::of(root, json), alpha(json));
    let seen_through = alpha != Alpha::Opaque;
    let extensions = json.extensions.as_ref();
    // Glossiness is smoothness, and so not what an image of it could be multiplied by; what is specular there is left to the
    // index of refraction.
    let (metallic, roughness) = match glossy {
        Some(glossy) => (0.0, 1.0 - glossy.glossiness_factor.0),
        None => (json.pbr_metallic_roughness.metallic_factor.0, json.pbr_metallic_roughness.roughness_factor.0),
    };
    let transmission = extensions.and_then(|e| e.transmission.as_ref()).map_or(0.0, |t| t.transmission_factor.0);
    let strength = extensions.and_then(|e| e.emissive_strength.as_ref()).map_or(1.0, |e| e.emissive_strength.0);
    let ior = extensions.and_then(|e| e.ior.as_ref()).map_or(Material::PLAIN.ior, |e| e.ior.0);
    let emission = json.emissive_factor.0.map(|x| if (x * strength).is_finite() { (x * strength).max(0.0) } else { 0.0 });
    let value = |texture: Option<TextureUse>, channel: Channel| texture.map(|texture| ValueTexture { texture, channel });
    let normal_scale = json.normal_texture.as_ref().map(|normal| normal.scale).filter(|scale| scale.is_finite());
    Material {
        name: json.name.clone().unwrap_or_default(),
        base_color: [r, g, b, if seen_through { a } else { 1.0 }],
        double_sided: json.double_sided,
        base_color_texture: maps.base_color,
        alpha_texture: value(maps.base_color.filter(|_| seen_through), Channel::Alpha),
        alpha,
        metallic: unit(metallic),
        metallic_texture: value(maps.metallic_roughness.filter(|_| metallic > 0.0), Channel::Blue),
        roughness: unit(roughness),
        roughness_texture: value(maps.metallic_roughness.filter(|_| roughness > 0.0), Channel::Green),
        normal_texture: maps.normal.map(|texture| NormalTexture { texture, scale: normal_scale.unwrap_or(1.0) }),
        transmission: unit(transmission),
        transmission_texture: value(maps.transmission, Channel::Red),
        ior: if ior.is_finite() { ior.max(1.0) } else { Material::PLAIN.ior },
        // Where it shines is not known without the map: better nowhere than everywhere.
        emission: if maps.emission_left_out { [0.0; 3] } else { emission },
        emission_texture: maps.emission,
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
