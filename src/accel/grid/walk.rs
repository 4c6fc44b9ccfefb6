//! How a ray steps from cell to cell (Amanatides and Woo 1987), with each plane's t worked out from
//! the plane's number in 64 bits.

use super::lattice::Lattice;
use crate::geometry::Ray;

/// A ray in 64 bits. The axes come as arrays, since they are picked by number.
#[derive(Clone, Copy, Debug)]
pub struct Line {
    origin: [f64; 3],
    dir: [f64; 3],
    inv: [f64; 3],
    /// The ray's interval and the error that t of a hit carries from the triangle test.
    from: f64,
    to: f64,
}

impl Line {
    /// For lattices of that slack.
    #[inline(always)]
    pub fn new(ray: &Ray, slack: f64) -> Self {
        let (origin, dir) = (ray.origin.as_dvec3(), ray.dir.as_dvec3());
        let (from, to) = (f64::from(ray.tmin) - 4.0 * slack, f64::from(ray.tmax) + 4.0 * slack);
        Self { origin: origin.into(), dir: dir.into(), inv: (1.0 / dir).into(), from, to }
    }
}

/// Where a step leads.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Step {
    /// Into the next cell.
    In,
    /// Out of the lattice.
    Out,
    /// Nowhere: the best hit lies before whatever comes next.
    Done,
}

/// A ray on its way through the cells.
#[derive(Clone, Copy, Debug)]
pub struct Walk<'a> {
    lattice: &'a Lattice,
    line: &'a Line,
    /// The cell it is in.
    pub at: [usize; 3],
    /// The t at which each axis is next crossed; infinite for an axis it is parallel to.
    next: [f64; 3],
}

impl<'a> Walk<'a> {
    /// Starts where the ray's interval begins inside the lattice; `None` if it misses it. The
    /// lattice is taken with its slack, so a ray that runs along its face is inside: a lattice in a
    /// cell of another is not lost to the rounding of its outermost planes.
    #[inline(always)]
    pub fn enter(lattice: &'a Lattice, line: &'a Line) -> Option<Self> {
        let (mut entry, mut exit) = (line.from, line.to);
        for k in 0..3 {
            let low = lattice.plane(k, 0) - lattice.slack - line.origin[k];
            let high = lattice.plane(k, lattice.resolution[k]) + lattice.slack - line.origin[k];
            if line.dir[k] == 0.0 {
                if low > 0.0 || high < 0.0 {
                    return None;
                }
            } else {
                let (a, b) = (low * line.inv[k], high * line.inv[k]);
                entry = entry.max(a.min(b));
                exit = exit.min(a.max(b));
            }
        }
        if entry > exit {
            return None;
        }
        let at = [0, 1, 2].map(|k| lattice.layer(k, line.origin[k] + line.dir[k] * entry));
        let mut walk = Self { lattice, line, at, next: [f64::INFINITY; 3] };
        (0..3).filter(|k| line.dir[*k] != 0.0).for_each(|k| walk.next[k] = walk.crossing(k));
        Some(walk)
    }

    /// The t at which the ray leaves its layer on an axis.
    #[inline(always)]
    fn crossing(&self, k: usize) -> f64 {
        let plane = self.lattice.plane(k, self.at[k] + usize::from(self.line.inv[k] > 0.0));
        (plane - self.line.origin[k]) * self.line.inv[k]
    }

    /// The axis that is crossed next.
    #[inline(always)]
    fn axis(&self) -> usize {
        let [x, y, z] = self.next;
        if x <= y && x <= z {
            0
        } else if y <= z {
            1
        } else {
            2
        }
    }

    /// Steps into the next cell. A hit may lie outside the cell it was found in, so the walk is done
    /// only when the best hit lies before the next cell, less the slack along the axis crossed.
    #[inline(always)]
    pub fn step(&mut self, best_t: f32) -> Step {
        let k = self.axis();
        let earliest = self.next[k] - self.lattice.slack * self.line.inv[k].abs();
        if f64::from(best_t) < earliest {
            return Step::Done;
        }
        let forward = self.line.inv[k] > 0.0;
        if self.at[k] == if forward { self.lattice.resolution[k] - 1 } else { 0 } {
            return Step::Out;
        }
        if forward {
            self.at[k] += 1;
        } else {
            self.at[k] -= 1;
        }
        self.next[k] = self.crossing(k);
        Step::In
    }
}
