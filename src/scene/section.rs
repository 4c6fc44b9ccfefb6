//! A plane that cuts the scene open for the camera.

use std::str::FromStr;

use crate::geometry::num::narrow;
use crate::geometry::{Aabb, Axis, HalfSpace, Side};

/// Where a scene is cut: across an axis, at a place of its bounds, and which side is left.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Section {
    /// The axis that the plane is perpendicular to.
    pub axis: Axis,
    /// From 0, where the scene's bounds begin along the axis, to 1, where they end.
    pub place: f32,
    /// The side that is left.
    pub side: Side,
}

impl Default for Section {
    fn default() -> Self {
        Self { axis: Axis::X, place: 0.5, side: Side::Below }
    }
}

impl Section {
    /// What is left of a scene with these bounds; lengths are theirs. Of an empty scene any part will do.
    pub fn of(&self, bounds: &Aabb) -> HalfSpace {
        let bounds = if bounds.is_empty() { Aabb { min: glam::Vec3::ZERO, max: glam::Vec3::ZERO } } else { *bounds };
        let [min, max] = [bounds.min, bounds.max].map(|corner| f64::from(corner[self.axis.index()]));
        HalfSpace { axis: self.axis, at: narrow(min + (max - min) * f64::from(self.place)), side: self.side }
    }
}

/// `x,0.5` leaves what is below the middle along x, `-x,0.5` what is above it.
impl FromStr for Section {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let parsed = text.split_once(',').and_then(|(axis, place)| {
            let axis = axis.trim();
            let (name, side) = axis.strip_prefix('-').map_or((axis, Side::Below), |name| (name, Side::Above));
            let axis = Axis::ALL.into_iter().find(|known| known.name() == name)?;
            let place = place.trim().parse().ok().filter(|place| (0.0..=1.0).contains(place))?;
            Some(Self { axis, place, side })
        });
        parsed.ok_or_else(|| "a section is an axis and a place from 0 to 1, as in x,0.5, or -x,0.5 for the other side".to_owned())
    }
}

impl std::fmt::Display for Section {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let side = if self.side == Side::Above { "-" } else { "" };
        write!(f, "{side}{},{}", self.axis.name(), self.place)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    #[test]
    fn a_section_is_at_a_place_of_the_bounds() {
        let bounds = Aabb { min: Vec3::new(-1.0, 2.0, 0.0), max: Vec3::new(3.0, 2.0, 1.0) };
        let section = Section { place: 0.25, ..Section::default() };
        assert_eq!(section.of(&bounds), HalfSpace { axis: Axis::X, at: 0.0, side: Side::Below });
        let ends = [0.0, 1.0].map(|place| Section { place, ..section }.of(&bounds).at);
        assert_eq!(ends, [-1.0, 3.0]);
        assert_eq!(Section { axis: Axis::Y, ..section }.of(&bounds).at, 2.0);
        assert!(section.of(&Aabb::EMPTY).at.is_finite());
        let widest = Aabb { min: Vec3::splat(f32::MIN), max: Vec3::splat(f32::MAX) };
        assert_eq!(Section { place: 0.5, ..section }.of(&widest).at, 0.0);
    }

    #[test]
    fn a_section_is_read_from_text() {
        assert_eq!("x,0.5".parse(), Ok(Section::default()));
        assert_eq!("-z, 1".parse(), Ok(Section { axis: Axis::Z, place: 1.0, side: Side::Above }));
        for text in ["x,0.5", "-z,1", "y,0.33"] {
            assert_eq!(text.parse::<Section>().map(|section| section.to_string()), Ok(text.to_owned()));
        }
        for text in ["", "x", "w,0.5", "x,1.5", "x,nan", "--x,0.5", "x,0.5,1"] {
            assert!(text.parse::<Section>().is_err(), "{text}");
        }
    }
}
