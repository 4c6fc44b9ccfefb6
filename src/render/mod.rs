//! From a camera to a picture: rays, samples, shading, the film they gather on, and the scheduler
//! that refines a picture while nobody waits for it.

mod amounts;
pub mod colormap;
mod develop;
mod film;
mod heat;
pub mod light;
mod linear;
mod looks;
mod mode;
mod picture;
mod png;
pub mod progressive;
pub mod raster;
pub mod sampler;
mod shade;
pub mod spawn;
mod spread;
mod still;
mod tile;
mod work;

pub use amounts::{Amounts, Histogram};
pub use develop::{Curve, Development, Range, Tone, auto_range, encode};
pub use film::Film;
pub use heat::HeatRays;
pub use light::Transport;
pub use linear::{LinearError, LinearPicture};
pub use looks::Looks;
pub use mode::Mode;
pub use picture::{Picture, Progress, Shot};
pub use png::{PngError, png};
pub use progressive::{Renderer, Request};
pub use still::{Still, Until, render};
pub use tile::Job;
pub use work::Work;
