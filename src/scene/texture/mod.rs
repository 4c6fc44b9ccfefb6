//! Images on surfaces.
//!
//! Loading a model notes where its images are ([`Image`]) and how materials use them
//! ([`TextureUse`]), and decodes none of them: the first picture does not wait for that.
//! [`Textures::decode`] does it afterwards, for the images that are seen, and as much of them as the kind of picture needs
//! ([`Detail`]).

mod decode;
mod pack;
mod sampler;
mod source;
mod texels;
mod textures;
mod uses;
mod uv_transform;

pub use sampler::{Filter, Sampler, Wrap};
pub use source::{Image, ImageSource};
pub use texels::{Channel, Texture};
pub use textures::Textures;
pub use uses::Detail;
pub(super) use uses::{color_images, shown_materials};
pub use uv_transform::UvTransform;

/// How a material uses an image. Which of a file's sets of texture coordinates it refers to is no
/// part of it: [`super::Mesh::uvs`] is that set.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TextureUse {
    /// Index into [`super::Scene::images`].
    pub image: usize,
    /// What lies between and beyond the texels.
    pub sampler: Sampler,
    /// From the mesh's coordinates to the image's.
    pub transform: UvTransform,
}

#[cfg(test)]
pub(super) mod tests;
