//! The search for a plane among few: equal bins along each axis count where boxes begin and where
//! they end, and the planes between bins are tried (Popov et al. 2006; Hunt, Mark and Stoll 2006;
//! counting both ends: Shevtsov, Soupikov and Kapustin 2007, "Highly Parallel Fast KD-tree
//! Construction"; Danilewski, Popov and Slusallek 2010). One pass over the boxes, no order needed.

use rayon::prelude::*;

use super::costs::{Candidate, Costs, Plane};
use super::deal::KdRef;
use crate::geometry::{Aabb, Axis, num};
use crate::task::{Cancel, Cancelled};

/// The most bins on an axis.
pub const MAX_BINS: u32 = 256;

const MOST: usize = MAX_BINS as usize;

/// References from which on a cell is binned in parallel, and in what portions.
const PARALLEL: usize = 1 << 15;
const CHUNK: usize = 1 << 13;

/// How many boxes begin, and how many end, in each bin of each axis.
#[derive(Clone)]
struct Counted {
    begin: [[u32; MOST]; 3],
    end: [[u32; MOST]; 3],
}

impl Counted {
    const NOTHING: Self = Self { begin: [[0; MOST]; 3], end: [[0; MOST]; 3] };

    fn of(refs: &[KdRef], scales: &[Scale; 3]) -> Self {
        let mut counted = Self::NOTHING;
        for r in refs {
            for (k, scale) in scales.iter().enumerate() {
                counted.begin[k][scale.bin(r.bounds.min[k])] += 1;
                counted.end[k][scale.bin(r.bounds.max[k])] += 1;
            }
        }
        counted
    }

    fn join(mut self, other: &Self) -> Self {
        let all = self.begin.iter_mut().chain(&mut self.end).flatten();
        all.zip(other.begin.iter().chain(&other.end).flatten()).for_each(|(a, b)| *a += b);
        self
    }
}

/// From a place on an axis to its bin, and back to where bins begin.
#[derive(Clone, Copy)]
struct Scale {
    origin: f32,
    width: f32,
    /// 0 if the axis is too short to divide.
    per_unit: f32,
    bins: usize,
}

impl Scale {
    fn new(cell: &Aabb, k: usize, bins: u32) -> Self {
        let (origin, width) = (cell.min[k], cell.size()[k]);
        let per_unit = bins as f32 / width;
        Self { origin, width, per_unit: if per_unit.is_finite() { per_unit } else { 0.0 }, bins: bins as usize }
    }

    #[inline(always)]
    fn bin(&self, x: f32) -> usize {
        num::floor_index(f64::from((x - self.origin) * self.per_unit), self.bins - 1)
    }

    fn begin(&self, bin: usize) -> f32 {
        self.origin + self.width * (bin as f32 / self.bins as f32)
    }
}

/// The cheapest plane between `bins` equal bins on each axis, strictly inside the cell.
pub fn best_plane(costs: &Costs, cell: &Aabb, refs: &[KdRef], bins: u32, cancel: &Cancel) -> Result<Option<Plane>, Cancelled> {
    let scales = [0, 1, 2].map(|k| Scale::new(cell, k, bins));
    let counted = if refs.len() < PARALLEL {
        Counted::of(refs, &scales)
    } else {
        let chunk = |refs: &[KdRef]| cancel.check().map(|()| Box::new(Counted::of(refs, &scales)));
        let join = |a: Box<Counted>, b: Box<Counted>| Ok(Box::new(a.join(&b)));
        *refs.par_chunks(CHUNK).map(chunk).try_reduce(|| Box::new(Counted::NOTHING), join)?
    };
    let found = [0, 1, 2].map(|k| {
        let on = costs.on_axis(cell, Axis::ALL[k]);
        let (mut below, mut above) = (0, refs.len());
        let mut best = Candidate::NONE;
        for bin in 1..scales[k].bins {
            below += counted.begin[k][bin - 1] as usize;
            above -= counted.end[k][bin - 1] as usize;
            let pos = scales[k].begin(bin);
            if on.inside(pos) {
                // Boxes in a plane are counted above it, as the bin that begins there holds them.
                best = best.or(on.candidate(pos, false, below as f64, above as f64));
            }
        }
        best
    });
    Ok(costs.cheapest(cell, found))
}
