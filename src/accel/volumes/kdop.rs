//! Boxes with their corners and edges cut off by slabs of fixed directions, and the octahedron.

use super::points::Points;
use super::volume::Volume;
use crate::accel::cell::{Form, Shape};
use crate::geometry::kdop::{DiagonalLine, Diagonals, Octahedron, box_planes};
use crate::geometry::num::{round_down, round_up};
use crate::geometry::polytope::{Plane, area};
use crate::geometry::{Aabb, Line, Polyhedron, Slabs};
use crate::task::Cancelled;
use glam::Vec3;

/// A box and `N` slabs of diagonals: k is 6 + 2N.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub struct Kdop<const FIRST: usize, const N: usize> {
    bounds: Aabb,
    slabs: Diagonals<FIRST, N>,
}

/// The slabs of the axes alone: a box, written as one more set of directions.
pub type Kdop6 = Kdop<0, 0>;
/// Its corners cut off.
pub type Kdop14 = Kdop<0, 4>;
/// Its edges cut off.
pub type Kdop18 = Kdop<4, 6>;
/// Both cut off.
pub type Kdop26 = Kdop<0, 10>;

impl<const FIRST: usize, const N: usize> Volume for Kdop<FIRST, N> {
    const ID: &'static str = ["kdop6", "", "", "", "kdop14", "", "kdop18", "", "", "", "kdop26"][N];
    type Shared = ();
    type Fit = Self;
    type Up = Diagonals<FIRST, N>;
    type Ray = (Slabs, DiagonalLine<N>);

    /// The slabs of a node are exactly those around its children's.
    fn around(points: &Points<'_>, below: Option<[Self::Up; 2]>) -> Result<(Self, Self::Up), Cancelled> {
        let slabs = diagonals(points, below)?;
        Ok((Self { bounds: points.bounds, slabs }, slabs))
    }

    fn store(fit: Self, (): &mut ()) -> Self {
        fit
    }

    fn ray(line: &Line) -> Self::Ray {
        (line.slabs, Diagonals::<FIRST, N>::line(line))
    }

    /// All slabs say whether the line meets the volume, those of the axes where something may be hit.
    #[inline(always)]
    fn interval(&self, (): &(), (axes, diagonals): &Self::Ray) -> Option<(f32, f32)> {
        let in_box = axes.interval(&self.bounds);
        let (entry, exit) = self.slabs.cut(diagonals, in_box);
        (entry <= exit).then_some(in_box)
    }

    fn shape(&self, (): &(), centre: Vec3) -> Shape {
        if N == 0 {
            return Shape::Box(self.bounds);
        }
        let mut planes = self.slabs.planes();
        planes.extend(box_planes(&self.bounds, centre.as_dvec3()));
        Shape::Convex { bounds: self.bounds, area: area(&planes, reach(&self.bounds, centre)) }
    }

    fn form(&self, (): &(), centre: Vec3) -> Form {
        if N == 0 { Form::Box(self.bounds) } else { behind(&self.bounds, &self.slabs.planes(), centre) }
    }
}

impl Volume for Octahedron {
    const ID: &'static str = "kdop8";
    type Shared = ();
    type Fit = Self;
    type Up = Self;
    type Ray = (Line, DiagonalLine<4>);

    fn around(points: &Points<'_>, below: Option<[Self; 2]>) -> Result<(Self, Self), Cancelled> {
        diagonals(points, below).map(|slabs| (slabs, slabs))
    }

    fn store(fit: Self, (): &mut ()) -> Self {
        fit
    }

    fn ray(line: &Line) -> Self::Ray {
        (*line, Self::line(line))
    }

    #[inline(always)]
    fn interval(&self, (): &(), (line, diagonals): &Self::Ray) -> Option<(f32, f32)> {
        let (min, max) = self.rounded_box();
        let in_box = line.in_box(min, max);
        let (entry, exit) = self.cut(diagonals, in_box);
        (entry <= exit).then_some(in_box)
    }

    fn shape(&self, (): &(), centre: Vec3) -> Shape {
        // The halves of 32-bit sums err by one rounding, the sums with the centre by another.
        let (min, max) = self.rounded_box();
        let end = |rounded: f32, k: usize| f64::from(rounded) + f64::from(centre[k]);
        let min: [f32; 3] = std::array::from_fn(|k| round_down(end(min[k].next_down(), k)));
        let max: [f32; 3] = std::array::from_fn(|k| round_up(end(max[k].next_up(), k)));
        let bounds = Aabb { min: min.into(), max: max.into() };
        Shape::Convex { bounds, area: area(&self.planes(), reach(&bounds, centre)) }
    }

    fn form(&self, (): &(), centre: Vec3) -> Form {
        behind(self.shape(&(), centre).bounds(), &self.planes(), centre)
    }
}

fn diagonals<const FIRST: usize, const N: usize>(
    points: &Points<'_>,
    below: Option<[Diagonals<FIRST, N>; 2]>,
) -> Result<Diagonals<FIRST, N>, Cancelled> {
    if let Some([left, right]) = below {
        return Ok(left.union(&right));
    }
    let mut slabs = Diagonals::EMPTY;
    if N > 0 {
        points.each(|p| slabs = slabs.with(p))?;
    }
    Ok(slabs)
}

/// The part of a box behind some planes, which are relative to `centre`. They are taken as they are, offsets of 32 bits and all: two
/// faces of a hull may meet at an angle of 1e-4, where an edge moves ten thousand times as far as a plane that is called met early.
pub fn behind(bounds: &Aabb, planes: &[Plane], centre: Vec3) -> Form {
    const SLACK: f64 = 1e-12;
    let slack = SLACK * f64::from(bounds.size().max_element());
    let mut form = Polyhedron::of_box(bounds);
    for plane in planes {
        form.cut(&Plane { offset: plane.offset + plane.normal.dot(centre.as_dvec3()), ..*plane }, slack);
    }
    Form::Polyhedron(form)
}

/// How far a box reaches from `centre`.
pub fn reach(bounds: &Aabb, centre: Vec3) -> f64 {
    let (min, max) = (bounds.min.as_dvec3() - centre.as_dvec3(), bounds.max.as_dvec3() - centre.as_dvec3());
    min.abs().max(max.abs()).length().max(f64::MIN_POSITIVE)
}
