//! Arguments that several commands take.

use std::path::PathBuf;
use std::str::FromStr;
use std::sync::Arc;

use crate::geometry::num::narrow;
use crate::render::light::Surroundings;
use crate::render::{Curve, Film, Tone, Transport};
use crate::scene::{CameraSpec, Environment, Keep};

use super::context::Context;
use super::failure::Failure;
use super::{bar, output};

/// What is opened, and with how much of the machine.
#[derive(Debug, clap::Args)]
pub struct ModelArgs {
    /// A file (.gltf, .glb, .obj, .ply, .stl), builtin:NAME, or builtin:NAME?triangles=N.
    pub model: String,
    #[command(flatten)]
    pub machine: MachineArgs,
}

/// What is made of the scene.
#[derive(Clone, Copy, Debug, Default, clap::Args)]
pub struct SceneArgs {
    /// Flatten meshes that stand in several places, instead of building one structure for each and a level above.
    #[arg(long)]
    pub flatten: bool,
    /// Treat everything as if it needed all that any scene can: vertices with every attribute, each image whole, every hit
    /// tested for holes, a level above single meshes. For seeing what leaving that out saves ('boxwood needs').
    #[arg(long, conflicts_with = "flatten")]
    pub force_all: bool,
}

impl SceneArgs {
    /// Every instance as triangles of its own.
    pub const FLAT: Self = Self { flatten: true, force_all: false };

    /// How much of the scene is kept.
    pub const fn keep(self) -> Keep {
        if self.force_all { Keep::All } else { Keep::Needed }
    }
}

/// How much of the machine is used.
#[derive(Clone, Copy, Debug, clap::Args)]
pub struct MachineArgs {
    /// Threads that load, build and trace [default: one for each core].
    #[arg(long, value_name = "N", default_value_t = 0, hide_default_value = true, value_parser = threads())]
    pub threads: usize,
    /// Memory that the work may take, in MiB [default: half of the machine's or container's].
    #[arg(long, value_name = "MIB")]
    pub memory: Option<u64>,
}

/// More threads than any machine has are a slip of the finger.
fn threads() -> clap::builder::RangedU64ValueParser<usize> {
    clap::builder::RangedU64ValueParser::new().range(..=1024)
}

/// What is looked at.
#[derive(Debug, clap::Args)]
pub struct LookArgs {
    /// "eye X,Y,Z target X,Y,Z [up X,Y,Z] [fov DEGREES | height H]": fov is the vertical angle of a
    /// perspective view (default 40), height that of a parallel one in world units [default: the
    /// model's own view, or all of it].
    #[arg(long, value_name = "SPEC")]
    pub camera: Option<CameraSpec>,
}

/// Which numbers samples are made of.
#[derive(Clone, Copy, Debug, clap::Args)]
pub struct SeedArgs {
    /// Another seed makes another picture of the same.
    #[arg(long, value_name = "N", default_value_t = 0)]
    pub seed: u32,
}

/// What a path traced picture depends on besides model and camera.
#[derive(Clone, Debug, clap::Args)]
pub struct LightArgs {
    #[command(flatten)]
    pub seed: SeedArgs,
    #[command(flatten)]
    pub around: AroundArgs,
    #[command(flatten)]
    pub transport: TransportArgs,
}

/// What is around the scene, in mode path.
#[derive(Clone, Debug, clap::Args)]
pub struct AroundArgs {
    /// An image of the surroundings (.hdr, .exr; its middle column looks along -Z, or what is that where another axis is up)
    /// [default: a clear day where the model has no lights, and else nothing].
    #[arg(long, value_name = "FILE", conflicts_with = "sun")]
    pub environment: Option<PathBuf>,
    /// Turn the image about the axis that is up.
    #[arg(long, value_name = "DEGREES", default_value_t = 0.0, allow_negative_numbers = true, requires = "environment", value_parser = degrees)]
    pub environment_turn: f32,
    /// How many times as bright the image is.
    #[arg(long, value_name = "FACTOR", default_value_t = 1.0, requires = "environment", value_parser = positive)]
    pub environment_strength: f64,
    /// A clear day, whatever lights the model has, with the sun that high over the horizon and that far round; below it there
    /// is none.
    #[arg(long, value_name = "ELEVATION,AZIMUTH", allow_negative_numbers = true)]
    pub sun: Option<SunAt>,
}

/// Where the sun is, in degrees.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SunAt {
    elevation: f32,
    azimuth: f32,
}

impl FromStr for SunAt {
    type Err = String;

    fn from_str(s: &str) -> Result<Self, String> {
        let both = s.split_once(',').and_then(|(e, a)| Some((degrees(e.trim()).ok()?, degrees(a.trim()).ok()?)));
        let (elevation, azimuth) = both.ok_or("the sun is at ELEVATION,AZIMUTH, in degrees")?;
        Ok(Self { elevation, azimuth })
    }
}

impl AroundArgs {
    /// What it comes to. Reads the image; what is wrong with it is told on standard error.
    pub fn surroundings(&self, cx: &Context) -> Result<Surroundings, Failure> {
        if let Some(SunAt { elevation, azimuth }) = self.sun {
            return Ok(Surroundings::Day { elevation: elevation.to_radians(), azimuth: azimuth.to_radians() });
        }
        let Some(path) = &self.environment else { return Ok(Surroundings::Usual) };
        let load_cx = cx.load_cx();
        let image = bar::watch("environment", &load_cx.progress, || Environment::open(path, &load_cx))?;
        image.warnings().iter().for_each(|warning| output::warn(&format!("{}: {warning}", path.display())));
        let (turn, strength) = (self.environment_turn.to_radians(), narrow(self.environment_strength));
        Ok(Surroundings::Image { image: Arc::new(image), turn, strength })
    }
}

fn degrees(text: &str) -> Result<f32, String> {
    let degrees = text.parse().ok().filter(|degrees: &f32| degrees.abs() <= 3600.0);
    degrees.ok_or_else(|| "it is not a number of degrees".to_owned())
}

/// How far light is followed, in mode path.
#[derive(Clone, Copy, Debug, clap::Args)]
pub struct TransportArgs {
    /// Surfaces that a path meets at most; light that comes over more is missing.
    #[arg(long, value_name = "N", default_value_t = Transport::default().surfaces, value_parser = clap::value_parser!(u32).range(1..=64))]
    pub surfaces: u32,
    /// Surfaces before a path may end by chance (Russian roulette).
    #[arg(long, value_name = "N", default_value_t = Transport::default().certain)]
    pub roulette: u32,
    /// Cut down light over two and more surfaces that adds more than this to a sample: fewer bright dots, and a picture that
    /// is darker than it should be. Off unless asked; what it takes is told.
    #[arg(long, value_name = "LIGHT", value_parser = positive)]
    pub clamp: Option<f64>,
}

impl TransportArgs {
    /// The same for the renderer.
    pub fn transport(self) -> Transport {
        Transport { surfaces: self.surfaces, certain: self.roulette, clamp: self.clamp.map(narrow) }
    }
}

/// How light becomes colour, in mode path.
#[derive(Clone, Copy, Debug, clap::Args)]
pub struct ToneArgs {
    /// Exposure in stops, each of which doubles the light; or auto, which makes what is seen a middle grey.
    #[arg(long, value_name = "STOPS|auto", default_value = "0", allow_negative_numbers = true)]
    pub exposure: Exposure,
    /// What becomes of light that is too bright: plain (white) or filmic (bent as film does).
    #[arg(long, default_value = "plain")]
    pub tone: Curve,
}

impl ToneArgs {
    /// The same for a picture.
    pub fn tone(self, film: &Film) -> Tone {
        let exposure = match self.exposure {
            Exposure::Stops(stops) => stops,
            Exposure::Auto => film.fitting_exposure().unwrap_or(0.0),
        };
        Tone { exposure, curve: self.tone }
    }
}

/// How bright a picture is made.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Exposure {
    /// By so much.
    Stops(f32),
    /// As suits it.
    Auto,
}

impl FromStr for Exposure {
    type Err = String;

    fn from_str(s: &str) -> Result<Self, String> {
        if s == "auto" {
            return Ok(Self::Auto);
        }
        let stops = s.parse().ok().filter(|stops: &f32| stops.abs() <= 32.0);
        stops.map(Self::Stops).ok_or_else(|| "it is not a number of stops from -32 to 32, nor auto".to_owned())
    }
}

/// A positive number.
pub fn positive(text: &str) -> Result<f64, String> {
    let number = text.parse().ok().filter(|number: &f64| *number > 0.0 && number.is_finite());
    number.ok_or_else(|| "it is not a positive number".to_owned())
}

/// A positive number of seconds.
pub fn seconds(text: &str) -> Result<f64, String> {
    positive(text).map_err(|_| "it is not a positive number of seconds".to_owned())
}

/// A number from 0 to 1.
pub fn share(text: &str) -> Result<f64, String> {
    let share = text.parse().ok().filter(|share: &f64| (0.0..=1.0).contains(share));
    share.ok_or_else(|| "it is not a number from 0 to 1".to_owned())
}

/// Columns and rows of a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Size {
    pub width: u32,
    pub height: u32,
}

impl Size {
    /// The most columns or rows.
    const MOST: u32 = 16_384;

    /// Width over height.
    pub fn aspect(self) -> f32 {
        self.width as f32 / self.height as f32
    }

    /// Columns times rows.
    pub fn pixels(self) -> u64 {
        u64::from(self.width) * u64::from(self.height)
    }
}

impl FromStr for Size {
    type Err = String;

    fn from_str(s: &str) -> Result<Self, String> {
        let side = |text: &str| text.parse().ok().filter(|n| (1..=Self::MOST).contains(n));
        let sides = s.split_once(['x', 'X']).and_then(|(w, h)| Some(Self { width: side(w)?, height: side(h)? }));
        sides.ok_or_else(|| format!("a size is WIDTHxHEIGHT, each from 1 to {}", Self::MOST))
    }
}

impl std::fmt::Display for Size {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}x{}", self.width, self.height)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_are_two_positive_numbers() {
        assert_eq!("640x480".parse(), Ok(Size { width: 640, height: 480 }));
        for wrong in ["640", "0x5", "5x0", "axb", "1x1x1", "-1x5", "99999x1", "x"] {
            assert!(wrong.parse::<Size>().is_err(), "{wrong}");
        }
    }
}
