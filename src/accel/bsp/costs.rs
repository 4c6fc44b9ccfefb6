//! Which plane divides a cell best, by the surface area heuristic (MacDonald and Booth 1990), among
//! planes perpendicular to the axes and those that the triangles give: their own, and those through
//! their edges upright on them (Ize, Wald and Parker 2008).

use super::pieces::{Piece, Pieces};
use super::plane::{Plane, Sides, Slack};
use super::polytope::{MANY_FACES, Polytope};
use crate::geometry::{Aabb, Axis, num};
use crate::scene::Geometry;
use glam::DVec3;

/// The most candidate planes on an axis of a large cell, plus one.
pub const MAX_BINS: u32 = 128;

/// Cells with at most this many triangles try every face of every box; larger ones try equal bins.
const EXACT: usize = 64;
/// General planes are judged by at most this many triangles of a cell, evenly spread.
const COUNTED: usize = 256;

/// Which planes are tried.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Offered {
    /// Perpendicular to the axes: a k-d tree.
    Axis,
    /// Those of the triangles' faces too.
    Faces,
    /// And those through their edges, upright on the faces.
    FacesAndEdges,
}

/// The weights, and what is tried.
#[derive(Clone, Copy, Debug)]
pub struct Costs {
    /// Which planes.
    pub offered: Offered,
    /// How many triangles of a cell offer planes.
    pub samples: usize,
    /// Planes tried on each axis of a large cell, plus one.
    pub bins: usize,
    /// Cost of a step over a plane perpendicular to an axis.
    pub c_trav: f64,
    /// Cost of a step over a general plane.
    pub c_plane: f64,
    /// Cost of testing a triangle.
    pub c_isect: f64,
    /// Share forgiven when an axis plane leaves one side empty.
    pub empty_bonus: f64,
}

/// A cell and what is in it.
#[derive(Clone, Copy)]
pub struct Content<'a> {
    /// Its form.
    pub form: &'a Polytope,
    /// The area of its form.
    pub area: f64,
    /// A box around it.
    pub bounds: &'a Aabb,
    /// Its triangles.
    pub pieces: &'a Pieces,
    /// Where they are.
    pub geometry: &'a Geometry,
    /// How near is near.
    pub slack: &'a Slack,
}

/// A plane that was chosen, and the cost of the divided cell.
#[derive(Clone, Copy, Debug)]
pub struct Choice {
    /// The plane.
    pub plane: Plane,
    /// What it costs.
    pub cost: f64,
}

/// Triangles on each side of a plane; those on both count twice.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Dealt {
    below: f64,
    above: f64,
}

impl Costs {
    /// The cost of not dividing.
    pub fn leaf(&self, pieces: usize) -> f64 {
        self.c_isect * pieces as f64
    }

    /// The cheapest plane that divides the cell, if there is any candidate; the first of equals.
    pub fn best(&self, content: &Content) -> Option<Choice> {
        let mut scratch = Vec::new();
        let mut best: Option<Choice> = None;
        for axis in Axis::ALL {
            let found = self.on_axis(content, axis);
            self.improve(&mut best, content, found, &mut scratch);
        }
        if self.offered != Offered::Axis && content.form.faces() < MANY_FACES {
            let sample = Sample::of(content);
            for tri in content.offering(self.samples) {
                let face = Plane::of_face(&tri);
                let edges = (self.offered == Offered::FacesAndEdges).then(|| Plane::of_edges(&tri));
                for plane in face.into_iter().chain(edges.into_iter().flatten()) {
                    self.improve(&mut best, content, Some((plane, sample.deal(&plane, content.slack))), &mut scratch);
                }
            }
        }
        best
    }

    /// Keeps the better of the best and a candidate.
    fn improve(&self, best: &mut Option<Choice>, content: &Content, found: Option<(Plane, Dealt)>, scratch: &mut Vec<f64>) {
        let Some((plane, dealt)) = found else { return };
        let (step, bonus) = match plane {
            Plane::General { .. } => (self.c_plane, 1.0),
            Plane::Axis { .. } if dealt.below == 0.0 || dealt.above == 0.0 => (self.c_trav, 1.0 - self.empty_bonus),
            Plane::Axis { .. } => (self.c_trav, 1.0),
        };
        // The areas of the parts add up to at least the whole's: often that is enough to know.
        let at_least = step + self.c_isect * bonus * dealt.below.min(dealt.above);
        if best.is_some_and(|best| at_least >= best.cost) {
            return;
        }
        let Some(areas) = content.form.areas(&plane, content.slack, scratch) else { return };
        let tests = (areas.below * dealt.below + areas.above * dealt.above) / content.area;
        let cost = step + self.c_isect * bonus * tests;
        if cost.is_finite() && best.is_none_or(|best| cost < best.cost) {
            *best = Some(Choice { plane, cost });
        }
    }

    /// The best plane perpendicular to an axis, as if the cell were its box; its true areas decide
    /// between the axes.
    fn on_axis(&self, content: &Content, axis: Axis) -> Option<(Plane, Dealt)> {
        let (k, bounds, list) = (axis.index(), content.bounds, content.pieces.list());
        let mut best: Option<(f64, f32, Dealt)> = None;
        let candidate = |pos: f32, below: usize, above: usize| {
            if bounds.min[k] < pos && pos < bounds.max[k] {
                let (low, high) = bounds.split(axis, pos);
                let bonus = if below == 0 || above == 0 { 1.0 - self.empty_bonus } else { 1.0 };
                let cost = bonus * (low.area() * below as f64 + high.area() * above as f64);
                if best.is_none_or(|best| cost < best.0) {
                    best = Some((cost, pos, Dealt { below: below as f64, above: above as f64 }));
                }
            }
        };
        if list.len() <= EXACT {
            swept(list, k, candidate)
        } else {
            binned(list, bounds, k, self.bins, candidate)
        }
        best.map(|(_, pos, dealt)| (Plane::Axis { axis, pos }, dealt))
    }
}

/// Every face of every box, with how many pieces are below and above it.
fn swept(list: &[Piece], k: usize, mut each: impl FnMut(f32, usize, usize)) {
    let sorted = |of: fn(&Piece, usize) -> f32| {
        let mut all = [0f32; EXACT];
        list.iter().zip(&mut all).for_each(|(piece, x)| *x = of(piece, k));
        all[..list.len()].sort_unstable_by(f32::total_cmp);
        all
    };
    let (starts, ends) = (sorted(|p, k| p.bounds.min[k]), sorted(|p, k| p.bounds.max[k]));
    let (starts, ends) = (&starts[..list.len()], &ends[..list.len()]);
    for pos in starts.iter().chain(ends) {
        // What lies in the plane is below.
        let flat = list.iter().filter(|p| p.bounds.min[k] == *pos && p.bounds.max[k] == *pos).count();
        let below = starts.partition_point(|x| x < pos) + flat;
        each(*pos, below, list.len() - ends.partition_point(|x| x <= pos));
    }
}

/// Equal bins: a piece is counted in the bin of its start and in that of its end.
fn binned(list: &[Piece], bounds: &Aabb, k: usize, bins: usize, mut each: impl FnMut(f32, usize, usize)) {
    let (origin, width) = (bounds.min[k], bounds.size()[k]);
    let per_unit = bins as f32 / width;
    if !per_unit.is_finite() {
        return;
    }
    let bin = |x: f32| num::floor_index(f64::from((x - origin) * per_unit), bins - 1);
    let (mut starts, mut ends) = ([0usize; MAX_BINS as usize], [0usize; MAX_BINS as usize]);
    for piece in list {
        starts[bin(piece.bounds.min[k])] += 1;
        ends[bin(piece.bounds.max[k])] += 1;
    }
    let (mut below, mut above) = (0, list.len());
    for i in 1..bins {
        below += starts[i - 1];
        above -= ends[i - 1];
        each(origin + width * (i as f32 / bins as f32), below, above);
    }
}

impl Content<'_> {
    /// So many triangles, evenly spread over the cell's list.
    fn offering(&self, samples: usize) -> impl Iterator<Item = [DVec3; 3]> + '_ {
        let list = self.pieces.list();
        let n = samples.min(list.len());
        (0..n).map(move |i| self.geometry.corners(list[spread(i, n, list.len())].prim).map(|p| p.as_dvec3()))
    }
}

/// The middle of the `i`-th of `n` equal parts of a list.
const fn spread(i: usize, n: usize, len: usize) -> usize {
    (2 * i + 1) * len / (2 * n)
}

/// The corners of some triangles of a cell, together, for counting sides.
struct Sample {
    corners: Vec<DVec3>,
    ends: Vec<usize>,
    /// How many triangles each of them stands for.
    weight: f64,
}

impl Sample {
    fn of(content: &Content) -> Self {
        let list = content.pieces.list();
        let n = list.len().min(COUNTED);
        let mut sample = Self { corners: Vec::with_capacity(4 * n), ends: Vec::with_capacity(n), weight: 1.0 };
        for i in 0..n {
            content.pieces.corners(&list[spread(i, n, list.len())], content.geometry, &mut sample.corners);
            sample.ends.push(sample.corners.len());
        }
        sample.weight = list.len() as f64 / n.max(1) as f64;
        sample
    }

    fn deal(&self, plane: &Plane, slack: &Slack) -> Dealt {
        let (mut below, mut above, mut start) = (0u32, 0u32, 0);
        let band = slack.of(plane, true);
        for end in &self.ends {
            let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
            for p in &self.corners[start..*end] {
                let s = plane.distance(*p);
                low = if s < low { s } else { low };
                high = if s > high { s } else { high };
            }
            start = *end;
            let sides = Sides::of(low, high, band);
            below += u32::from(sides != Sides::Above);
            above += u32::from(sides != Sides::Below);
        }
        Dealt { below: f64::from(below) * self.weight, above: f64::from(above) * self.weight }
    }
}
