//! The box with faces parallel to the axes: what every other volume is compared with.

use super::points::Points;
use super::volume::Volume;
use crate::accel::cell::{Form, Shape};
use crate::geometry::{Aabb, Line, Slabs};
use crate::task::Cancelled;
use glam::Vec3;

impl Volume for Aabb {
    const ID: &'static str = "aabb";
    type Shared = ();
    type Fit = Self;
    type Up = ();
    type Ray = Slabs;

    fn around(points: &Points<'_>, _: Option<[(); 2]>) -> Result<(Self, ()), Cancelled> {
        Ok((points.bounds, ()))
    }

    fn store(fit: Self, (): &mut ()) -> Self {
        fit
    }

    fn ray(line: &Line) -> Slabs {
        line.slabs
    }

    #[inline(always)]
    fn interval(&self, (): &(), slabs: &Slabs) -> Option<(f32, f32)> {
        let (entry, exit) = slabs.interval(self);
        (entry <= exit).then_some((entry, exit))
    }

    fn shape(&self, (): &(), _: Vec3) -> Shape {
        Shape::Box(*self)
    }

    fn form(&self, (): &(), _: Vec3) -> Form {
        Form::Box(*self)
    }
}
