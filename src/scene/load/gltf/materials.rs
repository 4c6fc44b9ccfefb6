//! glTF materials, as far as the shaded mode needs them.

use gltf::json::material::{AlphaMode, Material as Json};
use gltf::json::{Root, validation::Checked};

use crate::scene::Material;

/// Every material of the document, in its order.
pub(super) fn all(root: &Root) -> Vec<Material> {
    root.materials.iter().map(material).collect()
}

fn material(json: &Json) -> Material {
    let glossy = json.extensions.as_ref().and_then(|e| e.pbr_specular_glossiness.as_ref());
    let [r, g, b, a] = glossy.map_or(json.pbr_metallic_roughness.base_color_factor.0, |glossy| glossy.diffuse_factor.0);
    Material {
        name: json.name.clone().unwrap_or_default(),
        base_color: [r, g, b, if is_opaque(json) { 1.0 } else { a }],
        double_sided: json.double_sided,
    }
}

/// Whether alpha is to be passed over, in the factor as in vertex colours.
pub(super) fn is_opaque(json: &Json) -> bool {
    !matches!(json.alpha_mode, Checked::Valid(AlphaMode::Mask | AlphaMode::Blend))
}
