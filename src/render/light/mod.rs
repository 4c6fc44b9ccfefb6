//! Light: what surfaces do with it ([`Bsdf`]), where it comes from ([`Sources`]), and paths that it takes to the eye (`path`).

mod albedo;
mod beams;
mod bsdf;
mod environment;
mod microfacet;
mod path;
mod shining;
mod sky;
mod sources;
mod transport;

pub use bsdf::Bsdf;
pub use environment::Dome;
pub use sky::{Sky, Sun};
pub use sources::{Sources, Surroundings};
pub use transport::Transport;
