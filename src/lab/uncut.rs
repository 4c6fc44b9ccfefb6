//! What random lines do in a structure if nothing ends them early, beside what the areas of its cells
//! say. That holds where cells nest; where it does not agree, a count or an area is wrong.

use rayon::prelude::*;
use std::time::Instant;

use super::counting::Counted;
use super::lines::line;
use crate::accel::Accel;
use crate::accel::probe::Counts;
use crate::geometry::{Aabb, num};
use crate::task::{Cancel, Cancelled, Pool};

/// Counts of lines through the whole structure, in the mean of those that meet its root.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct UncutLines {
    /// Lines that met the root.
    pub lines: u64,
    /// Nodes and cells entered by a line.
    pub nodes: f64,
    /// The standard error of that mean.
    pub nodes_error: f64,
    /// Primitives tested by a line.
    pub tests: f64,
    /// The standard error of that mean.
    pub tests_error: f64,
}

/// When there are enough lines.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Enough {
    /// Three standard errors of both means are within this share of them.
    pub three_sigma: f64,
    /// Or this long was counted.
    pub secs: f64,
    /// Or there were this many.
    pub lines: u64,
}

impl Default for Enough {
    fn default() -> Self {
        Self { three_sigma: 0.01, secs: 2.0, lines: 4_000_000 }
    }
}

/// Lines of the first batch, so that structures which are slow are found out early.
const FIRST: u64 = 64;
/// Fewer say too little of how much they differ.
const FEWEST: u64 = 4096;

impl UncutLines {
    /// Counts ever larger batches until there are enough. Lines go through the box of the root.
    ///
    /// # Errors
    /// [`Cancelled`] if asked to stop.
    pub fn count(accel: &dyn Accel, enough: &Enough, pool: &Pool, cancel: &Cancel) -> Result<Self, Cancelled> {
        let (space, root) = (accel.geometry().space(), *accel.root().shape.bounds());
        let bounds = Aabb { min: space.world_point(root.min), max: space.world_point(root.max) };
        let (mut sum, mut done, start) = (Counted::default(), 0, Instant::now());
        while !accel.geometry().world_bounds().is_empty() {
            let secs = start.elapsed().as_secs_f64();
            // No batch shall take much longer than what is left.
            let within = ((enough.secs - secs) / secs.max(1e-6) * done as f64).clamp(0.0, 1e15);
            let more = if done == 0 { FIRST } else { done.min(num::floor_index(within, usize::MAX) as u64) };
            let more = more.min(enough.lines - done);
            if more == 0 || (done >= FEWEST && Self::of(&sum).is_within(enough.three_sigma)) {
                break;
            }
            sum.join(&batch(accel, &bounds, done..done + more, pool, cancel)?);
            done += more;
        }
        Ok(Self::of(&sum))
    }

    fn of(sum: &Counted) -> Self {
        Self {
            lines: sum.nodes.n,
            nodes: sum.nodes.mean(),
            nodes_error: sum.nodes.error(),
            tests: sum.prims.mean(),
            tests_error: sum.prims.error(),
        }
    }

    /// Whether three standard errors of both means are within a share of them.
    pub fn is_within(&self, share: f64) -> bool {
        3.0 * self.nodes_error <= share * self.nodes && 3.0 * self.tests_error <= share * self.tests
    }
}

fn batch(
    accel: &dyn Accel,
    bounds: &Aabb,
    lines: std::ops::Range<u64>,
    pool: &Pool,
    cancel: &Cancel,
) -> Result<Counted, Cancelled> {
    let follow = |mut sum: Counted, i| {
        let mut counts = Counts::default();
        accel.count_uncut(&line(bounds, i), &mut counts, cancel)?;
        // A line that meets the root's box, but not the root, is none of those that are asked for.
        if counts.nodes > 0 {
            sum.add(counts);
        }
        Ok(sum)
    };
    let join = |mut a: Counted, b: Counted| {
        a.join(&b);
        Ok(a)
    };
    pool.run(|| lines.into_par_iter().try_fold(Counted::default, follow).try_reduce(Counted::default, join))
}
