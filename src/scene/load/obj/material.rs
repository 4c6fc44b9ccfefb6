//! One material of an MTL file, as it is put together statement by statement.

use super::statements::values;
use crate::scene::load::text::{Line, float};
use crate::scene::load::unit;
use crate::scene::texture::Channel;
use crate::scene::{Alpha, Material, ValueTexture};

/// A material whose statements are being read.
pub(super) struct Draft {
    pub material: Material,
    color_said: bool,
    opacity_said: bool,
    roughness_said: bool,
    /// Phong's exponent.
    shininess: Option<f32>,
    is_shiny: bool,
}

impl Draft {
    pub fn new(name: String) -> Self {
        Self {
            material: Material { name, ..Material::PLAIN },
            color_said: false,
            opacity_said: false,
            roughness_said: false,
            shininess: None,
            is_shiny: false,
        }
    }

    /// Takes a statement that names no image.
    pub fn set(&mut self, word: &[u8], line: &Line) {
        let number = |i: usize| values(line).nth(i).and_then(float).filter(|x| x.is_finite());
        let [r, g, b, a] = &mut self.material.base_color;
        match word {
            b"Kd" => {
                if let Some(red) = number(0) {
                    // One number stands for three.
                    (*r, *g, *b) = (red, number(1).unwrap_or(red), number(2).unwrap_or(red));
                    self.color_said = true;
                }
            }
            b"d" => {
                // `-halo` may come before the number.
                if let Some(opacity) = values(line).last().and_then(float) {
                    (*a, self.opacity_said) = (unit(opacity), true);
                }
            }
            b"Ke" => {
                if let Some(red) = number(0) {
                    let rgb = [red, number(1).unwrap_or(red), number(2).unwrap_or(red)];
                    self.material.emission = rgb.map(|x| x.max(0.0));
                }
            }
            b"Ni" => self.material.ior = number(0).filter(|n| *n >= 1.0).unwrap_or(self.material.ior),
            // The extension for physically based materials.
            b"Pm" => self.material.metallic = number(0).map_or(self.material.metallic, unit),
            b"Pr" => (self.material.roughness, self.roughness_said) = (number(0).map_or(1.0, unit), true),
            b"Ns" if !self.roughness_said => self.shininess = number(0).filter(|n| *n >= 0.0),
            b"Ks" => self.is_shiny = (0..3).filter_map(number).any(|x| x > 0.0),
            // Where both stand, `d` is the one of the format.
            b"Tr" if !self.opacity_said => *a = number(0).map_or(*a, |t| 1.0 - unit(t)),
            _ => {}
        }
    }

    /// The material, once all that is said of it is known.
    pub fn finish(self) -> Material {
        let Self { mut material, color_said, .. } = self;
        // Facets as wide as Phong's highlight (Walter et al. 2007, section 5.1), as perceived.
        if let Some(shininess) = self.shininess.filter(|_| self.is_shiny && !self.roughness_said) {
            material.roughness = (2.0 / (shininess + 2.0)).sqrt().sqrt();
        }
        // What an image is multiplied by: where nothing is said of it, or that it is 0, the image alone is meant.
        if material.roughness_texture.is_some() && (!self.roughness_said || material.roughness == 0.0) {
            material.roughness = 1.0;
        }
        if material.metallic_texture.is_some() && material.metallic == 0.0 {
            material.metallic = 1.0;
        }
        if material.emission_texture.is_some() && material.emission == [0.0; 3] {
            material.emission = [1.0; 3];
        }
        let [r, g, b, a] = &mut material.base_color;
        // `map_Kd` is multiplied by `Kd`. Black is written by programs that mean the image alone,
        // and would make it pointless.
        if material.base_color_texture.is_some() && (!color_said || [*r, *g, *b] == [0.0; 3]) {
            (*r, *g, *b) = (1.0, 1.0, 1.0);
        }
        // Of an image that gives the colour too, only the alpha channel can be meant.
        if let (Some(color), Some(ValueTexture { texture, channel: channel @ Channel::Mask })) =
            (&material.base_color_texture, &mut material.alpha_texture)
            && color.image == texture.image
        {
            *channel = Channel::Alpha;
        }
        // Nobody writes a surface that is nowhere: some programs take 1 for opaque in `Tr`, or 0 in `d`.
        if *a == 0.0 {
            *a = 1.0;
        }
        if *a < 1.0 || material.alpha_texture.is_some() {
            material.alpha = Alpha::Blend;
        }
        material
    }
}
