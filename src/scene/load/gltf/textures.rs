//! The textures of glTF materials: which image, how it is looked up, and by which set of texture
//! coordinates.

use gltf::json::extensions::texture::TextureTransform;
use gltf::json::material::{Material as Json, NormalTexture};
use gltf::json::texture::{Info, MagFilter, Texture, WrappingMode};
use gltf::json::{Index, Root, validation::Checked};
use serde::Deserialize;

use crate::scene::texture::{Filter, Sampler, TextureUse, UvTransform, Wrap};

/// What a material reads from images, by the one set of texture coordinates that its meshes keep: that of its colour, or
/// else that of the first map here. Images are given by their index in the document. What would be multiplied by 0 is not
/// among them.
#[derive(Default)]
pub(super) struct Maps {
    pub base_color: Option<TextureUse>,
    /// Roughness in green, metallic in blue.
    pub metallic_roughness: Option<TextureUse>,
    pub normal: Option<TextureUse>,
    pub emission: Option<TextureUse>,
    /// In red.
    pub transmission: Option<TextureUse>,
    /// The set of texture coordinates; `None` where nothing is read from an image.
    pub set: Option<u32>,
    /// How many maps go by another set, and are left out.
    pub left_out: usize,
    /// Whether the one of emission is among those.
    pub emission_left_out: bool,
}

/// A texture, and the set of coordinates that it goes by.
type Use = (TextureUse, u32);

impl Maps {
    pub fn of(root: &Root, json: &Json) -> Self {
        let extensions = json.extensions.as_ref();
        let pbr = &json.pbr_metallic_roughness;
        let glossy = extensions.and_then(|e| e.pbr_specular_glossiness.as_ref());
        // Where both models are there, the one of specular and glossiness is preferred.
        let (color, rough) = match glossy {
            Some(glossy) => (glossy.diffuse_texture.as_ref(), None),
            None => (pbr.base_color_texture.as_ref(), pbr.metallic_roughness_texture.as_ref()),
        };
        let rough = rough.filter(|_| pbr.metallic_factor.0 > 0.0 || pbr.roughness_factor.0 > 0.0);
        let emission = json.emissive_texture.as_ref().filter(|_| json.emissive_factor.0.iter().any(|x| *x > 0.0));
        let clear = extensions.and_then(|e| e.transmission.as_ref()).filter(|t| t.transmission_factor.0 > 0.0);
        let clear = clear.and_then(|t| t.transmission_texture.as_ref());
        let of_info = |info: Option<&Info>| info.and_then(|info| of_info(root, info));
        let mut maps = Self::default();
        maps.base_color = maps.take(of_info(color));
        maps.metallic_roughness = maps.take(of_info(rough));
        maps.normal = maps.take(json.normal_texture.as_ref().and_then(|normal| of_normal(root, normal)));
        let before = maps.left_out;
        maps.emission = maps.take(of_info(emission));
        maps.emission_left_out = maps.left_out > before;
        maps.transmission = maps.take(of_info(clear));
        maps
    }

    fn take(&mut self, map: Option<Use>) -> Option<TextureUse> {
        let (texture, set) = map?;
        if *self.set.get_or_insert(set) == set {
            return Some(texture);
        }
        self.left_out += 1;
        None
    }
}

/// The set of texture coordinates that a material needs, if it needs any.
pub(super) fn uv_set(root: &Root, material: usize) -> Option<u32> {
    Maps::of(root, root.materials.get(material)?).set
}

/// What to say of maps that the shown materials have and that are left out.
pub(super) fn sentence(root: &Root, shown: &[bool]) -> Option<String> {
    let shown = root.materials.iter().zip(shown).filter(|(_, shown)| **shown);
    let left_out: usize = shown.map(|(json, _)| Maps::of(root, json).left_out).sum();
    (left_out > 0).then(|| format!("Maps that go by a second set of texture coordinates were left out: {left_out}."))
}

fn of_info(root: &Root, info: &Info) -> Option<Use> {
    let transform = info.extensions.as_ref().and_then(|e| e.texture_transform.as_ref());
    texture(root, (info.index, info.tex_coord), transform)
}

/// The crate reads no extension of normal textures.
fn of_normal(root: &Root, normal: &NormalTexture) -> Option<Use> {
    let transform = normal.extensions.as_ref().and_then(|e| e.others.get("KHR_texture_transform"));
    let transform = transform.and_then(|json| TextureTransform::deserialize(json).ok());
    texture(root, (normal.index, normal.tex_coord), transform.as_ref())
}

fn texture(root: &Root, (index, set): (Index<Texture>, u32), transform: Option<&TextureTransform>) -> Option<Use> {
    let texture = root.get(index)?;
    let image = image(root, texture)?;
    let set = transform.and_then(|t| t.tex_coord).unwrap_or(set);
    let transform = transform.map(|t| UvTransform::khr(t.offset.0, t.rotation.0, t.scale.0));
    let sampler = texture.sampler.and_then(|index| root.get(index)).map(sampler);
    Some((TextureUse { image, sampler: sampler.unwrap_or_default(), transform: transform.unwrap_or_default() }, set))
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
