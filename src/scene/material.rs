//! What a surface looks like.

use super::texture::{Channel, TextureUse};

/// A material: metallic-roughness (glTF 2.0, section 3.9.2), with what light it sends out and lets through. What an image
/// says is multiplied by the number beside it.
#[derive(Clone, Debug, PartialEq)]
pub struct Material {
    /// What the file calls it; may be empty.
    pub name: String,
    /// Linear colour and opacity.
    pub base_color: [f32; 4],
    /// Whether the back is shaded like the front. Rays hit both sides in any case.
    pub double_sided: bool,
    /// The image whose colours `base_color` is multiplied by. Its alpha channel is not looked at.
    pub base_color_texture: Option<TextureUse>,
    /// The image whose values opacity is multiplied by: often the same one.
    pub alpha_texture: Option<ValueTexture>,
    /// What opacity does.
    pub alpha: Alpha,
    /// From 0, a dielectric, to 1, a metal.
    pub metallic: f32,
    /// The image whose values `metallic` is multiplied by.
    pub metallic_texture: Option<ValueTexture>,
    /// As perceived, from 0, a mirror, to 1.
    pub roughness: f32,
    /// The image whose values `roughness` is multiplied by: in glTF always the one of `metallic`.
    pub roughness_texture: Option<ValueTexture>,
    /// Which way the surface faces where it is uneven.
    pub normal_texture: Option<NormalTexture>,
    /// The share of light that passes a dielectric straight, as through a thin pane, from 0 to 1.
    pub transmission: f32,
    /// The image whose values `transmission` is multiplied by.
    pub transmission_texture: Option<ValueTexture>,
    /// The index of refraction, which says how much a dielectric mirrors; 1 for nothing.
    pub ior: f32,
    /// Linear radiance that it sends out from both sides.
    pub emission: [f32; 3],
    /// The image whose colours `emission` is multiplied by. Its alpha channel is not looked at.
    pub emission_texture: Option<TextureUse>,
}

/// What the opacity of a surface does (glTF 2.0, section 3.9.4).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Alpha {
    /// Nothing: the surface is solid everywhere.
    #[default]
    Opaque,
    /// It is solid where opacity is at least this, and not there where it is less.
    Mask {
        /// The least opacity that is solid.
        cutoff: f32,
    },
    /// It lets through the share that opacity is short of 1.
    Blend,
}

/// A texture that a single value is read from, as it is stored: opacity, say, or roughness.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ValueTexture {
    /// The image, and how it lies on the surface.
    pub texture: TextureUse,
    /// Which of its channels is the value.
    pub channel: Channel,
}

/// A texture that normals are read from, in tangent space (glTF 2.0, section 3.9.3): x to the right of the image, y up in
/// it, z away from the surface. Red, green and blue as stored, 0 to 1, stand for -1 to 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NormalTexture {
    /// The image, and how it lies on the surface.
    pub texture: TextureUse,
    /// What x and y are multiplied by, before the normal is made as long as 1 again.
    pub scale: f32,
}

impl Material {
    /// A light grey: what a mesh without a material is made of.
    pub const PLAIN: Self = Self {
        name: String::new(),
        base_color: [0.7, 0.7, 0.7, 1.0],
        double_sided: true,
        base_color_texture: None,
        alpha_texture: None,
        alpha: Alpha::Opaque,
        metallic: 0.0,
        metallic_texture: None,
        roughness: 1.0,
        roughness_texture: None,
        normal_texture: None,
        transmission: 0.0,
        transmission_texture: None,
        ior: 1.5,
        emission: [0.0; 3],
        emission_texture: None,
    };

    /// Whether anything of it is read from an image.
    pub fn is_textured(&self) -> bool {
        self.images().next().is_some()
    }

    /// Whether more of it than colour, opacity and emission is read from an image.
    pub fn has_surface_maps(&self) -> bool {
        self.surface_values().next().is_some() || self.normal_texture.is_some()
    }

    /// The images that it reads; the same one may come several times.
    pub(super) fn images(&self) -> impl Iterator<Item = usize> {
        let colors = [self.base_color_texture, self.emission_texture, self.normal_texture.map(|normal| normal.texture)];
        let values = self.alpha_texture.into_iter().chain(self.surface_values());
        colors.into_iter().flatten().chain(values.map(|value| value.texture)).map(|texture| texture.image)
    }

    /// The single values, but for opacity, that it reads from images.
    pub(super) fn surface_values(&self) -> impl Iterator<Item = ValueTexture> {
        [self.metallic_texture, self.roughness_texture, self.transmission_texture].into_iter().flatten()
    }

    /// Gives its images new numbers. What reads one that gets none is no longer read from an image.
    pub(super) fn renumber_images(&mut self, new: impl Fn(usize) -> Option<usize>) {
        let texture = |old: TextureUse| new(old.image).map(|image| TextureUse { image, ..old });
        let value = |old: ValueTexture| texture(old.texture).map(|texture| ValueTexture { texture, ..old });
        for color in [&mut self.base_color_texture, &mut self.emission_texture] {
            *color = color.and_then(texture);
        }
        let values = [&mut self.alpha_texture, &mut self.metallic_texture, &mut self.roughness_texture];
        for map in values.into_iter().chain([&mut self.transmission_texture]) {
            *map = map.and_then(value);
        }
        let normal = |old: NormalTexture| texture(old.texture).map(|texture| NormalTexture { texture, ..old });
        self.normal_texture = self.normal_texture.and_then(normal);
    }
}

impl Default for Material {
    fn default() -> Self {
        Self::PLAIN
    }
}
