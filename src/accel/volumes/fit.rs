//! Volumes around the nodes of a tree, the deepest first, so that a node's fit can build on its
//! children's.
//!
//! Nodes of one depth are fitted in parallel. A fit passes over its points a few times, so the work
//! is that of the points times the depth of the tree, which is at most [`MAX_DEPTH`].

use rayon::prelude::*;

use super::points::{Points, levels, ranges};
use super::volume::Volume;
use crate::accel::bvh::{Built, MAX_DEPTH};
use crate::accel::{BuildCx, BuildError, Fits};
use crate::task::{Cancelled, Charge, OverBudget};

const _: () = assert!(MAX_DEPTH == 64, "the depth that bounds the work");

/// A node to be fitted and what its children handed up.
type Job<V> = (u32, Option<[<V as Volume>::Up; 2]>);

/// A node, its fit, and what that hands up.
type Done<V> = (u32, <V as Volume>::Fit, <V as Volume>::Up);

/// The fits of all nodes, in their order. `boxes` says what a volume must hold (see [`Points`]);
/// `charge` grows by what fits hold besides their own size.
pub fn fit<V: Volume>(built: &Built, boxes: bool, charge: &mut Charge, cx: &BuildCx) -> Result<Vec<V::Fit>, BuildError> {
    let nodes = &built.nodes;
    cx.progress.start("fit", nodes.len() as u64);
    let ranges = ranges(nodes.iter().map(|node| node.first_and_count()));
    let mut fits: Vec<Option<V::Fit>> = nodes.iter().map(|_| None).collect();
    let mut ups: Vec<Option<V::Up>> = nodes.iter().map(|_| None).collect();
    let centre = built.geometry.bounds().centre();
    let fit_one = |(node, below): Job<V>| {
        let range = &ranges[node as usize];
        let triangles = &built.packed[range.start as usize..range.end as usize];
        let bounds = nodes[node as usize].bounds();
        let points = Points { triangles, bounds, centre, boxes, cancel: &cx.cancel };
        cx.cancel.check()?;
        let (fit, up) = V::around(&points, below)?;
        cx.progress.advance(1);
        Ok((node, fit, up))
    };
    for level in levels(nodes).iter().rev() {
        let mut take = |node: usize| ups[node].take();
        let jobs: Vec<Job<V>> = level
            .iter()
            .map(|node| {
                let left = nodes[*node as usize].left().map(|left| left as usize);
                (*node, left.and_then(|left| Some([take(left)?, take(left + 1)?])))
            })
            .collect();
        let done: Result<Vec<Done<V>>, Cancelled> = cx.pool.run(|| jobs.into_par_iter().with_max_len(64).map(fit_one).collect());
        let done = done?;
        charge.grow(done.iter().map(|(_, fit, _)| V::fit_bytes(fit)).sum()).map_err(too_large)?;
        for (node, fit, up) in done {
            fits[node as usize] = Some(fit);
            ups[node as usize] = Some(up);
        }
    }
    Ok(fits.into_iter().flatten().collect())
}

/// What to say when the memory budget does not suffice.
pub fn too_large(over: OverBudget) -> BuildError {
    BuildError::Memory { structure: "volumes", over, remedy: "Raise the memory budget, or use bvh.", fits: Fits::default() }
}
