//! Which plane divides a cell best, by the surface area heuristic (MacDonald and Booth 1990).

use crate::geometry::{Aabb, Axis, num};
use crate::scene::PrimRef;

/// The most candidate planes on an axis of a large cell, plus one.
pub const MAX_BINS: u32 = 128;

/// A triangle in a cell: the box around the part of it that lies there (at most that large).
#[derive(Clone, Copy, Debug)]
pub struct KdRef {
    /// Within the cell.
    pub bounds: Aabb,
    /// The triangle.
    pub prim: PrimRef,
}

/// The weights.
#[derive(Clone, Copy, Debug)]
pub struct Costs {
    /// Planes tried on each axis of a large cell, plus one.
    pub bins: u32,
    /// Cost of a step.
    pub c_trav: f64,
    /// Cost of testing a triangle.
    pub c_isect: f64,
    /// Share forgiven when one side is empty.
    pub empty_bonus: f64,
}

/// A plane that was chosen.
#[derive(Clone, Copy, Debug)]
pub struct Plane {
    /// The axis it is perpendicular to.
    pub axis: Axis,
    /// Where it crosses the axis.
    pub pos: f32,
    /// The cost of the divided cell.
    pub cost: f64,
}

/// Cells with at most this many triangles try every face of every box; larger ones try equal bins.
const EXACT: usize = 256;

impl Costs {
    /// The cost of not dividing.
    pub fn leaf(&self, refs: usize) -> f64 {
        self.c_isect * refs as f64
    }

    /// The cheapest plane strictly inside the cell, if there is any candidate.
    pub fn best_plane(&self, cell: &Aabb, refs: &[KdRef]) -> Option<Plane> {
        let on_axis = |axis| if refs.len() <= EXACT { self.swept(cell, refs, axis) } else { self.binned(cell, refs, axis) };
        Axis::ALL.into_iter().filter_map(on_axis).min_by(|a, b| a.cost.total_cmp(&b.cost))
    }

    /// The cost of a plane with `below` and `above` triangles on its sides.
    fn plane(&self, cell: &Aabb, axis: Axis, pos: f32, below: usize, above: usize) -> Plane {
        let (low, high) = cell.split(axis, pos);
        let bonus = if below == 0 || above == 0 { 1.0 - self.empty_bonus } else { 1.0 };
        let tests = (low.area() * below as f64 + high.area() * above as f64) / cell.area();
        Plane { axis, pos, cost: self.c_trav + self.c_isect * bonus * tests }
    }

    /// Every face of every box, in order: a box is counted below from its start on, above up to its
    /// end; one that lies in the plane is below.
    fn swept(&self, cell: &Aabb, refs: &[KdRef], axis: Axis) -> Option<Plane> {
        let k = axis.index();
        let mut starts = [0f32; EXACT];
        let mut ends = [0f32; EXACT];
        let (starts, ends) = (&mut starts[..refs.len()], &mut ends[..refs.len()]);
        for (i, r) in refs.iter().enumerate() {
            (starts[i], ends[i]) = (r.bounds.min[k], r.bounds.max[k]);
        }
        starts.sort_unstable_by(f32::total_cmp);
        ends.sort_unstable_by(f32::total_cmp);
        let mut best: Option<Plane> = None;
        let (mut started, mut ended) = (0, 0);
        while ended < ends.len() {
            let pos = if started < starts.len() { starts[started].min(ends[ended]) } else { ends[ended] };
            // Below: what starts before the plane, or lies in it. Above: what ends after it.
            let before = started;
            started += starts[started..].iter().take_while(|s| **s <= pos).count();
            let ends_here = ends[ended..].iter().take_while(|e| **e <= pos).count();
            if cell.min[k] < pos && pos < cell.max[k] {
                // What starts and ends here lies in the plane; of what starts here, the rest is above.
                let flat = flat_at(refs, k, pos, started - before, ends_here);
                let candidate = self.plane(cell, axis, pos, before + flat, refs.len() - ended - ends_here);
                if best.is_none_or(|b| candidate.cost < b.cost) {
                    best = Some(candidate);
                }
            }
            ended += ends_here;
        }
        best
    }

    /// Equal bins: a box is counted in the bin of its start and in that of its end.
    fn binned(&self, cell: &Aabb, refs: &[KdRef], axis: Axis) -> Option<Plane> {
        let (k, bins) = (axis.index(), self.bins as usize);
        let (origin, width) = (cell.min[k], cell.size()[k]);
        let per_unit = bins as f32 / width;
        if !per_unit.is_finite() {
            return None;
        }
        let bin = |x: f32| num::floor_index(f64::from((x - origin) * per_unit), bins - 1);
        let (mut starts, mut ends) = ([0usize; MAX_BINS as usize], [0usize; MAX_BINS as usize]);
        for r in refs {
            starts[bin(r.bounds.min[k])] += 1;
            ends[bin(r.bounds.max[k])] += 1;
        }
        let (mut below, mut above) = (0, refs.len());
        let mut best: Option<Plane> = None;
        for i in 1..bins {
            below += starts[i - 1];
            above -= ends[i - 1];
            let pos = origin + width * (i as f32 / bins as f32);
            if cell.min[k] < pos && pos < cell.max[k] {
                let candidate = self.plane(cell, axis, pos, below, above);
                if best.is_none_or(|b| candidate.cost < b.cost) {
                    best = Some(candidate);
                }
            }
        }
        best
    }
}

/// How many boxes lie entirely in the plane; only looked for where some start and some end there.
fn flat_at(refs: &[KdRef], k: usize, pos: f32, starting: usize, ending: usize) -> usize {
    if starting == 0 || ending == 0 {
        return 0;
    }
    refs.iter().filter(|r| r.bounds.min[k] == pos && r.bounds.max[k] == pos).count()
}
