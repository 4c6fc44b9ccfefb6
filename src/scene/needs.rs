//! What a scene uses of all that a scene can have, worked out once from what its placed meshes really hold. Whatever
//! comes after (what is kept in memory, which shading is run, whether hits are tested for holes, whether there is an
//! upper level) is chosen by it, outside the loops; [`Keep::All`] is the opposite, which the savings are measured against.

use glam::{Affine3A, Vec2, Vec3};

use super::coverage::Surface;
use super::texture::{Channel, Image, TextureUse, Textures};
use super::{Geometry, LoadCx, Material, Mesh, Reason, Scene, ValueTexture};

/// Something that a scene may use or leave out.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Feature {
    /// Shading normals of vertices.
    Normals,
    /// Colours of vertices.
    VertexColors,
    /// Texture coordinates.
    Uvs,
    /// Images that surfaces take their colour from.
    ColorMaps,
    /// Images that surfaces take their opacity from.
    AlphaMaps,
    /// Images that say how metallic, rough or clear surfaces are, or which way they face.
    SurfaceMaps,
    /// Hits that are asked whether the surface is there at all.
    AlphaTest,
    /// Surfaces that shine.
    Emission,
    /// Lights of the file that are no surfaces.
    Lights,
    /// Surfaces that let light through.
    Transmission,
    /// Whether the back of a surface is seen.
    DoubleSided,
    /// A level above structures of single meshes.
    Instancing,
    /// Normals that are turned with their instance.
    Transforms,
    /// The numbers of vertices and triangles.
    Indices,
    /// Positions and indices beside those that structures are built over.
    Corners,
    /// Meshes that stand nowhere.
    UnplacedMeshes,
    /// Images and channels that no surface reads.
    UnusedImages,
}

/// How much of a model is kept.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Keep {
    /// What the scene needs.
    #[default]
    Needed,
    /// Everything in the file: what is left out is measured against it.
    All,
}

impl Feature {
    /// All of them, in the order of reports.
    pub const ALL: [Self; 17] = [
        Self::Normals,
        Self::VertexColors,
        Self::Uvs,
        Self::ColorMaps,
        Self::AlphaMaps,
        Self::SurfaceMaps,
        Self::AlphaTest,
        Self::Emission,
        Self::Lights,
        Self::Transmission,
        Self::DoubleSided,
        Self::Instancing,
        Self::Transforms,
        Self::Indices,
        Self::Corners,
        Self::UnplacedMeshes,
        Self::UnusedImages,
    ];

    /// The name in files.
    pub const fn id(self) -> &'static str {
        match self {
            Self::Normals => "normals",
            Self::VertexColors => "vertex-colors",
            Self::Uvs => "uvs",
            Self::ColorMaps => "color-maps",
            Self::AlphaMaps => "alpha-maps",
            Self::SurfaceMaps => "surface-maps",
            Self::AlphaTest => "alpha-test",
            Self::Emission => "emission",
            Self::Lights => "lights",
            Self::Transmission => "transmission",
            Self::DoubleSided => "double-sided",
            Self::Instancing => "instancing",
            Self::Transforms => "transforms",
            Self::Indices => "indices",
            Self::Corners => "second-corners",
            Self::UnplacedMeshes => "unplaced-meshes",
            Self::UnusedImages => "unused-images",
        }
    }

    /// The name in the window.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Normals => "Normals",
            Self::VertexColors => "Vertex colours",
            Self::Uvs => "Texture coordinates",
            Self::ColorMaps => "Colour images",
            Self::AlphaMaps => "Opacity images",
            Self::SurfaceMaps => "Surface maps",
            Self::AlphaTest => "Test for holes",
            Self::Emission => "Emission",
            Self::Lights => "Lights",
            Self::Transmission => "Transmission",
            Self::DoubleSided => "Two-sidedness",
            Self::Instancing => "Upper level",
            Self::Transforms => "Turned normals",
            Self::Indices => "Wide indices",
            Self::Corners => "Second corners",
            Self::UnplacedMeshes => "Unplaced meshes",
            Self::UnusedImages => "Unused images",
        }
    }

    const fn bit(self) -> u32 {
        1 << self as u32
    }
}

/// A set of features.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Needs(u32);

impl Needs {
    /// Everything: right for any scene.
    pub const ALL: Self = Self(u32::MAX);

    /// Whether a feature is among them.
    pub const fn has(self, feature: Feature) -> bool {
        self.0 & feature.bit() != 0
    }

    /// The same with one more.
    #[must_use]
    pub const fn with(self, feature: Feature) -> Self {
        Self(self.0 | feature.bit())
    }

    /// What the placed meshes of a scene use, as far as `textures` are there. One that is not counts as having holes
    /// where its material may have some.
    pub fn of(scene: &Scene, textures: &Textures) -> Self {
        let mut needs = Self::default();
        let places = places(scene);
        for (number, mesh) in scene.meshes.iter().enumerate().filter(|(number, _)| places[*number] > 0) {
            let surface = Surface::new(scene, number, textures);
            let (material, mapped) = (material_of(scene, mesh), !mesh.uvs.is_empty());
            let colored_by = material.base_color_texture.filter(|_| mapped);
            let alpha_by = material.alpha_texture.filter(|_| mapped && material.alpha != super::Alpha::Opaque);
            let waits = alpha_by.is_some_and(|alpha| textures.get(alpha.texture.image).is_none());
            let used = [
                (Feature::Normals, !mesh.normals.is_empty()),
                (Feature::VertexColors, !mesh.colors.is_empty()),
                (Feature::Uvs, mapped),
                (Feature::ColorMaps, colored_by.is_some()),
                (Feature::AlphaMaps, alpha_by.is_some()),
                (Feature::SurfaceMaps, mapped && material.has_surface_maps()),
                (Feature::AlphaTest, surface.needs_test() || waits),
                (Feature::Instancing, places[number] > 1),
                (Feature::Emission, shines(material)),
                (Feature::Transmission, material.transmission > 0.0),
            ];
            for (feature, _) in used.into_iter().filter(|(_, used)| *used) {
                needs = needs.with(feature);
            }
        }
        let turned = |i: &super::Instance| i.world_from_object != Affine3A::IDENTITY && !scene.meshes[i.mesh].normals.is_empty();
        if scene.instances.iter().any(turned) {
            needs = needs.with(Feature::Transforms);
        }
        if !scene.lights.is_empty() {
            needs = needs.with(Feature::Lights);
        }
        needs.with(Feature::Indices)
    }
}

pub(super) fn shines(material: &Material) -> bool {
    material.emission.iter().any(|x| *x > 0.0)
}

/// How often each mesh stands somewhere.
pub(super) fn places(scene: &Scene) -> Vec<u32> {
    let mut places = vec![0; scene.meshes.len()];
    scene.instances.iter().for_each(|i| places[i.mesh] += 1);
    places
}

pub(super) fn material_of<'a>(scene: &'a Scene, mesh: &Mesh) -> &'a Material {
    static PLAIN: Material = Material::PLAIN;
    mesh.material.and_then(|m| scene.materials.get(m)).unwrap_or(&PLAIN)
}

/// Frees what no picture looks at: texture coordinates of meshes whose material reads no image, and colours of vertices
/// that are all white.
pub(super) fn drop_idle(scene: &mut Scene) {
    let Scene { meshes, materials, .. } = scene;
    for mesh in meshes {
        if !mesh.material.and_then(|m| materials.get(m)).is_some_and(Material::is_textured) {
            mesh.uvs = Vec::new();
        }
        if mesh.colors.iter().all(|color| *color == WHITE) {
            mesh.colors = Vec::new();
        }
    }
}

const WHITE: [f32; 4] = [1.0; 4];

/// Bytes of a scene, by what they are for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct SceneBytes {
    /// Of positions and indices.
    pub corners: u64,
    /// Of normals.
    pub normals: u64,
    /// Of colours of vertices.
    pub colors: u64,
    /// Of texture coordinates.
    pub uvs: u64,
    /// Of meshes that stand nowhere.
    pub unplaced: u64,
    /// Of materials, instances, lights, and images as they are stored.
    pub rest: u64,
}

impl SceneBytes {
    /// All together.
    pub const fn total(&self) -> u64 {
        self.corners + self.normals + self.colors + self.uvs + self.unplaced + self.rest
    }
}

impl Scene {
    /// The bytes that it takes in memory now.
    pub fn bytes(&self) -> SceneBytes {
        let mut bytes = SceneBytes::default();
        for (mesh, places) in self.meshes.iter().zip(places(self)) {
            let (normals, colors) = (size_of_val(&mesh.normals[..]) as u64, size_of_val(&mesh.colors[..]) as u64);
            let uvs = size_of_val(&mesh.uvs[..]) as u64;
            let corners = (size_of_val(&mesh.positions[..]) + size_of_val(&mesh.triangles[..])) as u64;
            if places == 0 {
                bytes.unplaced += normals + colors + uvs + corners;
            } else {
                bytes.normals += normals;
                bytes.colors += colors;
                bytes.uvs += uvs;
                bytes.corners += corners;
            }
        }
        let lists = size_of_val(&self.meshes[..]) + size_of_val(&self.instances[..]) + size_of_val(&self.materials[..]);
        let lights = size_of_val(&self.lights[..]);
        bytes.rest = (lists + lights) as u64 + self.images.iter().map(Image::bytes).sum::<u64>();
        bytes
    }

    /// What structures are built over, with instances kept or every one flattened ([`Geometry::new`]); and of the scene as
    /// much as is to be kept: everything, filled in, or what is needed, without corners.
    ///
    /// # Errors
    /// As [`Geometry::new`].
    pub fn gather(&mut self, flatten: bool, cx: &LoadCx) -> Result<Geometry, Reason> {
        if cx.keep == Keep::All {
            self.fill_in();
        }
        let geometry = if flatten { Geometry::new(self, cx) } else { Geometry::with_instances(self, cx) }?;
        if cx.keep == Keep::Needed {
            self.give_up_corners();
        }
        Ok(geometry)
    }

    /// Gives up positions, and indices where nothing else of a vertex is looked up by them: once there is a
    /// [`super::Geometry`] it holds them. The scene cannot be flattened again after that.
    pub fn give_up_corners(&mut self) {
        for mesh in &mut self.meshes {
            mesh.positions = Vec::new();
            if mesh.normals.is_empty() && mesh.colors.is_empty() && mesh.uvs.is_empty() {
                mesh.triangles = Vec::new();
            }
        }
    }

    /// Gives every mesh and material everything that there is, with values that change nothing in a picture: normals of
    /// no length, white colours, texture coordinates of 0, a white image of one texel. What a program with one kind of
    /// vertex and one kind of material would hold.
    pub fn fill_in(&mut self) {
        let white = self.images.len();
        self.images.push(Image::white());
        for mesh in &mut self.meshes {
            let n = mesh.positions.len();
            mesh.normals.resize(n, Vec3::ZERO);
            mesh.colors.resize(n, WHITE);
            // Without coordinates an image does not show, and with some it would.
            if !mesh.material.and_then(|m| self.materials.get(m)).is_some_and(Material::is_textured) {
                mesh.uvs.resize(n, Vec2::ZERO);
            }
            if mesh.material.is_none() {
                mesh.material = Some(self.materials.len());
            }
        }
        self.materials.push(Material::PLAIN);
        for material in &mut self.materials {
            let texture = TextureUse { image: white, ..TextureUse::default() };
            material.base_color_texture.get_or_insert(texture);
            for map in [&mut material.metallic_texture, &mut material.roughness_texture, &mut material.transmission_texture] {
                map.get_or_insert(ValueTexture { texture, channel: Channel::Red });
            }
        }
    }
}

#[cfg(test)]
mod tests;
