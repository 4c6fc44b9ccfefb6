//! Scenes made in code: always at hand, the same everywhere, and most of them in any size.
//!
//! A scene is one file here and one line of [`all`]. Each is made for something: a figure for a
//! lecture, a classic that readers of papers know, or a way to make some structure suffer.

mod bezier;
mod cornell_box;
mod fill;
mod hair;
mod lecture;
mod menger;
mod noise;
mod random;
mod soup;
mod spec;
mod sphere;
mod sphere_flake;
mod stadium;
mod teapot;
mod teapot_in_stadium;
mod terrain;

use super::{Camera, FirstView, LoadCx, Projection, Reason, Scene};
use glam::Vec3;
pub(crate) use random::Random;
use spec::Spec;

/// What the name of a built-in scene begins with.
pub const SCHEME: &str = "builtin:";

/// The most triangles that may be asked for.
pub const MAX_TRIANGLES: usize = 50_000_000;

/// The same where each mesh is counted as often as it is placed.
pub const MAX_PLACED: usize = 2_000_000_000;

/// Makes the scene with about so many triangles.
type Generate = fn(usize, &LoadCx) -> Result<Scene, Reason>;

/// One built-in scene.
#[derive(Debug)]
pub struct Builtin {
    /// What the user calls it, after [`SCHEME`].
    pub id: &'static str,
    /// What it shows, in one sentence.
    pub about: &'static str,
    /// How many triangles it has.
    pub size: Size,
    generate: Generate,
}

/// How many triangles a built-in scene has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Size {
    /// Always so many.
    Fixed(usize),
    /// So many unless told otherwise by `?triangles=N`, which the scene comes as near to as its
    /// construction allows. Ten million are made in seconds; [`MAX_TRIANGLES`] is the limit.
    Scales(usize),
    /// The same, but meshes are placed many times, and [`MAX_PLACED`] is the limit.
    Places(usize),
}

impl Size {
    /// The number of triangles when nothing is said.
    pub const fn by_default(self) -> usize {
        match self {
            Self::Fixed(n) | Self::Scales(n) | Self::Places(n) => n,
        }
    }

    /// The most that may be asked for.
    pub const fn most(self) -> usize {
        match self {
            Self::Fixed(n) => n,
            Self::Scales(_) => MAX_TRIANGLES,
            Self::Places(_) => MAX_PLACED,
        }
    }
}

use Size::{Fixed, Places, Scales};

#[rustfmt::skip]
static ALL: [Builtin; 9] = [
    scene("lecture", "Sixteen flat triangles, for drawing trees on.", Fixed(16), lecture::generate),
    scene("teapot", "The Utah teapot, from its Bezier patches.", Scales(6_320), teapot::generate),
    scene("teapot-in-stadium", "A small teapot in a huge stadium, which a uniform grid puts into one cell.", Scales(20_224), teapot_in_stadium::generate),
    scene("cornell-box", "The Cornell box, as measured.", Scales(38), cornell_box::generate),
    scene("sphere-flake", "Haines' sphere flake: one sphere, placed hundreds of times.", Places(104_962), sphere_flake::generate),
    scene("menger", "A Menger sponge: large flat faces, all parallel to the axes.", Scales(36_096), menger::generate),
    scene("terrain", "Mountains: an even sheet of small triangles.", Scales(131_072), terrain::generate),
    scene("hair", "A ball of hair: long thin triangles, whose boxes are mostly empty.", Scales(100_000), hair::generate),
    scene("soup", "Triangles thrown at random into a cube.", Scales(100_000), soup::generate),
];

const fn scene(id: &'static str, about: &'static str, size: Size, generate: Generate) -> Builtin {
    Builtin { id, about, size, generate }
}

/// Every built-in scene, in the order in which lists show them.
pub fn all() -> &'static [Builtin] {
    &ALL
}

/// A view of `target` from `offset` away, z up. As its angle is the vertical one, what fits by height
/// is seen in a picture of any shape that is not upright.
fn view(target: Vec3, offset: Vec3) -> FirstView {
    let projection = Projection::Perspective { fov_y: Camera::DEFAULT_FOV_Y };
    FirstView::From(Camera { eye: target + offset, target, up: Vec3::Z, projection })
}

/// Makes the scene that `spec` names: `NAME` or `NAME?triangles=N`. The same spec gives the same
/// scene to the bit, on any number of threads.
///
/// # Errors
/// No such scene or option, over the memory budget, or cancelled.
pub fn generate(spec: &str, cx: &LoadCx) -> Result<Scene, Reason> {
    let Spec { scene, triangles } = Spec::parse(spec)?;
    cx.cancel.check()?;
    let mut made = (scene.generate)(triangles, cx)?;
    made.name = format!("{SCHEME}{spec}");
    Ok(made)
}
