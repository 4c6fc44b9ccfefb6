//! The exact search for a plane: every place where a box begins or ends is tried, by one sweep over
//! the sorted events of each axis (Wald and Havran 2006, §4.2).

use rayon::prelude::*;

use super::costs::{Candidate, Costs, OnAxis, Plane};
use super::events::Event;
use crate::geometry::{Aabb, Axis};
use crate::task::{Cancel, Cancelled};

/// Events from which on a cell is swept in parallel, and in what portions.
const PARALLEL: usize = 1 << 15;
const CHUNK: usize = 1 << 14;

/// The cheapest plane strictly inside a cell of so many references.
pub fn best_plane(
    costs: &Costs,
    cell: &Aabb,
    refs: usize,
    lists: [&[Event]; 3],
    cancel: &Cancel,
) -> Result<Option<Plane>, Cancelled> {
    let on = Axis::ALL.map(|axis| costs.on_axis(cell, axis));
    let start = Counts { below: 0.0, above: refs as f64 };
    let found = if lists[0].len() < PARALLEL {
        [0, 1, 2].map(|k| sweep(lists[k], &on[k], start))
    } else {
        let axis = |k: usize| in_chunks(lists[k], &on[k], start, cancel);
        let (x, (y, z)) = rayon::join(|| axis(0), || rayon::join(|| axis(1), || axis(2)));
        [x?, y?, z?]
    };
    Ok(costs.cheapest(cell, found))
}

/// How many boxes begin before a plane, and how many end behind it.
#[derive(Clone, Copy, Debug)]
struct Counts {
    below: f64,
    above: f64,
}

/// A first pass counts, so that each chunk knows where it starts; a second one looks for planes.
fn in_chunks(events: &[Event], on: &OnAxis, start: Counts, cancel: &Cancel) -> Result<Candidate, Cancelled> {
    let count = |chunk: &[Event]| {
        cancel.check().map(|()| (chunk.iter().filter(|e| e.begins()).count(), chunk.iter().filter(|e| e.ends()).count()))
    };
    let counted: Vec<_> = events.par_chunks(CHUNK).map(count).collect::<Result<_, _>>()?;
    let starts: Vec<Counts> = counted
        .iter()
        .scan(start, |at, (begin, end)| {
            let here = *at;
            *at = Counts { below: at.below + *begin as f64, above: at.above - *end as f64 };
            Some(here)
        })
        .collect();
    let look = |(chunk, start): (&[Event], &Counts)| cancel.check().map(|()| sweep(chunk, on, *start));
    let found: Vec<Candidate> = events.par_chunks(CHUNK).zip(&starts).map(look).collect::<Result<_, _>>()?;
    Ok(found.into_iter().fold(Candidate::NONE, Candidate::or))
}

/// Sweeps some events. At each the plane is weighed with what is known by then: at an end this box
/// no longer counts above, at a start not yet below. Among events of one place that counts some
/// boxes twice, but never too few, and the last end and the first start count right: so the minimum
/// is right, and places need not be told apart. Of the boxes in a plane, the last one sees all of
/// them below, the first one all above; in between the cost is between those two.
fn sweep(events: &[Event], on: &OnAxis, start: Counts) -> Candidate {
    let Counts { mut below, mut above } = start;
    let mut best = Candidate::NONE;
    for event in events {
        let (begins, pos) = (event.begins(), event.pos());
        let ends = event.ends();
        above -= if ends { 1.0 } else { 0.0 };
        if on.inside(pos) {
            if begins & ends {
                best = best.or(on.candidate(pos, false, below, above + 1.0));
                best = best.or(on.candidate(pos, true, below + 1.0, above));
            } else {
                best = best.or(on.candidate(pos, begins, below, above));
            }
        }
        below += if begins { 1.0 } else { 0.0 };
    }
    best
}
