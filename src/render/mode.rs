//! What a picture shows.

use crate::accel::probe::Counts;

/// A way to turn a hit, or the work it took, into a colour.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Mode {
    /// Base colour under a headlight and a sky.
    #[default]
    Shaded,
    /// The shading normal as a colour.
    Normals,
    /// Distance along the view.
    Depth,
    /// How open the surroundings of a point are.
    Ao,
    /// Light, followed from surface to surface.
    Path,
    /// Nodes visited by a ray.
    Nodes,
    /// Leaves visited by a ray.
    Leaves,
    /// Primitives tested by a ray.
    Prims,
    /// Entries that wait on the stack at once while a ray is traced.
    Stack,
}

impl Mode {
    /// All of them, in the order of menus.
    pub const ALL: [Self; 9] =
        [Self::Shaded, Self::Path, Self::Ao, Self::Normals, Self::Depth, Self::Nodes, Self::Leaves, Self::Prims, Self::Stack];

    /// The name used on the command line and in files.
    pub const fn id(self) -> &'static str {
        match self {
            Self::Shaded => "shaded",
            Self::Normals => "normals",
            Self::Depth => "depth",
            Self::Ao => "ao",
            Self::Path => "path",
            Self::Nodes => "nodes",
            Self::Leaves => "leaves",
            Self::Prims => "prims",
            Self::Stack => "stack",
        }
    }

    /// The name in the window.
    pub const fn label(self) -> &'static str {
        match self {
            Self::Shaded => "Shaded",
            Self::Normals => "Normals",
            Self::Depth => "Depth",
            Self::Ao => "Ambient occlusion",
            Self::Path => "Path traced",
            Self::Nodes => "Nodes visited",
            Self::Leaves => "Leaves visited",
            Self::Prims => "Primitives tested",
            Self::Stack => "Stack depth",
        }
    }

    /// One sentence for the user.
    pub const fn help(self) -> &'static str {
        match self {
            Self::Shaded => "Base colour under a headlight and a sky.",
            Self::Normals => "The direction of the surface as a colour: red is x, green is y, blue is z.",
            Self::Depth => "Distance from the camera, near is bright.",
            Self::Path => "Light from the model's lamps, or from a sky where it has none, followed from surface to surface.",
            Self::Ao => "How much of the sky each point sees: one random ray a sample.",
            Self::Nodes => "How many nodes or cells each ray visits in the structure.",
            Self::Leaves => "How many leaves, which hold triangles, each ray visits.",
            Self::Prims => "How many triangles each ray is tested against.",
            Self::Stack => "How many nodes wait on the stack at once, at most, while each ray is traced; in an octree, levels.",
        }
    }

    /// Whether pixels are amounts that a range turns into colours, rather than colours.
    pub const fn is_scalar(self) -> bool {
        self.is_heat() || matches!(self, Self::Depth)
    }

    /// Rays that a pixel takes for a sample, about: what a pass takes is foreseen by it.
    pub const fn rays_per_pixel(self) -> f64 {
        match self {
            Self::Path => 8.0,
            Self::Ao => 2.0,
            _ => 1.0,
        }
    }

    /// What of a traversal's counts is shown.
    pub(super) const fn amount(self, counts: &Counts) -> u64 {
        match self {
            Self::Nodes => counts.nodes,
            Self::Leaves => counts.leaves,
            Self::Stack => counts.stack,
            _ => counts.prims,
        }
    }

    /// Whether the traversal is watched.
    pub const fn is_heat(self) -> bool {
        matches!(self, Self::Nodes | Self::Leaves | Self::Prims | Self::Stack)
    }
}

impl std::str::FromStr for Mode {
    type Err = String;

    fn from_str(s: &str) -> Result<Self, String> {
        let ids = || Self::ALL.map(Self::id).join(", ");
        Self::ALL.into_iter().find(|mode| mode.id() == s).ok_or_else(|| format!("there is no mode '{s}': use one of {}", ids()))
    }
}
