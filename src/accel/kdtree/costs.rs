//! What a plane costs, by the surface area heuristic (MacDonald and Booth 1990).

use crate::geometry::{Aabb, Axis};

/// The weights.
#[derive(Clone, Copy, Debug)]
pub struct Costs {
    /// Cost of a step.
    pub c_trav: f64,
    /// Cost of testing a triangle.
    pub c_isect: f64,
    /// Share forgiven when one side is empty (Wald and Havran 2006, §3.2).
    pub empty_bonus: f64,
}

/// A plane that divides a cell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plane {
    /// The axis it is perpendicular to.
    pub axis: Axis,
    /// Where it crosses the axis.
    pub pos: f32,
    /// Which side gets the triangles that lie in it.
    pub planar_below: bool,
    /// The cost of the divided cell, nothing forgiven.
    pub cost: f64,
    /// The cost by which it was chosen: less, if one side is empty.
    pub forgiven: f64,
}

/// A plane across some axis.
#[derive(Clone, Copy, Debug)]
pub struct Candidate {
    pos: f32,
    planar_below: bool,
    /// The expected number of triangles tested, times the cell's area.
    tests: f64,
    /// The share of it that counts when planes are compared.
    counts: f64,
}

impl Candidate {
    /// Worse than any plane.
    pub const NONE: Self = Self { pos: 0.0, planar_below: true, tests: f64::INFINITY, counts: 1.0 };

    /// The cheaper one; the first of equals.
    #[inline(always)]
    pub fn or(self, other: Self) -> Self {
        if other.weight() < self.weight() { other } else { self }
    }

    #[inline(always)]
    fn weight(&self) -> f64 {
        self.tests * self.counts
    }
}

impl Costs {
    /// The cost of not dividing.
    pub fn leaf(&self, refs: usize) -> f64 {
        self.c_isect * refs as f64
    }

    /// What planes across an axis of the cell cost.
    pub fn on_axis(&self, cell: &Aabb, axis: Axis) -> OnAxis {
        let (k, d) = (axis.index(), cell.size().as_dvec3());
        let (b, c) = (d[(k + 1) % 3], d[(k + 2) % 3]);
        let (min, max) = (cell.min[k], cell.max[k]);
        OnAxis { min, max, ends: 2.0 * b * c, girth: 2.0 * (b + c), width: d[k], counts_if_empty: 1.0 - self.empty_bonus }
    }

    /// The cheapest of the axes' candidates, the first of equals; `None` if there is none at all.
    pub fn cheapest(&self, cell: &Aabb, found: [Candidate; 3]) -> Option<Plane> {
        let cheaper = |a: (Candidate, Axis), b: (Candidate, Axis)| if b.0.weight() < a.0.weight() { b } else { a };
        let (best, axis) = found.into_iter().zip(Axis::ALL).reduce(cheaper)?;
        let cost = |tests: f64| self.c_trav + self.c_isect * tests / cell.area();
        let (cost, forgiven) = (cost(best.tests), cost(best.weight()));
        cost.is_finite().then_some(Plane { axis, pos: best.pos, planar_below: best.planar_below, cost, forgiven })
    }
}

/// The areas of the sides of a plane are linear in where it is.
#[derive(Clone, Copy, Debug)]
pub struct OnAxis {
    /// Where the cell begins; planes lie strictly inside.
    pub min: f32,
    /// Where it ends.
    pub max: f32,
    /// The area of its two faces across the axis.
    ends: f64,
    /// The circumference of such a face.
    girth: f64,
    width: f64,
    /// The share of the cost that counts when one side is empty.
    counts_if_empty: f64,
}

impl OnAxis {
    /// Whether a plane lies strictly inside.
    #[inline(always)]
    pub fn inside(&self, pos: f32) -> bool {
        (self.min < pos) & (pos < self.max)
    }

    /// A plane with so many triangles on either side, those in it among them.
    #[inline(always)]
    pub fn candidate(&self, pos: f32, planar_below: bool, below: f64, above: f64) -> Candidate {
        let depth = f64::from(pos) - f64::from(self.min);
        let tests = (self.ends + self.girth * depth) * below + (self.ends + self.girth * (self.width - depth)) * above;
        let counts = if below == 0.0 || above == 0.0 { self.counts_if_empty } else { 1.0 };
        Candidate { pos, planar_below, tests, counts }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    #[test]
    fn a_plane_costs_what_the_areas_of_its_sides_say() {
        let costs = Costs { c_trav: 1.0, c_isect: 1.5, empty_bonus: 0.2 };
        let cell = Aabb { min: Vec3::new(0.5, 0.0, -1.0), max: Vec3::new(2.5, 1.0, 2.0) };
        for axis in Axis::ALL {
            let on = costs.on_axis(&cell, axis);
            let pos = cell.min[axis.index()] + 0.25;
            let (low, high) = cell.split(axis, pos);
            let is = |found: Plane, cost: f64| (found.cost - cost).abs() < 1e-12;
            let plane = |below, above| {
                let found = on.candidate(pos, true, below, above);
                costs.cheapest(&cell, [Candidate::NONE, found, Candidate::NONE]).expect("one")
            };
            let expected = 1.0 + 1.5 * (3.0 * low.area() + 5.0 * high.area()) / cell.area();
            assert!(is(plane(3.0, 5.0), expected) && plane(3.0, 5.0).forgiven == plane(3.0, 5.0).cost);
            let tests = 1.5 * 5.0 * high.area() / cell.area();
            assert!(is(plane(0.0, 5.0), 1.0 + tests) && (plane(0.0, 5.0).forgiven - 1.0 - 0.8 * tests).abs() < 1e-12);
            assert!(on.inside(pos) && !on.inside(on.min) && !on.inside(on.max));
        }
        assert_eq!(costs.cheapest(&cell, [Candidate::NONE; 3]), None);
    }
}
