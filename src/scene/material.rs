//! What a surface looks like.

use super::texture::{Channel, TextureUse};

/// A material: metallic-roughness (glTF 2.0, section 3.9.2), with what light it sends out and lets through.
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
    pub alpha_texture: Option<AlphaTexture>,
    /// What opacity does.
    pub alpha: Alpha,
    /// From 0, a dielectric, to 1, a metal.
    pub metallic: f32,
    /// As perceived, from 0, a mirror, to 1.
    pub roughness: f32,
    /// The share of light that passes a dielectric straight, as through a thin pane, from 0 to 1.
    pub transmission: f32,
    /// The index of refraction, which says how much a dielectric mirrors; 1 for nothing.
    pub ior: f32,
    /// Linear radiance that it sends out from both sides.
    pub emission: [f32; 3],
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

/// A texture that opacity is read from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AlphaTexture {
    /// The image, and how it lies on the surface.
    pub texture: TextureUse,
    /// Which of its channels is opacity.
    pub channel: Channel,
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
        roughness: 1.0,
        transmission: 0.0,
        ior: 1.5,
        emission: [0.0; 3],
    };

    /// Whether anything of it is read from an image.
    pub fn is_textured(&self) -> bool {
        self.base_color_texture.is_some() || self.alpha_texture.is_some()
    }
}

impl Default for Material {
    fn default() -> Self {
        Self::PLAIN
    }
}
