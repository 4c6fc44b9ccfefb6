//! The textures of glTF materials: which image, how it is looked up, and by which set of texture
//! coordinates.

use gltf::json::material::Material as Json;
use gltf::json::texture::{Info, MagFilter, Texture, WrappingMode};
use gltf::json::{Root, validation::Checked};

use crate::scene::texture::{Filter, Sampler, TextureUse, UvTransform, Wrap};

/// The texture of a material's colour. Its image is given by its index in the document.
pub(super) fn base_color(root: &Root, json: &Json) -> Option<TextureUse> {
    let info = info(json)?;
    let texture = root.get(info.index)?;
    let image = image(root, texture)?;
    let transform = info.extensions.as_ref().and_then(|e| e.texture_transform.as_ref());
    let transform = transform.map(|t| UvTransform::khr(t.offset.0, t.rotation.0, t.scale.0));
    let sampler = texture.sampler.and_then(|index| root.get(index)).map(sampler);
    Some(TextureUse { image, sampler: sampler.unwrap_or_default(), transform: transform.unwrap_or_default() })
}

/// The set of texture coordinates that a material needs, if it needs any.
pub(super) fn uv_set(root: &Root, material: usize) -> Option<u32> {
    let json = root.materials.get(material)?;
    base_color(root, json)?;
    let info = info(json)?;
    let over = info.extensions.as_ref().and_then(|e| e.texture_transform.as_ref()).and_then(|t| t.tex_coord);
    Some(over.unwrap_or(info.tex_coord))
}

/// Where both models are there, the one of specular and glossiness is preferred.
fn info(json: &Json) -> Option<&Info> {
    match json.extensions.as_ref().and_then(|e| e.pbr_specular_glossiness.as_ref()) {
        Some(glossy) => glossy.diffuse_texture.as_ref(),
        None => json.pbr_metallic_roughness.base_color_texture.as_ref(),
    }
}

/// The image of a texture; one in a format of an extension only where there is no other.
fn image(root: &Root, texture: &Texture) -> Option<usize> {
    let webp = || texture.extensions.as_ref()?.others.get("EXT_texture_webp")?.get("source")?.as_u64();
    let there = |index: usize| (index < root.images.len()).then_some(index);
    there(texture.source.value()).or_else(|| there(usize::try_from(webp()?).ok()?))
}

fn sampler(json: &gltf::json::texture::Sampler) -> Sampler {
    let wrap = |mode: &Checked<WrappingMode>| match mode {
        Checked::Valid(WrappingMode::ClampToEdge) => Wrap::Clamp,
        Checked::Valid(WrappingMode::MirroredRepeat) => Wrap::Mirror,
        _ => Wrap::Repeat,
    };
    let nearest = matches!(json.mag_filter, Some(Checked::Valid(MagFilter::Nearest)));
    let filter = if nearest { Filter::Nearest } else { Filter::Linear };
    Sampler { wrap_u: wrap(&json.wrap_s), wrap_v: wrap(&json.wrap_t), filter }
}
