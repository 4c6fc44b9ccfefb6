//! The sphere: the least to store and to test, and the loosest around most things.

use super::points::Points;
use super::volume::Volume;
use crate::accel::cell::{Form, Shape};
use crate::geometry::kdop::extremes;
use crate::geometry::num::{round_down, round_up};
use crate::geometry::sphere::{Sphere, smallest_ball};
use crate::geometry::{Aabb, Line};
use crate::task::Cancelled;
use glam::{DVec3, Vec3};

/// Rounds in which a large node's sphere, fitted to its extreme points, takes in the point farthest
/// outside and is fitted again.
const ROUNDS: usize = 4;

impl Volume for Sphere {
    const ID: &'static str = "sphere";
    type Shared = ();
    type Fit = Self;
    type Up = Vec<DVec3>;
    type Ray = Line;

    /// The smallest ball around the points of a small node, or around the extreme points of a large
    /// one; its radius comes from all points in any case.
    fn around(points: &Points<'_>, below: Option<[Vec<DVec3>; 2]>) -> Result<(Self, Vec<DVec3>), Cancelled> {
        let mut few = points.for_choosing(below)?;
        let mut best = Self::new(Vec3::ZERO, f64::INFINITY);
        for _ in 0..ROUNDS {
            let Some((centre, radius)) = smallest_ball(&few) else { break };
            let centre = centre.as_vec3();
            let (far, reach) = farthest(points, centre)?;
            if reach < f64::from(best.radius) {
                best = Self::new(centre, reach);
            }
            if reach <= radius * (1.0 + 1e-6) {
                break;
            }
            few.push(far);
        }
        Ok((best, extremes(&few)))
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
        let (at, r) = (self.centre.as_dvec3() + centre.as_dvec3(), f64::from(self.radius));
        let (min, max) = ((at - r).to_array().map(round_down), (at + r).to_array().map(round_up));
        Shape::Convex { bounds: Aabb { min: min.into(), max: max.into() }, area: self.area() }
    }

    fn form(&self, (): &(), centre: Vec3) -> Form {
        Form::Sphere { centre: self.centre.as_dvec3() + centre.as_dvec3(), radius: self.radius.into() }
    }
}

fn farthest(points: &Points<'_>, centre: Vec3) -> Result<(DVec3, f64), Cancelled> {
    let (centre, mut far, mut squared) = (centre.as_dvec3(), DVec3::ZERO, 0.0);
    points.each(|p| {
        let d = p.distance_squared(centre);
        if d > squared {
            (far, squared) = (p, d);
        }
    })?;
    Ok((far, squared.sqrt()))
}
