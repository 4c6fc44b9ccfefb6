//! What a model holds, however it was stored: meshes, where they stand, what they are made of, and
//! a camera to begin with. Loading fills it ([`load`]), or a generator does ([`builtin`]);
//! [`Geometry`] is what the acceleration structures see of it.

pub mod builtin;
mod camera;
mod camera_spec;
pub mod coverage;
mod environment;
mod error;
mod extremes;
mod findings;
mod finish;
mod first_view;
mod geometry;
mod light;
pub mod load;
mod material;
mod mesh;
mod needs;
mod placed;
mod section;
mod source;
mod subdivide;
pub mod texture;
mod whose;

pub use camera::{Camera, Frame, Projection};
pub use camera_spec::CameraSpec;
pub use environment::Environment;
pub use error::{LoadError, Reason};
pub use findings::Finding;
pub use finish::{Finish, Finished};
pub use first_view::{FirstView, StoredCamera};
pub use geometry::{Counts, Geometry, PrimRef};
pub use light::{Light, LightKind};
pub use material::{Alpha, Material, NormalTexture, ValueTexture};
pub use mesh::{Instance, Mesh};
pub use needs::{Feature, Keep, Needs, SceneBytes};
pub use placed::{Place, Placed};
pub use section::Section;
pub use source::{LoadCx, open};
pub use subdivide::subdivide;
pub use whose::Whose;

use glam::Vec3;

/// A whole model.
#[derive(Clone, Debug, Default)]
pub struct Scene {
    /// What the user knows it by: the file's path as given, or `builtin:NAME?...`.
    pub name: String,
    /// The triangle meshes, in file order.
    pub meshes: Vec<Mesh>,
    /// Where meshes stand, in node order. A mesh may be placed many times, or never.
    pub instances: Vec<Instance>,
    /// What meshes are made of; a mesh refers to them by index.
    pub materials: Vec<Material>,
    /// The images that materials use, not yet decoded; a material refers to them by index.
    pub images: Vec<texture::Image>,
    /// Lights that are no surfaces, in node order.
    pub lights: Vec<Light>,
    /// The direction that is up: what the orbiting camera keeps upright.
    pub up: Vec3,
    /// A view that suits the model; without one the whole model is framed.
    pub camera: Option<FirstView>,
    /// What could not be read, or was left out, in words for the user. Each is one sentence.
    pub warnings: Vec<String>,
}

impl Scene {
    /// The number of triangles when every instance is counted.
    pub fn triangle_count(&self) -> u64 {
        self.instances.iter().map(|i| self.meshes[i.mesh].triangles.len() as u64).sum()
    }

    /// The view to begin with: the scene's own, or all of `bounds` from a little above. `aspect` is
    /// the picture's width over its height.
    pub fn first_camera(&self, bounds: &crate::geometry::Aabb, aspect: f32) -> Camera {
        let up = self.up.normalize_or(Vec3::Y);
        self.camera.and_then(|view| view.camera(bounds, up, aspect)).unwrap_or_else(|| {
            let ahead = if up.z.abs() > 0.9 { Vec3::new(0.6, -1.0, 0.0) } else { Vec3::new(0.6, 0.0, 1.0) };
            Camera::framing(bounds, ahead + up * 0.55, up, aspect)
        })
    }
}
