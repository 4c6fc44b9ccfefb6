//! Light: what surfaces do with it ([`Bsdf`]), where it comes from ([`Sources`]), and paths that it takes to the eye (`path`).

mod albedo;
mod bsdf;
mod microfacet;
mod path;
mod sources;

pub use bsdf::Bsdf;
pub use sources::{Sky, Sources};
