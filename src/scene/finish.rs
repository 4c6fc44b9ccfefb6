//! What a surface is made of at a point: the material's numbers, each multiplied by what its image says there. It is all
//! that paths of light ask of a surface, besides its shape.

use glam::{Vec2, Vec3};

use super::coverage::Surface;
use super::load::unit;
use super::needs::material_of;
use super::texture::{Channel, Texture, TextureUse, Textures};
use super::{Material, Mesh, NormalTexture, Scene, ValueTexture};

/// A mesh with its material and the images that are there: looked up once, asked for every hit.
#[derive(Clone, Copy, Debug)]
pub struct Finish<'a> {
    surface: Surface<'a>,
    mesh: &'a Mesh,
    material: &'a Material,
    metallic: Option<Map<'a>>,
    roughness: Option<Map<'a>>,
    transmission: Option<Map<'a>>,
    normal: Option<(Map<'a>, f32)>,
    emission: Option<Map<'a>>,
}

/// What a surface is made of at a point. All of it is finite.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Finished {
    /// Linear colour, 0 to 1.
    pub base: [f32; 3],
    /// From 0, a dielectric, to 1, a metal.
    pub metallic: f32,
    /// As perceived, from 0, a mirror, to 1.
    pub roughness: f32,
    /// The share of light that passes a dielectric, 0 to 1.
    pub transmission: f32,
    /// The index of refraction, at least 1.
    pub ior: f32,
    /// Linear radiance that it sends out, never negative.
    pub emission: [f32; 3],
    /// Which way it faces in tangent space, of unit length and with z above 0; `None` where no image says so. See
    /// [`Finish::uvs`] for where x and y point.
    pub bend: Option<Vec3>,
}

/// An image, how it lies on the surface, and the channel that a single value is read from.
#[derive(Clone, Copy, Debug)]
struct Map<'a> {
    texture: &'a Texture,
    by: &'a TextureUse,
    channel: Channel,
}

impl<'a> Finish<'a> {
    /// What a mesh is made of. Images that are not there, or not yet, count as if the material had none, as do those of a
    /// mesh that has no texture coordinates, and those that were decoded for something else
    /// ([`Detail::Colors`](super::texture::Detail)).
    ///
    /// # Panics
    /// The scene has no such mesh.
    pub fn new(scene: &'a Scene, mesh: usize, textures: &'a Textures) -> Self {
        let surface = Surface::new(scene, mesh, textures);
        let mesh = &scene.meshes[mesh];
        let material = material_of(scene, mesh);
        let texture = |image: usize| textures.get(image).map(AsRef::as_ref).filter(|_| !mesh.uvs.is_empty());
        let colors = |by: &'a TextureUse| {
            let texture = texture(by.image).filter(|texture| texture.has_colors())?;
            Some(Map { texture, by, channel: Channel::Red })
        };
        let value = |of: &'a Option<ValueTexture>| {
            let ValueTexture { texture: by, channel } = of.as_ref()?;
            let texture = texture(by.image).filter(|texture| texture.has(*channel))?;
            Some(Map { texture, by, channel: *channel })
        };
        let normal = |NormalTexture { texture, scale }: &'a NormalTexture| Some((colors(texture)?, *scale));
        Self {
            surface,
            mesh,
            material,
            metallic: value(&material.metallic_texture),
            roughness: value(&material.roughness_texture),
            transmission: value(&material.transmission_texture),
            normal: material.normal_texture.as_ref().and_then(normal),
            emission: material.emission_texture.as_ref().and_then(colors),
        }
    }

    /// What it is made of at a point of a triangle of the mesh. `u` and `v` are the weights of the triangle's second and
    /// third corner.
    pub fn at(&self, triangle: u32, u: f32, v: f32) -> Finished {
        let maps = [self.metallic, self.roughness, self.transmission, self.emission, self.normal.map(|(map, _)| map)];
        // Asked for only where there are some.
        let uv = if maps.iter().any(Option::is_some) {
            self.surface.uv(self.mesh.triangles[triangle as usize], u, v)
        } else {
            Vec2::ZERO
        };
        let value = |factor: f32, map: Option<Map>| unit(factor * map.map_or(1.0, |map| map.value(uv)));
        let Material { metallic, roughness, transmission, ior, .. } = *self.material;
        Finished {
            base: self.surface.color::<true, true>(triangle, u, v).map(unit),
            metallic: value(metallic, self.metallic),
            roughness: value(roughness, self.roughness),
            transmission: value(transmission, self.transmission),
            ior: if ior.is_finite() { ior.max(1.0) } else { Material::PLAIN.ior },
            emission: self.shining(uv),
            bend: self.normal.and_then(|(map, scale)| map.normal(uv, scale)),
        }
    }

    /// The linear radiance that a point sends out: that of [`Self::at`] alone.
    pub fn emission(&self, triangle: u32, u: f32, v: f32) -> [f32; 3] {
        let uv = if self.emission.is_some() { self.surface.uv(self.mesh.triangles[triangle as usize], u, v) } else { Vec2::ZERO };
        self.shining(uv)
    }

    fn shining(&self, uv: Vec2) -> [f32; 3] {
        let map = self.emission.map_or([1.0; 3], |map| map.color(uv));
        std::array::from_fn(|c| radiance(self.material.emission[c] * map[c]))
    }

    /// Where the corners of a triangle are on the image of normals, whose u points to the right and whose v points down;
    /// `None` where it has none. In tangent space x is the way that u grows along the surface, and y the way that v
    /// becomes less: the image is looked at with its top up (glTF 2.0, section 3.9.3).
    pub fn uvs(&self, triangle: u32) -> Option<[Vec2; 3]> {
        let (map, _) = self.normal?;
        Some(self.mesh.triangles[triangle as usize].map(|i| map.by.transform.apply(self.mesh.uvs[i as usize])))
    }
}

impl Map<'_> {
    fn value(&self, uv: Vec2) -> f32 {
        self.texture.value(self.by.transform.apply(uv), &self.by.sampler, self.channel)
    }

    fn color(&self, uv: Vec2) -> [f32; 3] {
        let [r, g, b, _] = self.texture.color(self.by.transform.apply(uv), &self.by.sampler);
        [r, g, b]
    }

    /// The normal in tangent space. What points into the surface is no normal, and is taken for one that barely points
    /// out of it.
    fn normal(&self, uv: Vec2, scale: f32) -> Option<Vec3> {
        let [x, y, z] = self.texture.stored(self.by.transform.apply(uv), &self.by.sampler).map(|stored| 2.0 * stored - 1.0);
        Vec3::new(x * scale, y * scale, z.max(1.0 / 255.0)).try_normalize()
    }
}

/// Light of one colour that a surface may send out.
fn radiance(x: f32) -> f32 {
    if x.is_finite() { x.max(0.0) } else { 0.0 }
}

#[cfg(test)]
mod tests;
