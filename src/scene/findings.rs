//! Why a scene uses a feature or leaves it out, in sentences.

use glam::Affine3A;

use super::needs::{material_of, places, shines};
use super::texture::color_images;
use super::{Feature, Mesh, Needs, Scene};

/// A feature of a scene, and why it is used or left out.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Finding {
    /// Which one.
    pub feature: Feature,
    /// Whether the scene uses it.
    pub used: bool,
    /// A sentence.
    pub why: String,
}

impl Needs {
    /// Every feature, and why it is used or left out.
    pub fn findings(self, scene: &Scene) -> Vec<Finding> {
        let facts = Facts::of(scene);
        let finding = |feature: Feature| Finding { feature, used: self.has(feature), why: facts.why(feature, self.has(feature)) };
        Feature::ALL.into_iter().map(finding).collect()
    }
}

/// What sentences about a scene need.
struct Facts {
    placed: usize,
    normals: usize,
    colors: usize,
    mapped: usize,
    color_images: usize,
    of_surfaces: usize,
    maybe_holes: usize,
    shining: usize,
    lights: usize,
    clear: usize,
    instances: usize,
    repeated: (usize, u64),
    turned: usize,
}

impl Facts {
    fn of(scene: &Scene) -> Self {
        let places = places(scene);
        let placed = || scene.meshes.iter().zip(&places).filter(|(_, places)| **places > 0).map(|(mesh, _)| mesh);
        let count = |is: fn(&Mesh) -> bool| placed().filter(|mesh| is(mesh)).count();
        let many = || places.iter().filter(|places| **places > 1);
        Self {
            placed: placed().count(),
            normals: count(|mesh| !mesh.normals.is_empty()),
            colors: count(|mesh| !mesh.colors.is_empty()),
            mapped: count(|mesh| !mesh.uvs.is_empty()),
            color_images: color_images(scene),
            of_surfaces: placed().filter(|mesh| !mesh.uvs.is_empty() && material_of(scene, mesh).has_surface_maps()).count(),
            maybe_holes: placed().filter(|mesh| material_of(scene, mesh).alpha != super::Alpha::Opaque).count(),
            shining: placed().filter(|mesh| shines(material_of(scene, mesh))).count(),
            lights: scene.lights.len(),
            clear: placed().filter(|mesh| material_of(scene, mesh).transmission > 0.0).count(),
            instances: scene.instances.len(),
            repeated: (many().count(), many().map(|places| u64::from(*places)).sum()),
            turned: scene.instances.iter().filter(|i| i.world_from_object != Affine3A::IDENTITY).count(),
        }
    }

    fn why(&self, feature: Feature, used: bool) -> String {
        let (placed, instances) = (self.placed, self.instances);
        let of_meshes = |n: usize, what: &str| format!("{what}: {n} of {placed} meshes.");
        match (feature, used) {
            (Feature::Normals, true) => of_meshes(self.normals, "Shading smooths triangles by the normals of their vertices"),
            (Feature::Normals, false) => "No mesh has normals: triangles are shaded flat.".into(),
            (Feature::VertexColors, true) => of_meshes(self.colors, "There are colours at vertices"),
            (Feature::VertexColors, false) => "No mesh has colours at its vertices, or all are white.".into(),
            (Feature::Uvs, true) => of_meshes(self.mapped, "Images are looked up by texture coordinates"),
            (Feature::Uvs, false) => "No material reads an image, so texture coordinates are not kept.".into(),
            (Feature::ColorMaps, true) => {
                format!("Surfaces take their colour from images; colour and opacity together need {}.", self.color_images)
            }
            (Feature::ColorMaps, false) => "No surface takes its colour from an image.".into(),
            (Feature::AlphaMaps, true) => {
                of_meshes(self.maybe_holes, "Surfaces take their opacity from images, among those that may have holes")
            }
            (Feature::AlphaMaps, false) => "No surface takes its opacity from an image.".into(),
            (Feature::SurfaceMaps, true) => {
                of_meshes(self.of_surfaces, "Images say how metallic, rough or clear surfaces are, or which way they face")
            }
            (Feature::SurfaceMaps, false) => "No image says how metallic, rough, clear or uneven a surface is.".into(),
            (Feature::AlphaTest, true) => {
                of_meshes(self.maybe_holes, "Some may have holes, so that each hit is asked whether it counts")
            }
            (Feature::AlphaTest, false) if self.maybe_holes > 0 => {
                of_meshes(self.maybe_holes, "Some could have holes, but their opacity is 1 everywhere")
            }
            (Feature::AlphaTest, false) => "All surfaces are solid: every hit counts.".into(),
            (Feature::Emission, true) => of_meshes(self.shining, "Paths of light begin at surfaces that shine"),
            (Feature::Emission, false) if self.lights > 0 => "No surface shines.".into(),
            (Feature::Emission, false) => "No surface shines: paths of light begin at a sky.".into(),
            (Feature::Lights, true) => format!("The file has lights of its own that are no surfaces: {}.", self.lights),
            (Feature::Lights, false) => "The file has no lights but surfaces that may shine.".into(),
            (Feature::Transmission, true) => of_meshes(self.clear, "Surfaces let paths of light through"),
            (Feature::Transmission, false) => "No surface lets light through.".into(),
            (Feature::DoubleSided, _) => "Rays hit both sides of every triangle, and both are shaded alike.".into(),
            (Feature::Instancing, true) => {
                let (meshes, times) = self.repeated;
                format!("Meshes that stand in several places are kept once, below an upper level: {meshes}, in {times} places.")
            }
            (Feature::Instancing, false) => "No mesh stands in two places: there is one level.".into(),
            (Feature::Transforms, true) => {
                format!("Normals are turned with what is moved or turned: {} of {instances} instances.", self.turned)
            }
            (Feature::Transforms, false) if self.turned > 0 => "What is moved or turned has no normals.".into(),
            (Feature::Transforms, false) => "Everything stands as it was made: normals are right as they are.".into(),
            (Feature::Indices, _) => "32 bits number all vertices and triangles; what needs more is refused.".into(),
            (Feature::Corners, _) => "Structures share one copy of positions and indices; the model's own is given up.".into(),
            (Feature::UnplacedMeshes, _) => "Meshes that stand nowhere are not read.".into(),
            (Feature::UnusedImages, _) => "Images and channels that no surface reads are not decoded.".into(),
        }
    }
}
