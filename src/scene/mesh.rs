//! Triangle meshes and where they stand.

use glam::{Affine3A, Vec2, Vec3};

/// Triangles with one material, in the space of their object, as loaded.
///
/// Every attribute list is either empty (the file has none) or as long as `positions`; every index
/// of a triangle is below `positions.len()`. Loaders see to both.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mesh {
    /// What the file calls it; may be empty.
    pub name: String,
    /// Vertex positions. They may hold NaN or infinities, as the file has them; none once they were given up
    /// ([`super::Scene::give_up_corners`]).
    pub positions: Vec<Vec3>,
    /// Three vertex indices a triangle, in file order, degenerate ones included.
    pub triangles: Vec<[u32; 3]>,
    /// Shading normals, not necessarily of unit length.
    pub normals: Vec<Vec3>,
    /// The texture coordinates that the material's textures use; none where it has no texture.
    pub uvs: Vec<Vec2>,
    /// Linear vertex colours with opacity.
    pub colors: Vec<[f32; 4]>,
    /// Index into [`super::Scene::materials`]; `None` for the default material.
    pub material: Option<usize>,
}

/// One mesh, placed once.
#[derive(Clone, Debug, PartialEq)]
pub struct Instance {
    /// Index into [`super::Scene::meshes`].
    pub mesh: usize,
    /// From the mesh's space to the world's. May mirror, shear, or flatten to nothing.
    pub world_from_object: Affine3A,
}

impl Instance {
    /// The mesh where it is.
    pub const fn identity(mesh: usize) -> Self {
        Self { mesh, world_from_object: Affine3A::IDENTITY }
    }
}
