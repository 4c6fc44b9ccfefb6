//! From a camera to a picture: rays, samples, shading, the film they gather on, and the scheduler
//! that refines a picture while nobody waits for it.

pub mod colormap;
mod develop;
mod film;
pub mod light;
mod looks;
mod mode;
mod picture;
pub mod progressive;
pub mod raster;
pub mod sampler;
mod shade;
pub mod spawn;
mod spread;
mod still;
mod tile;

pub use develop::{Development, Range, auto_range};
pub use film::Film;
pub use looks::Looks;
pub use mode::Mode;
pub use picture::{Picture, Progress};
pub use progressive::{Renderer, Request};
pub use still::{Still, render};
pub use tile::Job;
