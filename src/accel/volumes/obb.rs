//! The box of any orientation: tight around what is flat or long in no axis's direction.

use super::points::Points;
use super::volume::Volume;
use crate::accel::cell::{Form, Shape};
use crate::geometry::kdop::extremes;
use crate::geometry::num::{round_down, round_up};
use crate::geometry::obb::{Extents, Obb, good_axes};
use crate::geometry::{Aabb, Line, Polyhedron};
use crate::task::Cancelled;
use glam::{DVec3, Vec3};

impl Volume for Obb {
    const ID: &'static str = "obb";
    type Shared = ();
    type Fit = Self;
    type Up = Vec<DVec3>;
    type Ray = Line;

    /// Axes come from the points of a small node, or the extreme points of a large one; the extents
    /// along them, and those of the box with faces parallel to the axes, from all points. The
    /// smaller of the two boxes is taken.
    fn around(points: &Points<'_>, below: Option<[Vec<DVec3>; 2]>) -> Result<(Self, Vec<DVec3>), Cancelled> {
        let few = points.for_choosing(below)?;
        let (mut turned, mut straight) = (Extents::new(good_axes(&few)), Extents::new(Vec3::AXES));
        points.each(|p| {
            turned.add(p);
            straight.add(p);
        })?;
        let best = if turned.area() < straight.area() { turned } else { straight };
        Ok((best.obb(), extremes(&few)))
    }

    fn store(fit: Self, (): &mut ()) -> Self {
        fit
    }

    fn ray(line: &Line) -> Line {
        *line
    }

    #[inline(always)]
    fn interval(&self, (): &(), line: &Line) -> Option<(f32, f32)> {
        Self::interval(self, line)
    }

    fn shape(&self, (): &(), centre: Vec3) -> Shape {
        let corners = self.corners().map(|p| p + centre.as_dvec3());
        let min = corners.into_iter().fold(DVec3::INFINITY, DVec3::min).to_array().map(round_down);
        let max = corners.into_iter().fold(DVec3::NEG_INFINITY, DVec3::max).to_array().map(round_up);
        Shape::Convex { bounds: Aabb { min: min.into(), max: max.into() }, area: self.area() }
    }

    fn form(&self, (): &(), centre: Vec3) -> Form {
        Form::Polyhedron(Polyhedron::of_corners(self.corners().map(|p| p + centre.as_dvec3())))
    }
}
