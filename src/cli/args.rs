//! Arguments that several commands take.

use std::str::FromStr;

use crate::scene::{CameraSpec, Keep};

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

/// A positive number of seconds.
pub fn seconds(text: &str) -> Result<f64, String> {
    let secs = text.parse().ok().filter(|secs: &f64| *secs > 0.0 && secs.is_finite());
    secs.ok_or_else(|| "it is not a positive number of seconds".to_owned())
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
