//! How much of a surface is there: opacity at a point of a triangle, of the material's factor, the
//! vertex colours and the texture together (glTF 2.0, section 3.9.4), and whether a ray that meets
//! it there stops.

use glam::Vec2;

use super::texture::{Texture, Textures};
use super::{Alpha, Material, Mesh, Scene};
use crate::geometry::num;

/// A mesh with its material and what it has of textures: all that opacity at a point depends on.
#[derive(Clone, Copy, Debug)]
pub struct Surface<'a> {
    mesh: &'a Mesh,
    material: &'a Material,
    color_map: Option<&'a Texture>,
    alpha_map: Option<&'a Texture>,
}

static PLAIN: Material = Material::PLAIN;

impl<'a> Surface<'a> {
    /// The surface of a mesh. Textures that are not there, or not yet, count as white, as do those
    /// of a mesh that has no texture coordinates.
    ///
    /// # Panics
    /// The scene has no such mesh.
    #[inline]
    pub fn new(scene: &'a Scene, mesh: usize, textures: &'a Textures) -> Self {
        let mesh = &scene.meshes[mesh];
        let material = mesh.material.and_then(|m| scene.materials.get(m)).unwrap_or(&PLAIN);
        let map = |image: usize| textures.get(image).map(AsRef::as_ref).filter(|_| !mesh.uvs.is_empty());
        let color_map = material.base_color_texture.and_then(|texture| map(texture.image));
        let alpha_map = material.alpha_texture.and_then(|alpha| map(alpha.texture.image));
        Self { mesh, material, color_map, alpha_map }
    }

    /// Whether rays may pass it anywhere. If not, [`Self::covers`] is true everywhere and need not
    /// be asked: a texture without a transparent texel, say, makes no surface that blends.
    pub fn needs_test(&self) -> bool {
        let enough = match self.material.alpha {
            Alpha::Opaque => return false,
            Alpha::Mask { cutoff } => cutoff,
            Alpha::Blend => 1.0,
        };
        let vertices_are_one = self.mesh.colors.iter().all(|[.., alpha]| *alpha >= 1.0);
        let map_is_one = self.alpha_map.zip(self.material.alpha_texture).is_none_or(|(map, by)| map.is_one(by.channel));
        let [.., factor] = self.material.base_color;
        let stops = vertices_are_one && map_is_one && factor >= enough;
        !stops
    }

    /// Opacity at a point, 0 to 1, before the material's [`Alpha`] decides what it means. `u` and
    /// `v` are the weights of the triangle's second and third corner. The same bits on every
    /// machine.
    pub fn alpha(&self, triangle: u32, u: f32, v: f32) -> f32 {
        let corners = || self.mesh.triangles[triangle as usize];
        let [.., mut alpha] = self.material.base_color;
        if !self.mesh.colors.is_empty() {
            let [a, b, c] = corners().map(|i| self.mesh.colors[i as usize][3]);
            alpha *= between(a, b, c, u, v);
        }
        if let (Some(map), Some(by)) = (self.alpha_map, &self.material.alpha_texture) {
            let uv = by.texture.transform.apply(self.uv(corners(), u, v));
            alpha *= map.value(uv, &by.texture.sampler, by.channel);
        }
        num::min(num::max(alpha, 0.0), 1.0)
    }

    /// The share of light that stops at a point: 1 where the surface is opaque, 0 or 1 where it is
    /// cut out, its opacity where it blends.
    pub fn coverage(&self, triangle: u32, u: f32, v: f32) -> f32 {
        match self.material.alpha {
            Alpha::Opaque => 1.0,
            Alpha::Mask { cutoff } => f32::from(u8::from(self.alpha(triangle, u, v) >= cutoff)),
            Alpha::Blend => self.alpha(triangle, u, v),
        }
    }

    /// Whether a ray that meets triangle `primitive` of an instance of this mesh at `(u, v)` stops
    /// there. Of a surface that blends, a share of the hits equal to its opacity stops rays
    /// (stochastic transparency: Enderton, Sintorn, Shirley and Luebke, 2010); which of them is a
    /// matter of the hit alone (hashed alpha testing: Wyman and McGuire, 2017), so that every
    /// structure, thread and run decides alike.
    pub fn covers(&self, instance: u32, primitive: u32, u: f32, v: f32) -> bool {
        self.coverage(primitive, u, v) > threshold(instance, primitive, u, v)
    }

    /// The linear colour at a point. Where no mesh of the scene has vertex colours, or none an image, these need not be
    /// looked for (`COLORS`, `MAPS`).
    #[inline(always)]
    pub fn color<const COLORS: bool, const MAPS: bool>(&self, triangle: u32, u: f32, v: f32) -> [f32; 3] {
        let corners = || self.mesh.triangles[triangle as usize];
        let [r, g, b, _] = self.material.base_color;
        let mut color = [r, g, b];
        if COLORS && !self.mesh.colors.is_empty() {
            let at = corners().map(|i| self.mesh.colors[i as usize]);
            color = std::array::from_fn(|c| color[c] * between(at[0][c], at[1][c], at[2][c], u, v));
        }
        if MAPS && let (Some(map), Some(by)) = (self.color_map, &self.material.base_color_texture) {
            let of_map = map.color(by.transform.apply(self.uv(corners(), u, v)), &by.sampler);
            color = std::array::from_fn(|c| color[c] * of_map[c]);
        }
        color
    }

    /// The mesh's texture coordinates at a point of a triangle, of which it must have some.
    #[inline]
    pub(super) fn uv(&self, corners: [u32; 3], u: f32, v: f32) -> Vec2 {
        let [a, b, c] = corners.map(|i| self.mesh.uvs[i as usize]);
        Vec2::new(between(a.x, b.x, c.x, u, v), between(a.y, b.y, c.y, u, v))
    }
}

/// For each mesh of the scene, whether hits on it need the alpha test.
pub fn tested_meshes(scene: &Scene, textures: &Textures) -> Vec<bool> {
    (0..scene.meshes.len()).map(|mesh| Surface::new(scene, mesh, textures).needs_test()).collect()
}

/// Between the corners of a triangle; exact where all three are the same.
#[inline]
fn between(a: f32, b: f32, c: f32, u: f32, v: f32) -> f32 {
    a + (b - a) * u + (c - a) * v
}

/// A number from 0 to below 1 for a hit, as if drawn at random: what its coverage has to exceed.
pub fn threshold(instance: u32, primitive: u32, u: f32, v: f32) -> f32 {
    // Zeros of either sign are the same place.
    let (u, v) = ((u + 0.0).to_bits(), (v + 0.0).to_bits());
    let pair = |high: u32, low: u32| u64::from(high) << 32 | u64::from(low);
    let mixed = scrambled(scrambled(pair(instance, primitive)) ^ pair(u, v));
    // As many bits as a float holds: 1 is never reached.
    (mixed >> 40) as f32 / (1u32 << 24) as f32
}

/// The finalizer of SplitMix64 (Steele, Lea and Flood, 2014), after its first step, which keeps 0
/// from staying 0.
fn scrambled(x: u64) -> u64 {
    let x = x.wrapping_add(0x9E37_79B9_7F4A_7C15);
    let x = (x ^ x >> 30).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    let x = (x ^ x >> 27).wrapping_mul(0x94D0_49BB_1331_11EB);
    x ^ x >> 31
}

#[cfg(test)]
mod tests;
