//! Lights that are no surfaces: points without a size, and what shines from far away.

use glam::Vec3;

/// A light without a size (KHR_lights_punctual, Khronos, 2018). No ray meets it.
#[derive(Clone, Debug, PartialEq)]
pub struct Light {
    /// What the file calls it; may be empty.
    pub name: String,
    /// How it shines.
    pub kind: LightKind,
    /// Linear colour times intensity, finite and never negative: candela (lm/sr) of points and spots, lux (lm/m²) where it
    /// is directional. The unit of length is the scene's.
    pub color: [f32; 3],
    /// Where it is in the world; of no matter where it is directional.
    pub at: Vec3,
    /// The direction in the world that it shines in, of unit length; of no matter to a point.
    pub towards: Vec3,
    /// How far it may be cut off, in units of the world: above 0; `None` if it reaches everywhere.
    pub range: Option<f32>,
}

/// How a light shines.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LightKind {
    /// From a point, in all directions alike; less with the square of the distance.
    Point,
    /// From a point into a cone; less with the square of the distance.
    Spot {
        /// Half the angle, in radians, of the cone within which it shines in full: at least 0.
        inner: f32,
        /// Half the angle, in radians, of the cone beyond which it does not: above `inner`, at most a right angle.
        outer: f32,
    },
    /// From infinitely far away, everywhere alike.
    Directional,
}
